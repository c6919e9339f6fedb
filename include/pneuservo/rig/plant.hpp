// The simulated axis: valves, both lines with their chambers, slider and supply, built from the elements.
#pragma once
#include <type_traits>

#include <pneuservo/core/pack.hpp>
#include <pneuservo/core/signal.hpp>
#include <pneuservo/elements/line_with_chamber.hpp>
#include <pneuservo/elements/slider.hpp>
#include <pneuservo/elements/valves.hpp>
#include <pneuservo/rig/axis.hpp>

namespace pneuservo {

/// Where a plant starts: at rest, gas at ambient temperature, each line at its chamber's pressure.
template <class S> struct PlantStart {
  S position_m{};
  S pressure_1_Pa{};
  S pressure_2_Pa{};
};

/// Pressure of chamber 2 that balances the piston at rest: A_1 p_1 - A_2 p_2 - (A_1 - A_2) p_atm = 0.
template <class S> S balancing_pressure_2(const AxisParameters<S>& axis, const S& pressure_1_Pa) noexcept {
  const S a_1 = axis.cylinder.area_1_m2, a_2 = axis.cylinder.area_2_m2, p_atm = axis.air.atmosphere_Pa;
  return (a_1 * pressure_1_Pa - (a_1 - a_2) * p_atm) / a_2;
}

/// Numerical effort for both lines, the same for every lane.
struct PlantGrid {
  int cells = 0;
  int substeps = 0;  ///< of a period; 0: as many as sound and flow need, over all lanes
  double port_tolerance = pneuservo::port_tolerance;
};

/// What acts on the gas beside the model; side 1 in the low half, side 2 in the high half.
template <class S> struct GasDisturbance {
  Pair<S> valve_area_m2{};      ///< more of the edge that fills; negative: of the one that empties
  Pair<S> line_flow_kgps{};     ///< into the middle of each line
  Pair<S> chamber_flow_kgps{};  ///< into each chamber, at its gas's temperature
  Pair<S> end_loss_Pa{};        ///< of pressure from each line's end to its chamber
};

/// Both sides are computed side by side in the lanes of Pair<S>; S itself may carry several rigs.
/// step() is one control period with the commands held; it allocates nothing and throws nothing.
template <class S> class AxisPlant {
 public:
  using P = Pair<S>;

  /// Allocates. cells_per_m: cells of the lines, at least one a line.
  void configure(const AxisParameters<S>& axis, double period_s, double cells_per_m,
                 ValveArrangement arrangement = ValveArrangement::five_port) {
    const int cells =
        std::max(cell_count(axis.line_1.length_m, cells_per_m), cell_count(axis.line_2.length_m, cells_per_m));
    configure(axis, period_s, PlantGrid{cells, 0}, arrangement);
  }
  /// Allocates. A fixed number of sub-steps keeps lanes free of each other whatever flows in them.
  void configure(const AxisParameters<S>& axis, double period_s, const PlantGrid& grid,
                 ValveArrangement arrangement = ValveArrangement::five_port) {
    axis_ = axis;
    air_ = Air<S>(axis.air);
    period_s_ = period_s;
    sides_.configure(join_parameters<LineParameters<P>>(axis.line_1, axis.line_2), side_geometry(axis),
                     join_parameters<AirParameters<P>>(axis.air, axis.air), grid.cells);
    sides_.fix_substeps(grid.substeps);
    sides_.line().set_port_tolerance(grid.port_tolerance);
    LineEffects<P> line_effects;
    const auto of_line_1 = LineEffects<S>::of_line_1(axis.effects), of_line_2 = LineEffects<S>::of_line_2(axis.effects);
    LineEffects<P>::visit(
        [](auto& to, const auto& side_1, const auto& side_2) {
          to = join_parameters<std::remove_cvref_t<decltype(to)>>(side_1, side_2);
        },
        line_effects, of_line_1, of_line_2);
    line_effects.critical_pressure_ratio = join(axis.valve.critical_pressure_ratio, axis.valve.critical_pressure_ratio);
    sides_.line().set_effects(line_effects);
    valves_.configure(arrangement, axis.valve, axis.effects.valve, period_s);
    slider_.configure(axis.slider, axis.effects.motion, axis.cylinder.stroke_m, axis.cylinder.end_stop_restitution);
    chambers_leak_ = any(axis.effects.chamber_leak_1.area_m2 > S(0)) ||
                     any(axis.effects.chamber_leak_2.area_m2 > S(0)) || any(axis.effects.piston_leak.area_m2 > S(0));
    leak_zone_ = any(axis.effects.piston_leak_zone.area_m2 > S(0));
    relieves_ = any(axis.effects.chamber_relief_1.area_per_pressure_m2_per_Pa > S(0)) ||
                any(axis.effects.chamber_relief_2.area_per_pressure_m2_per_Pa > S(0));
    leaks_by_table_ = axis.effects.leak_over_pressure_1.is_there() || axis.effects.leak_over_pressure_2.is_there();
    chambers_leak_ = chambers_leak_ || leak_zone_ || relieves_ || leaks_by_table_;
    droops_ = any(axis.effects.supply_droop.area_m2 > S(0));
    const SupplySwing<S>& swing = axis.effects.supply_swing;
    supply_swing_.configure(swing.amplitude_Pa, swing.frequency_Hz, swing.phase_rad);
    swings_ = supply_swing_.is_there();
    reset({S(0), air_.atmosphere_Pa, air_.atmosphere_Pa});
  }

  void reset(const PlantStart<S>& start) noexcept {
    slider_.reset(start.position_m, S(0));
    sides_.reset(join(start.pressure_1_Pa, start.pressure_2_Pa), join(air_.temperature_K, air_.temperature_K),
                 distances());
    valves_.reset(S(0));
    supply_swing_.reset();
    supply_pressure_ = fed_pressure();
    supply_is_imposed_ = false;
    supply_area_m2_ = P(0);
    last_step_s_ = 0.0;
  }

  /// One period under the command of a five-port valve, or u and -u for a pair of three-port valves [V].
  void step(const S& command_V) noexcept { step(command_V, -command_V); }
  /// One period under a command for each three-port valve [V].
  void step(const S& command_1_V, const S& command_2_V) noexcept {
    run_period(command_1_V, command_2_V, [this](double h, int, int) noexcept {
      if (!held_) slider_.step(h, middle_force(h), {gauge_pressure_sum()});
    });
  }

  /// One period with the piston led from outside to position_m at its end, at even speed.
  void step_led(const S& command_1_V, const S& command_2_V, const S& position_m) noexcept {
    run_period(command_1_V, command_2_V, Leading(*this, position_m));
  }
  /// Multiplies the pressure and the temperature of the gas of both sides, lines and chambers; its mass follows.
  void scale_gas(const P& pressure, const P& temperature) noexcept { sides_.scale_gas(pressure, temperature); }

  /// Pressure that feeds the supply from here on; without supply_droop it is that of the supply.
  void set_supply_pressure(const S& pressure_Pa) noexcept {
    axis_.supply.pressure_Pa = pressure_Pa;
    if (!droops_) supply_pressure_ = fed_pressure();
  }
  /// Pressure that the valves find until reset(), as measured; the model of the supply goes on beside it.
  void impose_valve_supply(const S& pressure_Pa) noexcept {
    imposed_supply_ = pressure_Pa;
    supply_is_imposed_ = true;
  }
  /// Leak of each chamber to atmosphere from here on [m2].
  void set_chamber_leaks(const S& area_1_m2, const S& area_2_m2) noexcept {
    axis_.effects.chamber_leak_1.area_m2 = area_1_m2;
    axis_.effects.chamber_leak_2.area_m2 = area_2_m2;
    chambers_leak_ = true;
  }
  /// Acts from here on.
  void set_disturbance(const GasDisturbance<S>& disturbance) noexcept {
    disturbance_ = disturbance;
    disturbed_ = true;
    sides_.line().set_inflow(disturbance.line_flow_kgps);
    sides_.set_end_loss(disturbance.end_loss_Pa);
  }
  /// Holds the piston where it is (tests, held-piston experiments) or lets it go.
  void hold_piston(bool held) noexcept { held_ = held; }

  S position() const noexcept { return slider_.position(); }
  S velocity() const noexcept { return slider_.velocity(); }
  P port_pressure() const noexcept { return sides_.port_pressure(); }
  P chamber_pressure() const noexcept { return sides_.chamber().pressure(); }
  S supply_pressure() const noexcept { return supply_pressure_; }
  /// What the valve of each side takes from the supply [kg/s], at the areas of the last sub-step.
  P supply_flow() const noexcept { return supply_flow(supply_area_m2_); }
  /// Flows of the last sub-step at both lines' ends.
  const LineFlow<P>& flow() const noexcept { return flow_; }
  /// Force of both chambers and the atmosphere on piston and rod [N].
  S driving_force() const noexcept {
    const S a_1 = axis_.cylinder.area_1_m2, a_2 = axis_.cylinder.area_2_m2;
    const P p = chamber_pressure();
    return a_1 * low(p) - a_2 * high(p) - (a_1 - a_2) * air_.atmosphere_Pa;
  }
  const LineWithChamber<P>& sides() const noexcept { return sides_; }
  LineWithChamber<P>& sides() noexcept { return sides_; }
  Slider<S>& slider() noexcept { return slider_; }
  Valves<S>& valves() noexcept { return valves_; }

  /// Parameters of both sides in one pair: side 1 low, side 2 high.
  template <class To, class From> static To join_parameters(const From& side_1, const From& side_2) {
    To out{};
    To::visit(
        [](const Field&, auto& to, const auto& a, const auto& b) {
          if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(a)>>) to = a;  // choices are those of both sides
          else to = join(a, b);
        },
        out, side_1, side_2);
    return out;
  }
  static ChamberGeometry<P> side_geometry(const AxisParameters<S>& axis) noexcept {
    const auto& c = axis.cylinder;
    const S half = S(0.5) * c.stroke_m;
    return {join(c.area_1_m2, c.area_2_m2), join(c.dead_volume_1_m3, c.dead_volume_2_m3),
            join(c.wall_heat_W_per_m2K, c.wall_heat_W_per_m2K), join(c.linear_about_Pa, c.linear_about_Pa),
            join(c.dead_volume_1_m3 + half * c.area_1_m2, c.dead_volume_2_m3 + half * c.area_2_m2)};
  }

