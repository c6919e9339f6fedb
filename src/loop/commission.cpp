// Commissioning: probes, and what they prove.
#include "loop/commission.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <pneuservo/loop/fault.hpp>
#include <pneuservo/rig/possible_values.hpp>

#include "loop/air_force.hpp"
#include "loop/calibration.hpp"
#include "loop/commission_model.hpp"
#include "loop/commission_probe.hpp"
#include "loop/supervised_steps.hpp"

namespace pneuservo {
namespace {

constexpr double first_rest_s = 1.0;
constexpr double significant = 6.0;      // standard deviations of white noise: by chance once in 5e8
constexpr double least_answer = 0.1;     // of the model's: less is no answer of this valve
constexpr double least_way_m = 3e-4;     // of all probes together, each of some 2 mm
constexpr double plausible_factor = 1.6; // scale of the encoder: what valve area, supply and friction leave open
constexpr double free_hardness = 3.0;    // force over the model's: beyond it the slider sticks and slips
constexpr double shift_error_s = 0.03;   // of an answer's start: one way through 10 m of line
constexpr double sensor_share = 0.01;    // of the supply: error of a port sensor
constexpr double sure = 3.0;             // standard deviations of that error
constexpr std::uint64_t of_sensors = [] {
  std::uint64_t all = fault_position_range | fault_supply_low | fault_pressure_limit;
  for (const Signal signal : channel_signals) {
    const SignalFaults faults = faults_of(signal);
    all |= faults.missing | faults.frozen | faults.jumped;
  }
  return all;
}();

/// Signs of both probes together: +1 as the config says, -1 reversed, 0 not proven.
struct Signs {
  int position = 0, pressure = 0, chambers = 0;
};

class Commissioning {
 public:
  Commissioning(const Rig& rig, const Origins& origins) : rig_(rig), origins_(origins) {}
  CommissionResult result;

  bool judge_rest(const RestState& rest);
  void judge_probes(const std::vector<Probe>& probes);
  void fault(const std::string& why) { add("supervision", CommissionVerdict::wrong, why, ""); }

 private:
  void add(std::string name, CommissionVerdict verdict, std::string what, std::string remedy) {
    result.checks.push_back({std::move(name), verdict, std::move(what), std::move(remedy)});
  }
  bool has(Signal signal) const { return origins_.channels[signal] != Origin::absent; }
  void judge_sensor(Signal signal, const RestState& rest);
  void judge_supply(const RestState& rest);
  void judge_drift(const RestState& rest);
  void fit(const Probe& probe);
  void judge_encoder(const std::vector<Probe>& probes);
  void judge_wiring();
  void judge_mirror(double own_N, double exchanged_N);
  void judge_balance(double own_N);
  void judge_chambers(const RestState& rest);
  void judge_scale();
  void judge_neutral();

