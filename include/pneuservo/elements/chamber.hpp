// Cylinder chamber with mass and energy balance (thesis 3.15 to 3.18, written so that they hold in both directions).
#pragma once
#include <pneuservo/elements/air.hpp>

namespace pneuservo {

/// Geometry of one chamber: V = V_0 + A s, s = distance of the piston from this chamber's end stop.
template <class S> struct ChamberGeometry {
  S area_m2{};
  S dead_volume_m3{};
  S wall_heat_W_per_m2K{};
  S linear_pressure_Pa{};  ///< P_0, V_0 of a linear chamber (2.3, 2.4); 0: not linear
  S linear_volume_m3{};

  S volume_m3(const S& s) const noexcept { return dead_volume_m3 + area_m2 * s; }
  /// S_c = 2 A + perimeter s, perimeter of a circle of area A.
  S wall_area_m2(const S& s) const noexcept {
    return S(2) * area_m2 + S(3.5449077018110318) * square_root(area_m2) * s;
  }
};

/// What crosses the chamber's boundary in a sub-step beside the line's flow, positive into the chamber.
template <class S> struct ChamberInflow {
  S mass_flow_kgps{};
  S enthalpy_flow_W{};
};

/// dm/dt = G; d(m c_v T)/dt = G h - p dV/dt + h_c S_c (T_w - T); p = (kappa - 1) U / V.
/// Compression is trapezoidal (exact for an adiabatic change to second order), wall heat implicit.
template <class S> class Chamber {
 public:
  void configure(const ChamberGeometry<S>& geometry, const Air<S>& air) noexcept {
    geometry_ = geometry;
    air_ = air;
    kappa_minus_one_ = air.kappa - S(1);
    ends_area_ = geometry.wall_area_m2(S(0));
    perimeter_ = geometry.wall_area_m2(S(1)) - ends_area_;
    reset(air.atmosphere_Pa, air.temperature_K, S(0));
  }
  /// Gas at pressure and temperature, piston at distance s from the end stop.
  void reset(const S& pressure_Pa, const S& temperature_K, const S& s) noexcept {
    volume_ = geometry_.volume_m3(s);
    mass_ = pressure_Pa * volume_ / (air_.R * temperature_K);
    energy_ = pressure_Pa * volume_ / (air_.kappa - S(1));
    pressure_ = pressure_Pa;
    temperature_ = temperature_K;
  }
  /// One sub-step of h [s] with the inflow; at its end the piston is at distance s_new.
  void step(double h, const ChamberInflow<S>& inflow, const S& s_new) noexcept {
    // Everything that needs only the piston comes first: the flow is known last.
    const S volume_new = geometry_.volume_m3(s_new), sum = volume_new + volume_;
    const S work = kappa_minus_one_ * (volume_new - volume_), larger = sum + work;
    const S reciprocal = S(1) / (larger * volume_new);  // one division for both
    const S compressed = (sum - work) * (volume_new * reciprocal);
    const S per_volume = kappa_minus_one_ * (larger * reciprocal);
    const S heat = S(h) * geometry_.wall_heat_W_per_m2K * (ends_area_ + perimeter_ * s_new);
    mass_ = maximum(mass_ + S(h) * inflow.mass_flow_kgps, S(1e-12));
    energy_ = (energy_ + S(h) * inflow.enthalpy_flow_W) * compressed;
    // Wall heat implicit: (m c_v + heat) T = U + heat T_w.
    const S capacity = mass_ * air_.cv;
    temperature_ = (energy_ + heat * air_.temperature_K) / (capacity + heat);
    energy_ = capacity * temperature_;
    volume_ = volume_new;
    pressure_ = energy_ * per_volume;
  }

  /// The same linearised, isothermal: dp/dt = R T/V_0 G - P_0/V_0 dV/dt (2.3, 2.4).
  void step_linear(double h, const S& mass_flow_kgps, const S& s_new) noexcept {
    const S volume_new = geometry_.volume_m3(s_new), RT = air_.R * air_.temperature_K;
    pressure_ += (RT * S(h) * mass_flow_kgps - geometry_.linear_pressure_Pa * (volume_new - volume_)) /
                 geometry_.linear_volume_m3;
    volume_ = volume_new;
    temperature_ = air_.temperature_K;
    mass_ = pressure_ * volume_ / RT;
    energy_ = mass_ * air_.cv * temperature_;
  }

  /// Multiplies the gas's pressure and temperature; its mass follows.
  void scale_gas(const S& pressure, const S& temperature) noexcept {
    mass_ *= pressure / temperature;
    energy_ *= pressure;
    pressure_ *= pressure;
    temperature_ *= temperature;
  }

  S pressure() const noexcept { return pressure_; }
  S temperature() const noexcept { return temperature_; }
  S volume() const noexcept { return volume_; }
  S mass() const noexcept { return mass_; }
  S internal_energy() const noexcept { return energy_; }
  const ChamberGeometry<S>& geometry() const noexcept { return geometry_; }

 private:
  ChamberGeometry<S> geometry_;
  Air<S> air_;
  S kappa_minus_one_{}, ends_area_{}, perimeter_{};
  S volume_{}, mass_{}, energy_{}, pressure_{}, temperature_{};
};

}  // namespace pneuservo
