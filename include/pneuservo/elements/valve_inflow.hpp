// Air that the valves give both sides in a period, by their own law, from commands and measured pressures.
#pragma once
#include <array>

#include <pneuservo/elements/air.hpp>
#include <pneuservo/elements/valve_port.hpp>
#include <pneuservo/elements/valves.hpp>

namespace pneuservo {

/// Mean over the period that ends now: the command was held, the port pressures went from the last samples to these.
/// HOT but configure, which allocates the valves' delay lines.
class ValveInflow {
 public:
  using Two = Pack<double, 2>;

  void configure(const AirParameters<double>& air, ValveArrangement arrangement, const ValveParameters<double>& valve,
                 const ValveEffects<double>& effects, double period_s) {
    air_ = Air<Two>(cast<AirParameters<Two>>(air));
    port_ = PortConstants<Two>(air_, Two(valve.critical_pressure_ratio));
    valves_.configure(arrangement, valve, effects, period_s);
    valves_.set_time_step(period_s);
    reset();
  }
  void reset() noexcept {
    valves_.reset(0.0);
    started_ = false;
  }
  /// [kg/s] into each side.
  Two step(const std::array<double, 2>& command_V, const std::array<double, 2>& port_Pa, double supply_Pa) noexcept {
    const Two now = join(port_Pa[0], port_Pa[1]);
    if (!started_) port_Pa_ = now;
    started_ = true;
    valves_.set_commands(command_V[0], command_V[1]);
    const PortAreas<Two> areas = valves_.step(0.0);
    const Two middle = Two(0.5) * (now + port_Pa_);
    port_Pa_ = now;
    return valve_port_inflow(port_, air_, {areas.supply, areas.exhaust, Two(supply_Pa), port_.shape.critical}, middle);
  }

 private:
  Air<Two> air_;
  PortConstants<Two> port_;
  Valves<double> valves_;
  Two port_Pa_{};
  bool started_ = false;
};

}  // namespace pneuservo
