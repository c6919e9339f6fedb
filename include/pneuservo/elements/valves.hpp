// The valves of an axis: one five-port spool, or two three-port valves with a command each; both ports in lanes.
#pragma once
#include <pneuservo/core/pack.hpp>
#include <pneuservo/elements/valve.hpp>

namespace pneuservo {

enum class ValveArrangement {
  five_port,         ///< one spool: what fills port 1 empties port 2
  three_port_pair,   ///< a spool a port
};

/// Side 1 in the low half of the lanes, side 2 in the high half. A five-port spool is a pair whose second spool does
/// the opposite of the first, its offset included.
template <class S> class Valves {
 public:
  using P = Pair<S>;

  /// Allocates the delay lines. Both valves have the same parameters and effects.
  void configure(ValveArrangement arrangement, const ValveParameters<S>& valve, const ValveEffects<S>& effects,
                 double period_s) {
    arrangement_ = arrangement;
    ValveParameters<P> both{};
    ValveParameters<P>::visit([](const Field&, auto& to, const auto& from) { to = join(from, from); }, both, valve);
    both.on_off = valve.on_off;
    ValveEffects<P> of_both{};
    copy_groups(of_both, effects);
    if (arrangement == ValveArrangement::five_port)
      of_both.valve_offset.offset_V = join(effects.valve_offset.offset_V, -effects.valve_offset.offset_V);
    pair_.configure(both, of_both, period_s);
    const auto edges_1 = PortEdges<S>::of_port_1(effects), edges_2 = PortEdges<S>::of_port_2(effects);
    pair_.set_edges(
        {join(edges_1.supply_slope, edges_2.supply_slope), join(edges_1.exhaust_slope, edges_2.exhaust_slope),
         join(edges_1.supply_overlap, edges_2.supply_overlap), join(edges_1.exhaust_overlap, edges_2.exhaust_overlap),
         joined(edges_1.filling, edges_2.filling), joined(edges_1.emptying, edges_2.emptying)});
  }
  void reset(const S& command) noexcept { pair_.reset(join(command, command)); }
  /// The commands that act from the start of the coming period; a five-port spool has the first alone.
  void set_commands(const S& command_1_V, const S& command_2_V) noexcept {
    pair_.set_command(join(command_1_V, arrangement_ == ValveArrangement::five_port ? -command_1_V : command_2_V));
  }
  void set_time_step(double step_s) noexcept { pair_.set_time_step(step_s); }
  bool move_within_period() const noexcept { return pair_.moves_within_period(); }
  /// One sub-step that begins `in_period_s` after the start of the period; areas at the spools' mean over it.
  PortAreas<P> step(double in_period_s) noexcept { return pair_.step(in_period_s); }
  /// The spools themselves, e.g. to give each its own parameters.
  Valve<P>& pair() noexcept { return pair_; }
  const Valve<P>& pair() const noexcept { return pair_; }

 private:
  static ValveLinearity<P> joined(const ValveLinearity<S>& one, const ValveLinearity<S>& other) noexcept {
    ValveLinearity<P> out;
    const auto join_both = [](const Field&, auto& to, const auto& a, const auto& b) { to = join(a, b); };
    ValveLinearity<P>::visit(join_both, out, one, other);
    return out;
  }
  static void copy_groups(ValveEffects<P>& to, const ValveEffects<S>& from) noexcept {
    ValveEffects<P>::visit(
        [](const Field&, auto& group, const auto& source) {
          std::remove_cvref_t<decltype(group)>::visit([](const Field&, auto& a, const auto& b) { a = join(b, b); },
                                                      group, source);
        },
        to, from);
  }

  ValveArrangement arrangement_ = ValveArrangement::five_port;
  Valve<P> pair_;
};

}  // namespace pneuservo
