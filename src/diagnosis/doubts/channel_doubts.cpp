// Single recorded channels against what they can hold.
#include "diagnosis/doubts/channel_doubts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <pneuservo/loop/input_guard.hpp>
#include <pneuservo/rig/possible_values.hpp>

#include "config/input_error.hpp"
#include "diagnosis/doubts/range_doubts.hpp"
#include "record/foreign/column_guess.hpp"

namespace pneuservo {

namespace {

/// Of the stroke: a sensor's offset may bring the position so far beyond its half, another unit brings it further.
constexpr double furthest = 0.6;
constexpr double least_motion = 0.01;  ///< of the stroke: less is no motion in any unit
constexpr double command_share = 1.05;
/// Of the supply's gauge pressure: what pressures that are read in too small a unit stay below, for two units differ by
/// 6.9 and more. The least of 81 recordings of machines comes to 0.71.
constexpr double least_driving = 1 / 6.894757;
constexpr double slowest_spike_s = 2e-3;  ///< between rows; a chamber may go there and back in more

struct Unit {
  double factor;
  std::string_view name;
};
constexpr std::array<Unit, 4> length_units{
    {{1e-3, "millimetres"}, {1e-2, "centimetres"}, {1e-6, "micrometres"}, {0.0254, "inches"}}};
constexpr std::array<Unit, 6> pressure_units{
    {{1, ""}, {1e5, "bar"}, {1e3, "kPa"}, {1e6, "MPa"}, {6894.757, "psi"}, {100, "mbar"}}};

struct Range {
  double low, high;
  double span() const { return high - low; }
};

Range range_of(const std::vector<double>& values) {
  const auto [low, high] = quantiles(values, lowest_share, highest_share);
  return {low, high};
}

/// Readings of a position in which it stays within the stroke, its zero at the middle or at an end.
std::vector<UnitReading> position_readings(double stroke_m, const Range& range) {
  std::vector<UnitReading> out;
  const auto add = [&](double factor, std::string_view name) {
    const double low = factor * range.low, high = factor * range.high;
    if (high - low < least_motion * stroke_m || high - low > 2 * furthest * stroke_m) return;
    if (std::max(-low, high) <= furthest * stroke_m) out.push_back({factor, 0, std::string(name)});
    else if (low >= (0.5 - furthest) * stroke_m && high <= (0.5 + furthest) * stroke_m)
      out.push_back(
          {factor, -0.5 * stroke_m, fmt::format("{}{}counted from the retracted end", name, name.empty() ? "" : ", ")});
  };
  add(1, "");
  if (!out.empty() || range.span() <= 2 * furthest * stroke_m) return out;  // metres, whose zero is another
  for (const Unit& unit : length_units) add(unit.factor, unit.name);
  return out;
}

/// "millimetres, centimetres or inches"
std::string names_of(const std::vector<UnitReading>& readings) {
  std::string out;
  for (std::size_t i = 0; i < readings.size(); ++i)
    out += (i == 0 ? "" : i + 1 == readings.size() ? " or " : ", ") + readings[i].name;
  return out;
}

/// What a channel may do from one row to the next. Values in its unit.
struct Plausible {
  double lowest = -infinite, highest = infinite;  ///< outside: no measurement
  double slack = 0;  ///< noise and quantum make this much of a step
  double excursion = infinite;  ///< no more than this away from both neighbours, which agree
  int frozen_rows = 0;  ///< equal values in a row that the sensor's noise rules out; 0: equality proves nothing
};

/// A slider gets no further from a straight course than the most acceleration takes it in a row's time. Equal values
/// prove nothing: a slider rests.
Plausible plausible_position(const Rig& rig, double interval_s) {
  const PossibleRange range = possible_position_m(rig);
  Plausible out{range.lowest, range.highest,
                sensor_slack(rig.sensors.position.noise_m, rig.sensors.position.quantum_m)};
  const double acceleration_mps2 = most_acceleration_mps2(rig);
  if (acceleration_mps2 > 0) out.excursion = out.slack + acceleration_mps2 * interval_s * interval_s;
  return out;
}

Plausible plausible_pressure(const Rig& rig, const PressureSensorParameters& sensor) {
  const PossibleRange range = possible_pressure_Pa(rig);
  Plausible out{range.lowest, range.highest, sensor_slack(sensor.noise_Pa, sensor.quantum_Pa)};
  out.excursion = out.slack + pressure_step_Pa(rig);
  out.frozen_rows = frozen_after_ticks(sensor.noise_Pa, sensor.quantum_Pa);
  return out;
}

/// What was taken out of one column.
struct TakenOut {
  std::size_t impossible = 0, frozen = 0;
  std::vector<ClippedEnd> clipped;
  double first_frozen_s = no_value, last_frozen_s = no_value;
};

enum SampleVerdict : char { good, is_impossible, is_frozen };

/// Up to two values that stand apart from both neighbours, on one side, while these agree.
void mark_spikes(const std::vector<double>& y, double excursion, std::vector<char>& verdict) {
  for (std::size_t width = 1; width <= 2; ++width)
    for (std::size_t i = 1; i + width < y.size(); ++i) {
      const double before = y[i - 1], after = y[i + width];
      double least = infinite, sides = 0;
      for (std::size_t k = i; k < i + width; ++k) {
        const double apart = std::min(std::abs(y[k] - before), std::abs(y[k] - after));
        least = std::isfinite(y[k]) ? std::min(least, apart) : 0;
        sides += (y[k] > before ? 1 : -1) + (y[k] > after ? 1 : -1);
      }
      if (!(least > excursion) || std::abs(sides) < 2.0 * static_cast<double>(width)) continue;
      if (!(std::abs(after - before) < 0.25 * least)) continue;  // NaN too
      std::fill_n(verdict.begin() + static_cast<std::ptrdiff_t>(i), width, is_impossible);
    }
}

/// Steps elsewhere that a step out of a standstill must exceed so many times to prove the standstill a frozen sensor.
constexpr double step_of_a_jump = 5;

/// Rows of the longest run of equal values.
std::size_t longest_standstill(const std::vector<double>& y) {
  std::size_t longest = 0, first = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (y[i] != y[first]) first = i;
    longest = std::max(longest, i + 1 - first);
  }
  return longest;
}

/// Runs of equal values that the noise rules out, or that end in a step no motion of this recording makes, from one row
/// to the next: behind a gap the motion may be anywhere. The first value of a run was measured.
void mark_frozen(const std::vector<double>& t_s, const std::vector<double>& y, const Plausible& plausible,
                 std::vector<char>& verdict) {
  const auto frozen_rows = static_cast<std::size_t>(std::max(0, plausible.frozen_rows));
  const std::size_t longest = longest_standstill(y);
  if (longest < least_standstill && (frozen_rows == 0 || longest <= frozen_rows)) return;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < t_s.size(); ++i) intervals.push_back(t_s[i] - t_s[i - 1]);
  const double gap_s = 1.5 * quantile(intervals, 0.5);
  std::vector<double> steps;
  for (std::size_t i = 1; i < y.size(); ++i)
    if (y[i] != y[i - 1]) steps.push_back(std::abs(y[i] - y[i - 1]));
  const double jump = std::max(step_of_a_jump * quantile(steps, 0.99), 10 * plausible.slack);
  for (std::size_t first = 0, end = 0; first < y.size(); first = end) {
    end = first + 1;
    while (end < y.size() && y[end] == y[first]) ++end;
    const bool by_noise = frozen_rows > 0 && end - first > frozen_rows;
    const bool by_jump = end - first >= least_standstill && end < y.size() && std::abs(y[end] - y[first]) > jump &&
                         std::abs(t_s[end] - t_s[end - 1]) < gap_s;
    if (by_noise || by_jump)
      std::fill(verdict.begin() + static_cast<std::ptrdiff_t>(first) + 1,
                verdict.begin() + static_cast<std::ptrdiff_t>(end), is_frozen);
  }
}

