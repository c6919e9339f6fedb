// Named steps before the first motion: homing and zeroing.
#include "loop/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/loop/fault.hpp>
#include <pneuservo/record/row.hpp>

#include "loop/air_force.hpp"
#include "loop/supervised_steps.hpp"

namespace pneuservo {
namespace {

constexpr double settle_s = 0.3, longest_settle_s = 3.0;
/// Peak of the homing speed that the valve's law allows; the command is less where the air is thin.
constexpr double homing_speed_mps = 0.1;
/// Of the growth of force that the valve's law gives at the largest volume: less than this is no stop. A valve of a
/// quarter of its area, or a dead band of three quarters of the command, still passes.
constexpr double growing_share = 0.25;
constexpr double force_smoothing_s = 0.02;

[[noreturn]] void refuse(const std::string& why) { throw std::runtime_error("homing: " + why); }

/// One way to an end: what the slider, the air and the limit switches do under a steady small push.
class WayToEnd {
 public:
  WayToEnd(const Rig& rig, const HomingSettings& settings, HomingEnd end)
      : rig_(rig), settings_(settings), end_(end), sign_(end == HomingEnd::high ? 1 : -1),
        smoothing_(-std::expm1(-rig.period_s / force_smoothing_s)) {
    const double range_V = HomingSettings::usual_share * rig.axis.valve.command_max_V;
    command_V_ = settings.command_V > 0.0 ? settings.command_V : range_V;
    const double area_m2 = end == HomingEnd::high ? rig.axis.cylinder.area_1_m2 : rig.axis.cylinder.area_2_m2;
    available_N_ = area_m2 * (rig.axis.supply.pressure_Pa - rig.axis.air.atmosphere_Pa);
    const auto& c = rig.axis.cylinder;
    const auto& sensor = rig.sensors.port_pressure;
    noise_N_ =
        std::hypot(c.area_1_m2, c.area_2_m2) * (6.0 * sensor.noise_Pa * std::sqrt(smoothing_) + sensor.quantum_Pa);
    fastest_mps_ = std::min(rig.limits.speed_mps.value_or(HomingSettings::fastest_mps), HomingSettings::fastest_mps);
  }
  /// Volts beyond the closing command; nothing: the end is found, at end_m().
  std::optional<double> step(const StepSample& sample) {
    const double x = sample.in.position_m;
    if (!std::isfinite(x)) return 0.0;
    if (std::isnan(first_m_)) first_m_ = before_m_ = x, smooth_Pa_ = sample.in.port_Pa;
    for (std::size_t i = 0; i < 2; ++i) smooth_Pa_[i] += smoothing_ * (sample.in.port_Pa[i] - smooth_Pa_[i]);
    judge_motion(sample, x);
    judge_switches(sample.raw.digital);
    if (is_end(sample, x)) return std::nullopt;
    if (sample.t_s > settings_.timeout_s)
      refuse(fmt::format("the slider did not come to rest within {:g} s: give a larger command, check air and valve",
                         settings_.timeout_s));
    volts_ = push_V(sample.t_s);
    return sign_ * volts_;
  }
  double end_m() const noexcept { return stands_at_m_; }
  bool confirmed_by_switch() const noexcept { return switch_[end_ == HomingEnd::high ? 1 : 0] == LineState::on; }

