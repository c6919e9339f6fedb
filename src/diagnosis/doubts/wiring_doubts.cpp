// Exchanged, reversed and misread channels as hypotheses.
#include "diagnosis/doubts/wiring_doubts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pneuservo/rig/possible_values.hpp>

#include "config/input_error.hpp"
#include "diagnosis/doubts/channel_doubts.hpp"
#include "diagnosis/doubts/wiring_balance.hpp"
#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/recordings/even_samples.hpp"
#include "diagnosis/recordings/stretches.hpp"
#include "diagnosis/residuals/force_balance.hpp"

namespace pneuservo {

namespace {

constexpr double judged_s = 6;     ///< of each recording: some strokes
constexpr double force_judged_s = 20;
constexpr double judge_effort = 60;  ///< cells times sub-steps: a share of the pressures' swing is enough
/// Misfit as recorded below which nothing is doubted: the geometric mean of the least that 106 recordings of machines
/// with faults miss by as they are wired (0.08), and with channels exchanged or reversed (0.84).
constexpr double doubtful = 0.25;
constexpr double own_swing = 1.0;  ///< misfit of a constant, by the misfit's definition
/// Of the misfit as recorded, that another reading must come down to. In an earlier trial a wrong wiring missed by
/// 2.6 times or more; readings differ by more than wirings (a factor of 6.9, 10 or 1000, a zero of an atmosphere).
constexpr double decisive = 0.4;
/// The same of another wiring. On those recordings a wrong wiring missed by 1.78 times what the right one missed by, or
/// more: the geometric mean of that and equality.
constexpr double decisive_wiring = 0.75;
/// Between the means at both ends of a line, which show nearly one pressure: the geometric mean of equality and 6.9,
/// the least ratio of two units (psi over kPa).
constexpr double one_unit = 2.6;
/// Means over which the difference of a side's two pressures is judged: it lasts as long as a stroke, white noise of
/// 600 Pa comes down to 85 Pa.
constexpr double side_mean_s = 0.05;
constexpr double neutral_tolerance = 0.02;  ///< of the command's range: data sheets state 5 +- 0.1 V of 0 to 10 V
constexpr int golden_steps = 8;  ///< of a golden section: to 2 % of what is allowed
/// Of the lead that a held force has: a force is of its instant where its own lead is less, and known to that.
constexpr double instant_share = 0.4, least_known = 0.2;
constexpr double infinite_misfit = std::numeric_limits<double>::infinity();

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

/// How one kind of channel may be meant, with what its range says.
struct ReadingsOf {
  std::vector<std::string> columns;
  std::vector<UnitReading> readings;
  std::string evidence;
};

void apply(const ReadingsOf& of, std::size_t reading, Recording& recording) {
  for (const std::string& column : of.columns) apply_reading(of.readings[reading], recording, column);
}

bool is_as_recorded(const UnitReading& reading) { return reading.factor == 1 && reading.offset == 0; }

/// One reading of each kind, for kinds that are judged together: gauge pressures do not fit beside a command whose
/// neutral is elsewhere, nor that beside them.
using Choice = std::vector<std::size_t>;

std::vector<Choice> choices_of(const std::vector<ReadingsOf>& kinds) {
  std::vector<Choice> out{{}};
  for (const ReadingsOf& kind : kinds) {
    std::vector<Choice> longer;
    for (const Choice& choice : out)
      for (std::size_t i = 0; i < kind.readings.size(); ++i) {
        longer.push_back(choice);
        longer.back().push_back(i);
      }
    out = std::move(longer);
  }
  return out;
}

bool needs_fit(const std::vector<ReadingsOf>& kinds, const Choice& choice) {
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (kinds[k].readings[choice[k]].needs_fit) return true;
  return false;
}

/// The least misfit over neutrals of the valve within what data sheets allow: an error of the neutral moves simulated
/// pressures ever further, as wrong pressures do.
double misfit_at_best_neutral(const Rig& rig, const Recording& recording) {
  if (!recording.has("u_V")) return port_misfit(rig, recording);
  const double golden = 0.5 * (std::sqrt(5.0) - 1), most_V = neutral_tolerance * rig.axis.valve.command_max_V;
  const auto misfit_at = [&](double by_V) {
    Recording changed = recording;
    for (double& command_V : changed.column("u_V")) command_V += by_V;
    return port_misfit(rig, changed);
  };
  double low = -most_V, high = most_V, a = high - golden * (high - low), b = low + golden * (high - low);
  double at_a = misfit_at(a), at_b = misfit_at(b);
  for (int step = 0; step < golden_steps; ++step)
    if (at_a < at_b) {
      high = std::exchange(b, a);
      at_b = std::exchange(at_a, misfit_at(a = high - golden * (high - low)));
    } else {
      low = std::exchange(a, b);
      at_a = std::exchange(at_b, misfit_at(b = low + golden * (high - low)));
    }
  return std::min(at_a, at_b);
}

/// Of the gas at each instant: a dead band, a leak or a rest lets simulated pressures drift by more than a unit does.
double misfit_of_gas(const Rig& rig, const Recording& recording) { return gas_misfit(rig, recording, judged_s); }

using MisfitOf = double (*)(const Rig&, const Recording&);

std::vector<double> misfits_of(const Rig& rig, const Recording& judged, const std::vector<ReadingsOf>& kinds,
                               const std::vector<Choice>& choices, MisfitOf misfit_of) {
  std::vector<double> out;
  for (const Choice& choice : choices) {
    const bool is_far = needs_fit(kinds, choice);
    out.push_back(infinite_misfit);
    if (is_far && misfit_of == &misfit_at_best_neutral) continue;  // such a reading changes more than a neutral does
    Recording tried = judged;
    for (std::size_t k = 0; k < kinds.size(); ++k) apply(kinds[k], choice[k], tried);
    const double misfit = misfit_of(rig, tried);
    if (!is_far || misfit < own_swing) out.back() = misfit;
  }
  return out;
}

/// Whether a map states another unit or zero than SI for the columns: somebody knew.
bool is_stated(const Recording& recording, const ReadingsOf& of) {
  const ImportedColumn source = source_of(recording, of.columns.front());
  return source.factor != 1 || source.offset != 0;
}

std::string name_of(const UnitReading& reading) { return reading.name.empty() ? "as recorded" : reading.name; }

std::size_t corrections_of(const std::vector<ReadingsOf>& kinds, const Choice& choice) {
  std::size_t out = 0;
  for (std::size_t k = 0; k < kinds.size(); ++k) out += !is_as_recorded(kinds[k].readings[choice[k]]);
  return out;
}

/// Of some choices those that correct the fewest kinds: what is as recorded stays so where it fits as well.
std::vector<std::size_t> fewest_corrections(const std::vector<ReadingsOf>& kinds, const std::vector<Choice>& choices,
                                            std::vector<std::size_t> some) {
  std::size_t fewest = kinds.size();
  for (const std::size_t i : some) fewest = std::min(fewest, corrections_of(kinds, choices[i]));
  std::erase_if(some, [&](std::size_t i) { return corrections_of(kinds, choices[i]) > fewest; });
  return some;
}

/// The first kind that two choices read otherwise.
std::size_t first_difference(const Choice& a, const Choice& b) {
  return static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin());
}

/// Of the choices that fit about as well as the best one, the one that keeps what is stated, else the one that corrects
/// the fewest kinds; throws where that leaves two.
std::size_t one_of_fitting(const Recording& recording, const std::vector<ReadingsOf>& kinds,
                           const std::vector<Choice>& choices, const std::vector<double>& misfits, std::size_t best,
                           std::vector<std::string>& notes) {
  std::vector<std::size_t> fitting{best}, as_stated;
  for (std::size_t i = 0; i < misfits.size(); ++i)
    if (i != best && misfits[best] > decisive * misfits[i]) fitting.push_back(i);
  if (fitting.size() == 1) return best;
  std::copy_if(fitting.begin(), fitting.end(), std::back_inserter(as_stated), [&](std::size_t i) {
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (is_stated(recording, kinds[k]) && !is_as_recorded(kinds[k].readings[choices[i][k]])) return false;
    return true;
  });
  const bool is_by_statement = as_stated.size() == 1;
  const auto left =
      is_by_statement ? as_stated : fewest_corrections(kinds, choices, as_stated.empty() ? fitting : as_stated);
  const std::size_t taken = left.front();
  const std::size_t other = left.size() > 1 ? left[1] : fitting[0] == taken ? fitting[1] : fitting[0];
  const std::size_t k = first_difference(choices[other], choices[taken]);
  const UnitReading &one = kinds[k].readings[choices[taken][k]], &another = kinds[k].readings[choices[other][k]];
  if (left.size() != 1)
    throw InputError(fmt::format("{}: {} or {}? State it: {}", kinds[k].evidence, name_of(one), name_of(another),
                                 stated_reading(recording, kinds[k].columns.front(), one)));
  const bool is_twice = another.offset != 0 && source_of(recording, kinds[k].columns.front()).offset != 0;
  if (!is_twice)  // a zero that was stated already is no second reading
    notes.push_back(fmt::format("{}: taken {}; {} would fit as well", kinds[k].evidence,
                                is_by_statement ? "as stated" : name_of(one), name_of(another)));
  return taken;
}

/// The choice that alone brings the misfit down; as recorded where that fits. Two are asked for.
Choice decided(const Rig& rig, const Recording& recording, const std::vector<ReadingsOf>& kinds,
               std::vector<std::string>& notes) {
  const std::vector<Choice> choices = choices_of(kinds);
  if (choices.size() == 1) return choices.front();
  const Recording judged = most_moving_part(recording, judged_s);
  const auto found = std::find_if(choices.begin(), choices.end(), [&](const Choice& choice) {
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (!is_as_recorded(kinds[k].readings[choice[k]])) return false;
    return true;
  });
  const auto as_recorded = static_cast<std::size_t>(found - choices.begin());
  const bool is_possible = found != choices.end();
  for (const MisfitOf misfit_of : {&port_misfit, &misfit_at_best_neutral, &misfit_of_gas}) {
    const std::vector<double> misfits = misfits_of(rig, judged, kinds, choices, misfit_of);
    if (is_possible && misfits[as_recorded] < doubtful) break;
    const auto best = static_cast<std::size_t>(std::min_element(misfits.begin(), misfits.end()) - misfits.begin());
    if (is_possible && !(misfits[best] < std::min(decisive * misfits[as_recorded], own_swing))) continue;
    return choices[one_of_fitting(recording, kinds, choices, misfits, best, notes)];
  }
  return choices[as_recorded];
}

struct Rewired {
  Wiring wiring;
  double misfit, misfit_as_recorded;
};

/// The other wiring under which the balances leave decisively less than as recorded, and than a constant.
std::optional<Rewired> rewired(const Rig& rig, const Recording& judged) {
  const double as_recorded = std::min(balance_misfit(rig, judged, judged_s), own_swing);
  std::optional<Rewired> out;
  for (const Wiring& wiring : wirings(judged)) {
    Recording other = judged;
    wiring.apply(other);
    const double misfit = balance_misfit(rig, other, judged_s);
    if (misfit < (out ? out->misfit : decisive_wiring * as_recorded)) out = Rewired{wiring, misfit, as_recorded};
  }
  return out;
}

bool are_whole(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == std::round(v) || std::isnan(v); });
}