/// Spikes first: what lies beyond them is no end of a range.
TakenOut judge_column(const Plausible& plausible, const std::vector<double>& t_s, std::vector<double>& values) {
  std::vector<char> verdict(values.size(), good);
  mark_spikes(values, plausible.excursion, verdict);
  TakenOut out;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (verdict[i] != good || values[i] < plausible.lowest || values[i] > plausible.highest) {
      ++out.impossible;
      values[i] = no_value;
    }
  out.clipped = clipped_ends(values, plausible.slack, plausible.frozen_rows);
  for (const ClippedEnd& end : out.clipped) std::replace(values.begin(), values.end(), end.value, no_value);
  std::fill(verdict.begin(), verdict.end(), good);
  mark_frozen(t_s, values, plausible, verdict);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (verdict[i] != is_frozen) continue;
    ++out.frozen;
    if (!std::isfinite(out.first_frozen_s)) out.first_frozen_s = t_s[i];
    out.last_frozen_s = t_s[i];
    values[i] = no_value;
  }
  return out;
}

void tell_taken(const Recording& recording, const std::string& column, const TakenOut& taken,
                std::vector<std::string>& notes) {
  if (taken.impossible > 0)
    notes.push_back(fmt::format("{}: {} sample{} of {} {} beyond what the loop takes for possible: left out",
                                recording.path, taken.impossible, taken.impossible > 1 ? "s" : "", column,
                                taken.impossible > 1 ? "are" : "is"));
  for (const ClippedEnd& end : taken.clipped)
    notes.push_back(
        fmt::format("{}: {} is clipped at {:.6g}, where it stays for {} rows: left out; does the sensor's or "
                    "the logger's range end there?",
                    recording.path, column, end.value, end.rows));
  if (taken.frozen > 0)
    notes.push_back(fmt::format("{}: {} is frozen for {} rows between {:.6g} and {:.6g} s: left out; is the sensor "
                                "connected?",
                                recording.path, column, taken.frozen, taken.first_frozen_s, taken.last_frozen_s));
}

}  // namespace

