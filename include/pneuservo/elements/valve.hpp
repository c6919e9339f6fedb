// One valve of a port: the spool of a proportional servo valve with its command path, or two on/off valves; areas.
#pragma once
#include <algorithm>
#include <array>
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

/// What the two edges of one port are beside those of the valve.
template <class S> struct PortEdges {
  S supply_slope = S(0), exhaust_slope = S(0);  ///< share of the valve's
  S supply_overlap = S(0), exhaust_overlap = S(0);  ///< of valve_dead_band's
  ValveLinearity<S> filling, emptying;  ///< while the spool fills this port, and empties it

  static PortEdges of_port_1(const ValveEffects<S>& effects) noexcept {
    return {effects.valve_edge_slopes.supply_1,   effects.valve_edge_slopes.exhaust_1,
            effects.valve_edge_overlaps.supply_1, effects.valve_edge_overlaps.exhaust_1,
            effects.valve_linearity_forward,      effects.valve_linearity_backward};
  }
  static PortEdges of_port_2(const ValveEffects<S>& effects) noexcept {
    return {effects.valve_edge_slopes.supply_2,   effects.valve_edge_slopes.exhaust_2,
            effects.valve_edge_overlaps.supply_2, effects.valve_edge_overlaps.exhaust_2,
            effects.valve_linearity_backward,     effects.valve_linearity_forward};
  }
};

