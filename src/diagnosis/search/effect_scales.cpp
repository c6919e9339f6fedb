// What sizes of effects are measured in, as numbers of a rig and its recordings.
#include "diagnosis/search/effect_scales.hpp"

#include <algorithm>
#include <cmath>

namespace pneuservo {

namespace {

constexpr double slowest_mps = 1e-5;   ///< top speed of a recording that stands
constexpr double free_convection = 25;  ///< W/(m2 K) between gas and wall, at most; on the faces of a cube

}  // namespace

/// A usual one where the config has none: recordings with pressures need no supply.
double ScaleTable::supply_Pa() const { return rig.axis.supply.pressure_Pa > 0 ? rig.axis.supply.pressure_Pa : 6e5; }

double ScaleTable::gauge_supply_Pa() const { return std::max(supply_Pa() - rig.axis.air.atmosphere_Pa, 1e4); }

double ScaleTable::force_N() const {
  return rig.kind == RigKind::driven_axis ? rig.drive.force_max_N : rig.axis.cylinder.area_1_m2 * gauge_supply_Pa();
}

double ScaleTable::valve_area_m2() const {
  if (rig.is_pneumatic()) return rig.axis.valve.area_max_m2;
  if (rig.kind == RigKind::switched_cylinder) return rig.throttle_1.inflow_area_m2;
  return 5e-3 * rig.vessel.volume_m3;  // empties the vessel within about a second, whatever its size
}

/// T (1 - (p_atm/p)^((kappa - 1)/kappa)), more than filling warms: T (kappa/(1 + (kappa - 1) p_atm/p) - 1). Gas that
/// nothing has charged is as warm as its wall.
double ScaleTable::adiabatic_change_K() const {
  const AirParameters<double>& air = rig.axis.air;
  const double first_Pa = range.first_Pa > 0 ? range.first_Pa : air.atmosphere_Pa + gauge_supply_Pa();
  const double ratio = std::min(air.atmosphere_Pa / first_Pa, 1.0);
  return air.temperature_K * (1 - std::pow(ratio, 1 - 1 / air.heat_capacity_ratio));
}

double ScaleTable::supply_resistance_Pa_s_per_kg() const {
  const AirParameters<double>& air = rig.axis.air;
  return 10 * air.gas_constant_J_per_kgK * air.temperature_K / rig.vessel.volume_m3;
}

double ScaleTable::top_speed_mps() const { return std::max(range.top_speed_mps, slowest_mps); }

double ScaleTable::channel_offset() const {
  if (channel == "x") return 2 * half_stroke_m();
  if (channel == "supply_flow") return open_flow_kgps();
  return channel == "F" ? force_N() : supply_Pa();
}

double ScaleTable::open_flow_kgps() const {
  const Air<double> air(rig.axis.air);
  return air.flow_constant * valve_area_m2() * supply_Pa() / std::sqrt(air.R * air.temperature_K);
}

double ScaleTable::operator()(EffectScale scale) const {
  switch (scale) {
    case EffectScale::one: return 1;
    case EffectScale::force: return force_N();
    case EffectScale::force_per_pressure: return force_N() / gauge_supply_Pa();
    case EffectScale::force_per_speed: return force_N() / top_speed_mps();
    case EffectScale::drag: return force_N() / (top_speed_mps() * top_speed_mps());
    case EffectScale::stiffness: return force_N() / half_stroke_m();
    case EffectScale::valve_area: return valve_area_m2();
    case EffectScale::valve_area_per_pressure: return valve_area_m2() / gauge_supply_Pa();
    case EffectScale::inverse_valve_area: return 1 / (valve_area_m2() * valve_area_m2());
    case EffectScale::inverse_bore_area: return std::pow(line().section_m2(), -2);
    case EffectScale::wall_heat: return free_convection * 6 * std::cbrt(std::pow(rig.vessel.volume_m3, 2));
    case EffectScale::laminar_conductance: return open_flow_kgps() / (supply_Pa() * supply_Pa());
    case EffectScale::moving_mass: return rig.axis.slider.mass_kg + rig.axis.slider.payload_kg;
    case EffectScale::top_speed: return top_speed_mps();
    case EffectScale::half_stroke: return half_stroke_m();
    case EffectScale::line_volume: return line().volume_m3();
    case EffectScale::channel_offset: return channel_offset();
    case EffectScale::viscosity: return rig.axis.slider.viscous_friction_Ns_per_m;
    case EffectScale::adiabatic_change: return adiabatic_change_K();
    case EffectScale::supply_resistance: return supply_resistance_Pa_s_per_kg();
    case EffectScale::supply_pressure: return supply_Pa();
    case EffectScale::stroke: return rig.axis.cylinder.stroke_m;
    case EffectScale::duration: return std::max(range.duration_s, 1.0);  // some time, where no row is compared
    case EffectScale::channel_gain: return channel == "x" || channel == "F" ? 1 : 0.6;
  }
  return 1;
}

}  // namespace pneuservo
