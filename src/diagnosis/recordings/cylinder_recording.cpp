// A recording of a pneumatic cylinder made ready for comparison.
#include "diagnosis/recordings/cylinder_recording.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/input_error.hpp"
#include "diagnosis/recordings/even_samples.hpp"
#include "diagnosis/residuals/gaussian_kernel.hpp"

namespace pneuservo {

namespace {

constexpr double position_sigma_s = 0.003, pressure_sigma_s = 0.005;
constexpr double long_gap_s = 0.02, forget_gap_s = 0.5;
constexpr double longest_told_steps = 12;  ///< of the loop, over three rows: a line through slower ones tells no age

double interval_of(const Recording& recording) {
  const double interval_s = row_interval_s(recording);
  if (!(interval_s > 0)) throw InputError(fmt::format("{}: found one row, expected a recording", recording.path));
  return interval_s;
}

/// What the rows' command says of the time between them.
bool is_held(const Recording& recording, const std::string& column, int steps) {
  const Sampling stated = source_of(recording, column).sampling;
  if (stated != Sampling::unstated) return stated == Sampling::held;
  return steps == 1;  // every n-th command of a loop: between two of them there were others
}

/// Samples from one value to the next, the median, and the first sample that has one.
std::pair<std::size_t, std::size_t> written_samples(const std::vector<double>& values) {
  std::vector<std::size_t> known, apart;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values[i])) known.push_back(i);
  for (std::size_t i = 1; i < known.size(); ++i) apart.push_back(known[i] - known[i - 1]);
  if (apart.empty()) return {1, 0};
  const auto middle = apart.begin() + static_cast<std::ptrdiff_t>(apart.size() / 2);
  std::nth_element(apart.begin(), middle, apart.end());
  return {*middle, known.front()};
}

/// Whether rows at uneven stamps found commands that a loop had held since its last tick, rather than the command of
/// their own instant. A held one is off the line through its neighbours by its slope times how much older it is, with
/// the ticks where that explains most. Rows that do not tell were read: who writes in the loop's tick stamps evenly.
bool found_held(const std::vector<double>& time_s, const std::vector<double>& command_V, double step_s) {
  constexpr int phases = 8;
  constexpr double least_known = 0.25;  // standard error of the share of the age, 0 or 1
  constexpr double least_turns = 0.1;   // of the rows: with fewer on the other side of a tick their stamps err
  double most_explained = 0, share = 1, error = infinite;
  for (int phase = 0; phase < phases; ++phase) {
    const auto age_s = [&](std::size_t i) {
      const double ticks = (time_s[i] - time_s.front()) / step_s - static_cast<double>(phase) / phases;
      return step_s * (ticks - std::floor(ticks));
    };
    double both = 0, square = 0, rest = 0, count = 0, turns = 0;
    for (std::size_t i = 1; i + 1 < time_s.size(); ++i) {
      const double apart_s = time_s[i + 1] - time_s[i - 1], way = (time_s[i] - time_s[i - 1]) / apart_s;
      const double slope = (command_V[i + 1] - command_V[i - 1]) / apart_s;
      const double off = command_V[i] - command_V[i - 1] - way * (command_V[i + 1] - command_V[i - 1]);
      const double by_age = -slope * (age_s(i) - (1 - way) * age_s(i - 1) - way * age_s(i + 1));
      if (!std::isfinite(off * by_age) || apart_s > longest_told_steps * step_s) continue;
      both += off * by_age;
      square += by_age * by_age;
      rest += off * off;
      turns += std::abs(age_s(i) - age_s(i - 1)) > 0.5 * step_s;
      ++count;
    }
    if (!(square > 0) || !(both > 0) || both * both / square <= most_explained) continue;
    most_explained = both * both / square;
    share = turns > least_turns * count ? both / square : 0;
    error = std::sqrt(std::max(0.0, rest - most_explained) / count / square);
  }
  return error > least_known || share > 0.5;
}

/// How long before the middle of the step that its command acts in a row was read. A loop's own row begins the step;
/// one that finds a held command finds it half of a step old in the mean.
double read_before_middle_s(const Recording& recording, const std::string& column, bool is_even, double step_s) {
  if (source_of(recording, column).sampling == Sampling::instant) return 0.5 * step_s;
  const bool is_beside = !is_even && found_held(recording.t_s(), recording.column(column), step_s);
  return is_beside ? 0.5 * step_s : 0.0;
}

/// Missing values on a straight line between their neighbours; marks them, and what follows long gaps.
std::vector<double> filled(std::vector<double> values, double period_s, std::vector<char>& usable) {
  const auto known = [](double value) { return std::isfinite(value); };
  const auto first = std::find_if(values.begin(), values.end(), known);
  if (first == values.end()) return values;
  std::fill(values.begin(), first, *first);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (known(values[k])) continue;
    std::size_t end = k;
    while (end < values.size() && !known(values[end])) ++end;
    const double before = values[k - 1], after = end < values.size() ? values[end] : before;
    const auto gap = static_cast<double>(end - k);
    for (std::size_t i = k; i < end; ++i)
      values[i] = before + (after - before) * static_cast<double>(i - k + 1) / (gap + 1);
    const double spoilt_s = gap * period_s > long_gap_s ? forget_gap_s : 0.0;
    const std::size_t until = std::min(values.size(), end + static_cast<std::size_t>(spoilt_s / period_s));
    std::fill(usable.begin() + static_cast<std::ptrdiff_t>(k), usable.begin() + static_cast<std::ptrdiff_t>(until), 0);
    k = end;
  }
  return values;
}