void apply_reading(const UnitReading& reading, Recording& recording, const std::string& column) {
  for (double& value : recording.column(column)) value = reading.factor * value + reading.offset;
  ImportedColumn source = source_of(recording, column);
  source.factor *= reading.factor;
  source.offset = reading.factor * source.offset + reading.offset;
  recording.sources[column] = source;
}

std::string stated_sources(const Recording& recording, const std::vector<std::string>& columns) {
  std::string text;
  for (const std::string& column : columns)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", column, source_text(source_of(recording, column)));
  return fmt::format("import: {{columns: {{{}}}}}", text);
}

std::string stated_reading(Recording recording, const std::string& column, const UnitReading& reading) {
  apply_reading(reading, recording, column);
  return stated_sources(recording, {column});
}

std::vector<std::string> pressure_columns(const Recording& recording) {
  std::vector<std::string> out;
  for (const Signal signal : pressure_signals)
    if (const std::string_view name = info(signal).column; recording.has(name) && has_value(recording.column(name)))
      out.emplace_back(name);
  return out;
}

void leave_out_absent_sensors(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  if (!rig.is_pneumatic()) return;
  const auto leave_out = [&](const std::string& key, std::initializer_list<Signal> signals) {
    for (const Signal signal : signals) {
      const std::string_view column = info(signal).column;
      const bool is_stated = is_difference(signal) ? rig.has_sensor(signal) : rig.sensors.resolution(signal).rms() > 0;
      if (!is_stated && recording.has(column)) {
        recording.keep_columns([&](const std::string& name) { return name != column; });
        notes.push_back(fmt::format("{}: {} is left out: the config has no sensors.{}", recording.path, column, key));
      }
    }
  };
  // Where chambers alone are measured they stand for the ports, whatever the config says of them.
  if (recording.has(info(Signal::p1_port).column) && recording.has(info(Signal::p2_port).column))
    leave_out("chamber_pressure", {Signal::p1_chamber, Signal::p2_chamber});
  leave_out("supply_pressure", {Signal::p_supply});
  leave_out("supply_flow", {Signal::supply_flow});
  leave_out("differential_pressure", {Signal::dp1, Signal::dp2});
}

