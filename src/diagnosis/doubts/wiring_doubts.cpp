// Exchanged and reversed channels as hypotheses.
#include "diagnosis/doubts/wiring_doubts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pneuservo/rig/possible_values.hpp>

#include "config/input_error.hpp"
#include "diagnosis/doubts/channel_doubts.hpp"
#include "diagnosis/doubts/misfits.hpp"
#include "diagnosis/doubts/wiring_balance.hpp"
#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/recordings/even_samples.hpp"
#include "diagnosis/recordings/stretches.hpp"
#include "diagnosis/residuals/force_balance.hpp"

namespace pneuservo {

namespace {

constexpr double force_judged_s = 20;
constexpr double judge_effort = 60;  ///< cells times sub-steps: a share of the pressures' swing is enough
/// Of the misfit as recorded, that another wiring must come down to. On 106 recordings of machines with faults a wrong
/// wiring missed by 1.78 times what the right one missed by, or more: the geometric mean of that and equality.
constexpr double decisive_wiring = 0.75;
/// Means over which the difference of a side's two pressures is judged: it lasts as long as a stroke, white noise of
/// 600 Pa comes down to 85 Pa.
constexpr double side_mean_s = 0.05;
/// Of the lead that a held force has: a force is of its instant where its own lead is less, and known to that.
constexpr double instant_share = 0.4, least_known = 0.2;

void exchange(Recording& recording, const std::string& a, const std::string& b) {
  if (!recording.has(a) || !recording.has(b)) return;
  std::swap(recording.column(a), recording.column(b));
  const ImportedColumn one = source_of(recording, a), two = source_of(recording, b);
  recording.sources[a] = two;
  recording.sources[b] = one;
}

void reverse(Recording& recording, const std::string& column) {
  if (recording.has(column)) apply_reading({-1, 0, ""}, recording, column);
}

struct Wiring {
  std::string name;
  std::vector<std::string> columns;  ///< whose sources change
  std::function<void(Recording&)> apply;
};

using ColumnPair = std::pair<std::string, std::string>;

std::vector<Wiring> wirings(const Recording& recording) {
  std::vector<Wiring> out;
  const auto column = [](Signal signal) { return std::string(info(signal).column); };
  const auto add = [&](const std::string& name, const std::vector<ColumnPair>& pairs) {
    std::vector<std::string> columns;
    for (const auto& [a, b] : pairs) {
      if (!recording.has(a) || !recording.has(b)) return;
      columns.push_back(a);
      columns.push_back(b);
    }
    out.push_back({name, columns, [pairs](Recording& r) {
                     for (const auto& [a, b] : pairs) exchange(r, a, b);
                   }});
  };
  const auto add_pair = [&](Signal a, Signal b) {
    add(fmt::format("{} and {} are exchanged", info(a).name, info(b).name), {{column(a), column(b)}});
  };
  const ColumnPair ports{column(Signal::p1_port), column(Signal::p2_port)};
  const ColumnPair chambers{column(Signal::p1_chamber), column(Signal::p2_chamber)};
  add_pair(Signal::p1_port, Signal::p2_port);
  add_pair(Signal::p1_chamber, Signal::p2_chamber);
  add("sides 1 and 2 of ports and chambers are exchanged", {ports, chambers});
  add_pair(Signal::p1_port, Signal::p2_chamber);
  add_pair(Signal::p2_port, Signal::p1_chamber);
  for (const Signal pressure : {Signal::p1_port, Signal::p2_port, Signal::p1_chamber, Signal::p2_chamber})
    add_pair(pressure, Signal::p_supply);
  out.push_back({"u_V has the other sign", {"u_V"}, [](Recording& r) { reverse(r, "u_V"); }});
  out.push_back({"x_m counts the other way", {"x_m"}, [](Recording& r) { reverse(r, "x_m"); }});
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

struct Rewired {
  Wiring wiring;
  double misfit, misfit_as_recorded;
};

/// The other wiring under which the balances leave decisively less than as recorded, and than a constant.
std::optional<Rewired> rewired(const Rig& rig, const Recording& judged) {
  const double as_recorded = std::min(balance_misfit(rig, judged), own_swing);
  std::optional<Rewired> out;
  for (const Wiring& wiring : wirings(judged)) {
    Recording other = judged;
    wiring.apply(other);
    const double misfit = balance_misfit(rig, other);
    if (misfit < (out ? out->misfit : decisive_wiring * as_recorded)) out = Rewired{wiring, misfit, as_recorded};
  }
  return out;
}

/// How much earlier the drive force comes than what the motion needs, and its standard error [s]: what stands before
/// the force's own rate in a regression on acceleration, friction and drag. NaN where too little moves.
std::pair<double, double> force_lead(const Rig& rig, const Recording& whole, double interval_s) {
  const Recording recording = most_moving_part(whole, force_judged_s);
  const EvenSamples even(recording.t_s(), interval_s);
  const std::vector<double> measured = even.straight(recording.column("F_N")), force = held_over_gaps(measured);
  const ForceBalance balance(even.drawn(recording.column("x_m")), interval_s, rig.sensors.resolution(Signal::x));
  std::vector<char> known = balance.usable();
  for (std::size_t i = 0; i < known.size(); ++i) known[i] = known[i] && std::isfinite(measured[i]);
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

/// A recording and what the rig does under its command and motion.
struct Simulated {
  CylinderRecording prepared;
  GasCourse course;
};

Simulated simulated(const Rig& rig, const Recording& recording) {
  Simulated out{prepare_recording(recording, rig, judged_s), {}};
  const ImposedRun run{&rig, {}};
  const ImposedInputs& inputs = out.prepared.inputs;
  out.course = run_imposed(inputs, std::span(&run, 1), grid_for(rig, judge_effort, inputs.step_s()))[0];
  return out;
}

/// Means of equal length of one signal minus another; NaN where a row is not compared.
std::vector<double> mean_differences(const Simulated& of, const std::vector<double>& a, const std::vector<double>& b) {
  const auto length = static_cast<std::size_t>(std::max(1.0, side_mean_s / of.prepared.period_s()));
  std::vector<double> out;
  for (std::size_t first = 0; first + length <= a.size(); first += length) {
    double sum = 0;
    for (std::size_t k = first; k < first + length; ++k)
      sum += of.prepared.usable[k] ? a[k] - b[k] : std::numeric_limits<double>::quiet_NaN();
    out.push_back(sum / static_cast<double>(length));
  }
  return out;
}

/// What the pressures at both ends of a line differ by, against the simulated difference: as recorded it misses by
/// `misfit_as_recorded` of its swing, with both exchanged by `misfit`. A constant and the pressure's rate are taken out
/// of both, for sensors that are off or late make them. Absolute pressures run away by more than a line's difference.
struct SideMisfit {
  double misfit, misfit_as_recorded;
};

SideMisfit side_misfit(const Simulated& of, Signal port, Signal chamber) {
  const std::vector<double>&ports = of.course[port], &chambers = of.course[chamber];
  const std::vector<double> zero(ports.size(), 0.0);
  const std::vector<double> measured = mean_differences(of, of.prepared.measured[port], of.prepared.measured[chamber]);
  const std::vector<double> expected = mean_differences(of, ports, chambers), level = mean_differences(of, ports, zero);
  std::vector<std::size_t> rows;
  for (std::size_t i = 1; i + 1 < measured.size(); ++i)
    if (std::isfinite(measured[i] + expected[i] + level[i - 1] + level[i + 1])) rows.push_back(i);
  if (rows.size() < 10) return {infinite_misfit, infinite_misfit};
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd of_sensors(count, 2), differences(count, 2);
  for (Eigen::Index r = 0; r < count; ++r) {
    const std::size_t i = rows[static_cast<std::size_t>(r)];
    of_sensors.row(r) << 1.0, level[i + 1] - level[i - 1];
    differences.row(r) << measured[i], expected[i];
  }
  const Eigen::MatrixXd left = differences - of_sensors * of_sensors.colPivHouseholderQr().solve(differences);
  const double swing = left.col(0).norm();
  return {(left.col(0) + left.col(1)).norm() / swing, (left.col(0) - left.col(1)).norm() / swing};
}

/// The sensors at both ends of one line: exchanged where their difference fits decisively better with the other sign.
void doubt_sides(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  constexpr std::array<std::pair<Signal, Signal>, 2> sides{
      {{Signal::p1_port, Signal::p1_chamber}, {Signal::p2_port, Signal::p2_chamber}}};
  const auto has = [&](Signal signal) { return recording.has(std::string(info(signal).column)); };
  if (std::none_of(sides.begin(), sides.end(), [&](const auto& side) { return has(side.first) && has(side.second); }))
    return;
  const Simulated judged = simulated(rig, most_moving_part(recording, judged_s));
  for (const auto& [port, chamber] : sides) {
    if (!has(port) || !has(chamber)) continue;
    const SideMisfit found = side_misfit(judged, port, chamber);
    if (!(found.misfit < decisive_wiring * std::min(found.misfit_as_recorded, own_swing))) continue;
    const std::string a(info(port).column), b(info(chamber).column);
    exchange(recording, a, b);
    notes.push_back(
        fmt::format("{}: {} and {} are exchanged: so, their difference misses the simulated one by {:.0f} % of its "
                    "swing instead of {:.0f} %; compared so; to state it: {}",
                    recording.path, info(port).name, info(chamber).name, 100 * found.misfit,
                    100 * found.misfit_as_recorded, stated_sources(recording, {a, b})));
  }
}

}  // namespace

double port_misfit(const Rig& rig, const Recording& recording) {
  return misfit_or_infinite([&] {
    const auto [prepared, course] = simulated(rig, recording);
    double difference = 0, swing = 0;
    for (const Signal signal : pressure_signals)
      if (!prepared.measured[signal].empty())
        add_misfit(prepared.measured[signal], course[signal], prepared.usable, difference, swing);
    return std::sqrt(difference / swing);
  });
}

bool is_rather_rewired(const Rig& rig, const Recording& recording, const Recording& read_otherwise) {
  const std::optional<Rewired> found = rewired(rig, most_moving_part(recording, judged_s));
  return found && found->misfit < balance_misfit(rig, most_moving_part(read_otherwise, judged_s));
}

void doubt_wiring(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  if (rig.kind != RigKind::cylinder || !recording.has("x_m") || !recording.has("u_V")) return;
  Recording judged = most_moving_part(recording, judged_s);
  for (int round = 0; round < 2 && !(port_misfit(rig, judged) < doubtful); ++round) {  // two mistakes at once
    const std::optional<Rewired> found = rewired(rig, judged);
    if (!found) break;
    found->wiring.apply(judged);
    found->wiring.apply(recording);
    notes.push_back(
        fmt::format("{}: {}: so, the balances of gas and force leave {:.0f} % of what they balance instead of "
                    "{:.0f} %; compared so; to state it: {}",
                    recording.path, found->wiring.name, 100 * found->misfit, 100 * found->misfit_as_recorded,
                    stated_sources(recording, found->wiring.columns)));
  }
  doubt_sides(rig, recording, notes);
}

void doubt_sampling(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  if (rig.kind != RigKind::driven_axis || rig.has_pistons() || !recording.has("F_N")) return;
  if (is_own_format(recording) || source_of(recording, "F_N").sampling != Sampling::unstated) return;
  const double interval_s = row_interval_s(recording);
  const double of_held_s = 0.5 * std::min(rig.period_s, interval_s);  // what a held force comes early by
  const auto [lead_s, error_s] = force_lead(rig, recording, interval_s);
  if (!(error_s < least_known * of_held_s) || std::abs(lead_s) > instant_share * of_held_s) return;
  ImportedColumn source = source_of(recording, "F_N");
  source.sampling = Sampling::instant;
  recording.sources["F_N"] = source;
  notes.push_back(
      fmt::format("{}: F_N comes {:.2g} +- {:.1g} ms before the motion that it makes, a force held from row to "
                  "row would come {:.2g} ms before it: taken as read at its rows' instants; to state it: {}",
                  recording.path, 1e3 * lead_s, 1e3 * error_s, 1e3 * of_held_s, stated_sources(recording, {"F_N"})));
}

}  // namespace pneuservo
