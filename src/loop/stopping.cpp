// Stopping time and distance of a rig, simulated.
#include "loop/stopping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/rig/plant.hpp>

#include "config/rig_parameters.hpp"

namespace pneuservo {
namespace {

constexpr double gravity_mps2 = 9.80665;
constexpr double at_rest_mps = 1e-3, horizon_s = 1.0;
constexpr std::int64_t stops_of_a_course = 64;  // evenly spread; a move is over in a tenth of them at the fastest
constexpr double vented_over_atmosphere = 1.1, longest_vent_s = 20.0;
constexpr std::array<double, 4> speed_shares{0.25, 0.5, 0.75, 1.0};
// A share of the top speed counts up to this much above it: a reference passes its top speed between two stops.
constexpr double speed_slack = 1.02;

/// The plant with ideal sensors, and its state for whoever copies it.
class IdealPlant final : public Backend {
 public:
  explicit IdealPlant(const Rig& rig) : rig_(rig) { configure(); }
  void configure() override {
    plant_.configure(rig_.axis, rig_.period_s, rig_.simulation.cells_per_m, valve_arrangement(rig_));
    const InitialParameters& start = rig_.initial;
    plant_.reset({start.position_m, start.pressure_1_Pa,
                  start.pressure_2_Pa.value_or(balancing_pressure_2(rig_.axis, start.pressure_1_Pa))});
  }
  void activate() override {}
  bool read(std::int64_t tick, Measurement& measured) noexcept override {
    if (tick > 0) plant_.step(command_.valve_V, command_.valve_2_V);
    const PerSignal<double> values = true_values(plant_);
    for (const Signal signal : channel_signals)
      measured.channel[signal] = {values[signal], 0.0, true, Origin::simulated};
    return true;
  }
  bool write(std::int64_t, const Command& command) noexcept override {
    command_ = command;
    return true;
  }
  void deactivate() noexcept override {}
  Origins origins() const override {
    Origins all{.command = Origin::simulated};
    for (const Signal signal : channel_signals) all.channels[signal] = Origin::simulated;
    return all;
  }
  std::string name() const override { return "sim"; }

  const AxisPlant<double>& plant() const noexcept { return plant_; }
  const Command& command() const noexcept { return command_; }