 private:
  // Leads the slider along a straight line to where it shall be at the period's end.
  struct Leading {
    Leading(AxisPlant& plant, const S& end) noexcept
        : slider(plant.slider_), start(plant.slider_.position()), way(end - start),
          velocity(way * S(1.0 / plant.period_s_)) {}
    void operator()(double, int i, int n) const noexcept { slider.reset(start + S((i + 1.0) / n) * way, velocity); }
    Slider<S>& slider;
    S start, way, velocity;
  };
  // move(h, i, n) brings the slider to the end of sub-step i of n.
  template <class Move> void run_period(const S& command_1_V, const S& command_2_V, Move&& move) noexcept {
    valves_.set_commands(command_1_V, command_2_V);
    const int n = sides_.begin_period(period_s_);
    const double h = sides_.step_s();
    valves_.set_time_step(h);
    PortAreas<P> edges = valves_.step(0.0);
    for (int i = 0; i < n; ++i) {
      if (i > 0 && valves_.move_within_period()) edges = valves_.step(i * h);
      PortAreas<P> areas = edges;
      ChamberInflow<P> leaks = chambers_leak_ ? chamber_leaks() : ChamberInflow<P>{};
      if (disturbed_) disturb(areas, leaks);
      move(h, i, n);
      const ValvePort<P> port{areas.supply, areas.exhaust, join(valve_supply(), valve_supply()),
                              join(axis_.valve.critical_pressure_ratio, axis_.valve.critical_pressure_ratio)};
      flow_ = sides_.step_valve(port, distances(), leaks);
      supply_area_m2_ = areas.supply;
      if (swings_) supply_swing_.step(h);
      if (droops_) step_supply(h, areas);
      else if (swings_) supply_pressure_ = fed_pressure();
    }
  }
  // Of what feeds the supply.
  S fed_pressure() const noexcept {
    return swings_ ? axis_.supply.pressure_Pa + supply_swing_.value() : axis_.supply.pressure_Pa;
  }
  // Force at the middle of the sub-step: the gas moves after the slider, so the force of its start acts on the slider's
  // way and would take w h/4 from the damping ratio of the gas springs. Its last change, whatever made it, is carried
  // on.
  S middle_force(double h) noexcept {
    const S force = driving_force();
    const S change = last_step_s_ > 0.0 ? S(0.5 * h / last_step_s_) * (force - last_force_) : S(0);
    last_force_ = force;
    last_step_s_ = h;
    return force + change;
  }
  // Distances of the piston from the end stops of chamber 1 and 2; a little penetration must not empty a chamber.
  P distances() const noexcept {
    const S half = S(0.5) * axis_.cylinder.stroke_m;
    return maximum(join(half + slider_.position(), half - slider_.position()), P(0));
  }
  S gauge_pressure_sum() const noexcept {
    const P p = chamber_pressure();
    return maximum(low(p) - air_.atmosphere_Pa, S(0)) + maximum(high(p) - air_.atmosphere_Pa, S(0));
  }
  // Orifices from chamber to chamber and from each chamber to atmosphere.
  ChamberInflow<P> chamber_leaks() const noexcept {
    const P p = chamber_pressure(), T = sides_.chamber().temperature();
    const S b = axis_.valve.critical_pressure_ratio, p_atm = air_.atmosphere_Pa, T_amb = air_.temperature_K;
    const auto& e = axis_.effects;
    S area_1 = e.chamber_leak_1.area_m2, area_2 = e.chamber_leak_2.area_m2;
    if (relieves_) area_1 += e.chamber_relief_1.area_at(low(p)), area_2 += e.chamber_relief_2.area_at(high(p));
    if (leaks_by_table_) area_1 += e.leak_over_pressure_1.at(low(p)), area_2 += e.leak_over_pressure_2.at(high(p));
    const S out_1 = orifice_mass_flow(air_, area_1, b, low(p), low(T), p_atm, T_amb);
    const S out_2 = orifice_mass_flow(air_, area_2, b, high(p), high(T), p_atm, T_amb);
    S past_piston = axis_.effects.piston_leak.area_m2;
    if (leak_zone_) past_piston += axis_.effects.piston_leak_zone.area_at(slider_.position());
    const S across = orifice_mass_flow(air_, past_piston, b, low(p), low(T), high(p), high(T));
    const S h_1 = orifice_enthalpy_flow(air_, out_1, low(T), T_amb),
            h_2 = orifice_enthalpy_flow(air_, out_2, high(T), T_amb);
    const S h_across = orifice_enthalpy_flow(air_, across, low(T), high(T));
    return {join(-out_1 - across, across - out_2), join(-h_1 - h_across, h_across - h_2)};
  }
  // Of two edges that are open the difference is shifted; what both have stays.
  void disturb(PortAreas<P>& areas, ChamberInflow<P>& leaks) const noexcept {
    const P common = minimum(areas.supply, areas.exhaust);
    const P net = areas.supply - areas.exhaust + disturbance_.valve_area_m2;
    areas = {common + maximum(net, P(0)), common + maximum(-net, P(0))};
    const P flow = disturbance_.chamber_flow_kgps;
    leaks.mass_flow_kgps += flow;
    leaks.enthalpy_flow_W += flow * join(air_.cp, air_.cp) * sides_.chamber().temperature();
  }
  P supply_flow(const P& supply_area_m2) const noexcept {
    const S b = axis_.valve.critical_pressure_ratio, T = air_.temperature_K;
    const P p = port_pressure();
    const S supply = valve_supply();
    return join(orifice_mass_flow(air_, low(supply_area_m2), b, supply, T, low(p), T),
                orifice_mass_flow(air_, high(supply_area_m2), b, supply, T, high(p), T));
  }
  S valve_supply() const noexcept { return supply_is_imposed_ ? imposed_supply_ : supply_pressure_; }
  // V dp/dt = R T (G_in - G_out), isothermal at supply temperature, fed from the configured pressure.
  void step_supply(double h, const PortAreas<P>& areas) noexcept {
    const SupplyDroop<S>& droop = axis_.effects.supply_droop;
    const S b = axis_.valve.critical_pressure_ratio, T = air_.temperature_K;
    const S fed = orifice_mass_flow(air_, droop.area_m2, b, fed_pressure(), T, supply_pressure_, T);
    const P taken = supply_flow(areas.supply);
    const S next = supply_pressure_ + S(h) * air_.R * T * (fed - (low(taken) + high(taken))) / droop.volume_m3;
    supply_pressure_ = select(droop.area_m2 > S(0), maximum(next, S(1e3)), fed_pressure());
  }

