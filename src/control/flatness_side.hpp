// Inverse of one side of the servo table: from the motion of chamber pressure and piston back to the flow at the valve.
#pragma once
#include <vector>

#include <pneuservo/elements/air.hpp>
#include <pneuservo/elements/chamber.hpp>
#include <pneuservo/elements/parameters.hpp>
#include <pneuservo/elements/pipe_friction.hpp>

#include "control/smoothing_differentiator.hpp"

namespace pneuservo {

/// What a side shall do, on the fine grid of the plan; it starts at rest.
struct SideMotion {
  std::vector<double> pressure_Pa, pressure_rate_Paps;  ///< of the chamber
  std::vector<double> distance_m, speed_mps;  ///< of the piston from this chamber's end stop

  explicit SideMotion(std::size_t n) : pressure_Pa(n), pressure_rate_Paps(n), distance_m(n), speed_mps(n) {}
};

/// What the valve has to do for it.
struct PortMotion {
  std::vector<double> flow_kgps;  ///< into the line
  std::vector<double> pressure_Pa;  ///< at the port
  std::vector<double> temperature_K;  ///< of what would leave through the valve
};

/// Chamber and line, run forward in time (gas and wall heat are stable that way) and from the chamber to the valve.
class FlatnessSide {
 public:
  /// `rate` takes the time derivatives, on rows of step_s.
  FlatnessSide(const AirParameters<double>& air, const LineParameters<double>& line,
               const ChamberGeometry<double>& chamber, int cells, double step_s, SmoothingDifferentiator rate);
  /// `passes` over the line: a pass carries the temperature of what flows one cell further.
  PortMotion invert(const SideMotion& motion, int passes) const;

 private:
  using Row = std::vector<double>;
  /// Gas behind a face: what flows through the face towards the chamber, and the state on the chamber's side.
  struct Gas {
    Row flow, pressure, pressure_rate, temperature;
  };
  Gas chamber_gas(const SideMotion& motion, const Row& line_K) const;
  Row pressure_across(const Gas& gas, const Row& beyond_K, double distance_m) const;
  Gas cell_gas(const Gas& gas, Row pressure, const Row& beyond_K, const Row& flow_before) const;
  PortMotion through_line(Gas gas, std::vector<Row>& cell_K, std::vector<Row>& flow_before) const;
  PortMotion through_lag(const Gas& gas) const;

  Air<double> air_;
  LineParameters<double> line_;
  ChamberGeometry<double> chamber_;
  PipeFriction<double> friction_;
  SmoothingDifferentiator rate_;
  int cells_;
  double step_s_, section_m2_, cell_m_, cell_m3_;
};

}  // namespace pneuservo
