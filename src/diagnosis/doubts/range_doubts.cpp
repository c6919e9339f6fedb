// Recorded channels against the range and the steps of their own sensor.
#include "diagnosis/doubts/range_doubts.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <pneuservo/rig/possible_values.hpp>

#include "config/input_error.hpp"
#include "diagnosis/doubts/channel_doubts.hpp"

namespace pneuservo {

namespace {

/// Steps and kinks elsewhere that one must exceed so many times to be none of the motion's.
constexpr double beyond_the_motion = 5;
constexpr std::size_t slope_rows = 5;        ///< that a slope is taken over
constexpr std::size_t most_judged = 50000;   ///< rows: enough for every share used here
constexpr double same_multiple = 0.1;        ///< of a quantum: rounding of a printed value moves it so far
constexpr double own_noise_share =
    0.1;      ///< of the sensor's noise: a channel with less beside another has none of its own
constexpr double least_copied = 10;  ///< rows: so many leave so little noise by chance less than once in 1e9

std::vector<double> steps_of(const std::vector<double>& y) {
  std::vector<double> out(y.size(), 0.0);
  for (std::size_t i = 1; i < y.size(); ++i) out[i] = y[i] - y[i - 1];
  return out;
}

/// Mean step of up to slope_rows rows before (direction -1) or behind a row; NaN at the ends.
double slope_at(const std::vector<double>& y, std::size_t row, int direction) {
  if (direction < 0 ? row < slope_rows + 1 : row + slope_rows >= y.size()) return std::nan("");
  const std::size_t from = direction < 0 ? row - 1 - slope_rows : row;
  return (y[from + slope_rows] - y[from]) / static_cast<double>(slope_rows);
}

/// A step against the motion before and behind it, by which a counter began again.
struct Turn {
  std::size_t row;  ///< the first one behind it
  double step;      ///< without the motion's own
  bool against;     ///< the motion goes the other way on both sides
};

/// Steps of more than half of the channel's range that no motion of this recording makes. Two that undo each other
/// within two rows are a spike.
std::vector<Turn> turns_of(const std::vector<double>& t, const std::vector<double>& y, double interval_s) {
  const std::vector<double> steps = steps_of(y);
  std::vector<double> sizes;
  for (const double step : steps)
    if (step != 0) sizes.push_back(std::abs(step));
  const auto [low, high] = quantiles(y, lowest_share, highest_share);
  const double usual = quantile(std::move(sizes), 0.9), span = high - low;
  std::vector<Turn> out;
  for (std::size_t i = 1; i < y.size(); ++i) {
    if (!(std::abs(steps[i]) > std::max(0.5 * span, beyond_the_motion * usual)) || t[i] - t[i - 1] > 1.5 * interval_s)
      continue;
    if (!out.empty() && i - out.back().row <= 2 && out.back().step * steps[i] < 0) {
      out.pop_back();
      continue;
    }
    const double before = slope_at(y, i, -1), behind = slope_at(y, i, 1);
    const bool against = before * steps[i] < 0 && behind * steps[i] < 0;
    out.push_back({i, steps[i] - (against ? 0.5 * (before + behind) : 0.0), against});
  }
  return out;
}

/// The range of a counter that began again, [unit of the values]; 0 where the steps are not such.
double counter_range(const std::vector<Turn>& turns, const std::vector<double>& y) {
  std::vector<double> sizes, others;
  std::size_t against = 0;
  for (const Turn& turn : turns) sizes.push_back(std::abs(turn.step)), against += turn.against;
  if (2 * against <= turns.size()) return 0;
  const double range = quantile(sizes, 0.5);
  for (const double step : steps_of(y))
    if (step != 0 && std::abs(step) < 0.5 * range) others.push_back(std::abs(step));
  const double spread = beyond_the_motion * quantile(others, 0.9);
  const bool alike = std::all_of(sizes.begin(), sizes.end(), [&](double s) { return std::abs(s - range) <= spread; });
  return alike ? range : 0;
}

/// The distance of neighbouring values where a channel has but multiples of it; 0 where it has others.
double step_of_values(const std::vector<double>& values) {
  std::vector<double> sorted;
  for (std::size_t i = 0; i < values.size() && sorted.size() < most_judged; ++i)
    if (std::isfinite(values[i])) sorted.push_back(values[i]);
  const std::size_t all = sorted.size();
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() < 3 || 2 * sorted.size() > all) return 0;  // values do not repeat
  std::vector<double> gaps;
  for (std::size_t i = 1; i < sorted.size(); ++i) gaps.push_back(sorted[i] - sorted[i - 1]);
  std::vector<double> least;
  const double smallest = *std::min_element(gaps.begin(), gaps.end());
  for (const double gap : gaps)
    if (gap < (1 + same_multiple) * smallest) least.push_back(gap);
  const double step = quantile(least, 0.5);
  std::size_t multiples = 0;
  for (const double gap : gaps) multiples += std::abs(gap / step - std::round(gap / step)) < same_multiple;
  return static_cast<double>(multiples) >= 0.95 * static_cast<double>(gaps.size()) ? step : 0;
}

/// A sensor of the config: its quantum, which may be replaced, and what a config may say of it.
struct SensorOfColumn {
  double* quantum;
  double noise, most;
  std::string key;
};

SensorOfColumn sensor_of(SensorsParameters& sensors, const std::string& column) {
  constexpr double most_m = 0.01, most_Pa = 1e5, most_N = 1e5, most_kgps = 1;
  if (column == "x_m") return {&sensors.position.quantum_m, sensors.position.noise_m, most_m, "position.quantum_m"};
  if (column == "supply_flow_kgps")
    return {&sensors.supply_flow.quantum_kgps, sensors.supply_flow.noise_kgps, most_kgps, "supply_flow.quantum_kgps"};
  if (column == "F_N") return {&sensors.force.quantum_N, sensors.force.noise_N, most_N, "force.quantum_N"};
  PressureSensorParameters& sensor = pressure_sensor(sensors, column);
  const char* key = &sensor == &sensors.supply_pressure ? "supply_pressure"
                    : &sensor == &sensors.port_pressure ? "port_pressure"
                                                        : "chamber_pressure";
  return {&sensor.quantum_Pa, sensor.noise_Pa, most_Pa, fmt::format("{}.quantum_Pa", key)};
}

/// What a regression of one column's steps on another's leaves, and the factor.
struct Copy {
  double factor, rest, step;  ///< rest and step: rms of what is left and of the column's own steps
  double rows;                ///< with a value of both
};

Copy as_copy(const std::vector<double>& of, const std::vector<double>& column) {
  double both = 0, square = 0, own = 0, count = 0;
  const std::vector<double> a = steps_of(of), b = steps_of(column);
  const std::size_t rows = std::min(a.size(), most_judged);
  for (std::size_t i = 1; i < rows; ++i)
    if (std::isfinite(a[i]) && std::isfinite(b[i]))
      both += a[i] * b[i], square += a[i] * a[i], own += b[i] * b[i], ++count;
  const double factor = square > 0 ? both / square : 0;
  return {factor, std::sqrt(std::max(0.0, own - factor * both) / count), std::sqrt(own / count), count};
}

/// Runs of rows at one value, [first, end).
std::vector<std::pair<std::size_t, std::size_t>> runs_at(const std::vector<double>& y, double value) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (std::size_t first = 0, end = 0; first < y.size(); first = end) {
    end = first + 1;
    if (y[first] != value) continue;
    while (end < y.size() && y[end] == value) ++end;
    out.emplace_back(first, end);
  }
  return out;
}

