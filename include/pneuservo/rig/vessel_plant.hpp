// The simulated vessel behind an on/off valve, with the line between them where there is one
// (docs/physics/switched_rigs.md).
#pragma once
#include <algorithm>
#include <cmath>

#include <pneuservo/elements/line_with_chamber.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Both kinds of vessel behind one face: the valve at the vessel itself, or at the other end of a line. Delays of the
/// command and effects of sensors are not in it.
class VesselPlant {
 public:
  /// The gas at `start_Pa` everywhere. A wall that creeps has had its time at that pressure (`is_settled`), or none
  /// above the atmosphere's. Keeps the rig by reference. Allocates.
  VesselPlant(const Rig& rig, double start_Pa, bool is_settled = false) : rig_(rig), air_(rig.axis.air) {
    if (is_settled) grown_ = rig.vessel_effects.wall_creep.growth_per_Pa * (start_Pa - air_.atmosphere_Pa);
    const double temperature_K = rig.vessel.gas_temperature_K + rig.vessel_effects.charging_heat.excess_K;
    const double gas_kg = start_Pa * rig.vessel.volume_m3 / (air_.R * temperature_K);
    const ChamberGeometry<double> geometry = geometry_of(rig, gas_kg, air_);
    if (rig.line) {
      side_.configure(*rig.line, geometry, rig.axis.air,
                      std::max(least_cells, static_cast<int>(std::lround(cells_per_m * rig.line->length_m))));
      side_.reset(start_Pa, temperature_K, growth_s());
    } else {
      chamber_.configure(geometry, air_);
      chamber_.reset(start_Pa, temperature_K, growth_s());
    }
  }
  /// Goes on by h [s] under a command: above 0 open to the supply, below 0 to exhaust, 0 closed.
  void step(double h, double command, double stalled_Pa) noexcept {
    const double supply_area = command > 0 ? rig_.on_off_valve.supply_area_m2 : 0.0;
    const double exhaust_area = command < 0 ? rig_.on_off_valve.exhaust_area_m2 : 0.0;
    const double b = rig_.on_off_valve.critical_pressure_ratio;
    const double supply_Pa = pressure_behind_pump(rig_.vessel_effects.pump_curve, air_, supply_area, b, stalled_Pa,
                                                  port_Pa(), rig_.line ? air_.temperature_K : chamber_.temperature());
    if (rig_.line) {
      const int substeps = side_.begin_period(h);
      creep(h, side_.chamber().pressure());
      for (int i = 0; i < substeps; ++i)
        side_.step_valve({supply_area, exhaust_area, supply_Pa, b}, growth_s(), leak(side_.chamber()));
      return;
    }
    ChamberInflow<double> flow = leak(chamber_);
    const double p = chamber_.pressure(), T = chamber_.temperature();
    const double in = orifice_mass_flow(air_, supply_area, b, supply_Pa, air_.temperature_K, p, T);
    const double out = orifice_mass_flow(air_, exhaust_area, b, p, T, air_.atmosphere_Pa, air_.temperature_K);
    flow.mass_flow_kgps += in - out;
    flow.enthalpy_flow_W += orifice_enthalpy_flow(air_, in, air_.temperature_K, T) -
                            orifice_enthalpy_flow(air_, out, T, air_.temperature_K);
    creep(h, p);
    chamber_.step(h, flow, growth_s());
  }
  double chamber_Pa() const noexcept { return rig_.line ? side_.chamber().pressure() : chamber_.pressure(); }
  /// At the valve.
  double port_Pa() const noexcept { return rig_.line ? side_.port_pressure() : chamber_.pressure(); }

 private:
  static constexpr double cells_per_m = 4.0;
  static constexpr int least_cells = 4;

  /// Growth of a wall that creeps, as a way of the chamber's face.
  double growth_s() const noexcept { return grown_ * rig_.vessel.volume_m3 / face_m2; }
  void creep(double h, double p) noexcept {
    const WallCreep<double>& law = rig_.vessel_effects.wall_creep;
    if (law.growth_per_Pa != 0.0) grown_ = law.grown(grown_, h, p - air_.atmosphere_Pa);
  }
  static constexpr double face_m2 = 0.5;
  /// A chamber that does not move: its wall is twice its face, 1 m2, so that the coefficient is the conductance.
  static ChamberGeometry<double> geometry_of(const Rig& rig, double gas_kg, const Air<double>& air) noexcept {
    const ChargingHeat<double>& charging = rig.vessel_effects.charging_heat;
    double conductance = rig.vessel.wall_heat_W_per_K + rig.vessel_effects.wall_heat_exchange.conductance_W_per_K;
    if (charging.excess_K != 0.0) conductance += gas_kg * air.cv / charging.time_constant_s;
    return {face_m2, rig.vessel.volume_m3, conductance};
  }
  ChamberInflow<double> leak(const Chamber<double>& chamber) const noexcept {
    const double flow = vessel_leak_flow(rig_.vessel_effects, air_, rig_.on_off_valve.critical_pressure_ratio,
                                         chamber.pressure(), chamber.temperature());
    return {-flow, -orifice_enthalpy_flow(air_, flow, chamber.temperature(), air_.temperature_K)};
  }

  const Rig& rig_;
  Air<double> air_;
  LineWithChamber<double> side_;
  Chamber<double> chamber_;
  double grown_ = 0;  ///< share of the volume
};

}  // namespace pneuservo