 private:
  std::string end_word() const { return end_ == HomingEnd::high ? "high" : "low"; }
  double push_V(double t_s) const {
    const double ramp = std::min(t_s / HomingSettings::ramp_s, 1.0);
    if (settings_.command_V > 0.0) return command_V_ * ramp;
    const double slow_V = homing_speed_mps / std::max(speed_per_volt_mps(rig_, smooth_Pa_, sign_), 1e-12);
    return std::min(command_V_, slow_V) * ramp;
  }
  void judge_motion(const StepSample& sample, double x) {
    const double periods = static_cast<double>(sample.skipped + 1);
    const double slack_m = 6.0 * rig_.sensors.position.noise_m + rig_.sensors.position.quantum_m;
    if (std::fabs(x - before_m_) > fastest_mps_ * rig_.period_s * periods + slack_m)
      refuse(fmt::format("the slider is faster than limits.speed_mps or {:g} m/s: give a smaller command",
                         HomingSettings::fastest_mps));
    before_m_ = x;
    if (sign_ * (x - first_m_) < -HomingSettings::wrong_way_m)
      refuse(
          fmt::format("the slider went {:.1f} mm away from the {} end while it was pushed there: valve or encoder is "
                      "reversed, or the hoses are exchanged; pneuservo commission tells which",
                      1e3 * std::fabs(x - first_m_), end_word()));
    moved_ = moved_ || std::fabs(x - first_m_) > HomingSettings::standing_m;
  }
  // The other end's switch is no end to come to from here; its own one may be reached.
  void judge_switches(const DigitalInputs& digital) {
    const std::array<LineState, 2> now{digital.limit_low.state, digital.limit_high.state};
    const std::size_t other = end_ == HomingEnd::high ? 0 : 1;
    if (now[0] == LineState::unreadable || now[1] == LineState::unreadable) refuse("a limit switch cannot be read");
    if (now[other] == LineState::on && switch_[other] == LineState::off)
      refuse("the slider ran onto the limit switch of the other end: valve, encoder or switches are exchanged");
    switch_ = now;
  }
  // Growth of the force that the command gives a standing slider [N], at least: the largest volumes.
  double least_growth_N() const {
    const Air<double> air(rig_.axis.air);
    const auto& c = rig_.axis.cylinder;
    const double T = air.temperature_K, b = rig_.axis.valve.critical_pressure_ratio;
    const double area_m2 = volts_ * rig_.axis.valve.area_per_volt_m2_per_V, half_m = 0.5 * c.stroke_m;
    double rate = 0.0;
    for (std::size_t side = 0; side < 2; ++side) {
      const bool fills = (side == 0) == (sign_ > 0);
      const double p = smooth_Pa_[side];
      const double flow = fills ? orifice_mass_flow(air, area_m2, b, rig_.axis.supply.pressure_Pa, T, p, T)
                                : orifice_mass_flow(air, area_m2, b, p, T, air.atmosphere_Pa, T);
      const double volume_m3 = side_volume_m3(rig_, side, side == 0 ? half_m : -half_m);
      rate += (side == 0 ? c.area_1_m2 : c.area_2_m2) * std::max(flow, 0.0) * air.R * T / volume_m3;
    }
    return rate * rig_.period_s;
  }
  bool is_end(const StepSample& sample, double x) {
    const double force_N = sign_ * air_force_N(rig_, smooth_Pa_);
    if (std::isnan(stands_at_m_) || std::fabs(x - stands_at_m_) > HomingSettings::standing_m) {
      stands_at_m_ = x, stands_since_ = sample.tick;
      force_before_N_ = force_N, expected_N_ = 0.0;
    }
    expected_N_ += least_growth_N() * static_cast<double>(sample.skipped + 1);
    const double stands_s = static_cast<double>(sample.tick - stands_since_) * rig_.period_s;
    if (stands_s < HomingSettings::standing_s || sample.t_s <= HomingSettings::ramp_s + HomingSettings::standing_s)
      return false;
    if (force_N >= HomingSettings::pushing_share * available_N_) {
      stands_at_m_ = x;
      return true;
    }
    const double growth_N = force_N - force_before_N_;
    if (growth_N < -std::max(growing_share * expected_N_, noise_N_))
      refuse(
          fmt::format("the slider stands, but the air pushes away from the {} end: the port sensors are exchanged, or "
                      "valve and encoder are both reversed; pneuservo commission tells which",
                      end_word()));
    if (growth_N < growing_share * expected_N_) refuse_standstill(growth_N);
    return false;
  }
  [[noreturn]] void refuse_standstill(double growth_N) const {
    if (!moved_)
      refuse("the slider did not move: check air, valve and encoder, give a larger command, or move it off the stop");
    refuse(fmt::format(
        "the encoder stands still at {:.6g} m, but the air does not push as at a stop ({:.0f} N more in {:g} "
        "s, expected {:.0f} or more): the encoder is frozen, or a side leaks",
        stands_at_m_, growth_N, HomingSettings::standing_s, growing_share * expected_N_));
  }

