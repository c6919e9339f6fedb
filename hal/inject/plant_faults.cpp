// Injected faults of the machine itself.
#include "inject/plant_faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "config/rig_parameters.hpp"

namespace pneuservo {

PlantFaults::PlantFaults(const Rig& rig) : rig_(simulated_rig(rig)) {}

void PlantFaults::apply(double t_s, SimBackend& plant) noexcept {
  double supply_Pa = rig_.axis.supply.pressure_Pa;
  std::array<double, 2> leak_m2{rig_.axis.effects.chamber_leak_1.area_m2, rig_.axis.effects.chamber_leak_2.area_m2};
  bool any = false;
  for (const InjectedFault& fault : faults_) {
    if (!fault.is_on(t_s) || !fault.value) continue;
    if (fault.kind == InjectedKind::supply_loss) supply_Pa = *fault.value, any = true;
    if (fault.kind == InjectedKind::leak) leak_m2[fault.target == "2" ? 1 : 0] += *fault.value, any = true;
  }
  if (any || changed_) plant.set_machine(supply_Pa, leak_m2);
  changed_ = any;
  apply_to_slider(t_s, plant);
}

void PlantFaults::apply_to_slider(double t_s, SimBackend& plant) noexcept {
  SliderParameters<double> slider = rig_.axis.slider;
  MotionEffects<double> effects = rig_.axis.effects.motion;
  double way_m = rig_.axis.cylinder.stroke_m;
  bool any = false;
  for (const InjectedFault& fault : faults_) {
    if (!fault.is_on(t_s) || !fault.value) continue;
    switch (fault.kind) {
      case InjectedKind::payload: slider.payload_kg += *fault.value; break;
      case InjectedKind::dry_friction: effects.coulomb_friction.force_N += *fault.value; break;
      case InjectedKind::jam: slider.viscous_friction_Ns_per_m += *fault.value; break;
      case InjectedKind::obstacle:
        // A stop cannot come into being beyond the slider: it would throw it back.
        between_stops_ = between_stops_ || std::fabs(plant.truth().x_m) < *fault.value;
        if (!between_stops_) continue;
        way_m = std::min(way_m, 2.0 * *fault.value);
        break;
      default: continue;
    }
    any = true;
  }
  if (any || slider_changed_) plant.set_slider(slider, effects, way_m);
  slider_changed_ = any;
}

Command PlantFaults::command(double t_s, const Command& asked) noexcept {
  Command given = asked;
  for (const InjectedFault& fault : faults_) {
    if (!fault.is_on(t_s)) continue;
    if (fault.kind == InjectedKind::stuck_valve) {
      if (fault.value) last_.valve_V = *fault.value, last_.valve_2_V = -*fault.value;
      return last_;
    }
    const bool pair = rig_.valves() == 2;
    if (fault.kind == InjectedKind::exchanged_hoses && pair) std::swap(given.valve_V, given.valve_2_V);
    else if (fault.kind == InjectedKind::exchanged_hoses || fault.kind == InjectedKind::reversed_valve)
      given.valve_V = -given.valve_V, given.valve_2_V = -given.valve_2_V;
  }
  return last_ = given;
}

}  // namespace pneuservo
