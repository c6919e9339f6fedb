// Exchanged, reversed and misread channels as hypotheses.
#include "diagnosis/wiring_doubts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/input_error.hpp"
#include "diagnosis/channel_doubts.hpp"
#include "diagnosis/cylinder_recording.hpp"
#include "diagnosis/even_samples.hpp"
#include "diagnosis/force_balance.hpp"
#include "diagnosis/stretches.hpp"

namespace pneuservo {

namespace {

constexpr double judged_s = 6;     ///< of each recording: some strokes
constexpr double force_judged_s = 20;
constexpr double judge_effort = 60;  ///< cells times sub-steps: a share of the pressures' swing is enough
/// Machines with the faults that a diagnosis looks for miss by 0.1 to 3 swings of their pressures, with exchanged or
/// reversed channels by 2.6 to 67, and never less than 2.6 times what they miss by as they are wired.
constexpr double doubtful_wiring = 1.0, doubtful_unit = 0.25;  ///< misfit as recorded below which nothing is doubted
constexpr double decisive = 0.4;  ///< of the misfit as recorded, that another reading must come down to
/// Of the lead that a held force has: a force is of its instant where its own lead is less, and known to that.
constexpr double instant_share = 0.4, least_known = 0.2;
constexpr double slow_share = 0.1;  ///< of the top speed: slower motion may stick
constexpr double infinite_misfit = std::numeric_limits<double>::infinity();

void exchange(Recording& recording, const std::string& a, const std::string& b) {
  if (recording.has(a) && recording.has(b)) std::swap(recording.column(a), recording.column(b));
}

void reverse(Recording& recording, const std::string& column) {
  if (recording.has(column)) apply_reading({-1, 0, ""}, recording.column(column));
}

struct Wiring {
  std::string name, remedy;
  std::function<void(Recording&)> apply;
};

std::vector<Wiring> wirings(const Recording& recording) {
  std::vector<Wiring> out;
  const bool ports = recording.has("p1_port_Pa") && recording.has("p2_port_Pa");
  const std::string kind = ports ? "port" : "chamber";
  out.push_back(
      {fmt::format("p1_{0} and p2_{0} are exchanged", kind),
       fmt::format("import.columns: p1_{0}_Pa: {{column: p2_{0}_Pa}}, p2_{0}_Pa: {{column: p1_{0}_Pa}}", kind),
       [kind](Recording& r) { exchange(r, fmt::format("p1_{}_Pa", kind), fmt::format("p2_{}_Pa", kind)); }});
  if (ports && recording.has("p1_chamber_Pa"))
    out.push_back({"sides 1 and 2 of ports and chambers are exchanged",
                   "import.columns: p1_port_Pa: {column: p2_port_Pa}, and so on", [](Recording& r) {
                     exchange(r, "p1_port_Pa", "p2_port_Pa");
                     exchange(r, "p1_chamber_Pa", "p2_chamber_Pa");
                   }});
  out.push_back({"u_V has the other sign", "import.columns.u_V: {column: u_V, factor: -1}",
                 [](Recording& r) { reverse(r, "u_V"); }});
  out.push_back({"x_m counts the other way", "import.columns.x_m: {column: x_m, factor: -1}",
                 [](Recording& r) { reverse(r, "x_m"); }});
  return out;
}

/// Squared difference and squared swing of one channel over the judged rows.
void add_misfit(const std::vector<double>& measured, const std::vector<double>& simulated,
                const std::vector<char>& usable, double& difference, double& swing) {
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < measured.size(); ++k)
    if (usable[k] && std::isfinite(measured[k])) sum += measured[k], ++count;
  const double mean = sum / std::max(count, 1.0);
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (!usable[k] || !std::isfinite(measured[k])) continue;
    difference += (simulated[k] - measured[k]) * (simulated[k] - measured[k]);
    swing += (measured[k] - mean) * (measured[k] - mean);
  }
}

