// The simulated cylinder that an on/off valve sends from end to end: chambers behind flow control valves, slider, end
// cushions (docs/physics/switched_rigs.md).
#pragma once
#include <algorithm>

#include <pneuservo/elements/chamber.hpp>
#include <pneuservo/elements/cushion.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/slider.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// End stops do not rebound. Delays of the command and effects of sensors are not in it.
class SwitchedCylinderPlant {
 public:
  /// At rest at a position [m] under a command that has been given for long. Keeps the rig by reference.
  SwitchedCylinderPlant(const Rig& rig, double position_m, double command) noexcept : rig_(rig), air_(rig.axis.air) {
    const CylinderParameters<double>& c = rig.axis.cylinder;
    half_stroke_m_ = 0.5 * c.stroke_m;
    chamber_1_.configure({c.area_1_m2, c.dead_volume_1_m3, c.wall_heat_W_per_m2K}, air_);
    chamber_2_.configure({c.area_2_m2, c.dead_volume_2_m3, c.wall_heat_W_per_m2K}, air_);
    slider_.configure(rig.axis.slider, rig.axis.effects.motion, c.stroke_m, 0.0);
    slider_.reset(std::clamp(position_m, -half_stroke_m_, half_stroke_m_), 0.0);
    const double filled = rig.axis.supply.pressure_Pa, empty = air_.atmosphere_Pa;
    chamber_1_.reset(command > 0 ? filled : empty, air_.temperature_K, half_stroke_m_ + slider_.position());
    chamber_2_.reset(command < 0 ? filled : empty, air_.temperature_K, half_stroke_m_ - slider_.position());
  }
  /// Goes on by h [s] under a command: above 0 chamber 1 is fed and chamber 2 exhausts, below 0 the other way round, at
  /// 0 both are shut.
  void step(double h, double command) noexcept {
    const CylinderParameters<double>& c = rig_.axis.cylinder;
    const AxisEffects<double>& effects = rig_.axis.effects;
    const double p1 = chamber_1_.pressure(), p2 = chamber_2_.pressure(), atmosphere = air_.atmosphere_Pa;
    ChamberInflow<double> in_1 = inflow(chamber_1_, rig_.throttle_1, command, effects.chamber_leak_1.area_m2);
    ChamberInflow<double> in_2 = inflow(chamber_2_, rig_.throttle_2, -command, effects.chamber_leak_2.area_m2);
    const double T1 = chamber_1_.temperature(), T2 = chamber_2_.temperature();
    const double across =
        orifice_mass_flow(air_, effects.piston_leak.area_m2, rig_.cylinder_critical_ratio, p1, T1, p2, T2);
    const double carried = orifice_enthalpy_flow(air_, across, T1, T2);
    in_1.mass_flow_kgps -= across, in_1.enthalpy_flow_W -= carried;
    in_2.mass_flow_kgps += across, in_2.enthalpy_flow_W += carried;
    const double drive = c.area_1_m2 * (p1 - atmosphere) - c.area_2_m2 * (p2 - atmosphere) - cushion_forces(h);
    slider_.step(h, drive, {std::max(p1 - atmosphere, 0.0) + std::max(p2 - atmosphere, 0.0)});
    chamber_1_.step(h, in_1, half_stroke_m_ + slider_.position());
    chamber_2_.step(h, in_2, half_stroke_m_ - slider_.position());
  }
  double position_m() const noexcept { return slider_.position(); }
  double velocity_mps() const noexcept { return slider_.velocity(); }
  double chamber_1_Pa() const noexcept { return chamber_1_.pressure(); }
  double chamber_2_Pa() const noexcept { return chamber_2_.pressure(); }

 private:
  /// From the supply (command above 0) or to atmosphere (below) through valve and flow control valve.
  ChamberInflow<double> inflow(const Chamber<double>& chamber, const ThrottleParameters& throttle, double command,
                               double leak_area) const noexcept {
    const double b = rig_.cylinder_critical_ratio, p = chamber.pressure(), T = chamber.temperature();
    const double T_air = air_.temperature_K, atmosphere = air_.atmosphere_Pa;
    const double in = orifice_mass_flow(air_, command > 0 ? throttle.inflow_area_m2 : 0.0, b,
                                        rig_.axis.supply.pressure_Pa, T_air, p, T);
    const double out =
        orifice_mass_flow(air_, (command < 0 ? throttle.outflow_area_m2 : 0.0) + leak_area, b, p, T, atmosphere, T_air);
    return {in - out, orifice_enthalpy_flow(air_, in, T_air, T) - orifice_enthalpy_flow(air_, out, T, T_air)};
  }
  /// Of both ends, against positive x.
  double cushion_forces(double h) const noexcept {
    const double x = slider_.position(), v = slider_.velocity(), mass = slider_.mass();
    return cushion_force(rig_.cushion_2, half_stroke_m_ - x, v, mass, h) -
           cushion_force(rig_.cushion_1, x + half_stroke_m_, -v, mass, h);
  }

  const Rig& rig_;
  Air<double> air_;
  double half_stroke_m_ = 0;
  Chamber<double> chamber_1_, chamber_2_;
  Slider<double> slider_;
};

}  // namespace pneuservo
