// The plant alone on a recorded command: what it does, without sensors.
#include "sim/plant_course.hpp"

#include <cmath>
#include <initializer_list>
#include <string_view>

#include <fmt/format.h>

#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/rig/plant.hpp>

#include "config/input_error.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {
namespace {

/// First value of the first of these columns that is there and holds one; else the fallback.
double first_value(const Recording& recording, std::initializer_list<std::string_view> names, double fallback) {
  for (const std::string_view name : names)
    if (recording.has(name) && std::isfinite(recording.column(name).front())) return recording.column(name).front();
  return fallback;
}

/// The recording's own start: at rest, each line at its chamber's pressure.
PlantStart<double> recorded_start(const Rig& rig, const Recording& recording) {
  const PlantStart<double> own = plant_start(rig);
  return {first_value(recording, {"x_true_m", info(Signal::x).column}, own.position_m),
          first_value(recording, {"p1_chamber_true_Pa", info(Signal::p1_chamber).column, info(Signal::p1_port).column},
                      own.pressure_1_Pa),
          first_value(recording, {"p2_chamber_true_Pa", info(Signal::p2_chamber).column, info(Signal::p2_port).column},
                      own.pressure_2_Pa)};
}

/// A command that is held for longer than the axis takes for its whole stroke says nothing of where it stands.
void refuse_long_gaps(const Rig& rig, const Recording& recording) {
  const double longest_s = AxisLoop::longest_approach_s(rig.axis.cylinder.stroke_m);
  const std::vector<double>& t_s = recording.t_s();
  for (std::size_t i = 1; i < t_s.size(); ++i)
    if (t_s[i] - t_s[i - 1] > longest_s)
      throw InputError(
          fmt::format("{}, line {}: t_s goes from {} to {}, a gap of {:.6g} s without a command, expected at most "
                      "{:.3g} s, in which "
                      "the axis crosses its stroke: give the rows before or after it as a recording of their own",
                      recording.path, recording.line_numbers[i], t_s[i - 1], t_s[i], t_s[i] - t_s[i - 1], longest_s));
}

/// A gap is held; a column without a single value would be a command of 0 V that nobody gave.
void require_values(const Recording& recording, const std::string& name) {
  const std::vector<double>& command = recording.column(name);
  for (std::size_t i = 0; i < command.size(); ++i)
    if (std::isinf(command[i]))
      throw InputError(fmt::format("{}, line {}: {}: found {}, expected a command in volts", recording.path,
                                   recording.line_numbers[i], name, command[i]));
  for (const double value : command)
    if (std::isfinite(value)) return;
  throw InputError(fmt::format("{}: {}: found no value in any row, expected a command in volts", recording.path, name));
}

PlantCourse course_of(std::size_t rows, std::size_t valves) {
  PlantCourse course;
  for (const Signal signal : channel_signals) course.measured[signal].resize(rows);
  course.v_mps.resize(rows), course.u1_V.resize(rows);
  if (valves == 2) course.u2_V.resize(rows);
  return course;
}

}  // namespace

PlantCourse simulate_plant(const Rig& rig, const Recording& recording) {
  const std::vector<std::string> names = command_columns(rig);
  recording.require(names);
  for (const std::string& name : names) require_values(recording, name);
  refuse_long_gaps(rig, recording);
  const std::vector<double>&command_1 = recording.column(names.front()), &command_2 = recording.column(names.back());
  const std::vector<double>& t_s = recording.t_s();
  VolumeGrowth growth;  // of a pressure rig
  growth.configure(rig);
  AxisPlant<double> plant;
  plant.configure(rig.axis, rig.period_s, rig.simulation.cells_per_m, valve_arrangement(rig));
  PlantStart<double> start = recorded_start(rig, recording);
  if (rig.controls_pressure()) {
    growth.reset(start.pressure_1_Pa);
    start.position_m = growth.position_m();
  }
  plant.reset(start);
  const auto step = [&](double command_1_V, double command_2_V) {
    if (rig.controls_pressure()) step_pressure_plant(plant, growth, command_1_V);
    else plant.step(command_1_V, command_2_V);
  };
  PlantCourse course = course_of(recording.rows(), names.size());
  double held_1_V = 0.0, held_2_V = 0.0;
  std::int64_t tick = std::llround(t_s.front() / rig.period_s);
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    for (const std::int64_t due = std::llround(t_s[i] / rig.period_s); tick < due; ++tick) step(held_1_V, held_2_V);
    if (std::isfinite(command_1[i])) held_1_V = command_1[i];
    if (std::isfinite(command_2[i])) held_2_V = command_2[i];
    const PerSignal<double> values = true_values(plant);
    for (const Signal signal : channel_signals) course.measured[signal][i] = values[signal];
    course.v_mps[i] = plant.velocity();
    course.u1_V[i] = held_1_V;
    if (names.size() == 2) course.u2_V[i] = held_2_V;
  }
  return course;
}

}  // namespace pneuservo
