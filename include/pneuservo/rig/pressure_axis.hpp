// A pressure rig on the elements of an axis: its hose and volume are side 1, side 2 does what side 1 does.
#pragma once
#include <algorithm>

#include <pneuservo/elements/elastic_volume.hpp>
#include <pneuservo/rig/plant.hpp>
#include <pneuservo/rig/possible_values.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// The volume is a chamber between two walls of half a square metre, so that the conductance of its wall is the
/// chamber's coefficient; its growth is the way of a piston that nothing else moves. What follows from the rig's own
/// numbers is set anew here after each change of them. Does nothing to other kinds of rig.
inline void lay_out_pressure_axis(Rig& rig) {
  if (!rig.controls_pressure()) return;
  constexpr double wall_m2 = 0.5;
  // A stroke is above 0; it changes no rigid volume, whose piston stays at its end.
  constexpr double least_way_m = 1e-6;
  AxisParameters<double>& axis = rig.axis;
  axis.line_2 = axis.line_1;
  if (axis.valve.on_off) axis.valve.area_per_volt_m2_per_V = axis.valve.area_max_m2 / axis.valve.command_max_V;
  auto& chamber = axis.cylinder;
  chamber.area_1_m2 = chamber.area_2_m2 = wall_m2;
  chamber.dead_volume_1_m3 = chamber.dead_volume_2_m3 = rig.volume.volume_m3;
  chamber.wall_heat_W_per_m2K = rig.volume.wall_heat_W_per_K;
  const double most_m3 = rig.volume.growth_m3(possible_pressure_Pa(rig).highest, axis.air.atmosphere_Pa);
  chamber.stroke_m = std::max(most_m3 / wall_m2, least_way_m);
  axis.slider.mass_kg = 1.0;
  rig.initial.pressure_2_Pa = rig.initial.pressure_1_Pa;
  rig.initial.position_m =
      rig.volume.growth_m3(rig.initial.pressure_1_Pa, axis.air.atmosphere_Pa) / wall_m2 - 0.5 * chamber.stroke_m;
}

/// How far the volume of a pressure rig has grown, as the place of the piston that stands for it. HOT but configure.
class VolumeGrowth {
 public:
  void configure(const Rig& rig) noexcept {
    volume_ = rig.volume;
    air_ = Air<double>(rig.axis.air);
    wall_m2_ = rig.axis.cylinder.area_1_m2;
    half_way_m_ = 0.5 * rig.axis.cylinder.stroke_m;
    period_s_ = rig.period_s;
    reset(rig.initial.pressure_1_Pa);
  }
  /// At rest at a pressure.
  void reset(double p_Pa) noexcept { grown_m3_ = volume_.growth_m3(p_Pa, air_.atmosphere_Pa); }
  /// One period on, from the volume's gas at its start.
  void step(double p_Pa, double temperature_K, double inflow_kgps) noexcept {
    grown_m3_ = elastic_growth(volume_, air_, period_s_, grown_m3_, p_Pa, temperature_K, inflow_kgps);
    grown_m3_ = std::min(grown_m3_, 2.0 * half_way_m_ * wall_m2_);
  }
  double position_m() const noexcept { return grown_m3_ / wall_m2_ - half_way_m_; }

 private:
  ElasticVolumeParameters<double> volume_;
  Air<double> air_;
  double wall_m2_ = 0.5, half_way_m_ = 0.0, period_s_ = 1e-3, grown_m3_ = 0.0;
};

/// One period of the plant of a pressure rig under its valve's command. HOT.
inline void step_pressure_plant(AxisPlant<double>& plant, VolumeGrowth& growth, double command_V) noexcept {
  growth.step(low(plant.chamber_pressure()), low(plant.sides().chamber().temperature()),
              low(plant.flow().chamber_mass_flow_kgps));
  plant.step_led(command_V, command_V, growth.position_m());
}

}  // namespace pneuservo