void doubt_position_unit(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  const double stroke_m = rig.axis.cylinder.stroke_m;
  if (!recording.has("x_m") || !(stroke_m > 0) || !std::isfinite(stroke_m)) return;
  const Range range = range_of(recording.column("x_m"));
  if (!std::isfinite(range.low) || std::max(-range.low, range.high) <= furthest * stroke_m) return;
  const std::string evidence = fmt::format("{}: x_m goes from {:.4g} to {:.4g} m, the stroke is +-{:g} m",
                                           recording.path, range.low, range.high, 0.5 * stroke_m);
  const std::vector<UnitReading> readings = position_readings(stroke_m, range);
  if (readings.size() > 1)
    throw InputError(fmt::format("{}: {}? State it: {}", evidence, names_of(readings),
                                 stated_reading(recording, "x_m", readings[0])));
  if (readings.empty())
    throw InputError(fmt::format("{}: another zero or unit? State it, with x = 0 at mid-stroke: {}", evidence,
                                 stated_reading(recording, "x_m", {1, -0.5 * (range.low + range.high), ""})));
  apply_reading(readings.front(), recording, "x_m");
  notes.push_back(fmt::format("{}: taken for {}; to state it: {}", evidence, readings.front().name,
                              stated_sources(recording, {"x_m"})));
}

std::vector<UnitReading> position_zeros(const Rig& rig, const Recording& recording) {
  const double stroke_m = rig.axis.cylinder.stroke_m;
  const Range range = range_of(recording.column("x_m"));
  std::vector<UnitReading> out{{1, 0, ""}};
  if (stroke_m > 0 && std::isfinite(stroke_m) && range.low >= 0 && range.high <= (0.5 + furthest) * stroke_m)
    out.push_back({1, -0.5 * stroke_m, "counted from the retracted end", true});
  return out;
}

std::vector<UnitReading> pressure_readings(const Rig& rig, const Recording& recording,
                                           const std::vector<std::string>& columns) {
  const PossibleRange possible = possible_pressure_Pa(rig);
  const double atmosphere_Pa = rig.axis.air.atmosphere_Pa,
               driving_Pa = atmosphere_Pa + least_driving * (rig.axis.supply.pressure_Pa - atmosphere_Pa);
  std::vector<Range> ranges;
  for (const std::string& column : columns) ranges.push_back(range_of(recording.column(column)));
  double highest = -infinite;
  for (const Range& range : ranges) highest = std::max(highest, range.high);
  std::vector<UnitReading> out;
  for (const Unit& unit : pressure_units)
    for (const double offset : {0.0, atmosphere_Pa}) {
      const bool is_as_recorded = unit.factor == 1 && offset == 0;
      if (!is_as_recorded && unit.factor * highest + offset < driving_Pa) continue;
      const bool fits = std::all_of(ranges.begin(), ranges.end(), [&](const Range& range) {
        return unit.factor * range.low + offset >= possible.lowest &&
               unit.factor * range.high + offset <= possible.highest;
      });
      const std::string gauge = offset > 0 ? "gauge pressures" : "";
      if (fits)
        out.push_back({unit.factor, offset,
                       fmt::format("{}{}{}", unit.name, !unit.name.empty() && offset > 0 ? ", " : "", gauge)});
    }
  return out;
}

