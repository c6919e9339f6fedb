// One spool of a proportional servo valve: command path (delay, play, lag, spool, offset, dead band) and edge areas.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <pneuservo/elements/effects.hpp>
#include <pneuservo/elements/parameters.hpp>
#include <pneuservo/elements/second_order_filter.hpp>
#include <pneuservo/elements/valve_port.hpp>

namespace pneuservo {

/// Areas of the two edges at one port [m2].
template <class S> struct PortAreas {
  S supply, exhaust;
};

/// A spool and the port that it fills for s > 0 and empties for s < 0: a three-port valve. Area = area_per_volt
/// |s_eff|, at most area_max. Order of the command path: hold, delay, play, lag, spool dynamics, offset, dead band,
/// area. The other port of a five-port spool sees everything with the opposite sign (elements/valves.hpp).
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
  /// One sub-step that begins `in_period_s` after the start of the period; areas at the spool's exact mean over it.
  PortAreas<S> step(double in_period_s) noexcept {
    const S command = delayed_ ? delayed_command(in_period_s + 0.5 * step_s_) : history_[newest_];
    const S half = S(0.5) * effects_.valve_hysteresis.width_V;
    play_ = clamp(play_, command - half, command + half);
    lag_ += lag_gain_ * (play_ - lag_);
    spool_.step(lag_);
    return areas(spool_.mean());
  }
  /// Areas of the edges at spool signal s [V].
  PortAreas<S> areas(const S& spool_V) const noexcept {
    const S shifted = spool_V + effects_.valve_offset.offset_V;
    const S open = maximum(absolute(shifted) - effects_.valve_dead_band.width_V, S(0));
    const S area = minimum(parameters_.area_per_volt_m2_per_V * open, parameters_.area_max_m2);
    const S leak = effects_.valve_neutral_leak.area_m2;
    const S exhaust = area * effects_.valve_asymmetry.exhaust_ratio;
    const auto forward = shifted > S(0);
    const S zero(0);
    return {leak + select(forward, area, zero), leak + select(forward, zero, exhaust)};
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
  SecondOrderFilter<S> spool_;
};

}  // namespace pneuservo
