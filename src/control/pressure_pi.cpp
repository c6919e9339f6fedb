// PI on a pressure behind a hose: configuration, gain from the hose's acoustics, and the step of one period.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
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

/// For which a command is held: pulses begin once a carrier period.
double hold_s(const LawSetup& setup) {
  const auto& on_off = setup.axis.valve.on_off;
  return on_off ? on_off->carrier_period_s : setup.period_s;
}

double dead_time_s(const LawSetup& setup) {
  const auto& valve = setup.axis.valve;
  return 0.5 * hold_s(setup) + setup.axis.effects.valve.command_delay.delay_s +
         (valve.on_off ? valve.on_off->switching_time_on_s : 0.0);
}

/// From the wanted flow to the mean flow into the hose: half of the hold, delay or switching time, lag, spool.
Complex valve_path(const LawSetup& setup, Complex s) {
  const auto& valve = setup.axis.valve;
  const auto& effects = setup.axis.effects.valve;
  Complex path = std::exp(-s * dead_time_s(setup));
  path /= 1.0 + s * effects.valve_lag.time_constant_s;
  if (valve.natural_frequency_Hz > 0.0) {
    const double w = 2.0 * std::numbers::pi * valve.natural_frequency_Hz;
    path /= 1.0 + 2.0 * valve.damping_ratio * s / w + s * s / (w * w);
  }
  return path;
}

double valve_delay_s(const LawSetup& setup) {
  const auto& valve = setup.axis.valve;
  const auto& effects = setup.axis.effects.valve;
  const double spool_s =
      valve.natural_frequency_Hz > 0.0 ? valve.damping_ratio / (std::numbers::pi * valve.natural_frequency_Hz) : 0.0;
  return dead_time_s(setup) + effects.valve_lag.time_constant_s + spool_s;
}

/// The loop at one operating point without its controller, over frequencies up to the sampling's.
struct OpenLoop {
  std::vector<double> rad_per_s;
  std::vector<Complex> path;  ///< rate of the controlled pressure over the one wanted, 1 at rest
};

/// `at_port`: of the pressure at the valve, else of the one in the volume.
OpenLoop open_loop(const LawSetup& setup, bool at_port, double p_Pa) {
  constexpr int points = 2000;  // finer than the resonances of a hose with laminar friction alone
  const auto& line = setup.axis.line_1;
  const LineAcoustics acoustics(line.length_m, line.diameter_m, p_Pa, setup.axis.air, LineLoss::quasi_steady);
  const double volume_m3 = volume_that_grows_m3(*setup.volume, acoustics.air(), p_Pa);
  const LineEnds ends{.volume_in_m3 = 0.0, .volume_out_m3 = volume_m3};
  const double at_rest = volume_m3 / (volume_m3 + line.volume_m3());
  const double energy = acoustics.air().R * acoustics.air().temperature_K;
  const double lowest = 0.1 * PressurePiParameters::least_gain_per_s, highest = std::numbers::pi / setup.period_s;
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

std::array<OpenLoop, 2> open_loops(const LawSetup& setup, PressureSource source) {
  const bool at_port = source == PressureSource::valve;
  return {open_loop(setup, at_port, setup.axis.air.atmosphere_Pa),
          open_loop(setup, at_port, setup.axis.supply.pressure_Pa)};
}

double sensitivity(const std::array<OpenLoop, 2>& loops, const PressureGains& gains) {
  return std::max(sensitivity(loops[0], gains), sensitivity(loops[1], gains));
}

}  // namespace

// The filter's corner goes from a decade above the sampling's end, where it does nothing, down in quarter octaves while
// it lies above the best gain: below it its own lag leaves no margin. The gain climbs by factors that end at 1 %.
PressureGains pressure_gains(const LawSetup& setup, PressureSource source) {
  const std::array<OpenLoop, 2> loops = open_loops(setup, source);
  const double most_per_s = 0.5 / hold_s(setup), corner_step = std::exp2(-0.25);
  PressureGains best{PressurePiParameters::least_gain_per_s, 10.0 * std::numbers::pi / setup.period_s};
  for (double corner = best.filter_rad_per_s; corner > best.gain_per_s; corner *= corner_step)
    for (double factor = 2.0; factor > 1.01; factor = std::sqrt(factor))
      for (PressureGains next{factor * best.gain_per_s, corner};
           next.gain_per_s < most_per_s && sensitivity(loops, next) <= PressurePi::most_sensitivity;
           next.gain_per_s *= factor)
        best = next;
  return best;
}

