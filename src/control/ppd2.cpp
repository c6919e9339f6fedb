// PPD2: configuration and the step of one period.
#include <algorithm>
#include <cmath>

#include <pneuservo/control/ppd2.hpp>
#include <pneuservo/rig/axis.hpp>

namespace pneuservo {
namespace {

constexpr double rad_per_cycle = 6.283185307179586;
constexpr std::int64_t most_bridged_periods = 50;  // a late tick must not grow long itself

int order_of(FeedforwardKind kind) noexcept {
  switch (kind) {
    case FeedforwardKind::order_3: return 3;
    case FeedforwardKind::order_5: return 5;
    case FeedforwardKind::order_7: return 7;
    case FeedforwardKind::flatness: return 5;  // before the plan begins
    case FeedforwardKind::none: break;
  }
  return 0;
}

}  // namespace

ObserverGains observer_gains(const Ppd2Parameters& p) noexcept {
  if (p.observer_gains && p.observer_gains->size() == 3)
    return {(*p.observer_gains)[0], (*p.observer_gains)[1], (*p.observer_gains)[2]};
  return ObserverGains::butterworth(p.observer_rad_per_s);
}

void Ppd2::configure(const Ppd2Parameters& parameters, const AxisParameters<double>& axis, double period_s,
                     const Reference& reference, double duration_s) {
  input_ = parameters.observer;
  flat_ = parameters.feedforward == FeedforwardKind::flatness;
  follows_ = parameters.feedforward != FeedforwardKind::none;
  learning_ = flat_ ? parameters.learning : Learning::none;
  mean_pressure_Pa_ = parameters.mean_pressure_Pa;
  const SecondOrderLag line{rad_per_cycle * axis.line_1.natural_frequency_Hz, axis.line_1.damping_ratio};
  inverse_ = inverse_coefficients(linear_servo_table(axis, parameters.equilibrium_pressure_Pa, line),
                                  order_of(parameters.feedforward));
  gains_ = next_gains_ = gain_set(parameters);
  observer_.configure(observer_gains(parameters), period_s);
  limiter_.fill(CommandLimiter(axis.valve.command_max_V, parameters.command_rate_V_per_s, period_s));
  period_s_ = period_s;
  lead_s_ = input_ == ObserverInput::error ? 0.5 * period_s + parameters.command_delay_s : 0.0;
  bump_decay_ = std::exp(-period_s / bump_time_s);
  if (flat_) {
    FlatnessSettings settings;
    settings.period_s = period_s;
    settings.command_delay_s = parameters.command_delay_s;
    settings.mean_pressure_Pa = parameters.mean_pressure_Pa;
    flatness_ = FlatnessLaw(FlatnessPlan(axis, reference, duration_s, settings),
                            flatness_gains(axis, parameters.equilibrium_pressure_Pa), period_s);
  }
  reset();
}

void Ppd2::reset(const std::array<double, 2>& previous_V) noexcept {
  state_ = Ppd2State{};
  state_.gains = gains_;
  observer_.reset();
  flatness_.reset();
  for (std::size_t i = 0; i < 2; ++i) {
    limiter_[i].reset(previous_V[i]);
    state_.u_V[i] = limiter_[i].previous_V();
  }
  periods_ = 1;
}

void Ppd2::change_gains(const Ppd2GainSet& gains) noexcept {
  next_gains_ = gains;
  gains_change_ = !(gains == gains_);
}

void Ppd2::learn(const AxisParameters<double>& axis) {
  if (learning_ == Learning::flow) flatness_.learn_flow(axis);
  if (learning_ == Learning::area) flatness_.learn_area(axis);
}

double Ppd2::rest_s(bool moved, const std::array<double, 2>& port_Pa) const noexcept {
  if (!flat_) return 0.0;
  const double off_Pa = 0.5 * (port_Pa[0] + port_Pa[1]) - mean_pressure_Pa_;
  return moved || std::fabs(off_Pa) > mean_pressure_tolerance_Pa ? settling_s : 0.0;
}

// Command of valve 1 without what a change of gains left behind. On the measured position (2.42, 2.43):
//   u = Kp (r - x_measured) - Kv v - Ka a,  r = sum c_i x_ref^(i),  Kp c = inverse + {Kp, Kv, Ka}.
// On the error: u = u_ff - Kp e - Kv e_v - Ka e_a + Ki sum(-e) T,  u_ff = Kp (r - x_ref) - Kv x_ref' - Ka x_ref''.
// Without feedforward r is x_ref. Where the flatness plan has the feedforward, the linear inverse has none.
double Ppd2::total_V(const Ppd2GainSet& g, const Ppd2State& s, const ControlInput& in,
                     double* feedforward_V) const noexcept {
  const bool on_error = input_ == ObserverInput::error, planned = flat_ && in.tick >= 0;
  const ReferencePoint& r = on_error ? in.ahead : in.now;
  double u = 0.0;
  for (std::size_t i = 7; i >= 1 && !planned; --i) u += inverse_[i] * r.d[i];  // small terms first
  const double of_motion_V = g.velocity_gain_Vs_per_m * r.d[1] + g.acceleration_gain_Vs2_per_m * r.d[2];
  if (follows_ && !on_error) u += of_motion_V;
  if (!follows_ && on_error) u -= of_motion_V;
  *feedforward_V = u;
  const double e = on_error ? s.x_m : s.e_m;
  return u - g.position_gain_V_per_m * e - g.velocity_gain_Vs_per_m * s.v_mps -
         g.acceleration_gain_Vs2_per_m * s.a_mps2 + g.integral_gain_V_per_m_s * s.I_ms;
}

// The integral takes up the difference of both commands where there is one; else it fades.
void Ppd2::smooth_change(Ppd2State& s, const ControlInput& in) noexcept {
  double feedforward_V = 0.0;
  const double old_V = total_V(gains_, s, in, &feedforward_V), new_V = total_V(next_gains_, s, in, &feedforward_V);
  if (next_gains_.integral_gain_V_per_m_s > 0.0) s.I_ms += (old_V - new_V) / next_gains_.integral_gain_V_per_m_s;
  else s.u_bump_V += old_V - new_V;
  gains_ = next_gains_;
  gains_change_ = false;
}

// Both valves' commands for what the law asks of valve 1, before range and rate.
std::array<double, 2> Ppd2::commands(const ControlInput& in, double across_V) noexcept {
  if (!flat_) return {across_V, -across_V};
  const FlatnessCommand command = flatness_.step(in.tick, in.x_m - in.now.d[0], across_V, in.port_Pa[0], in.port_Pa[1]);
  return {command.valve_1_V, command.valve_2_V};
}

void Ppd2::update(const ControlInput& in) noexcept {
  const int periods = static_cast<int>(std::min(periods_, most_bridged_periods));
  MotionObserver observer = observer_;
  Ppd2State s = state_;
  s.e_m = in.x_m - in.now.d[0];
  const bool on_error = input_ == ObserverInput::error;
  observer.step(on_error ? s.e_m : in.x_m, periods);
  s.x_m = observer.position_m();
  s.v_mps = observer.velocity_mps();
  s.a_mps2 = observer.acceleration_mps2();
  s.speed_mps = s.v_mps + (on_error ? in.now.d[1] : 0.0);
  s.u_bump_V *= bump_decay_;
  if (state_.limit[0] == limit_none && state_.limit[1] == limit_none) s.I_ms -= (on_error ? s.x_m : s.e_m) * period_s_;
  if (gains_change_) smooth_change(s, in);

  const double across_V = total_V(gains_, s, in, &s.u_feedforward_V) + s.u_bump_V;
  s.finite = std::isfinite(across_V) && std::isfinite(s.speed_mps) && std::isfinite(in.port_Pa[0] + in.port_Pa[1]);
  if (!s.finite) {
    // State stays as it was before this sample: observer, integral and commands survive a single bad measurement.
    state_.finite = false;
    state_.limit = {};
    state_.gains = gains_;
    periods_ += 1;
    return;
  }
  s.gains = gains_;
  s.u_feedback_V = across_V - s.u_feedforward_V;
  s.u_unlimited_V = commands(in, across_V);
  for (std::size_t i = 0; i < 2; ++i) {
    const CommandLimiter::Result result = limiter_[i].limit(s.u_unlimited_V[i]);
    s.u_V[i] = result.command_V;
    s.limit[i] = result.limit;
  }
  observer_ = observer;
  state_ = s;
  periods_ = 1;
}

}  // namespace pneuservo