/// Pressure columns that are in one unit: ports and chambers apart where a line's ends show other sizes. The supply
/// goes with those whose sizes it is nearer to.
std::vector<std::vector<std::string>> by_unit(const Recording& recording) {
  const std::vector<std::string> all = pressure_columns(recording);
  const auto size_of = [&](const std::string& column) { return quantile(recording.column(column), 0.5); };
  double most = 1, ports = 0, chambers = 0;
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const std::string port(info(port_signals[side]).column), chamber(info(chamber_signals[side]).column);
    if (!recording.has(port) || !recording.has(chamber) || !(size_of(port) > 0 && size_of(chamber) > 0)) continue;
    ports = size_of(port), chambers = size_of(chamber);
    most = std::max({most, ports / chambers, chambers / ports});
  }
  if (all.empty()) return {};
  if (most < one_unit) return {all};
  std::vector<std::vector<std::string>> out(2);
  for (const std::string& column : all) {
    const Signal signal = *signal_of_column(column);
    const double size = size_of(column);
    const bool is_nearer = std::abs(std::log(size / chambers)) < std::abs(std::log(size / ports));
    out[is_chamber(signal) || (!is_port(signal) && is_nearer) ? 1 : 0].push_back(column);
  }
  return out;
}

/// What the recording's channels may be meant as; throws where a kind has no reading.
std::vector<ReadingsOf> possible_readings(const Rig& rig, const Recording& recording) {
  std::vector<ReadingsOf> out;
  for (const std::vector<std::string>& pressures : by_unit(recording)) {
    double low = 1e300, high = -1e300;
    for (const std::string& column : pressures) {
      low = std::min(low, quantile(recording.column(column), lowest_share));
      high = std::max(high, quantile(recording.column(column), highest_share));
    }
    out.push_back({pressures, pressure_readings(rig, recording, pressures),
                   fmt::format("{}: {} go{} from {:.4g} to {:.4g} Pa, possible are {:.0f} to {:.0f} Pa absolute",
                               recording.path, fmt::join(pressures, ", "), pressures.size() == 1 ? "es" : "", low, high,
                               possible_pressure_Pa(rig).lowest, possible_pressure_Pa(rig).highest)});
  }
  if (recording.has("u_V") && std::isfinite(quantile(recording.column("u_V"), 0.5)))
    out.push_back({{"u_V"},
                   command_readings(rig, recording),
                   fmt::format("{}: u_V goes from {:.4g} to {:.4g} V, the valve takes +-{:g} V", recording.path,
                               quantile(recording.column("u_V"), lowest_share),
                               quantile(recording.column("u_V"), highest_share), rig.axis.valve.command_max_V)});
  if (recording.has("x_m") && std::isfinite(quantile(recording.column("x_m"), 0.5)))
    out.push_back({{"x_m"},
                   position_zeros(rig, recording),
                   fmt::format("{}: x_m goes from {:.4g} to {:.4g} m, the stroke is +-{:g} m", recording.path,
                               quantile(recording.column("x_m"), lowest_share),
                               quantile(recording.column("x_m"), highest_share), 0.5 * rig.axis.cylinder.stroke_m)});
  for (const ReadingsOf& kind : out)
    if (kind.readings.empty())
      throw InputError(fmt::format(
          "{}, expected that: {}? State it, as SI = factor x value + offset: "
          "import: {{columns: {{{}: {{column: \"{}\", factor: ..., offset: ...}}}}}}",
          kind.evidence, are_whole(recording.column(kind.columns.front())) ? "counts of a converter" : "in which unit",
          kind.columns.front(), source_of(recording, kind.columns.front()).column));
  return out;
}

