// A line and the chamber at its end, stepped together: the pneumatic side that plant, estimator and diagnosis share.
#pragma once
#include <pneuservo/elements/chamber.hpp>
#include <pneuservo/elements/lagged_line.hpp>
#include <pneuservo/elements/wide_line.hpp>

namespace pneuservo {

/// Default cell count: cells_per_m cells a metre, at least one; the longest lane decides.
template <class S> int cell_count(const S& length_m, double cells_per_m) noexcept {
  return std::max(1, static_cast<int>(std::lround(largest(length_m) * cells_per_m)));
}

/// The line's ends first, then the chamber, last the gas inside the line, in the same sub-step: what waits for the
/// chamber need not wait for the line. Behind a valve the line is what its `model` says; with a
/// prescribed port pressure it is always the distributed one. `s` is the piston's distance from this chamber's end stop
/// [m].
template <class S> class LineWithChamber {
 public:
  void configure(const LineParameters<S>& line, const ChamberGeometry<S>& geometry, const AirParameters<S>& air,
                 int cells) {
    line_.configure(line, air, cells);
    chamber_.configure(geometry, line_.air());
    lags_ = line.model == LineModel::second_order_lag;
    is_linear_ = lags_ && any(geometry.linear_pressure_Pa > S(0));
    if (lags_) lagged_.configure(line, air, geometry.linear_pressure_Pa);
    substeps_ = 0;
    end_loss_Pa_ = S(0), loses_at_end_ = false;
    // A small chamber behind a big cell is the stiffest spring of the grid; it is smallest at the end stop.
    const S dx = line_.cell_length();
    const S g = square_root(maximum(S(1), S(0.5) * (S(1) + line_.cross_section() * dx / geometry.dead_volume_m3)));
    // Sound speed at 1.2 times ambient temperature: compression warms the gas by up to that.
    sound_mps_ = largest(square_root(line_.air().kappa * line_.air().R * S(1.2) * line_.air().temperature_K));
    stiffness_per_m_ = largest(g / dx);
  }
  /// Everything at rest at one pressure and temperature.
  void reset(const S& pressure_Pa, const S& temperature_K, const S& s) noexcept {
    line_.reset(pressure_Pa, temperature_K);
    lagged_.reset();
    chamber_.reset(pressure_Pa, temperature_K, s);
  }
  /// Chooses the sub-steps of the coming period, Courant number 0.9 of sound plus flow, and returns their number.
  int begin_period(double period_s) noexcept {
    const int n = fixed_substeps_ > 0 ? fixed_substeps_ : needed_substeps(period_s, line_.largest_speed());
    if (n != substeps_ || period_s != period_s_) {
      substeps_ = n;
      period_s_ = period_s;
      step_s_ = period_s / n;
      line_.set_time_step(step_s_);
      if (lags_) lagged_.set_time_step(step_s_);
    }
    return n;
  }
  double step_s() const noexcept { return step_s_; }
  /// Sub-steps for a flow of up to flow_mps.
  int needed_substeps(double period_s, double flow_mps) const noexcept {
    // Nearly always one sub-step, so that case needs no rounding.
    const double need = lags_ ? period_s / lagged_.longest_step_s()
                              : (sound_mps_ + flow_mps) * (stiffness_per_m_ * period_s * (1.0 / 0.9));
    return need <= 1.0 ? 1 : std::clamp(static_cast<int>(std::ceil(need)), 1, 1000);
  }
  /// Speed of sound that the sub-steps reckon with.
  double sound_mps() const noexcept { return sound_mps_; }
  /// This many sub-steps in every period; 0: as many as are needed.
  void fix_substeps(int substeps) noexcept { fixed_substeps_ = substeps; }
  /// Multiplies the pressure and the temperature of all gas; its mass follows.
  void scale_gas(const S& pressure, const S& temperature) noexcept {
    line_.scale_gas(pressure, temperature);
    chamber_.scale_gas(pressure, temperature);
  }

  /// One sub-step with the port pressure of its middle; returns the flows of the line's ends.
  LineFlow<S> step_prescribed(const S& port_pressure_Pa, const S& s_new, const ChamberInflow<S>& extra = {}) noexcept {
    if (line_.is_cushioned()) line_.set_piston_distance(s_new);
    const LineFlow<S> flow = line_.advance_ends_prescribed(port_pressure_Pa, end());
    step_chamber(flow, s_new, extra);
    line_.advance_inside();
    return flow;
  }
  /// One sub-step with a valve at the port.
  LineFlow<S> step_valve(const ValvePort<S>& valve, const S& s_new, const ChamberInflow<S>& extra = {}) noexcept {
    if (lags_) return step_lagged(valve, s_new, extra);
    if (line_.is_cushioned()) line_.set_piston_distance(s_new);
    const LineFlow<S> flow = line_.advance_ends_valve(valve, end());
    step_chamber(flow, s_new, extra);
    line_.advance_inside();
    return flow;
  }
  /// Pressure at the valve port, of the last sub-step.
  S port_pressure() const noexcept { return lags_ ? chamber_.pressure() : line_.port_pressure(); }

  /// Pressure that is lost from the line's end to the chamber from here on [Pa].
  void set_end_loss(const S& loss_Pa) noexcept {
    end_loss_Pa_ = loss_Pa;
    loses_at_end_ = true;
  }

  Line<S>& line() noexcept { return line_; }
  const Line<S>& line() const noexcept { return line_; }
  Chamber<S>& chamber() noexcept { return chamber_; }
  const Chamber<S>& chamber() const noexcept { return chamber_; }

 private:
  ChamberEnd<S> end() const noexcept {
    const S p = chamber_.pressure();
    return {loses_at_end_ ? p + end_loss_Pa_ : p, chamber_.temperature()};
  }
  void step_chamber(const LineFlow<S>& flow, const S& s_new, const ChamberInflow<S>& extra) noexcept {
    chamber_.step(
        step_s_,
        {flow.chamber_mass_flow_kgps + extra.mass_flow_kgps, flow.chamber_enthalpy_flow_W + extra.enthalpy_flow_W},
        s_new);
  }
  // Out of the way of the distributed line, whose port and inflow stay in registers: here they are copies.
  [[gnu::noinline]] LineFlow<S> step_lagged(ValvePort<S> valve, S s_new, ChamberInflow<S> extra) noexcept {
    if (!is_linear_) {
      const LineFlow<S> flow = lagged_.step_valve(valve, end());
      step_chamber(flow, s_new, extra);
      return flow;
    }
    const S flow = lagged_.step_linear(valve);
    chamber_.step_linear(step_s_, flow + extra.mass_flow_kgps, s_new);
    return {flow, flow, orifice_enthalpy_flow(line_.air(), flow, chamber_.temperature(), chamber_.temperature())};
  }
  Line<S> line_;
  LaggedLine<S> lagged_;
  bool lags_ = false, is_linear_ = false;
  Chamber<S> chamber_;
  S end_loss_Pa_{};
  bool loses_at_end_ = false;
  int substeps_ = 0, fixed_substeps_ = 0;
  double period_s_ = 0.0, step_s_ = 1e-3;
  double sound_mps_ = 343.0, stiffness_per_m_ = 1.0;
};

}  // namespace pneuservo
