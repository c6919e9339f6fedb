// A whole sub-step of a line from its two parts, for who has no chamber that steps between them.
#pragma once
#include <pneuservo/elements/line_ends.hpp>
#include <pneuservo/elements/valve_port.hpp>

namespace pneuservo {

/// Base of a line on scalar S, which has both parts as members: first the ends (`advance_ends_prescribed`,
/// `advance_ends_valve`), whose flows are all that valve and chamber want of the step, then the gas between them
/// (`advance_inside`). What is computed from the flows in between runs beside the second part.
template <class Line, class S> class LineSteps {
 public:
  /// One sub-step with the port pressure prescribed (middle of the sub-step): the estimator's boundary.
  /// Gas that enters at the port has the stagnation temperature of the supply.
  LineFlow<S> step_prescribed(const S& port_pressure_Pa, const ChamberEnd<S>& chamber) noexcept {
    return finished(line().advance_ends_prescribed(port_pressure_Pa, chamber));
  }
  /// One sub-step with a valve at the port: the port pressure follows from orifice and line together. The orifice's own
  /// flow is booked, so that valve and line agree in mass to rounding.
  LineFlow<S> step_valve(const ValvePort<S>& valve, const ChamberEnd<S>& chamber) noexcept {
    return finished(line().advance_ends_valve(valve, chamber));
  }

 private:
  Line& line() noexcept { return static_cast<Line&>(*this); }
  LineFlow<S> finished(const LineFlow<S>& flow) noexcept {
    line().advance_inside();
    return flow;
  }
};

}  // namespace pneuservo