/// The reading that alone brings the misfit down, or none where the first does not need one. Two are asked for.
const UnitReading& decided(const Rig& rig, const Recording& recording, const std::vector<UnitReading>& readings,
                           const std::vector<std::string>& columns, const std::string& what) {
  if (readings.size() == 1 || rig.kind != RigKind::cylinder) return readings.front();
  const bool is_as_recorded = readings.front().name.empty();
  std::vector<double> misfits;
  for (const UnitReading& reading : readings) {
    Recording tried = most_moving_part(recording, judged_s);
    for (const std::string& column : columns) apply_reading(reading, tried.column(column));
    misfits.push_back(port_misfit(rig, tried));
    if (is_as_recorded && misfits[0] < doubtful_unit) return readings.front();
  }
  const std::size_t best = static_cast<std::size_t>(std::min_element(misfits.begin(), misfits.end()) - misfits.begin());
  if (is_as_recorded && !(misfits[best] < decisive * misfits[0])) return readings.front();
  for (std::size_t i = 0; i < misfits.size(); ++i)
    if (i != best && misfits[best] > decisive * misfits[i])
      throw InputError(fmt::format("{}: {} or {}? State it: {}", what, readings[best].name, readings[i].name,
                                   stated_reading(columns.front(), readings[best])));
  return readings[best];
}

void take_reading(const Rig& rig, Recording& recording, const std::vector<UnitReading>& readings,
                  const std::vector<std::string>& columns, const std::string& evidence,
                  std::vector<std::string>& notes) {
  if (readings.empty())
    throw InputError(fmt::format("{}, expected that: in which unit? State it: {}", evidence,
                                 "import: {columns: {NAME: {column: NAME, factor: ...}}}"));
  const UnitReading reading = decided(rig, recording, readings, columns, evidence);
  if (reading.factor == 1 && reading.offset == 0) return;
  for (const std::string& column : columns) apply_reading(reading, recording.column(column));
  notes.push_back(fmt::format("{}: taken for {}; to state it: {}{}", evidence, reading.name,
                              stated_reading(columns.front(), reading),
                              columns.size() > 1 ? ", the others alike" : ""));
}

/// How much earlier the drive force comes than what the motion needs, and its standard error [s]: what stands before
/// the force's own rate in a regression on acceleration, friction and drag. NaN where too little moves.
std::pair<double, double> force_lead(const Rig& rig, const Recording& whole, double interval_s) {
  const Recording recording = most_moving_part(whole, force_judged_s);
  const EvenSamples even(recording.t_s(), interval_s);
  std::vector<double> force = even.straight(recording.column("F_N"));
  const ForceBalance balance(even.drawn(recording.column("x_m")), interval_s, rig.sensors.position.rms_m());
  std::vector<char> known = balance.usable();
  for (std::size_t i = 0; i < force.size(); ++i)
    if (!std::isfinite(force[i])) {
      force[i] = i > 0 ? force[i - 1] : 0;
      known[i] = 0;
    }
  const GaussianKernel& kernel = balance.kernel();
  const std::vector<double> drive = kernel.apply(force, 0), rate = kernel.apply(force, 1),
                            acceleration = kernel.apply(balance.velocity_mps(), 1);
  const std::vector<double>& v = balance.velocity_mps();
  const double slow = slow_share * std::max(quantile(v, 0.99), -quantile(v, 0.01));
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < drive.size(); ++i)
    if (known[i] && std::abs(v[i]) > slow) rows.push_back(i);
  if (rows.size() < 40 * kernel.reach()) return {std::nan(""), std::nan("")};
  Eigen::MatrixXd terms(static_cast<Eigen::Index>(rows.size()), 6);
  Eigen::VectorXd wanted(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::size_t i = rows[r];
    const auto at = static_cast<Eigen::Index>(r);
    terms.row(at) << acceleration[i], v[i], v[i] > 0 ? 1.0 : 0.0, v[i] > 0 ? 0.0 : -1.0, v[i] * std::abs(v[i]), rate[i];
    wanted(at) = drive[i];
  }
  const Eigen::MatrixXd inverse = (terms.transpose() * terms).inverse();
  const Eigen::VectorXd solved = inverse * (terms.transpose() * wanted);
  // Neighbours within the kernel's reach err alike.
  const double independent = static_cast<double>(rows.size()) / static_cast<double>(2 * kernel.reach());
  const double variance = (terms * solved - wanted).squaredNorm() / static_cast<double>(rows.size());
  return {solved(5),
          std::sqrt(variance * inverse(5, 5) * static_cast<double>(rows.size()) / std::max(independent, 1.0))};
}

}  // namespace