/// Twice smoothed so that a cubic comes out exact: the Gaussian alone flattens every bend.
std::vector<double> smoothed_position(const GaussianKernel& kernel, const std::vector<double>& position) {
  std::vector<double> once = kernel.apply(position, 0), rest(position.size());
  for (std::size_t k = 0; k < position.size(); ++k) rest[k] = position[k] - once[k];
  rest = kernel.apply(rest, 0);
  for (std::size_t k = 0; k < position.size(); ++k) once[k] += rest[k];
  return once;
}

/// The measured pressure that stands for each port while the gas finds its state: the port's own, else the chamber's.
void take_start_pressures(CylinderRecording& out, const std::string& path) {
  const GaussianKernel kernel(std::max(pressure_sigma_s, out.period_s()), out.period_s());
  for (std::size_t side = 0; side < 2; ++side) {
    const Signal port = port_signals[side], chamber = chamber_signals[side];
    const Signal source = !out.measured[port].empty() ? port : chamber;
    if (out.measured[source].empty())
      throw InputError(fmt::format("{}: found no column {} or {}, expected a pressure of side {}", path,
                                   info(port).column, info(chamber).column, side + 1));
    std::vector<char> ignored(out.samples());
    std::vector<double> values = filled(out.measured[source], out.period_s(), ignored);
    values.resize(std::min(values.size(), out.inputs.release + 2 * kernel.reach()));
    out.inputs.start_sensor[side] = source;
    out.inputs.start_Pa[side] = kernel.apply(values, 0);
    out.inputs.start_Pa_per_s[side] = kernel.apply(values, 1);
  }
}

/// What the valves find. A sensor that is read more slowly than a droop comes says too little of it, and no more than
/// the model does.
void take_supply(CylinderRecording& out) {
  const std::vector<double>& measured = out.measured[Signal::p_supply];
  const auto known = std::ranges::count_if(measured, [](double value) { return std::isfinite(value); });
  if (known * long_gap_s < static_cast<double>(out.samples()) * out.period_s()) return;
  const GaussianKernel kernel(std::max(pressure_sigma_s, out.period_s()), out.period_s());
  std::vector<char> ignored(out.samples());
  const std::vector<double> values = filled(measured, out.period_s(), ignored);
  out.inputs.supply_Pa = kernel.apply(values, 0);
  out.inputs.supply_Pa_per_s = kernel.apply(values, 1);
}

/// Ports and chambers always: the force is of the chambers, and what a start may have changed shows at both.
void want_signals(CylinderRecording& out) {
  std::erase_if(out.inputs.wanted, [&](Signal signal) {
    return !std::ranges::count(port_signals, signal) && !std::ranges::count(chamber_signals, signal) &&
           out.measured[signal].empty();
  });
}

}  // namespace

CylinderRecording prepare_recording(const Recording& recording, const Rig& rig, double longest_s) {
  const std::vector<std::string> commands = command_columns(rig);
  recording.require({"x_m", commands.front(), commands.back()});
  CylinderRecording out;
  out.inputs.period_s = interval_of(recording);
  out.inputs.steps = std::max(1, static_cast<int>(std::lround(out.period_s() / rig.period_s)));
  out.inputs.command_is_held = is_held(recording, commands.front(), out.inputs.steps);
  const EvenSamples even(recording.t_s(), out.period_s(), longest_s);
  std::tie(out.inputs.command_samples, out.inputs.first_command) =
      written_samples(even.placed(recording.column(commands.front())));
  out.start_s = recording.t_s().front();
  out.usable.assign(even.count(), 1);
  out.position_m = even.drawn(recording.column("x_m"));
  for (std::size_t valve = 0; valve < commands.size(); ++valve)
    out.inputs.command_V[valve] =
        filled(even.straight(recording.column(commands[valve]),
                             read_before_middle_s(recording, commands[valve], even.is_even(), out.inputs.step_s())),
               out.period_s(), out.usable);
  for (const Signal signal : gas_signals) {
    if (!recording.has(info(signal).column)) continue;
    std::vector<double>& values = out.measured[signal];
    values = even.placed(recording.column(info(signal).column));
    // At the end of its range a sensor says no more than that.
    const double range = rig.sensors.resolution(signal).range;
    std::ranges::replace_if(
        values, [&](double v) { return std::fabs(v) >= range; }, std::numeric_limits<double>::quiet_NaN());
    if (std::none_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) values.clear();
  }
  want_signals(out);
  const std::vector<double> position = filled(out.position_m, out.period_s(), out.usable);
  const GaussianKernel kernel(std::max(position_sigma_s, out.period_s()), out.period_s());
  out.inputs.position_m = smoothed_position(kernel, position);
  out.inputs.velocity_mps = kernel.apply(position, 1);
  out.inputs.release = static_cast<std::size_t>(std::lround(ports_followed_s / out.period_s()));
  const auto first = static_cast<std::size_t>(std::lround(first_compared_s / out.period_s()));
  if (out.samples() < first + static_cast<std::size_t>(1.0 / out.period_s()))
    throw InputError(fmt::format("{}: found {:.3g} s of samples, expected at least {:.3g} s", recording.path,
                                 out.period_s() * static_cast<double>(out.samples()), first_compared_s + 1.0));
  std::fill_n(out.usable.begin(), first, 0);
  // Smoothing reaches beyond the last sample.
  std::fill_n(out.usable.rbegin(), kernel.reach(), 0);
  if (!std::isfinite(out.inputs.position_m.front()) || !std::isfinite(out.inputs.command_of(0).front()) ||
      !std::isfinite(out.inputs.command_of(1).front()))
    throw InputError(
        fmt::format("{}: found no value in x_m or {}, expected numbers", recording.path, fmt::join(commands, " or ")));
  take_start_pressures(out, recording.path);
  take_supply(out);
  return out;
}

}  // namespace pneuservo