  const Rig& rig_;
  const HomingSettings& settings_;
  HomingEnd end_;
  int sign_;
  double smoothing_, command_V_ = 0.0, available_N_ = 0.0, fastest_mps_ = 0.0, volts_ = 0.0,
                     noise_N_ = 0.0;  // six standard deviations of a difference of two smoothed forces
  double first_m_ = Row::none, before_m_ = Row::none, stands_at_m_ = Row::none, force_before_N_ = 0.0,
         expected_N_ = 0.0;
  std::array<double, 2> smooth_Pa_{};
  std::array<LineState, 2> switch_{};
  std::int64_t stands_since_ = 0;
  bool moved_ = false;
};

/// Waits, the valve closed, until the slider stands: what was unbalanced at the start is no wrong direction.
void let_settle(const Rig& rig, SupervisedSteps& steps) {
  double stands_at_m = Row::none, since_s = 0.0;
  steps.run([&](const StepSample& sample) -> StepAnswer {
    const double x = sample.in.position_m;
    if (!(std::fabs(x - stands_at_m) <= HomingSettings::standing_m)) stands_at_m = x, since_s = sample.t_s;
    const bool stands = std::isfinite(x) && sample.t_s - since_s >= settle_s;
    return {steps.command(0.0), stands || sample.t_s > std::max(longest_settle_s, 10.0 * rig.period_s)};
  });
}

/// Position where the slider stands at that end.
WayToEnd drive_to(const Rig& rig, SupervisedSteps& steps, const HomingSettings& settings, HomingEnd end) {
  WayToEnd way(rig, settings, end);
  steps.run([&](const StepSample& sample) -> StepAnswer {
    const auto volts = way.step(sample);
    return {steps.command(volts.value_or(0.0)), !volts};
  });
  return way;
}

}  // namespace

ChannelZero find_home(const Rig& rig, Backend& backend, const HomingSettings& settings) {
  // A dead stop is what is looked for; the switches are judged here.
  SupervisedSteps steps(rig, backend, "homing", settings.real_time, fault_position_frozen | fault_limit_switch);
  let_settle(rig, steps);
  const WayToEnd there = drive_to(rig, steps, settings, settings.end);
  const bool high = settings.end == HomingEnd::high;
  const double stroke_m = rig.axis.cylinder.stroke_m;
  std::string proof = "its limit switch";
  if (!there.confirmed_by_switch()) {
    if (rig.hal && rig.hal->gpio && (high ? rig.hal->gpio->limit_high : rig.hal->gpio->limit_low))
      refuse(
          fmt::format("the slider stands at {:.6g} m, but the limit switch of the {} end is not reached: something is "
                      "in the way",
                      there.end_m(), high ? "high" : "low"));
    const WayToEnd back = drive_to(rig, steps, settings, high ? HomingEnd::low : HomingEnd::high);
    const double way_m = std::fabs(back.end_m() - there.end_m());
    if (std::fabs(way_m - stroke_m) > HomingSettings::stroke_tolerance * stroke_m)
      refuse(fmt::format(
          "the way between both stops is {:.1f} mm, expected cylinder.stroke_m of {:.1f} mm: something is in "
          "the way, the encoder's scale is wrong, or it froze on the way",
          1e3 * way_m, 1e3 * stroke_m));
    proof = fmt::format("{:.1f} mm to the other end", 1e3 * way_m);
  }
  const double end_m = (high ? 0.5 : -0.5) * stroke_m;
  return {"x", end_m - there.end_m(),
          fmt::format("{} end at {:.6g} m, {}", high ? "high" : "low", there.end_m(), proof)};
}

std::vector<ChannelZero> find_pressure_zeros(const Rig& rig, Backend& backend, double duration_s, bool real_time) {
  // Vented sensors of either kind show what no run would accept.
  SupervisedSteps steps(rig, backend, "zeroing", real_time, ~(faults_of_devices(~0u) | fault_emergency_stop));
  PerSignal<double> sum;
  PerSignal<std::int64_t> count;
  steps.run([&](const StepSample& sample) -> StepAnswer {
    for (const Signal signal : channel_signals)
      if (const Channel& channel = sample.raw.channel[signal]; channel.valid && std::isfinite(channel.value))
        sum[signal] += channel.value, ++count[signal];
    return {steps.safe(), sample.t_s + 1.5 * rig.period_s > duration_s};
  });
  std::vector<ChannelZero> zeros;
  const double atmosphere_Pa = rig.axis.air.atmosphere_Pa;
  const auto origins = backend.origins().channels;
  for (const Signal signal : channel_signals) {
    if (!is_in_pascal(signal) || origins[signal] == Origin::absent) continue;
    const std::string name(info(signal).name);
    if (count[signal] == 0) throw std::runtime_error(fmt::format("zeroing: {} gave no value", name));
    const double mean_Pa = sum[signal] / static_cast<double>(count[signal]);
    const double vented_Pa = is_difference(signal) ? 0.0 : atmosphere_Pa;
    const bool absolute = std::fabs(mean_Pa - vented_Pa) <= sensor_tolerance_Pa,
               gauge = std::fabs(mean_Pa) <= sensor_tolerance_Pa;
    if (!absolute && !gauge)
      throw std::runtime_error(
          fmt::format("zeroing: {} shows {:.6g} Pa, expected {:.6g} (absolute) or 0 (gauge) within "
                      "{:g}: vent the lines, check the sensor's scale",
                      name, mean_Pa, atmosphere_Pa, sensor_tolerance_Pa));
    zeros.push_back({name, vented_Pa - mean_Pa,
                     is_difference(signal) ? "differential"
                     : absolute            ? "absolute"
                                           : "gauge"});
  }
  return zeros;
}

}  // namespace pneuservo