/// A spool and the port that it fills for s > 0 and empties for s < 0: a three-port valve. Area = area_per_volt
/// |s_eff|, at most area_max (valve_curve and valve_linearity bend the slope). Order of the command path: hold, delay,
/// play, stiction, lag, spool dynamics, offset, dead band, area. Two on/off valves have their coils in its place: one
/// on above half of command_max, one below minus half. The other port of a five-port spool sees everything with the
/// opposite sign (elements/valves.hpp).
template <class S> class Valve {
 public:
  /// Allocates the delay line; longest delay 0.5 s.
  void configure(const ValveParameters<S>& valve, const ValveEffects<S>& effects, double period_s) {
    parameters_ = valve;
    effects_ = effects;
    period_s_ = period_s;
    step_s_ = 0.0;
    history_.assign(static_cast<std::size_t>(std::ceil(0.5 / period_s)) + 2, S(0));
    const S bent = absolute(effects.valve_curve.near_middle) + absolute(effects.valve_curve.wide_open);
    is_curved_ = any(bent > S(0));
    sticks_ = any(effects.valve_stiction.threshold_V > S(0));
    delayed_ = any(effects.command_delay.delay_s > S(0));
    moves_within_ = delayed_ || any(effects.valve_lag.time_constant_s > S(0)) || any(valve.natural_frequency_Hz > S(0));
    is_on_off_ = valve.on_off.has_value();
    if (is_on_off_)
      for (auto& pair : on_off_)
        for (OnOffValve& one : pair) one.configure(*valve.on_off);
    reset(S(0));
  }
  /// After configure(): edges that differ from each other.
  void set_edges(const PortEdges<S>& edges) noexcept {
    edges_ = edges;
    edges_differ_ = any(absolute(edges.supply_slope) + absolute(edges.exhaust_slope) + absolute(edges.supply_overlap) +
                            absolute(edges.exhaust_overlap) >
                        S(0));
    is_uneven_ = any(edges.filling.size() + edges.emptying.size() > S(0));
  }
  void reset(const S& command) noexcept {
    for (std::size_t i = 0; i < on_off_.size(); ++i)
      for (std::size_t edge = 0; edge < 2; ++edge) on_off_[i][edge].reset(coil_is_on(command, i, edge));
    for (auto& past : history_) past = command;
    newest_ = 0;
    play_ = stuck_ = lag_ = command;
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
    pieces_ = moves_within_ ? static_cast<int>(std::ceil(step_s / longest_piece_s - 1e-9)) : 1;
    piece_s_ = step_s / pieces_;
    spool_.configure(parameters_.natural_frequency_Hz, parameters_.damping_ratio, piece_s_);
    const S tau = effects_.valve_lag.time_constant_s;
    lagging_ = tau > S(0);
    const S ratio = select(lagging_, tau, S(1)) * S(1.0 / piece_s_);
    lag_gain_ = S(1) - exponential(S(-1) / ratio);
    lag_mean_gain_ = ratio * lag_gain_;
  }
  /// Whether the areas change within a period, under one command.
  bool moves_within_period() const noexcept { return is_on_off_ || moves_within_; }
  /// One sub-step that begins `in_period_s` after the start of the period; areas at the spool's exact mean over it, or
  /// over pieces that resolve delay and lag however long the sub-step of the gas is.
  PortAreas<S> step(double in_period_s) noexcept {
    if (is_on_off_) return pulsed();
    if (moves_within_) return mean_areas(in_period_s);
    lag_ = held_by_spool(history_[newest_]);  // the spool is where the play leaves it, at once
    return areas(lag_);
  }
  /// Areas of the edges at spool signal s [V].
  PortAreas<S> areas(const S& spool_V) const noexcept {
    const S shifted = spool_V + effects_.valve_offset.offset_V;
    // Each edge opens where the spool is past its overlap, also where that is negative (an underlap).
    const S overlap = effects_.valve_dead_band.width_V;
    S slope = parameters_.area_per_volt_m2_per_V;
    if (is_curved_) slope = slope * effects_.valve_curve.factor(absolute(shifted), parameters_.command_max_V);
    if (is_uneven_) {
      const S way = absolute(shifted) / parameters_.command_max_V;
      slope = slope * (S(1) + select(shifted > S(0), edges_.filling.share(way), edges_.emptying.share(way)));
    }
    S supply_way = shifted - overlap, exhaust_way = -shifted - overlap, supply_slope = slope, exhaust_slope = slope;
    if (edges_differ_) {
      supply_way = supply_way - overlap * edges_.supply_overlap;
      exhaust_way = exhaust_way - overlap * edges_.exhaust_overlap;
      supply_slope = slope * (S(1) + edges_.supply_slope), exhaust_slope = slope * (S(1) + edges_.exhaust_slope);
    }
    const S supply = minimum(supply_slope * maximum(supply_way, S(0)), parameters_.area_max_m2);
    const S exhaust = minimum(exhaust_slope * maximum(exhaust_way, S(0)), parameters_.area_max_m2);
    const S leak = effects_.valve_neutral_leak.area_m2;
    return {leak + supply, leak + exhaust * effects_.valve_asymmetry.exhaust_ratio};
  }
  /// Spool at the end of the last sub-step [V], offset and dead band not in it.
  S spool() const noexcept { return select(parameters_.natural_frequency_Hz > S(0), spool_.value(), lag_); }

 private:
  bool coil_is_on(const S& command, std::size_t i, std::size_t edge) const noexcept {
    const int at = static_cast<int>(i);
    const double half_V = 0.5 * lane(parameters_.command_max_V, at), command_V = lane(command, at);
    return edge == 0 ? command_V > half_V : command_V < -half_V;
  }
  // Out of the way of the valve without delay, lag and spool, which is then compiled into the plant's step.
  [[gnu::noinline]] PortAreas<S> mean_areas(double in_period_s) noexcept {
    PortAreas<S> mean{};
    for (int i = 0; i < pieces_; ++i) {
      const double start = in_period_s + i * piece_s_;
      const PortAreas<S> now = piece(delayed_ ? delayed_command(start, start + piece_s_) : history_[newest_]);
      const S share(1.0 / (i + 1));  // a mean of equal areas is that area to the last bit
      mean = {mean.supply + share * (now.supply - mean.supply), mean.exhaust + share * (now.exhaust - mean.exhaust)};
    }
    return mean;
  }
  // Mean areas over the sub-step.
  [[gnu::noinline]] PortAreas<S> pulsed() noexcept {
    S fills(0), empties(0);
    for (std::size_t i = 0; i < on_off_.size(); ++i) {
      const auto share = [&](std::size_t edge) noexcept {
        return on_off_[i][edge].step(coil_is_on(history_[newest_], i, edge), step_s_) / step_s_;
      };
      set_lane(fills, static_cast<int>(i), share(0));
      set_lane(empties, static_cast<int>(i), share(1));
    }
    const PortAreas<S> shut = areas(S(0)), filling = areas(parameters_.command_max_V),
                       emptying = areas(-parameters_.command_max_V);
    return {shut.supply + fills * (filling.supply - shut.supply),
            shut.exhaust + empties * (emptying.exhaust - shut.exhaust)};
  }
  // The path over one piece under a constant command: play, lag, spool; areas at the spool's mean.
  PortAreas<S> piece(const S& command) noexcept {
    const S wanted = held_by_spool(command), gap = wanted - lag_;
    const S mean = select(lagging_, wanted - lag_mean_gain_ * gap, wanted);
    lag_ = select(lagging_, lag_ + lag_gain_ * gap, wanted);
    spool_.step(mean);
    return areas(spool_.mean());
  }
  // Where play and stiction let the spool go under a command.
  S held_by_spool(const S& command) noexcept {
    const S half = S(0.5) * effects_.valve_hysteresis.width_V;
    play_ = clamp(play_, command - half, command + half);
    if (!sticks_) return play_;
    stuck_ = select(absolute(play_ - stuck_) > effects_.valve_stiction.threshold_V, play_, stuck_);
    return stuck_;
  }
  // Mean of the command in force between two instants of the period, at most a period apart, each lane with its delay:
  // at most one change falls between them.
  S delayed_command(double from_s, double to_s) const noexcept {
    S out(0);
    for (int i = 0; i < ScalarTraits<S>::lanes; ++i) {
      const double delay = lane(effects_.command_delay.delay_s, i);
      const double last = std::ceil((delay - to_s) / period_s_);  // periods back of the command at the end
      const double share = std::clamp((to_s - (delay - last * period_s_)) / (to_s - from_s), 0.0, 1.0);
      const double now = lane(past_command(last), i);
      set_lane(out, i, share == 1.0 ? now : now + (1.0 - share) * (lane(past_command(last + 1.0), i) - now));
    }
    return out;
  }
  const S& past_command(double periods) const noexcept {
    const auto back = static_cast<std::size_t>(std::clamp(periods, 0.0, static_cast<double>(history_.size() - 1)));
    return history_[newest_ >= back ? newest_ - back : newest_ + history_.size() - back];
  }

  static constexpr double longest_piece_s = 0.25e-3;
  ValveParameters<S> parameters_;
  ValveEffects<S> effects_;
  PortEdges<S> edges_;
  double period_s_ = 1e-3, step_s_ = 0.0;
  std::vector<S> history_;
  std::size_t newest_ = 0;
  bool delayed_ = false, moves_within_ = false, is_curved_ = false, sticks_ = false, is_on_off_ = false,
       edges_differ_ = false, is_uneven_ = false;
  std::array<std::array<OnOffValve, 2>, ScalarTraits<S>::lanes> on_off_;  // that fills, that empties
  int pieces_ = 1;
  double piece_s_ = 1e-3;
  S play_{}, stuck_{}, lag_{}, lag_gain_{}, lag_mean_gain_{};
  Mask<S> lagging_{};
  SecondOrderFilter<S> spool_;
};

}  // namespace pneuservo
