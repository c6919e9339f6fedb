// A line as a lag of second order between the valve's flow and the chamber's (thesis 2.18).
#pragma once
#include <pneuservo/elements/line.hpp>
#include <pneuservo/elements/second_order_filter.hpp>

namespace pneuservo {

/// G_chamber/G_valve = w^2/(s^2 + 2 zeta w s + w^2): no pressure drop and no volume. The port has the chamber's
/// pressure, and what leaves through the valve its temperature; what enters has the supply's. The gas that the valve
/// has passed and the chamber has not yet seen is in the lag.
template <class S> class LaggedLine {
 public:
  /// linear_about_Pa: P_0 of linear flows; 0: they depend on the chamber's pressure.
  void configure(const LineParameters<S>& line, const AirParameters<S>& air, const S& linear_about_Pa = S(0)) noexcept {
    air_ = Air<S>(air);
    linear_about_Pa_ = linear_about_Pa;
    natural_frequency_Hz_ = line.natural_frequency_Hz;
    damping_ratio_ = line.damping_ratio;
    set_time_step(1e-3);
    reset();
  }
  void reset() noexcept { lag_.reset(S(0)); }
  void set_time_step(double step_s) noexcept { lag_.configure(natural_frequency_Hz_, damping_ratio_, step_s); }
  /// Longest sub-step [s] that follows the lag: a tenth of a radian.
  double longest_step_s() const noexcept { return 0.1 / (6.2831853071795865 * largest(natural_frequency_Hz_)); }

  /// One sub-step with a valve at the port; the chamber's flow is the lag's exact mean over it.
  LineFlow<S> step_valve(const ValvePort<S>& valve, const ChamberEnd<S>& chamber) noexcept {
    const S b = valve.critical_pressure_ratio, T_s = air_.temperature_K;
    const S in = orifice_mass_flow(air_, valve.supply_area_m2, b, valve.supply_pressure_Pa, T_s, chamber.pressure_Pa,
                                   chamber.temperature_K);
    const S out = orifice_mass_flow(air_, valve.exhaust_area_m2, b, chamber.pressure_Pa, chamber.temperature_K,
                                    air_.atmosphere_Pa, T_s);
    lag_.step(in - out);
    const S flow = lag_.mean();
    return {in - out, flow, orifice_enthalpy_flow(air_, flow, T_s, chamber.temperature_K)};
  }
  /// The same with the flows of the equilibrium, whatever the chamber's pressure is: choked from the supply (2.5), from
  /// P_0 to the atmosphere (2.6).
  S step_linear(const ValvePort<S>& valve) noexcept {
    const S T_s = air_.temperature_K, b = valve.critical_pressure_ratio;
    lag_.step(valve.supply_area_m2 * orifice_flux(air_, valve.supply_pressure_Pa, T_s, S(0), b) -
              valve.exhaust_area_m2 * orifice_flux(air_, linear_about_Pa_, T_s, air_.atmosphere_Pa, b));
    return lag_.mean();
  }

 private:
  Air<S> air_;
  S linear_about_Pa_{};
  S natural_frequency_Hz_{}, damping_ratio_{};
  SecondOrderFilter<S> lag_;
};

}  // namespace pneuservo
