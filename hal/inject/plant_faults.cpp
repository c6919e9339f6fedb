// Injected faults of the machine itself.
#include "inject/plant_faults.hpp"

#include <array>

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
}

Command PlantFaults::command(double t_s, const Command& asked) noexcept {
  for (const InjectedFault& fault : faults_) {
    if (fault.kind != InjectedKind::stuck_valve || !fault.is_on(t_s)) continue;
    if (fault.value) last_.valve_V = *fault.value, last_.valve_2_V = -*fault.value;
    return last_;
  }
  return last_ = asked;
}

}  // namespace pneuservo