  AxisParameters<S> axis_;
  Air<S> air_;
  double period_s_ = 1e-3;
  LineWithChamber<P> sides_;
  Valves<S> valves_;
  Slider<S> slider_;
  LineFlow<P> flow_;
  GasDisturbance<S> disturbance_;
  S supply_pressure_{}, imposed_supply_{};
  P supply_area_m2_{};
  Oscillation<S> supply_swing_;
  S last_force_{};
  double last_step_s_ = 0.0;  // 0: no step yet
  bool chambers_leak_ = false, leak_zone_ = false, relieves_ = false, leaks_by_table_ = false, droops_ = false,
       swings_ = false, held_ = false, disturbed_ = false, supply_is_imposed_ = false;
};

/// What ideal sensors would show.
template <class S> PerSignal<S> true_values(const AxisPlant<S>& plant) noexcept {
  const auto port = plant.port_pressure(), chamber = plant.chamber_pressure();
  PerSignal<S> values;
  values[Signal::x] = plant.position();
  values[Signal::p1_port] = low(port), values[Signal::p2_port] = high(port);
  values[Signal::p1_chamber] = low(chamber), values[Signal::p2_chamber] = high(chamber);
  values[Signal::dp1] = low(port) - low(chamber), values[Signal::dp2] = high(port) - high(chamber);
  values[Signal::p_supply] = plant.supply_pressure();
  const auto taken = plant.supply_flow();
  values[Signal::supply_flow] = low(taken) + high(taken);
  return values;
}

}  // namespace pneuservo
