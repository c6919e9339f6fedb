// PI on a pressure behind a hose: configuration, gain from the hose's acoustics, and the step of one period.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <pneuservo/control/pressure_pi.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/rig/axis.hpp>

#include "acoustics/line_acoustics.hpp"

namespace pneuservo {
namespace {

using Complex = std::complex<double>;

/// Of the target's pull over 1/k: both poles of the target lie at -2 k.
constexpr double pull_time_share = 0.25;
/// Both poles of error and integral lie at -k/2.
constexpr double integral_share = 0.25;

/// Volume with what its growth takes: dm/dp is that of a rigid one of this size, its gas isothermal.
double volume_that_grows_m3(const ElasticVolumeParameters<double>& volume, const Air<double>& air, double p_Pa) {
  return volume.volume_m3 + volume.growth_m3(p_Pa, air.atmosphere_Pa) + volume.compliance_m3_per_Pa * p_Pa;
}

/// From the wanted flow to the flow into the hose: half a period of hold, delay, lag, spool.
Complex valve_path(const LawSetup& setup, Complex s) {
  const auto& valve = setup.axis.valve;
  const auto& effects = setup.axis.effects.valve;
  Complex path = std::exp(-s * (0.5 * setup.period_s + effects.command_delay.delay_s));
  path /= 1.0 + s * effects.valve_lag.time_constant_s;
  if (valve.natural_frequency_Hz > 0.0) {
    const double w = 2.0 * std::numbers::pi * valve.natural_frequency_Hz;
    path /= 1.0 + 2.0 * valve.damping_ratio * s / w + s * s / (w * w);
  }
  return path;
}

/// Where the hose's first wave lies, a quarter of it long [rad/s].
double quarter_wave_rad_per_s(const LawSetup& setup) {
  return 0.5 * std::numbers::pi * Air<double>(setup.axis.air).sound_speed() / setup.axis.line_1.length_m;
}

double valve_delay_s(const LawSetup& setup) {
  const auto& valve = setup.axis.valve;
  const auto& effects = setup.axis.effects.valve;
  const double spool_s =
      valve.natural_frequency_Hz > 0.0 ? valve.damping_ratio / (std::numbers::pi * valve.natural_frequency_Hz) : 0.0;
  return 0.5 * setup.period_s + effects.command_delay.delay_s + effects.valve_lag.time_constant_s + spool_s;
}

/// The loop at one operating point without its controller, over frequencies up to the sampling's.
struct OpenLoop {
  std::vector<double> rad_per_s;
  std::vector<Complex> path;  ///< rate of the controlled pressure over the one wanted, 1 at rest
};

/// `at_port`: of the pressure at the valve, else of the one in the volume.
OpenLoop open_loop(const LawSetup& setup, bool at_port, double p_Pa) {
  constexpr int points = 1500;  // finer than the resonances of a hose with laminar friction alone
  const auto& line = setup.axis.line_1;
  const LineAcoustics acoustics(line.length_m, line.diameter_m, p_Pa, setup.axis.air, LineLoss::quasi_steady);
  const double volume_m3 = volume_that_grows_m3(*setup.volume, acoustics.air(), p_Pa);
  const LineEnds ends{.volume_in_m3 = 0.0, .volume_out_m3 = volume_m3};
  const double at_rest = volume_m3 / (volume_m3 + line.volume_m3());
  const double energy = acoustics.air().R * acoustics.air().temperature_K;
  const double lowest = 0.005, highest = std::numbers::pi / setup.period_s;
  OpenLoop out;
  for (int i = 0; i < points; ++i) {
    const double w = lowest * std::pow(highest / lowest, (i + 0.5) / points);
    const Complex s(0.0, w);
    out.rad_per_s.push_back(w);
    const LineTwoPort hose = acoustics.two_port(s);
    const Complex over_far = at_port ? hose.a + hose.b * s * volume_m3 / energy : 1.0;
    out.path.push_back(over_far * flow_transfer(acoustics, ends, s) / at_rest * valve_path(setup, s));
  }
  return out;
}

/// Largest 1/(1 + L); infinite where the closed loop is unstable: 1 + L turns forward by half a turn at most from its
/// double pole at rest to 1, and backward where it goes round 0.
double sensitivity(const OpenLoop& loop, const PressureGains& gains) {
  const double k = gains.gain_per_s;
  double most = 0.0, turned_rad = 0.0;
  Complex before(1.0);
  for (std::size_t i = 0; i < loop.path.size(); ++i) {
    const Complex s(0.0, loop.rad_per_s[i]), filter = 1.0 + s / gains.filter_rad_per_s;
    const Complex difference = 1.0 + k / s * (1.0 + integral_share * k / s) * loop.path[i] / (filter * filter);
    if (i > 0) turned_rad += std::arg(difference / before);
    before = difference;
    most = std::max(most, 1.0 / std::abs(difference));
  }
  return turned_rad > -0.5 * std::numbers::pi ? most : infinite;
}

std::array<OpenLoop, 2> open_loops(const LawSetup& setup, bool at_port) {
  return {open_loop(setup, at_port, setup.axis.air.atmosphere_Pa),
          open_loop(setup, at_port, setup.axis.supply.pressure_Pa)};
}

double sensitivity(const std::array<OpenLoop, 2>& loops, const PressureGains& gains) {
  return std::max(sensitivity(loops[0], gains), sensitivity(loops[1], gains));
}

PressureGains highest_gains(const LawSetup& setup, bool at_port) {
  constexpr double step = 1.02;              // finer than any margin is known
  constexpr double least_gain_per_s = 0.05;  // lower than that of any hose that a config may have
  constexpr int half_octaves = 6;
  const std::array<OpenLoop, 2> loops = open_loops(setup, at_port);
  PressureGains best{least_gain_per_s, 4.0 * quarter_wave_rad_per_s(setup)};
  for (int half_octave = -2; half_octave < half_octaves; ++half_octave) {
    PressureGains now{least_gain_per_s, quarter_wave_rad_per_s(setup) * std::exp2(-0.5 * half_octave)};
    while (now.gain_per_s * step < 0.5 / setup.period_s &&
           sensitivity(loops, {now.gain_per_s * step, now.filter_rad_per_s}) <= PressurePi::most_sensitivity)
      now.gain_per_s *= step;
    if (now.gain_per_s > best.gain_per_s) best = now;
  }
  return best;
}

}  // namespace

PressureGains pressure_gains(const LawSetup& setup) { return highest_gains(setup, false); }

double pressure_sensitivity(const LawSetup& setup, const PressureGains& gains) {
  return sensitivity(open_loops(setup, false), gains);
}

void PressurePi::configure(const PressurePiParameters& parameters, const LawSetup& setup) {
  parameters_ = parameters;
  volume_ = *setup.volume;
  air_ = Air<double>(setup.axis.air);
  const auto& valve = setup.axis.valve;
  line_volume_m3_ = setup.axis.line_1.volume_m3();
  supply_Pa_ = setup.axis.supply.pressure_Pa;
  critical_ratio_ = valve.critical_pressure_ratio;
  area_per_volt_ = valve.area_per_volt_m2_per_V;
  offset_V_ = setup.axis.effects.valve.valve_offset.offset_V;
  command_max_V_ = valve.command_max_V;
  range_V_ = std::min(command_max_V_, valve.area_max_m2 / area_per_volt_);
  period_s_ = setup.period_s;
  gains_ = highest_gains(setup, parameters.pressure_source == PressureSource::valve);
  gains_.gain_per_s = parameters.gain_per_s.value_or(gains_.gain_per_s);
  smoothing_ = -std::expm1(-period_s_ * gains_.gain_per_s / pull_time_share);
  filter_gain_ = -std::expm1(-period_s_ * gains_.filter_rad_per_s);
  delay_s_ = setup.axis.line_1.length_m / air_.sound_speed() + valve_delay_s(setup);
  late_.assign(static_cast<std::size_t>(std::max(1L, std::lround(delay_s_ / period_s_))), 0.0);
  first_ = true;
}

void PressurePi::start(double p_Pa) noexcept {
  first_ = false;
  target_Pa_ = p_Pa;
  pull_Pa_per_s_ = integral_Pas_ = 0.0;
  filtered_Pa_ = {};
  std::ranges::fill(late_, p_Pa);
}

double PressurePi::late_target(double target_Pa) noexcept {
  const double late_Pa = late_[oldest_];
  late_[oldest_] = target_Pa;
  oldest_ = oldest_ + 1 == late_.size() ? 0 : oldest_ + 1;
  return late_Pa;
}

// Two lags that keep the hose's waves out of the feedback.
double PressurePi::filtered(double error_Pa) noexcept {
  filtered_Pa_[0] += filter_gain_ * (error_Pa - filtered_Pa_[0]);
  filtered_Pa_[1] += filter_gain_ * (filtered_Pa_[0] - filtered_Pa_[1]);
  return filtered_Pa_[1];
}

// dm/dp of hose and volume, their gas adiabatic: the smaller of what it can be, so that the loop's gain is never above
// the one that was chosen.
double PressurePi::capacity_kg_per_Pa(double p_Pa) const noexcept {
  const double gas_m3 = volume_.volume_m3 + volume_.growth_m3(p_Pa, air_.atmosphere_Pa) + line_volume_m3_;
  return (gas_m3 / air_.kappa + volume_.compliance_m3_per_Pa * p_Pa) / (air_.R * air_.temperature_K);
}

double PressurePi::flux_kgps_per_V(bool fills, double port_Pa, double supply_Pa) const noexcept {
  const double up_Pa = fills ? supply_Pa : port_Pa, down_Pa = fills ? port_Pa : air_.atmosphere_Pa;
  if (!(up_Pa > down_Pa)) return 0.0;
  return area_per_volt_ * orifice_flux(air_, up_Pa, air_.temperature_K, down_Pa, critical_ratio_);
}

ControlOutput PressurePi::step(const ControlInput& in) noexcept {
  const double p_Pa = in.pressure_Pa[0], k = gains_.gain_per_s;
  if (first_) start(p_Pa);
  pull_Pa_per_s_ += smoothing_ * (k * (in.now.d[0] - target_Pa_) - pull_Pa_per_s_);
  const double most = parameters_.rate_max_Pa_per_s;
  double rate = std::clamp(in.now.d[1] + pull_Pa_per_s_, -most, most);
  const double late_Pa = late_target(target_Pa_), error_Pa = filtered(late_Pa - p_Pa);
  const double feedback = k * error_Pa + integral_share * k * k * integral_Pas_;
  const double capacity = capacity_kg_per_Pa(p_Pa), flow = capacity * (rate + feedback);
  const double supply_Pa = std::isfinite(in.supply_Pa) ? in.supply_Pa : supply_Pa_;
  const double per_volt = flux_kgps_per_V(flow > 0.0, in.port_Pa[0], supply_Pa);
  // Without a pressure behind the edge it can only be opened.
  const double opened_V = flow == 0.0 ? 0.0 : flow / std::max(per_volt, 1e-300);
  const double held_V = std::clamp(opened_V, -range_V_, range_V_);
  const bool limited = held_V != opened_V;
  if (limited) {
    const double passing = held_V * per_volt / capacity - feedback;
    rate = rate > 0.0 ? std::clamp(passing, 0.0, rate) : std::clamp(passing, rate, 0.0);
  } else integral_Pas_ += error_Pa * period_s_;
  pull_Pa_per_s_ = std::clamp(pull_Pa_per_s_, -most, most);
  if (limited) pull_Pa_per_s_ = rate - in.now.d[1];
  target_Pa_ += rate * period_s_;
  terms_ = {late_Pa,
            error_Pa,
            rate,
            integral_Pas_,
            flow,
            opened_V - offset_V_,
            limited ? (opened_V > 0.0 ? limit_upper : limit_lower) : limit_none};
  const double command_V = std::clamp(held_V - offset_V_, -command_max_V_, command_max_V_);
  const bool finite = std::isfinite(command_V);
  if (finite) last_V_ = command_V;
  return {{last_V_, last_V_}, 0.0, limited, finite};
}

}  // namespace pneuservo
