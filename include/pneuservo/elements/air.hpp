// Air as an ideal gas: its parameters and the constants derived from them (thesis 3.1, 3.10, 2.7).
#pragma once
#include <pneuservo/core/field.hpp>
#include <pneuservo/core/scalar.hpp>

namespace pneuservo {

/// The gas and its surroundings. The wall of lines and chambers is at `temperature_K`, and so is the supply.
template <class S> struct AirParameters {
  S gas_constant_J_per_kgK = S(287.0);
  S heat_capacity_ratio = S(1.4);
  S temperature_K = S(293.0);
  S atmosphere_Pa = S(101325.0);
  S viscosity_Pas = S(1.8e-5);
  S prandtl = S(0.71);

  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"gas_constant_J_per_kgK", "J/(kg K)", 50, 5000, "specific gas constant R", optional},
      p.gas_constant_J_per_kgK...);
    v(Field{"heat_capacity_ratio", "-", 1.01, 1.67, "kappa = c_p / c_v", optional}, p.heat_capacity_ratio...);
    v(Field{"temperature_K", "K", 200, 400, "ambient, wall and supply temperature", optional}, p.temperature_K...);
    v(Field{"atmosphere_Pa", "Pa", 1e4, 2e5, "ambient pressure, absolute", optional}, p.atmosphere_Pa...);
    v(Field{"viscosity_Pas", "Pa s", 1e-6, 1e-3, "dynamic viscosity, constant", optional}, p.viscosity_Pas...);
    v(Field{"prandtl", "-", 0.1, 10, "Prandtl number", optional}, p.prandtl...);
  }
};

/// Constants of the gas that every element needs, computed once per parameter set.
template <class S> struct Air {
  S R, kappa, cv, cp;
  S temperature_K, atmosphere_Pa, viscosity_Pas, prandtl;
  S flow_constant;  ///< K_f of the choked orifice (2.7), 0.68473 for kappa = 1.4

  Air() noexcept : Air(AirParameters<S>{}) {}
  explicit Air(const AirParameters<S>& p) noexcept
      : R(p.gas_constant_J_per_kgK), kappa(p.heat_capacity_ratio), cv(R / (kappa - S(1))), cp(kappa * cv),
        temperature_K(p.temperature_K), atmosphere_Pa(p.atmosphere_Pa), viscosity_Pas(p.viscosity_Pas),
        prandtl(p.prandtl), flow_constant(choked_flow_constant(kappa)) {}

  /// K_f = sqrt(kappa (2/(kappa+1))^((kappa+1)/(kappa-1))) (2.7).
  static S choked_flow_constant(const S& k) noexcept {
    const S exponent = (k + S(1)) / (k - S(1));
    return square_root(k * exponential(exponent * logarithm(S(2) / (k + S(1)))));
  }
  /// At ambient temperature [m/s].
  S sound_speed() const noexcept { return square_root(kappa * R * temperature_K); }
  /// Thermal conductivity k(T) = 7.95e-5 T + 2.0465e-3 W/(m K) (3.10).
  static S conductivity(const S& T) noexcept { return S(7.95e-5) * T + S(2.0465e-3); }
};

}  // namespace pneuservo
