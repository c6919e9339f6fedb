// Limits of the supervised motion, from the config's own simulation.
#include "loop/motion_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/air.hpp>
#include <pneuservo/rig/possible_values.hpp>

#include "config/rig_parameters.hpp"
#include "loop/trial_motion.hpp"
#include "pass/command_pass.hpp"

namespace pneuservo {
namespace {

/// Over the largest of 100 drawn machines; 100 further ones came to 1.3 times it once (command pass, chapter 5).
constexpr double usual_margin = 1.5;
/// Periods that are simulated, some 0.2 s of work; 5 s of motion at 1 kHz get 100 machines.
constexpr double simulated_periods = 5e5;
constexpr int most_machines = 100, least_machines = 20;
/// A prediction that permitted machines leave by more than a tenth of the stroke finds no obstacle in time.
constexpr double cap_share_of_stroke = 0.1;
/// The encoder's part: six standard deviations and a quantum.
constexpr double noise_deviations = 6.0;
/// Breakaway pressure of the seals of low-friction servo cylinders: 0.05 to 0.08 bar; 10 N on 1257 mm2.
constexpr double breakaway_Pa = 8e3;
/// A start that goes wrong is found within the 5 mm that it may go; what is left is the encoder's and the tick's.
constexpr double largest_start_deviation_m = 4e-3;
/// Smaller differences harm nobody and nothing; whoever wants a finer watch states it.
constexpr double least_deviation_m = 5e-4, least_speed_deviation_mps = 0.02;
/// Share of the start's largest speed that the steady flow of the limited command gives; the rest is what the gas
/// swings.
constexpr double start_speed_share = 0.75;
/// Of set-up work beside people; the approach stays at half of it.
constexpr double largest_start_mps = 0.2;
constexpr double standing_mps = 1e-3;  ///< slower is standing
constexpr double least_standing_m = 2e-4;

double encoder_part_m(const Rig& rig) {
  return noise_deviations * rig.sensors.position.noise_m + rig.sensors.position.quantum_m;
}

/// The encoder's part of the speed, as the law's filter lets it through.
double encoder_part_mps(const Rig& rig) {
  const double filter_s = rig.controller.velocity_filter_s();
  const double share = filter_s > 0.0 ? -std::expm1(-rig.period_s / filter_s) : 1.0;
  return share * encoder_part_m(rig) / rig.period_s;
}

/// Steady speed of the slider per volt: choked flow of the emptying side out of the smaller chamber [m/(s V)].
double speed_per_volt(const Rig& rig) {
  const Air<double> air(rig.axis.air);
  const auto& c = rig.axis.cylinder;
  return air.flow_constant * std::sqrt(air.R * air.temperature_K) * rig.axis.valve.area_per_volt_m2_per_V /
         std::min(c.area_1_m2, c.area_2_m2);
}

/// Command that moves the slider at a share of the start's speed, beyond what the valve's overlap takes.
double start_command_V(const Rig& rig) {
  const auto& valve = rig.axis.effects.valve;
  const double idle_V = std::max(valve.valve_dead_band.width_V, 0.0) + std::fabs(valve.valve_offset.offset_V) +
                        std::fabs(rig.safe_output.command_V);
  return start_speed_share * largest_start_mps / speed_per_volt(rig) + idle_V;
}

/// Standard deviation of the pressure sensors that close the force loop.
double pressure_noise_Pa(const Rig& rig) {
  return rig.controller.takes_chambers() ? rig.sensors.chamber_pressure.noise_Pa : rig.sensors.port_pressure.noise_Pa;
}

/// Force of the air that a slider at rest may show: what friction holds, what is noise, and what a safe output that
/// leaves the valve open makes of the ports, whose pressures the estimator begins with.
double resting_force_N(const Rig& rig) {
  const auto& c = rig.axis.cylinder;
  const double noise_N = noise_deviations * pressure_noise_Pa(rig) * std::hypot(c.area_1_m2, c.area_2_m2);
  const auto safe_V = safe_commands_V(rig);
  const double open_N = port_step_Pa_per_V(rig) * (std::fabs(safe_V[0]) * c.area_1_m2 +
                                                   std::fabs(rig.valves() == 2 ? safe_V[1] : safe_V[0]) * c.area_2_m2);
  return dry_friction_max_N(rig) + noise_N + open_N;
}

/// One machine that the config permits.
AxisParameters<double> drawn_machine(const Rig& rig, Random& random) {
  Rig machine = rig;
  machine.deviations.clear();
  machine.concealed.clear();
  for (const auto& [path, tolerance] : rig.tolerances)
    machine.deviations[path] = std::max(tolerance * std::clamp(random.normal(), -3.0, 3.0), -0.9);
  machine = simulated_rig(machine);
  auto& slider = machine.axis.slider;
  const double known_kg = rig.axis.slider.payload_kg;
  slider.payload_kg = random.uniform(0.0, std::max(known_kg, rig.limits.payload_max_kg.value_or(known_kg)));
  machine.axis.effects.motion.coulomb_friction.force_N += random.uniform(0.0, dry_friction_max_N(rig));
  return machine.axis;
}

/// A machine on its way along the reference.
struct Machine {
  MotionTwin axis;
  Random noise;
  double spread_m = 0.0, start_spread_m = 0.0, peak_speed_mps = 0.0, standing_force_N = 0.0, speed_spread_mps = 0.0;
};

TwinNoise drawn_noise(const Rig& rig, Random& random) {
  TwinNoise noise;
  const auto& s = rig.sensors;
  const double pressure_Pa = pressure_noise_Pa(rig);
  if (s.position.noise_m > 0.0) noise.position_m = s.position.noise_m * random.normal();
  if (pressure_Pa > 0.0)
    for (double& value : noise.pressure_Pa) value = pressure_Pa * random.normal();
  return noise;
}

/// Compares a machine with the prediction of the same tick.
void note(Machine& machine, const MotionTwin& prediction, bool starts) {
  const double off = std::fabs(machine.axis.position_m() - prediction.position_m());
  const double speed = std::fabs(machine.axis.speed_mps());
  const double faster = std::fabs(machine.axis.speed_mps() - prediction.velocity_mps());
  machine.spread_m = std::max(machine.spread_m, off);
  machine.speed_spread_mps = std::max(machine.speed_spread_mps, faster);
  if (starts) machine.start_spread_m = std::max(machine.start_spread_m, off);
  machine.peak_speed_mps = std::max(machine.peak_speed_mps, speed);
  if (speed < standing_mps)
    machine.standing_force_N = std::max(machine.standing_force_N, std::fabs(machine.axis.force_N()));
}

/// Whether a start from there is not proven yet, at the latest.
bool may_be_unproven(const MotionTwin& twin, double start_m) noexcept {
  return std::fabs(twin.position_m() - start_m) <=
         MotionSupervision::start_way_over_deviation * largest_start_deviation_m;
}

/// Largest command that the predicted motion needs until its start is proven, from a tick and a position on.
double largest_start_command_V(const Rig& rig, const TrialMotion& motion, MotionTwin twin, std::int64_t tick,
                               double start_m) {
  start_at(twin, rig, start_m);
  double most_V = 0.0;
  for (; tick < motion.last_tick && may_be_unproven(twin, start_m); ++tick) {
    twin.step(motion.at(tick), rig.axis.supply.pressure_Pa, MotionLimits::unlimited);
    for (const double command_V : twin.command_V()) most_V = std::max(most_V, std::fabs(command_V));
  }
  return most_V;
}

/// Runs prediction and machines side by side; the first machine is the config's own on the simulation's grid.
void run_machines(const Rig& rig, const TrialMotion& motion, MotionPrediction& out) {
  const auto count = static_cast<std::size_t>(
      std::clamp(static_cast<int>(simulated_periods / static_cast<double>(motion.last_tick - motion.reference_tick)),
                 least_machines, most_machines));
  MotionTwin& prediction = out.twin;
  std::vector<Machine> machines(count, Machine{prediction, Random()});
  Random draw(1);
  for (std::size_t i = 0; i < count; ++i) {
    Machine& machine = machines[i];
    if (i == 0) machine.axis.set_machine(rig, rig.axis, MotionTwin::simulated_cells(rig));
    else machine.axis.set_machine(rig, drawn_machine(rig, draw), prediction.cells());
    machine.noise = Random(2, i);
    start_at(machine.axis, rig, motion.start_m);
  }
  start_at(prediction, rig, motion.start_m);
  bool starts = true;
  for (std::int64_t tick = 0; tick < motion.last_tick; ++tick) {
    const ControlInput in = motion.at(tick);
    const double most_V = starts ? out.limits.start_command_V : MotionLimits::unlimited;
    for (Machine& machine : machines) {
      note(machine, prediction, starts);
      machine.axis.step(in, rig.axis.supply.pressure_Pa, most_V, drawn_noise(rig, machine.noise));
    }
    prediction.step(in, rig.axis.supply.pressure_Pa, most_V);
    out.following_error_m = std::max(out.following_error_m, std::fabs(in.now.d[0] - prediction.position_m()));
    starts = starts && may_be_unproven(prediction, motion.start_m);
  }
  out.machines = static_cast<int>(count);
  for (const Machine& machine : machines) {
    out.spread_m = std::max(out.spread_m, machine.spread_m);
    out.speed_spread_mps = std::max(out.speed_spread_mps, machine.speed_spread_mps);
    out.start_spread_m = std::max(out.start_spread_m, machine.start_spread_m);
    out.peak_speed_mps = std::max(out.peak_speed_mps, machine.peak_speed_mps);
    out.standing_force_N = std::max(out.standing_force_N, machine.standing_force_N);
  }
}

/// A stated limit; 0 is none.
double stated(double limit) { return limit > 0.0 ? limit : MotionLimits::unlimited; }

}  // namespace

/// An air bearing has no seals that rub.
double dry_friction_max_N(const Rig& rig) {
  const auto& c = rig.axis.cylinder;
  const double seals_N = info(rig.kind).has_seals ? breakaway_Pa * std::max(c.area_1_m2, c.area_2_m2) : 0.0;
  return rig.limits.dry_friction_max_N.value_or(seals_N);
}

MotionPrediction predict_motion(const Rig& wanted, const Reference& reference) {
  Rig rig = wanted;
  auto pass = pass_or_formula(rig, reference, PassWords::short_words).tables.prediction;
  return predict_motion(rig, reference, std::move(pass));
}

MotionPrediction predict_motion(const Rig& rig, const Reference& reference, std::shared_ptr<const PassTable> pass) {
  MotionPrediction out;
  MotionLimits& limits = out.limits;
  const LimitParameters& given = rig.limits;
  const double stroke_m = rig.axis.cylinder.stroke_m, encoder_m = encoder_part_m(rig);
  const double encoder_mps = encoder_part_mps(rig);
  limits.half_stroke_m = 0.5 * stroke_m;
  limits.end_stop_is_fault = given.end_stop_contact == EndStopContact::fault;
  limits.standing_m = std::max(least_standing_m, encoder_m);
  out.twin.configure(rig, reference, resting_force_N(rig), std::move(pass));
  const TrialMotion motion(rig, reference, out.twin);
  const double needed_V = std::max(largest_start_command_V(rig, motion, out.twin, 0, motion.start_m),
                                   largest_start_command_V(rig, motion, out.twin, motion.reference_tick, motion.end_m));
  limits.start_command_V = std::max(start_command_V(rig), usual_margin * needed_V);
  const bool is_stated = given.speed_mps && given.deviation_m && given.speed_deviation_mps && given.stall_force_N;
  if (!is_stated) run_machines(rig, motion, out);
  const double wanted_m = usual_margin * out.spread_m + encoder_m, cap_m = cap_share_of_stroke * stroke_m;
  out.scattered = wanted_m > cap_m;
  limits.deviation_m = given.deviation_m ? stated(*given.deviation_m) : std::clamp(wanted_m, least_deviation_m, cap_m);
  const double wanted_mps = std::max(usual_margin * out.speed_spread_mps, least_speed_deviation_mps) + encoder_mps;
  limits.speed_deviation_mps = given.speed_deviation_mps ? stated(*given.speed_deviation_mps) : wanted_mps;
  const double start_m = is_stated ? largest_start_deviation_m
                                   : std::max(usual_margin * out.start_spread_m + encoder_m, least_deviation_m);
  limits.start_deviation_m = std::isfinite(limits.deviation_m)
                                 ? std::min({limits.deviation_m, largest_start_deviation_m, start_m})
                                 : MotionLimits::unlimited;
  limits.start_speed_mps = largest_start_mps + encoder_mps;
  limits.stall_force_N = given.stall_force_N ? stated(*given.stall_force_N) : usual_margin * out.standing_force_N + 1.0;
  const ReferenceExtremes speeds = reference.extremes(1, rig.duration_s);
  const double asked_mps = std::max(-speeds.minimum, speeds.maximum);
  const double most_mps = std::max(2.0 * asked_mps, largest_start_mps);
  limits.speed_mps = given.speed_mps.value_or(
      encoder_mps + std::clamp(usual_margin * out.peak_speed_mps, largest_start_mps, most_mps));
  return out;
}

}  // namespace pneuservo