  const Rig& rig_;
  Origins origins_;
  Signs signs_;
  AnswerFit force_sum_, chamber_sum_;
  double way_m_ = 0.0;  // of all probes that moved, to the side of their command
  double force_noise_N_ = 0.0, chamber_noise_N_ = 0.0;
  std::vector<double> opens_V_, scales_;  // of each probe that moved
  std::vector<int> opens_to_;
  double ramp_V_per_s_ = 0.0, hardness_ = 0.0;  // force over the model's, of a probe that moved
};

// What one pressure channel shows at rest, without any motion.
void Commissioning::judge_sensor(Signal signal, const RestState& rest) {
  const std::string name(info(signal).name);
  const double mean_Pa = rest.mean[signal];
  if (rest.count[signal] == 0)
    return add(name, CommissionVerdict::wrong, "gives no value", "check sensor, cable and range");
  if (rest.bad[signal] > rest.count[signal] / 10)
    return add(name, CommissionVerdict::wrong,
               fmt::format("{} of {} samples are missing", rest.bad[signal], rest.bad[signal] + rest.count[signal]),
               "check cable and bus");
  if (rest.rms[signal] == 0.0 && rig_.sensors.resolution(signal).noise > 0.0)
    return add(name, CommissionVerdict::wrong,
               fmt::format("repeats {:.6g} Pa, which its declared noise rules out", mean_Pa),
               "check sensor and converter");
  if (mean_Pa < possible_pressure_Pa(rig_).lowest)
    return add(name, CommissionVerdict::wrong,
               fmt::format("shows {:.1f} kPa: a gauge sensor without its zero, or a wrong scale", 1e-3 * mean_Pa),
               "vent the lines and run pneuservo zero, or correct the channel's zero by the atmosphere");
  if (mean_Pa > possible_pressure_Pa(rig_).highest)
    return add(name, CommissionVerdict::wrong,
               fmt::format("shows {:.1f} kPa, more than the supply can give", 1e-3 * mean_Pa), "check the scale");
  if (signal != Signal::p_supply)
    add(name, CommissionVerdict::good, fmt::format("{:.1f} kPa at rest", 1e-3 * mean_Pa), "");
}

void Commissioning::judge_supply(const RestState& rest) {
  const double expected_Pa = rig_.axis.supply.pressure_Pa, mean_Pa = rest.mean[Signal::p_supply];
  const double tolerance_Pa = std::max(sensor_tolerance_Pa, 0.05 * expected_Pa);
  const std::string shown = fmt::format("{:.1f} kPa, expected {:.1f} absolute", 1e-3 * mean_Pa, 1e-3 * expected_Pa);
  if (std::fabs(mean_Pa - expected_Pa) <= tolerance_Pa) return add("p_supply", CommissionVerdict::good, shown, "");
  if (std::fabs(mean_Pa + rig_.axis.air.atmosphere_Pa - expected_Pa) <= tolerance_Pa)
    return add("p_supply", CommissionVerdict::wrong, shown + ": a gauge sensor without its zero",
               "vent the lines and run pneuservo zero");
  add("p_supply", CommissionVerdict::wrong, shown, "set the regulator, or supply.pressure_Pa to what it is");
}

void Commissioning::judge_drift(const RestState& rest) {
  const double way_m = rest.to_m - rest.from_m;
  if (way_m <= ProbeLimits::drift_m) return;
  const double volts = rest.drift_mps / speed_per_volt_mps(rig_, rest.port_Pa(), rest.drift_mps > 0.0 ? 1 : -1);
  add("rest", CommissionVerdict::wrong,
      fmt::format("the slider went {:.1f} mm with the valve closed, at {:.1f} mm/s at the end", 1e3 * way_m,
                  1e3 * rest.drift_mps),
      fmt::format("let it come to rest; if it drifts on, the valve closes near safe_output.command_V {:+.3g} V",
                  -volts));
}

bool Commissioning::judge_rest(const RestState& rest) {
  if (rest.count[Signal::x] == 0)
    add("x", CommissionVerdict::wrong, "gives no value", "check encoder, cable and supply");
  for (const Signal signal : channel_signals)
    if (is_pressure(signal) && has(signal)) judge_sensor(signal, rest);
  if (has(Signal::p_supply) && result.passed()) judge_supply(rest);
  if (rest.count[Signal::x] > 0) judge_drift(rest);
  return result.passed();
}

void join(AnswerFit& sum, const AnswerFit& one) {
  sum.measured_model += one.measured_model, sum.model_square += one.model_square;
  sum.scale = sum.model_square > 0.0 ? sum.measured_model / sum.model_square : 0.0;
}

/// Root of the sum of squares, less that of white noise.
double size_of(const std::vector<double>& values, double noise) {
  double square = -noise * noise * static_cast<double>(values.size());
  for (const double value : values) square += value * value;
  return std::sqrt(std::max(square, 0.0));
}

// One probe against the model: the position finds the dead part of the command where it moved, the force where not.
void Commissioning::fit(const Probe& probe) {
  const std::size_t ticks = probe.position_m.size();
  std::vector<double> way(ticks), force(ticks), chambers(ticks);
  const double rest_N = air_force_N(rig_, probe.before.port_Pa());
  const double chamber_rest_N =
      air_force_N(rig_, {probe.before.mean[Signal::p1_chamber], probe.before.mean[Signal::p2_chamber]});
  for (std::size_t i = 0; i < ticks; ++i) {
    way[i] = probe.position_m[i] - probe.before.mean[Signal::x];
    force[i] = air_force_N(rig_, probe.port_Pa[i]) - rest_N;
    chambers[i] = has(Signal::p1_chamber) && has(Signal::p2_chamber)
                      ? air_force_N(rig_, probe.chamber_Pa[i]) - chamber_rest_N
                      : 0.0;
  }
  const bool moved = probe.end == ProbeEnd::moved || probe.end == ProbeEnd::too_fast || probe.end == ProbeEnd::little;
  const auto& c = rig_.axis.cylinder;
  force_noise_N_ =
      std::hypot(c.area_1_m2 * probe.before.rms[Signal::p1_port], c.area_2_m2 * probe.before.rms[Signal::p2_port]);
  chamber_noise_N_ = std::hypot(c.area_1_m2 * probe.before.rms[Signal::p1_chamber],
                                c.area_2_m2 * probe.before.rms[Signal::p2_chamber]);
  ModelAnswer model;
  double dead_V = moved ? find_dead_V(rig_, probe, way, &ModelAnswer::position_m) : 0.0;
  if (moved) model = model_answer(rig_, probe, dead_V);
  const double hardness =
      moved ? size_of(force, force_noise_N_) / std::max(size_of(model.port_force_N, 0.0), 1e-9) : 0.0;
  const bool free = moved && hardness < free_hardness;
  hardness_ = std::max(hardness_, hardness);
  if (!free) {
    dead_V = find_dead_V(rig_, probe, force, &ModelAnswer::port_force_N);
    model = model_answer(rig_, probe, dead_V);
  }
  if (moved) {
    way_m_ += probe.direction * probe.moved_m;
    if (free) scales_.push_back(std::fabs(fit_answer(way, model.position_m).scale));
    opens_V_.push_back(dead_V), opens_to_.push_back(probe.direction);
  }
  join(force_sum_, fit_answer(force, model.port_force_N));
  join(chamber_sum_, fit_answer(chambers, model.chamber_force_N));
  ramp_V_per_s_ = std::max(ramp_V_per_s_, probe.ramp_V_per_s);
  result.farthest_m = std::max(result.farthest_m, probe.farthest_m);
  result.fastest_mps = std::max(result.fastest_mps, probe.fastest_mps);
}

/// Sign of an answer that noise does not explain.
int sign_of(const AnswerFit& sum, double noise) {
  const double deviations = sum.scale * std::sqrt(sum.model_square) / std::max(noise, 1e-300);
  if (std::fabs(deviations) < significant || std::fabs(sum.scale) < least_answer) return 0;
  return sum.scale > 0.0 ? 1 : -1;
}

void Commissioning::judge_encoder(const std::vector<Probe>& probes) {
  for (const Probe& probe : probes) {
    const std::string to = probe.direction > 0 ? "positive" : "negative";
    if (probe.end == ProbeEnd::unseen)
      add("encoder", CommissionVerdict::wrong,
          fmt::format("the air flowed at {:+.3g} V and did not push, but the position stood still",
                      probe.direction * probe.end_V),
          "check encoder and cable: it is frozen, or its scale is far too small");
    if (probe.end == ProbeEnd::pushed && std::fabs(probe.moved_m) < ProbeLimits::way_m)
      add("slider", CommissionVerdict::unclear,
          fmt::format("the air pushed with {:.0f} N more and the slider did not go {:.0f} mm to {} x",
                      std::fabs(probe.force_change_N), 1e3 * ProbeLimits::way_m, to),
          "move it off the end stop; look for what holds it");
    if (probe.end == ProbeEnd::no_answer)
      add("valve", CommissionVerdict::wrong,
          fmt::format("no pressure and no motion answered up to {:+.3g} V", probe.direction * probe.end_V),
          "check air, valve supply and the output's wire; a dead band beyond that is no servo valve's");
  }
}

// A cylinder with its hoses exchanged is the same machine in the mirror, and so is one whose encoder is reversed: signs
// cannot tell them apart, the areas of the piston and chamber sensors can.
void Commissioning::judge_mirror(double own_N, double exchanged_N) {
  const auto& c = rig_.axis.cylinder;
  const double error_N = sure * sensor_share * rig_.axis.supply.pressure_Pa * std::hypot(c.area_1_m2, c.area_2_m2);
  const std::string found = "port pressures answer the command as they should, the position goes the wrong way";
  const std::string encoder = "turn the sign of the encoder's scale (hal.channels.x)",
                    hoses = "exchange the hoses at the valve";
  if (own_N <= error_N && exchanged_N > error_N)
    return add("encoder", CommissionVerdict::wrong, found + ": the encoder is reversed", encoder);
  if (exchanged_N <= error_N && own_N > error_N)
    return add("hoses", CommissionVerdict::wrong, found + ": the hoses are exchanged", hoses);
  add("encoder or hoses", CommissionVerdict::wrong, found + ": the encoder is reversed or the hoses are exchanged",
      fmt::format("watch the slider: if it really goes to positive x at a positive command, {}; else {}", encoder,
                  hoses));
}

void Commissioning::judge_wiring() {
  if (signs_.position == 0)
    return add("signs", CommissionVerdict::unclear, "the position gave no clear answer",
               "mend what is wrong above and repeat");
  if (signs_.pressure == 0)
    return add("signs", CommissionVerdict::unclear,
               fmt::format("the position goes the {} way, the port pressures gave no clear answer",
                           signs_.position > 0 ? "right" : "wrong"),
               "check both port sensors and their noise, and repeat");
  if (signs_.position > 0 && signs_.pressure > 0)
    return add("signs", CommissionVerdict::good,
               "a positive command fills side 1 and moves the slider to positive x, a negative one back", "");
  if (signs_.position < 0 && signs_.pressure < 0)
    return add("valve", CommissionVerdict::wrong,
               "a positive command fills side 2 and moves the slider to negative x: the valve is reversed",
               "turn the sign of the output's scale (hal.channels.u), or exchange its wires");
  if (signs_.position > 0)
    add("port sensors", CommissionVerdict::wrong,
        "the slider goes the right way, the port pressures answer the wrong way: the port sensors are exchanged",
        "exchange the port sensors' channels (hal.channels.p1_port, p2_port); if they are right, valve and encoder are "
        "both reversed");
}

// Mean over both probes: dry friction holds the slider on both sides of its balance and drops out.
void Commissioning::judge_balance(double own_N) {
  const auto& c = rig_.axis.cylinder;
  const double supply_Pa = rig_.axis.supply.pressure_Pa, atmosphere_Pa = rig_.axis.air.atmosphere_Pa;
  const double error_N = sure * sensor_share * supply_Pa * std::hypot(c.area_1_m2, c.area_2_m2);
  if (std::fabs(own_N) <= error_N)
    return add("balance", CommissionVerdict::good,
               fmt::format("the pressures at rest balance the piston to {:+.1f} N (error {:.0f} N)", own_N, error_N),
               "");
  const std::array<std::pair<double, Signal>, 2> gauges{
      {{-c.area_1_m2 * atmosphere_Pa, Signal::p1_port}, {c.area_2_m2 * atmosphere_Pa, Signal::p2_port}}};
  for (const auto& [force_N, port] : gauges)
    if (std::fabs(own_N - force_N) <= std::min(error_N, 0.3 * std::fabs(force_N)))
      return add(
          std::string(info(port).name), CommissionVerdict::wrong,
          fmt::format("the piston is out of balance by {:+.0f} N at rest, as by a gauge sensor without its zero",
                      own_N),
          fmt::format("vent the lines and run pneuservo zero; if it is a load, state it (effects.constant_force)"));
  add("balance", CommissionVerdict::unclear,
      fmt::format("the piston is out of balance by {:+.0f} N at rest (error {:.0f} N): a load that the config does not "
                  "state, or a sensor's zero",
                  own_N, error_N),
      "state the load (effects.constant_force: {force_N: ...}), or run pneuservo zero");
}

void Commissioning::judge_chambers(const RestState& rest) {
  if (!has(Signal::p1_chamber) || !has(Signal::p2_chamber)) return;
  const double own_Pa = std::fabs(rest.mean[Signal::p1_chamber] - rest.mean[Signal::p1_port]) +
                        std::fabs(rest.mean[Signal::p2_chamber] - rest.mean[Signal::p2_port]);
  const double crossed_Pa = std::fabs(rest.mean[Signal::p1_chamber] - rest.mean[Signal::p2_port]) +
                            std::fabs(rest.mean[Signal::p2_chamber] - rest.mean[Signal::p1_port]);
  const double error_Pa = sure * 2.0 * sensor_share * rig_.axis.supply.pressure_Pa;
  const bool told_by_rest = std::fabs(rest.mean[Signal::p1_port] - rest.mean[Signal::p2_port]) > error_Pa;
  // What stands beside the chambers at the ports is right where neither sensors nor hoses are exchanged.
  const bool ports_crossed = signs_.position * signs_.pressure < 0;
  const bool crossed = told_by_rest ? (crossed_Pa < own_Pa) != ports_crossed : signs_.chambers * signs_.position < 0;
  if (crossed && !ports_crossed)
    return add("chamber sensors", CommissionVerdict::wrong,
               "each chamber sensor shows the other side's pressure: they are exchanged",
               "exchange their channels (hal.channels.p1_chamber, p2_chamber)");
  if (told_by_rest && std::min(own_Pa, crossed_Pa) > error_Pa)
    return add(
        "chamber sensors", CommissionVerdict::unclear,
        fmt::format("they differ from the ports by {:.0f} kPa at rest, together", 1e-3 * std::min(own_Pa, crossed_Pa)),
        "zero the sensors (pneuservo zero)");
  add("chamber sensors", told_by_rest || signs_.chambers != 0 ? CommissionVerdict::good : CommissionVerdict::unclear,
      fmt::format("they differ from the ports by {:.1f} kPa at rest, together", 1e-3 * own_Pa), "");
}

void Commissioning::judge_scale() {
  if (hardness_ >= free_hardness)
    add("friction", CommissionVerdict::good,
        fmt::format(
            "the air pushed {:.1f} times as hard as the model's slider needs: the encoder's scale is not judged",
            hardness_),
        "state dry friction (effects.coulomb_friction) or payload (slider.payload_kg)");
  if (scales_.empty() || hardness_ >= free_hardness || signs_.position <= 0 || signs_.pressure <= 0) return;
  const double scale = std::sqrt(scales_.front() * scales_.back());
  result.encoder_scale = scale;
  const std::string found =
      fmt::format("the position moves {:.2f} times as far as the air that the valve's law gives", scale);
  if (scale > plausible_factor || scale < 1.0 / plausible_factor)
    return add("scale", CommissionVerdict::wrong,
               found + fmt::format(", expected 1 within a factor of {:g}", plausible_factor),
               "check the encoder's scale, then valve.area_per_volt_m2_per_V, cylinder areas and supply");
  add("scale", CommissionVerdict::good, found, "");
}

void Commissioning::judge_neutral() {
  if (opens_V_.size() != 2 || opens_to_[0] == opens_to_[1] || signs_.position <= 0 || signs_.pressure <= 0) return;
  const std::size_t up = opens_to_[0] > 0 ? 0 : 1;
  const double up_V = opens_V_[up], down_V = opens_V_[1 - up];
  const double closed_V = rig_.safe_output.action == SafeAction::hold ? rig_.safe_output.command_V : 0.0;
  const double error_V = ramp_V_per_s_ * shift_error_s;
  const double neutral_V = closed_V + 0.5 * (up_V - down_V), band_V = 0.5 * (up_V + down_V);
  result.neutral_V = neutral_V, result.neutral_error_V = error_V;
  const bool off = std::fabs(neutral_V - closed_V) > sure * error_V;
  add("neutral", CommissionVerdict::good,
      fmt::format("the valve closes at {:+.4f} V (error {:.4f} V)", neutral_V, error_V),
      off ? fmt::format("state it: safe_output.command_V: {:.4f}", neutral_V) : "");
  if (band_V > sure * error_V) {
    result.dead_band_V = band_V;
    add("dead band", CommissionVerdict::good, fmt::format("it opens {:.4f} V beyond that", band_V),
        fmt::format("state it: effects.valve_dead_band: {{width_V: {:.4f}}}", band_V));
  }
}

void Commissioning::judge_probes(const std::vector<Probe>& probes) {
  judge_encoder(probes);
  double own_N = 0.0, exchanged_N = 0.0;
  for (const Probe& probe : probes) {
    fit(probe);
    const auto p = probe.after.port_Pa();
    const double load_N = rig_.axis.effects.motion.constant_force.force_N;
    own_N += (air_force_N(rig_, p) - load_N) / static_cast<double>(probes.size());
    exchanged_N += (air_force_N(rig_, {p[1], p[0]}) - load_N) / static_cast<double>(probes.size());
  }
  signs_.position = std::fabs(way_m_) < least_way_m ? 0 : way_m_ > 0.0 ? 1 : -1;
  signs_.pressure = sign_of(force_sum_, force_noise_N_);
  signs_.chambers = sign_of(chamber_sum_, chamber_noise_N_);
  judge_wiring();
  if (signs_.position < 0 && signs_.pressure > 0) judge_mirror(std::fabs(own_N), std::fabs(exchanged_N));
  if (signs_.position * signs_.pressure > 0) judge_balance(own_N);
  judge_chambers(probes.back().after);
  judge_scale();
  judge_neutral();
}

}  // namespace

bool CommissionResult::passed() const noexcept {
  return std::none_of(checks.begin(), checks.end(), [](const CommissionCheck& check) {
    return check.verdict == CommissionVerdict::wrong ||
           (check.verdict == CommissionVerdict::unclear && check.name == "signs");
  });
}

CommissionResult commission_axis(const Rig& rig, Backend& backend, bool real_time) {
  Commissioning commissioning(rig, backend.origins());
  std::vector<Probe> probes;
  try {
    SupervisedSteps steps(rig, backend, "commissioning", real_time, of_sensors);
    const RestState first = rest(steps, first_rest_s);
    if (!commissioning.judge_rest(first)) return commissioning.result;
    steps.judge_anew(fault_position_frozen);
    for (const int direction : {1, -1}) {
      probes.push_back(probe(rig, steps, direction, probes.empty() ? first : probes.back().after));
      if (probes.back().end == ProbeEnd::unseen) break;
    }
  } catch (const std::runtime_error& error) { commissioning.fault(error.what()); }
  if (!probes.empty()) commissioning.judge_probes(probes);
  return commissioning.result;
}

}  // namespace pneuservo