 private:
  Rig rig_;
  AxisPlant<double> plant_;
  Command command_;
};

/// The slider goes on under the command `held` for held_s, then under the safe output.
Stop stop_of(AxisPlant<double> plant, const Rig& rig, const Command& held, double held_s) {
  const auto safe_V = safe_commands_V(rig);
  const double start_m = plant.position(), half_m = 0.5 * rig.axis.cylinder.stroke_m;
  Stop stop;
  stop.speed_mps = std::fabs(plant.velocity());
  const double way = plant.velocity() < 0.0 ? -1.0 : 1.0;
  bool stood = false;
  double low_m = 0.0, high_m = 0.0;
  const auto ticks = static_cast<std::int64_t>((horizon_s + held_s) / rig.period_s);
  for (std::int64_t tick = 1; tick <= ticks; ++tick) {
    const double t_s = static_cast<double>(tick) * rig.period_s;
    if (t_s - rig.period_s < held_s) plant.step(held.valve_V, held.valve_2_V);
    else plant.step(safe_V[0], safe_V[1]);
    const double x = plant.position();
    stop.distance_m = std::max(stop.distance_m, std::fabs(x - start_m));
    stop.meets_end_stop = stop.meets_end_stop || half_m - std::fabs(x) < 1e-6;
    if (std::fabs(plant.velocity()) > at_rest_mps) stop.rest_s = t_s;
    if (!stood && plant.velocity() * way <= at_rest_mps) {
      stood = true;
      stop.standstill_s = t_s;
      low_m = high_m = x;
    }
    low_m = std::min(low_m, x), high_m = std::max(high_m, x);
    if (!stood) low_m = high_m = x;
  }
  if (!stood) stop.standstill_s = std::numeric_limits<double>::infinity();
  if (std::fabs(plant.velocity()) > at_rest_mps) stop.rest_s = std::numeric_limits<double>::infinity();
  stop.further_m = high_m - low_m;
  return stop;
}

/// Largest force on a slider that something holds where it is, with the valve in its safe output.
double held_force_N(AxisPlant<double> plant, const Rig& rig) {
  const auto safe_V = safe_commands_V(rig);
  plant.hold_piston(true);
  double force_N = std::fabs(plant.driving_force());
  for (double t_s = 0.0; t_s < 0.5; t_s += rig.period_s) {
    plant.step(safe_V[0], safe_V[1]);
    force_N = std::max(force_N, std::fabs(plant.driving_force()));
  }
  return force_N;
}

/// Work of the gas of one side against the atmosphere: p V ln(p / p_atm) - (p - p_atm) V; isothermal, the most there
/// is.
double work_of_gas_J(double pressure_Pa, double atmosphere_Pa, double volume_m3) {
  return std::max(0.0, volume_m3 * (pressure_Pa * std::log(pressure_Pa / atmosphere_Pa) - pressure_Pa + atmosphere_Pa));
}

double stored_energy_J(const AxisPlant<double>& plant, const Rig& rig) {
  const auto& c = rig.axis.cylinder;
  const double half_m = 0.5 * c.stroke_m, x = plant.position();
  const double volume_1 = c.dead_volume_1_m3 + c.area_1_m2 * (half_m + x) + rig.axis.line_1.volume_m3();
  const double volume_2 = c.dead_volume_2_m3 + c.area_2_m2 * (half_m - x) + rig.axis.line_2.volume_m3();
  const auto p = plant.chamber_pressure();
  const double atmosphere_Pa = rig.axis.air.atmosphere_Pa;
  return work_of_gas_J(low(p), atmosphere_Pa, volume_1) + work_of_gas_J(high(p), atmosphere_Pa, volume_2);
}

/// Until both chambers are vented in the safe output; infinite where the valve shuts the gas in.
double vent_time_s(AxisPlant<double> plant, const Rig& rig) {
  const auto safe_V = safe_commands_V(rig);
  const double limit_Pa = vented_over_atmosphere * rig.axis.air.atmosphere_Pa;
  for (double t_s = 0.0; t_s < longest_vent_s; t_s += rig.period_s) {
    const auto p = plant.chamber_pressure();
    if (std::max(low(p), high(p)) < limit_Pa) return t_s;
    plant.step(safe_V[0], safe_V[1]);
  }
  return std::numeric_limits<double>::infinity();
}

/// What the whole loop does on one machine along one reference: a stop from every between_stops_s of it.
struct FollowedCourse {
  std::vector<Stop> stops;
  std::optional<AxisPlant<double>> fastest;  ///< the plant at its highest speed
  Command fastest_command;
  std::int64_t fastest_tick = 0;
  double held_force_N = 0.0, stored_energy_J = 0.0;
};

/// Nothing may end the course: the stops are made here.
Rig without_limits(Rig rig) {
  LimitParameters& limits = rig.limits;
  limits.speed_mps = 100.0;
  limits.deviation_m = limits.stall_force_N = 0.0;
  limits.end_stop_contact = EndStopContact::allowed;
  limits.flow_mismatch_share = limits.chamber_mismatch_Pa = limits.checks_rest_s = limits.supply_share = 0.0;
  limits.bad_share = limits.missed_share = limits.position_margin_m = 1.0;
  limits.pressure_Pa = 1e8;
  rig.sensors.position.noise_m = rig.sensors.port_pressure.noise_Pa = 0.0;  // no ideal sensor is frozen
  rig.sensors.chamber_pressure.noise_Pa = rig.sensors.supply_pressure.noise_Pa = 0.0;
  return rig;
}

FollowedCourse follow(const Rig& told, const Rig& machine, const LoadPositions& load, bool every_stop) {
  const Rig rig = without_limits(told);
  IdealPlant backend(machine);
  AxisLoop loop;
  loop.configure(rig, load);
  FollowedCourse course;
  const auto ticks = static_cast<std::int64_t>(rig.duration_s / rig.period_s);
  const std::int64_t stride = std::max<std::int64_t>(1, ticks / stops_of_a_course);
  double fastest_mps = -1.0;
  for (std::int64_t tick = 0; static_cast<double>(tick) * rig.period_s <= rig.duration_s + loop.reference_start_s();
       ++tick) {
    if (!loop.pass(backend, tick, 0, nullptr, nullptr) || loop.faults() != 0) break;
    const AxisPlant<double>& plant = backend.plant();
    if (std::fabs(plant.velocity()) > fastest_mps) {
      fastest_mps = std::fabs(plant.velocity());
      course.fastest = plant;
      course.fastest_command = backend.command();
      course.fastest_tick = tick;
    }
    if (!every_stop || tick % stride != 0) continue;
    Stop stop = stop_of(plant, machine, {}, 0.0);
    stop.at_s = static_cast<double>(tick) * rig.period_s;
    course.stops.push_back(stop);
    course.stored_energy_J = std::max(course.stored_energy_J, stored_energy_J(plant, machine));
    if (tick % (5 * stride) == 0) course.held_force_N = std::max(course.held_force_N, held_force_N(plant, machine));
  }
  return course;
}

/// Machines at the ends of what the config allows: payload and supply.
std::vector<Rig> extreme_machines(const Rig& rig) {
  const double payload_kg = rig.axis.slider.payload_kg;
  const double most_kg = std::max(payload_kg, rig.limits.payload_max_kg.value_or(payload_kg));
  const auto found = rig.tolerances.find("supply.pressure_Pa");
  const double supply = found == rig.tolerances.end() ? 0.0 : 2.0 * found->second;
  std::vector<Rig> machines;
  for (const double kg : {payload_kg, most_kg}) {
    for (const double share : {1.0 - supply, 1.0 + supply}) {
      Rig machine = rig;
      machine.axis.slider.payload_kg = kg;
      machine.axis.supply.pressure_Pa *= share;
      machines.push_back(machine);
      if (supply == 0.0) break;
    }
    if (most_kg == payload_kg) break;
  }
  return machines;
}

/// A move over 0.45 of the stroke with its top speed at `center_m`, there and back. Degree 7: its top is 35/16 of the
/// mean.
Rig moved_to(Rig rig, double center_m, double speed_mps) {
  constexpr double peak_over_mean = 35.0 / 16.0, rest_s = 0.3;
  const double reach_m = 0.225 * rig.axis.cylinder.stroke_m;
  const double lasts_s = peak_over_mean * 2.0 * reach_m / speed_mps;
  ReferenceSpec spec;
  spec.kind = ReferenceKind::waypoints;
  spec.smoothness = 7;
  spec.times_s = {0.0, rest_s, rest_s + lasts_s, 2.0 * rest_s + lasts_s, 2.0 * (rest_s + lasts_s)};
  spec.positions_m = {center_m - reach_m, center_m - reach_m, center_m + reach_m, center_m + reach_m,
                      center_m - reach_m};
  rig.reference = spec;
  rig.duration_s = spec.times_s.back();
  rig.initial.position_m = spec.positions_m.front();
  rig.evaluation.reset();
  return rig;
}

/// Vented at one end; the supply comes back with the valve fully open to the other.
double repressurising_speed_mps(const Rig& rig) {
  double fastest = 0.0;
  for (const double way : {-1.0, 1.0}) {
    AxisPlant<double> plant;
    plant.configure(rig.axis, rig.period_s, rig.simulation.cells_per_m, valve_arrangement(rig));
    const double atmosphere_Pa = rig.axis.air.atmosphere_Pa, half_m = 0.5 * rig.axis.cylinder.stroke_m;
    plant.reset({-way * 0.99 * half_m, atmosphere_Pa, atmosphere_Pa});
    for (double t_s = 0.0; t_s < 2.0; t_s += rig.period_s) {
      plant.step(way * rig.axis.valve.command_max_V, -way * rig.axis.valve.command_max_V);
      fastest = std::max(fastest, way * plant.velocity());
    }
  }
  return fastest;
}

/// A vertical axis, chamber 1 below: balanced, then chamber 1 opens through the bore of its line.
void drop(const Rig& rig, StoppingTable& table) {
  AxisParameters<double> axis = rig.axis;
  const double weight_N = (axis.slider.mass_kg + axis.slider.payload_kg) * gravity_mps2;
  axis.effects.motion.constant_force.force_N += weight_N;
  AxisPlant<double> plant;
  axis.effects.chamber_leak_1.area_m2 = axis.line_1.section_m2();
  plant.configure(axis, rig.period_s, rig.simulation.cells_per_m, valve_arrangement(rig));
  const double p_1 = rig.initial.pressure_1_Pa, way_m = 0.5 * axis.cylinder.stroke_m;
  const double p_2 =
      std::max(balancing_pressure_2(axis, p_1) - weight_N / axis.cylinder.area_2_m2, axis.air.atmosphere_Pa);
  plant.reset({0.5 * way_m, p_1, p_2});
  const auto safe_V = safe_commands_V(rig);
  table.drop_s = std::numeric_limits<double>::infinity();
  for (double t_s = 0.0; t_s < 5.0; t_s += rig.period_s) {
    plant.step(safe_V[0], safe_V[1]);
    table.drop_speed_mps = std::max(table.drop_speed_mps, -plant.velocity());
    if (plant.position() > -0.5 * way_m) continue;
    table.drop_s = t_s + rig.period_s;
    return;
  }
}

void add_stops(const FollowedCourse& course, StoppingTable& table) {
  for (const Stop& stop : course.stops)
    for (StoppingRow& row : table.rows) {
      if (stop.speed_mps > speed_slack * row.speed_mps) continue;
      if (stop.distance_m > row.worst.distance_m) row.worst = stop;
      // A slider that hardly moved has no time to stop: times are those from the upper half of the speeds.
      if (stop.speed_mps > 0.5 * row.speed_mps) {
        row.standstill_s = std::max(row.standstill_s, stop.standstill_s);
        row.rest_s = std::max(row.rest_s, stop.rest_s);
      }
      row.further_m = std::max(row.further_m, stop.further_m);
    }
  table.held_force_N = std::max(table.held_force_N, course.held_force_N);
  table.stored_energy_J = std::max(table.stored_energy_J, course.stored_energy_J);
}

}  // namespace

StoppingTable stopping_table(const Rig& rig, const LoadPositions& load) {
  StoppingTable table;
  table.top_speed_mps = reference_peak_speed_mps(rig.reference, rig.duration_s, load);
  // A cause waits up to a period for its sample, over a bus one more for its frame; then the tick answers.
  const bool over_bus = rig.hal && rig.hal->can;
  table.reaction_s = (over_bus || rig.simulation.input_age_periods > 0 ? 3.0 : 2.0) * rig.period_s;
  const FollowedCourse own = follow(rig, rig, load, true);
  if (!own.fastest) return table;
  table.own_reference = stop_of(*own.fastest, rig, {}, 0.0);
  table.own_reference.at_s = static_cast<double>(own.fastest_tick) * rig.period_s;
  const double top_mps = std::max(table.top_speed_mps, table.own_reference.speed_mps);
  for (const double share : speed_shares) table.rows.push_back({.speed_mps = share * top_mps, .worst = {}});
  add_stops(own, table);
  const double half_m = 0.5 * rig.axis.cylinder.stroke_m;
  for (const Rig& machine : extreme_machines(rig)) {
    add_stops(follow(rig, machine, load, true), table);
    for (const double place : {-0.5, 0.0, 0.5}) {
      const Rig told = moved_to(rig, place * half_m, top_mps);
      Rig moved = machine;
      moved.initial = told.initial;
      ++table.moves;
      try {
        add_stops(follow(told, moved, load, true), table);
      } catch (const std::invalid_argument&) { ++table.moves_left_out; }
    }
  }
  if (over_bus) {
    table.watchdog_s = rig.hal->can->watchdog_s;
    table.watchdog_distance_m = stop_of(*own.fastest, rig, own.fastest_command, table.watchdog_s).distance_m;
  }
  table.vent_s = vent_time_s(*own.fastest, rig);
  table.repressurising_speed_mps = repressurising_speed_mps(rig);
  drop(extreme_machines(rig).back(), table);
  return table;
}

}  // namespace pneuservo