std::vector<UnitReading> command_readings(const Rig& rig, const Recording& recording) {
  const double most_V = rig.axis.valve.command_max_V;
  const Range range = range_of(recording.column("u_V"));
  std::vector<UnitReading> out;
  const auto add = [&](double factor, double offset, const char* name, bool needs_fit = false) {
    const double low = factor * range.low + offset, high = factor * range.high + offset;
    if (std::max(-low, high) <= command_share * most_V) out.push_back({factor, offset, name, needs_fit});
  };
  // Always on one side of zero, and about half of a range of twice the valve's.
  const auto is_from_the_end = [&](double neutral) {
    return range.low > 0 && 0.5 * (range.low + range.high) > 0.5 * neutral;
  };
  const auto add_per_cent = [&](bool needs_fit) {
    add(most_V / 100, 0, "per cent of the valve's range", needs_fit);
    if (is_from_the_end(50)) add(most_V / 50, -most_V, "per cent from the valve's end, neutral at 50 %", needs_fit);
  };
  const auto add_milliamperes = [&](bool needs_fit) {
    if (is_from_the_end(12)) add(most_V / 8, -1.5 * most_V, "milliamperes from 4 to 20, neutral at 12", needs_fit);
  };
  // A unit that the file states leaves its own readings, as long as one holds the range.
  const std::string unit = stated_command_unit(recording);
  if (unit == "%") add_per_cent(false);
  else if (unit == "mA") add_milliamperes(false);
  if (!out.empty()) return out;
  add(1, 0, "");
  if (is_from_the_end(most_V)) add(1, -most_V, "volts from the valve's end, neutral in the middle");
  const bool may_be_volts = !out.empty();
  if (!may_be_volts) add(1e-3, 0, "millivolts");
  add_per_cent(may_be_volts);
  add(most_V, 0, "shares of the valve's range", may_be_volts);
  if (is_from_the_end(0.5)) add(2 * most_V, -most_V, "shares from the valve's end, neutral at 0.5", may_be_volts);
  add_milliamperes(may_be_volts);
  return out;
}

std::string stated_command_unit(const Recording& recording) {
  const auto stated = recording.stated_units.find("u_V");
  return stated == recording.stated_units.end() ? "" : stated->second;
}

void take_out_impossible_samples(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  const double interval_s = row_interval_s(recording);
  if (!std::isfinite(interval_s)) return;
  if (recording.has("x_m"))
    tell_taken(recording, "x_m",
               judge_column(plausible_position(rig, interval_s), recording.t_s(), recording.column("x_m")), notes);
  if (!rig.is_pneumatic()) return;
  for (const std::string& column : pressure_columns(recording)) {
    Plausible plausible = plausible_pressure(rig, pressure_sensor(rig.sensors, column));
    // A hose that bursts takes the supply away at once; rows far apart show no spike.
    if (column == "p_supply_Pa" || interval_s > slowest_spike_s) plausible.excursion = infinite;
    tell_taken(recording, column, judge_column(plausible, recording.t_s(), recording.column(column)), notes);
  }
}

void refuse_standstill(const Rig& rig, const Recording& recording) {
  if (!recording.has("x_m")) return;
  const auto span = [&](const std::string& column) { return range_of(recording.column(column)).span(); };
  const double span_m = span("x_m");
  if (!std::isfinite(span_m))
    throw InputError(fmt::format("{}: x_m has no usable value, expected the measured position", recording.path));
  if (span_m > 2 * rig.sensors.position.quantum_m + 6 * rig.sensors.position.noise_m) return;
  if (rig.kind == RigKind::driven_axis)
    throw InputError(
        fmt::format("{}: x_m does not move ({:.4g} m throughout), expected motion to compare: is the encoder "
                    "connected?",
                    recording.path, quantile(recording.column("x_m"), 0.5)));
  // A cylinder that is held has pressures to compare.
  const std::vector<std::string> pressures = pressure_columns(recording);
  const bool is_still = std::all_of(pressures.begin(), pressures.end(), [&](const auto& p) { return !(span(p) > 0); });
  if (is_still)
    throw InputError(fmt::format("{}: neither x_m nor a pressure changes, expected motion to compare: are the sensors "
                                 "connected?",
                                 recording.path));
}

}  // namespace pneuservo