/// How much earlier the drive force comes than what the motion needs, and its standard error [s]: what stands before
/// the force's own rate in a regression on acceleration, friction and drag. NaN where too little moves.
std::pair<double, double> force_lead(const Rig& rig, const Recording& whole, double interval_s) {
  const Recording recording = most_moving_part(whole, force_judged_s);
  const EvenSamples even(recording.t_s(), interval_s);
  const std::vector<double> measured = even.straight(recording.column("F_N")), force = held_over_gaps(measured);
  const ForceBalance balance(even.drawn(recording.column("x_m")), interval_s, rig.sensors.position.rms_m());
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
  try {
    const auto [prepared, course] = simulated(rig, recording);
    double difference = 0, swing = 0;
    for (const Signal signal : pressure_signals)
      if (!prepared.measured[signal].empty())
        add_misfit(prepared.measured[signal], course[signal], prepared.usable, difference, swing);
    const double misfit = std::sqrt(difference / swing);
    return std::isfinite(misfit) ? misfit : infinite_misfit;
  } catch (const std::exception&) { return infinite_misfit; }
}

void doubt_units(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  if (rig.kind != RigKind::cylinder) return;
  const std::vector<ReadingsOf> kinds = possible_readings(rig, recording);
  const Choice choice = decided(rig, recording, kinds, notes);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const UnitReading& reading = kinds[k].readings[choice[k]];
    if (is_as_recorded(reading)) continue;
    apply(kinds[k], choice[k], recording);
    notes.push_back(fmt::format("{}: taken for {}; to state it: {}", kinds[k].evidence, reading.name,
                                stated_sources(recording, kinds[k].columns)));
  }
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
