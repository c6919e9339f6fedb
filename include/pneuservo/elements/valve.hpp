// Five-port proportional servo valve: command path (delay, play, lag, spool, offset, dead band) and edge areas.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <pneuservo/elements/effects.hpp>
#include <pneuservo/elements/parameters.hpp>
#include <pneuservo/elements/valve_port.hpp>

namespace pneuservo {

/// Second-order spool s'' + 2 zeta w s' + w^2 s = w^2 u, stepped exactly for a command that is constant over a step.
template <class S> class Spool {
 public:
  /// natural_frequency_Hz 0: the spool follows at once.
  void configure(const S& natural_frequency_Hz, const S& damping_ratio, double step_s) noexcept {
    immediate_ = !(natural_frequency_Hz > S(0));
    const S w = S(6.2831853071795865) * natural_frequency_Hz;
    exponentiate(w * w, S(2) * damping_ratio * w, S(step_s));
  }
  void reset(const S& value) noexcept {
    value_ = value;
    rate_ = S(0);
  }
  void step(const S& command) noexcept {
    const S error = value_ - command;
    const S next = command + a11_ * error + a12_ * rate_;
    rate_ = a21_ * error + a22_ * rate_;
    value_ = select(immediate_, command, next);
  }
  S value() const noexcept { return value_; }

 private:
  // exp([[0, 1], [-k, -d]] h) by a Taylor series of the matrix over 2^10, squared ten times: the same for every
  // damping.
  void exponentiate(const S& k, const S& d, const S& h) noexcept {
    const S t = h * S(1.0 / 1024.0);
    S b11(1), b12(0), b21(0), b22(1);
    a11_ = a22_ = S(1);
    a12_ = a21_ = S(0);
    for (int n = 1; n <= 10; ++n) {  // term_n = term_{n-1} A t / n
      const S f = t / S(n);
      const S c11 = -k * b12 * f, c12 = (b11 - d * b12) * f, c21 = -k * b22 * f, c22 = (b21 - d * b22) * f;
      b11 = c11, b12 = c12, b21 = c21, b22 = c22;
      a11_ += b11, a12_ += b12, a21_ += b21, a22_ += b22;
    }
    for (int i = 0; i < 10; ++i) {
      const S c11 = a11_ * a11_ + a12_ * a21_, c12 = a11_ * a12_ + a12_ * a22_;
      const S c21 = a21_ * a11_ + a22_ * a21_, c22 = a21_ * a12_ + a22_ * a22_;
      a11_ = c11, a12_ = c12, a21_ = c21, a22_ = c22;
    }
  }
  Mask<S> immediate_{};
  S a11_{}, a12_{}, a21_{}, a22_{};
  S value_{}, rate_{};
};

/// Areas of the four edges at one instant [m2].
template <class S> struct ValveAreas {
  S supply_1, exhaust_1, supply_2, exhaust_2;
};

/// s > 0: supply feeds port 1, port 2 exhausts; s < 0 the other way round. Area = area_per_volt |s_eff|, at most
/// area_max. Order of the command path: hold, delay, play, lag, spool dynamics, offset, dead band, area.
template <class S> class Valve {
 public:
  /// Allocates the delay line; longest delay 0.5 s.
  void configure(const ValveParameters<S>& valve, const ValveEffects<S>& effects, double period_s) {
    parameters_ = valve;
    effects_ = effects;
    period_s_ = period_s;
    step_s_ = 0.0;
    history_.assign(static_cast<std::size_t>(std::ceil(0.5 / period_s)) + 2, S(0));
    delayed_ = any(effects.command_delay.delay_s > S(0));
    reset(S(0));
  }
  void reset(const S& command) noexcept {
    for (auto& past : history_) past = command;
    newest_ = 0;
    play_ = lag_ = command;
    spool_.reset(command);
  }
  /// The command that acts from the start of the coming period.
  void set_command(const S& command_V) noexcept {
    newest_ = newest_ + 1 == history_.size() ? 0 : newest_ + 1;
    history_[newest_] = clamp(command_V, -parameters_.command_max_V, parameters_.command_max_V);
  }
  /// Sub-step of the following steps.
  void set_time_step(double step_s) noexcept {
    if (step_s == step_s_) return;
    step_s_ = step_s;
    spool_.configure(parameters_.natural_frequency_Hz, parameters_.damping_ratio, step_s);
    const S tau = effects_.valve_lag.time_constant_s;
    const auto lagging = tau > S(0);
    lag_gain_ = select(lagging, S(1) - exponential(-S(step_s) / select(lagging, tau, S(1))), S(1));
  }
  /// One sub-step that begins `in_period_s` after the start of the period; areas at its end.
  ValveAreas<S> step(double in_period_s) noexcept {
    const S command = delayed_ ? delayed_command(in_period_s + 0.5 * step_s_) : history_[newest_];
    const S half = S(0.5) * effects_.valve_hysteresis.width_V;
    play_ = clamp(play_, command - half, command + half);
    lag_ += lag_gain_ * (play_ - lag_);
    spool_.step(lag_);
    return areas(spool_.value());
  }
  /// Areas of the edges at spool signal s [V].
  ValveAreas<S> areas(const S& spool_V) const noexcept {
    const S shifted = spool_V + effects_.valve_offset.offset_V;
    const S open = maximum(absolute(shifted) - effects_.valve_dead_band.width_V, S(0));
    const S area = minimum(parameters_.area_per_volt_m2_per_V * open, parameters_.area_max_m2);
    const S leak = effects_.valve_neutral_leak.area_m2;
    const S exhaust = area * effects_.valve_asymmetry.exhaust_ratio;
    const auto forward = shifted > S(0);
    const S zero(0);
    return {leak + select(forward, area, zero), leak + select(forward, zero, exhaust),
            leak + select(forward, zero, area), leak + select(forward, exhaust, zero)};
  }
  S spool() const noexcept { return spool_.value(); }

 private:
  // Command in force at `time_s` after the start of the period, minus the delay of each lane.
  S delayed_command(double time_s) const noexcept {
    S out(0);
    for (int i = 0; i < ScalarTraits<S>::lanes; ++i) {
      const double past = (lane(effects_.command_delay.delay_s, i) - time_s) / period_s_;
      const auto back =
          static_cast<std::size_t>(std::clamp(std::ceil(past), 0.0, static_cast<double>(history_.size() - 1)));
      const std::size_t index = newest_ >= back ? newest_ - back : newest_ + history_.size() - back;
      set_lane(out, i, lane(history_[index], i));
    }
    return out;
  }
  ValveParameters<S> parameters_;
  ValveEffects<S> effects_;
  double period_s_ = 1e-3, step_s_ = 0.0;
  std::vector<S> history_;
  std::size_t newest_ = 0;
  bool delayed_ = false;
  S play_{}, lag_{}, lag_gain_ = S(1);
  Spool<S> spool_;
};

}  // namespace pneuservo
