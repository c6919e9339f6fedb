// Lines and chambers driven by measured port pressures and position: the model part of the estimator, on any lanes.
#pragma once
#include <cstdint>

#include <pneuservo/core/pack.hpp>
#include <pneuservo/elements/line_with_chamber.hpp>

namespace pneuservo {

/// Each lane is one side of an axis: its line, its chamber, its port pressure. Explicit and of fixed structure: a tick
/// costs nearly the same whatever the gas does (flow near sound speed is mended in a second pass). docs/physics/line.md
/// has the scheme.
template <class S> class AxisEstimator {
 public:
  /// Allocates. half_stroke_m: the piston is at distance half_stroke + sign x from the end stop, sign +1 for side 1.
  /// extrapolates: all is computed with steps half as long, too; the error of first order in the step cancels.
  void configure(const LineParameters<S>& line, const ChamberGeometry<S>& geometry, const AirParameters<S>& air,
                 const S& half_stroke_m, const S& sign, double period_s, int cells, bool extrapolates = false) {
    side_.configure(line, geometry, air, cells);
    extrapolates_ = extrapolates;
    if (extrapolates) finer_.configure(line, geometry, air, cells);
    half_stroke_ = half_stroke_m;
    sign_ = sign;
    period_s_ = period_s;
    ambient_ = air.temperature_K;
  }
  void set_effects(const LineEffects<S>& effects) noexcept {
    side_.line().set_effects(effects);
    if (extrapolates_) finer_.line().set_effects(effects);
  }
  /// Gas at rest at the port pressures: what is known when nothing is known.
  void reset(const S& port_pressure_Pa, double position_m) noexcept {
    side_.reset(port_pressure_Pa, ambient_, distance(position_m));
    if (extrapolates_) finer_.reset(port_pressure_Pa, ambient_, distance(position_m));
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
    const ChamberInflow<S> extra{correction_kgps + leaks.mass_flow_kgps,
                                 correction_kgps * side_.line().air().cv * chamber_temperature() +
                                     leaks.enthalpy_flow_W};
    flow_ = advance(side_, n, port_pressure_Pa, position_m, extra);
    if (extrapolates_) advance_finer(2 * n, port_pressure_Pa, position_m, extra);
    port_ = port_pressure_Pa;
    position_ = position_m;
  }

  S chamber_pressure() const noexcept { return told(side_.chamber().pressure(), finer_.chamber().pressure()); }
  S chamber_temperature() const noexcept { return told(side_.chamber().temperature(), finer_.chamber().temperature()); }
  const LineFlow<S>& flow() const noexcept { return flow_; }
  const LineWithChamber<S>& side() const noexcept { return side_; }
  /// How often a line has limited a speed or a temperature.
  std::int64_t guard_actions() const noexcept {
    return side_.line().guard_actions() + (extrapolates_ ? finer_.line().guard_actions() : 0);
  }

 private:
  // Richardson's extrapolation to a step of nothing.
  static S beyond(const S& coarse, const S& finer) noexcept { return finer + (finer - coarse); }
  // What cannot be negative goes no further than half the way to nothing, where guards hold one of both.
  S told(const S& coarse, const S& finer) const noexcept {
    return extrapolates_ ? maximum(beyond(coarse, finer), S(0.5) * finer) : coarse;
  }
  [[gnu::always_inline]] LineFlow<S> advance(LineWithChamber<S>& side, int n, const S& port_pressure_Pa,
                                             double position_m, const ChamberInflow<S>& extra) noexcept {
    const S rise = port_pressure_Pa - port_;
    const double way = position_m - position_;
    LineFlow<S> flow{};
    for (int i = 0; i < n; ++i) {
      const double middle = (i + 0.5) / n, end = static_cast<double>(i + 1) / n;
      flow = side.step_prescribed(port_ + S(middle) * rise, distance(position_ + end * way), extra);
    }
    return flow;
  }
  // Out of the way of the line that is not extrapolated.
  [[gnu::noinline]] void advance_finer(int n, const S& port_pressure_Pa, double position_m,
                                       const ChamberInflow<S>& extra) noexcept {
    finer_.fix_substeps(n);
    finer_.begin_period(period_s_);
    const LineFlow<S> finer = advance(finer_, n, port_pressure_Pa, position_m, extra);
    flow_ = {beyond(flow_.port_mass_flow_kgps, finer.port_mass_flow_kgps),
             beyond(flow_.chamber_mass_flow_kgps, finer.chamber_mass_flow_kgps),
             beyond(flow_.chamber_enthalpy_flow_W, finer.chamber_enthalpy_flow_W)};
  }
  S distance(double x) const noexcept { return maximum(half_stroke_ + sign_ * S(x), S(0)); }
  LineWithChamber<S> side_, finer_;  // finer_: with half the step, where it extrapolates
  bool extrapolates_ = false;
  S half_stroke_{}, sign_{}, ambient_{}, port_{};
  double position_ = 0.0, period_s_ = 1e-3;
  LineFlow<S> flow_{};
};

}  // namespace pneuservo
