// Lines and chambers driven by measured port pressures and position: the model part of the estimator, on any lanes.
#pragma once
#include <pneuservo/core/pack.hpp>
#include <pneuservo/elements/line_with_chamber.hpp>

namespace pneuservo {

/// Each lane is one side of an axis: its line, its chamber, its port pressure. Explicit and of fixed structure: a tick
/// costs nearly the same whatever the gas does (flow near sound speed is mended in a second pass). docs/physics/line.md
/// has the scheme.
template <class S> class AxisEstimator {
 public:
  /// Allocates. half_stroke_m: the piston is at distance half_stroke + sign x from the end stop, sign +1 for side 1.
  void configure(const LineParameters<S>& line, const ChamberGeometry<S>& geometry, const AirParameters<S>& air,
                 const S& half_stroke_m, const S& sign, double period_s, int cells) {
    side_.configure(line, geometry, air, cells);
    half_stroke_ = half_stroke_m;
    sign_ = sign;
    period_s_ = period_s;
    ambient_ = air.temperature_K;
  }
  /// Gas at rest at the port pressures: what is known when nothing is known.
  void reset(const S& port_pressure_Pa, double position_m) noexcept {
    side_.reset(port_pressure_Pa, ambient_, distance(position_m));
    port_ = port_pressure_Pa;
    position_ = position_m;
    flow_ = LineFlow<S>{};
  }
  /// From the last tick to this one; port pressure and position are linear between. The port pressure acts at the
  /// middle of each sub-step: the leapfrog's velocities live there. correction_kgps: gas that an observer adds to the
  /// chambers at their temperature; leaks: what else flows into them.
  void step(const S& port_pressure_Pa, double position_m, const S& correction_kgps = S(0),
            const ChamberInflow<S>& leaks = {}) noexcept {
    const int n = side_.begin_period(period_s_);
    const S rise = port_pressure_Pa - port_;
    const double way = position_m - position_;
    const ChamberInflow<S> extra{correction_kgps + leaks.mass_flow_kgps,
                                 correction_kgps * side_.line().air().cv * chamber_temperature() +
                                     leaks.enthalpy_flow_W};
    for (int i = 0; i < n; ++i) {
      const double middle = (i + 0.5) / n, end = static_cast<double>(i + 1) / n;
      flow_ = side_.step_prescribed(port_ + S(middle) * rise, distance(position_ + end * way), extra);
    }
    port_ = port_pressure_Pa;
    position_ = position_m;
  }

  S chamber_pressure() const noexcept { return side_.chamber().pressure(); }
  S chamber_temperature() const noexcept { return side_.chamber().temperature(); }
  const LineFlow<S>& flow() const noexcept { return flow_; }
  const LineWithChamber<S>& side() const noexcept { return side_; }
  LineWithChamber<S>& side() noexcept { return side_; }

 private:
  S distance(double x) const noexcept { return maximum(half_stroke_ + sign_ * S(x), S(0)); }
  LineWithChamber<S> side_;
  S half_stroke_{}, sign_{}, ambient_{}, port_{};
  double position_ = 0.0, period_s_ = 1e-3;
  LineFlow<S> flow_{};
};

}  // namespace pneuservo