double pressure_sensitivity(const LawSetup& setup, PressureSource source, const PressureGains& gains) {
  return sensitivity(open_loops(setup, source), gains);
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
  const auto& effects = setup.axis.effects.valve;
  const auto edges = PortEdges<double>::of_port_1(effects);
  valve_.configure(valve, effects, setup.period_s);
  valve_.set_edges(edges);
  const auto within = [most_V = valve.command_max_V](double u_V) { return std::clamp(u_V, -most_V, most_V); };
  const auto overlap_V = [&](double own) { return std::max(effects.valve_dead_band.width_V * (1 + own), 0.0); };
  closed_V_ = within(-effects.valve_offset.offset_V);
  fills_.begins_V = within(overlap_V(edges.supply_overlap) - effects.valve_offset.offset_V);
  fills_.widest_V = widest_V(fills_.begins_V, valve.command_max_V);
  empties_.begins_V = within(-overlap_V(edges.exhaust_overlap) - effects.valve_offset.offset_V);
  empties_.widest_V = widest_V(empties_.begins_V, -valve.command_max_V);
  period_s_ = setup.period_s;
  pulses_.reset();
  if (valve.on_off) pulses_.emplace().configure(valve, period_s_);
  gains_ = pressure_gains(setup, parameters.pressure_source);
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
  if (pulses_) pulses_->reset();
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

// A thousandth of the range is far below what a spool resolves; an area that grows no more has its end there.
double PressurePi::widest_V(double from_V, double end_V) const noexcept {
  constexpr int places = 1000;
  const auto area_m2 = [&](double u_V) {
    const PortAreas<double> areas = valve_.areas(u_V);
    return end_V > 0.0 ? areas.supply : areas.exhaust;
  };
  double reached_V = from_V;
  for (int i = 1; i <= places; ++i) {
    const double u_V = from_V + (end_V - from_V) * i / places;
    if (!(area_m2(u_V) > area_m2(reached_V))) break;
    reached_V = u_V;
  }
  return reached_V;
}

// Without a pressure behind it an edge can only be opened.
PortAreas<double> PressurePi::fluxes(double port_Pa, double supply_Pa) const noexcept {
  const auto flux = [&](double up_Pa, double down_Pa) {
    return up_Pa <= down_Pa ? 0.0 : orifice_flux(air_, up_Pa, air_.temperature_K, down_Pa, critical_ratio_);
  };
  return {flux(supply_Pa, port_Pa), flux(port_Pa, air_.atmosphere_Pa)};
}

double PressurePi::valve_flow_kgps(double command_V, const PortAreas<double>& flux) const noexcept {
  const PortAreas<double> areas = valve_.areas(command_V);
  return areas.supply * flux.supply - areas.exhaust * flux.exhaust;
}

// False position between the edge's beginning and its widest place, the end that stays halved (Illinois): exact at once
// for straight edges, and always within both ends.
double PressurePi::command_for_V(double flow_kgps, const PortAreas<double>& flux) const noexcept {
  constexpr int most_steps = 30;
  constexpr double close_share = 1e-9;
  const double at_rest = valve_flow_kgps(closed_V_, flux);
  if (!std::isfinite(flow_kgps - at_rest)) return std::numeric_limits<double>::quiet_NaN();
  if (flow_kgps == at_rest) return closed_V_;
  const Edge& edge = flow_kgps > at_rest ? fills_ : empties_;
  double near_V = edge.begins_V, far_V = edge.widest_V;
  double near = valve_flow_kgps(near_V, flux) - flow_kgps, far = valve_flow_kgps(far_V, flux) - flow_kgps;
  const double close = close_share * std::fabs(flow_kgps - at_rest);
  if (near * (flow_kgps - at_rest) >= 0.0) return near_V;  // as much passes already where the edge begins
  if (!(near * far < 0.0)) return far_V;
  for (int i = 0; i < most_steps; ++i) {
    const double u_V = (near * far_V - far * near_V) / (near - far), off = valve_flow_kgps(u_V, flux) - flow_kgps;
    if (std::fabs(off) <= close) return u_V;
    if (off * far < 0.0) near_V = far_V, near = far;
    else near *= 0.5;
    far_V = u_V, far = off;
  }
  return far_V;
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
  const PortAreas<double> flux = fluxes(in.port_Pa[0], supply_Pa);
  const double command_V = command_for_V(flow, flux), passes = valve_flow_kgps(command_V, flux);
  const bool fills = flow > passes;
  const bool limited = command_V == (fills ? fills_ : empties_).widest_V && flow != passes;
  if (limited) {
    const double passing = passes / capacity - feedback;
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
            limited
                ? command_V + (flow - passes) / std::max(area_per_volt_ * (fills ? flux.supply : flux.exhaust), 1e-300)
                : command_V,
            limited ? (fills ? limit_upper : limit_lower) : limit_none};
  const bool finite = std::isfinite(command_V);
  if (finite) last_V_ = pulses_ ? pulses_->step(command_V) : command_V;
  return {{last_V_, last_V_}, 0.0, limited, finite};
}

}  // namespace pneuservo