double port_misfit(const Rig& rig, const Recording& recording) {
  try {
    const CylinderRecording prepared = prepare_recording(recording, rig, judged_s);
    const ImposedRun run{&rig, {}};
    const GasCourse course =
        run_imposed(prepared.inputs, std::span(&run, 1), grid_for(rig, judge_effort, prepared.inputs.step_s()))[0];
    double difference = 0, swing = 0;
    for (const GasChannel channel : {port_1, port_2, chamber_1, chamber_2, supply})
      if (!prepared.measured_Pa[channel].empty())
        add_misfit(prepared.measured_Pa[channel], course[channel], prepared.usable, difference, swing);
    const double misfit = std::sqrt(difference / swing);
    return std::isfinite(misfit) ? misfit : infinite_misfit;
  } catch (const std::exception&) { return infinite_misfit; }
}

void doubt_units(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  if (rig.kind != RigKind::cylinder) return;
  const std::vector<std::string> pressures = pressure_columns(recording);
  if (!pressures.empty()) {
    double low = 1e300, high = -1e300;
    for (const std::string& column : pressures) {
      low = std::min(low, quantile(recording.column(column), 0.005));
      high = std::max(high, quantile(recording.column(column), 0.995));
    }
    take_reading(rig, recording, pressure_readings(rig, recording), pressures,
                 fmt::format("{}: {} go{} from {:.4g} to {:.4g} Pa, possible are {:.0f} to {:.0f} Pa absolute",
                             recording.path, fmt::join(pressures, ", "), pressures.size() == 1 ? "es" : "", low, high,
                             0.3 * rig.axis.air.atmosphere_Pa, 1.5 * rig.axis.supply.pressure_Pa),
                 notes);
  }
  if (recording.has("u_V") && std::isfinite(quantile(recording.column("u_V"), 0.5)))
    take_reading(rig, recording, command_readings(rig, recording), {"u_V"},
                 fmt::format("{}: u_V goes from {:.4g} to {:.4g} V, the valve takes +-{:g} V", recording.path,
                             quantile(recording.column("u_V"), 0.005), quantile(recording.column("u_V"), 0.995),
                             rig.axis.valve.command_max_V),
                 notes);
}

void doubt_wiring(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  if (rig.kind != RigKind::cylinder || !recording.has("x_m") || !recording.has("u_V")) return;
  Recording judged = most_moving_part(recording, judged_s);
  double misfit = port_misfit(rig, judged);
  for (int round = 0; round < 2 && !(misfit < doubtful_wiring); ++round) {  // two mistakes at once
    const std::vector<Wiring> tried = wirings(judged);
    std::size_t best = tried.size();
    double least = infinite_misfit;
    for (std::size_t i = 0; i < tried.size(); ++i) {
      Recording other = judged;
      tried[i].apply(other);
      const double here = port_misfit(rig, other);
      if (here < least) least = here, best = i;
    }
    if (best == tried.size() || !(least < decisive * misfit)) return;
    tried[best].apply(judged);
    tried[best].apply(recording);
    notes.push_back(fmt::format("{}: {}: simulated so, the pressures miss the measured ones by {:.0f} % of their swing "
                                "instead of {:.0f} %; compared so; to state it: {}",
                                recording.path, tried[best].name, 100 * least, std::min(100 * misfit, 9999.0),
                                tried[best].remedy));
    misfit = least;
  }
}

void doubt_sampling(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  if (rig.kind != RigKind::driven_axis || rig.has_pistons() || !recording.has("F_N")) return;
  const auto stated = recording.sampling.find("F_N");
  if (is_own_format(recording) || (stated != recording.sampling.end() && stated->second != Sampling::unstated)) return;
  const double interval_s = std::isfinite(recording.period_s) ? recording.period_s : rig.period_s;
  const double of_held_s = 0.5 * std::min(rig.period_s, interval_s);  // what a held force comes early by
  const auto [lead_s, error_s] = force_lead(rig, recording, interval_s);
  if (!(error_s < least_known * of_held_s) || std::abs(lead_s) > instant_share * of_held_s) return;
  recording.sampling["F_N"] = Sampling::instant;
  notes.push_back(
      fmt::format("{}: F_N comes {:.2g} +- {:.1g} ms before the motion that it makes, a force held from row to "
                  "row would come {:.2g} ms before it: taken as read at its rows' instants; to state it: "
                  "import.columns.F_N.sampling: instant",
                  recording.path, 1e3 * lead_s, 1e3 * error_s, 1e3 * of_held_s));
}

}  // namespace pneuservo