/// Kinks of the course away from a value: changes of slope from one slope_rows rows to the next.
double usual_kink(const std::vector<double>& y, double value) {
  std::vector<double> kinks;
  for (std::size_t i = slope_rows + 1; i + slope_rows < y.size(); ++i) {
    const auto from = y.begin() + static_cast<std::ptrdiff_t>(i - slope_rows - 1);
    if (std::find(from, from + 2 * slope_rows + 2, value) == from + 2 * slope_rows + 2)
      kinks.push_back(std::abs(slope_at(y, i, 1) - slope_at(y, i, -1)));
  }
  return quantile(kinks, 0.99);
}

/// Whether more rows stand at an end of the range than half a standard deviation of noise beside it holds, by six
/// standard deviations of both counts: noise makes its furthest values rarer, not more frequent.
bool piles_up(const std::vector<double>& y, double value, double slack) {
  const double near = slack / 12;
  double at = 0, beside = 0;
  for (const double v : y) {
    at += v == value;
    beside += v != value && std::abs(v - value) <= near;
  }
  return at - beside > 6 * std::sqrt(at + beside);
}

}  // namespace

void unwrap_position(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  if (!recording.has("x_m")) return;
  const double interval_s = row_interval_s(recording);
  std::vector<double>& x = recording.column("x_m");
  const std::vector<Turn> turns = turns_of(recording.t_s(), x, interval_s);
  double range = turns.empty() ? 0 : counter_range(turns, x);
  if (!(range > 0)) return;
  const double quantum = rig.sensors.position.quantum_m;
  if (quantum > 0 && range > 10 * quantum) range = std::round(range / quantum) * quantum;
  std::map<int, std::size_t> rows;  // by turns: most rows keep their value
  std::vector<int> counts;
  for (std::size_t i = 0, next = 0, turned = 0; i < x.size(); ++i, turned = 0) {
    for (; next < turns.size() && turns[next].row == i; ++next) turned = turns[next].step > 0 ? 2 : 1;
    counts.push_back((counts.empty() ? 0 : counts.back()) + (turned == 1 ? 1 : turned == 2 ? -1 : 0));
    ++rows[counts.back()];
  }
  const int most =
      std::max_element(rows.begin(), rows.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += range * (counts[i] - most);
  notes.push_back(fmt::format("{}: x_m begins again {} time{}, each by {:.6g} m against the motion on both sides: a "
                              "counter of that range; its turns are added, the zero is that of most rows",
                              recording.path, turns.size(), turns.size() > 1 ? "s" : "", range));
}

void take_resolution(Rig& rig, const Recording& recording, std::vector<std::string>& notes) {
  std::vector<std::string> columns =
      rig.kind == RigKind::cylinder ? pressure_columns(recording) : std::vector<std::string>();
  for (const Signal signal : {Signal::x, Signal::supply_flow})
    if (const std::string column(info(signal).column); recording.has(column)) columns.push_back(column);
  for (const std::string& column : columns) {
    const double step = step_of_values(recording.column(column));
    const SensorOfColumn sensor = sensor_of(rig.sensors, column);
    if (!(step > (1 + same_multiple) * std::sqrt(12.0) * rms_with_quantum(sensor.noise, *sensor.quantum))) continue;
    const std::string evidence = fmt::format("{}: {} comes in steps of {:.4g}, sensors.{} is {:g}", recording.path,
                                             column, step, sensor.key, *sensor.quantum);
    if (step > sensor.most)
      throw InputError(fmt::format("{}: expected {:g} at most to compare", evidence, sensor.most));
    notes.push_back(
        fmt::format("{}: compared with that step; to state it: sensors.{}: {:.4g}", evidence, sensor.key, step));
    *sensor.quantum = step;
  }
}

void refuse_repeated_channels(const Rig& rig, const Recording& recording) {
  SensorsParameters sensors = rig.sensors;
  std::vector<std::string> names = pressure_columns(recording);
  for (const char* name : {"x_ref_m", "x_m", "u_V", "F_N"})
    if (recording.has(name)) names.emplace_back(name);
  for (std::size_t a = 0; a < names.size(); ++a)
    for (std::size_t b = a + 1; b < names.size(); ++b) {
      if (names[a] == "u_V" && names[b] == "F_N") continue;  // a force by the command's gain
      const Copy copy = as_copy(recording.column(names[a]), recording.column(names[b]));
      double noise = 0;  // two pressures have sensors of their own
      if (names[a].ends_with("_Pa") && names[b].ends_with("_Pa"))
        noise =
            std::min(std::abs(copy.factor) * sensor_of(sensors, names[a]).noise, sensor_of(sensors, names[b]).noise);
      const double most = std::min(own_noise_share * noise, own_noise_share * copy.step);
      if (!(copy.step > 0) || copy.rows < least_copied || !(copy.rest <= std::max(most, 1e-7 * copy.step))) continue;
      throw InputError(fmt::format(
          "{}: {} repeats {}{}, expected a channel of its own: is it wired or logged twice?", recording.path, names[b],
          names[a], std::abs(copy.factor - 1) < 1e-9 ? " in every row" : fmt::format(" times {:.6g}", copy.factor)));
    }
}

std::vector<ClippedEnd> clipped_ends(const std::vector<double>& values, double slack, int frozen_rows) {
  const double low = quantile(values, 0), high = quantile(values, 1);
  std::vector<ClippedEnd> out;
  if (!(high > low)) return out;  // constant: frozen
  for (const double end_value : {low, high}) {
    const auto runs = runs_at(values, end_value);
    std::size_t rows = 0, longest = 0;
    for (const auto& [first, end] : runs) rows += end - first, longest = std::max(longest, end - first);
    bool is_clipped =
        frozen_rows > 0 && (longest > static_cast<std::size_t>(frozen_rows) || piles_up(values, end_value, slack));
    if (!is_clipped && longest >= least_standstill) {
      const double usual = beyond_the_motion * usual_kink(values, end_value) + slack / static_cast<double>(slope_rows);
      is_clipped = std::any_of(runs.begin(), runs.end(), [&](const auto& run) {
        return run.second - run.first >= least_standstill && std::abs(slope_at(values, run.first, -1)) > usual &&
               std::abs(slope_at(values, run.second, 1)) > usual;
      });
    }
    if (is_clipped) out.push_back({end_value, rows});
  }
  return out;
}

}  // namespace pneuservo
