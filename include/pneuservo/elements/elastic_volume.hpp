// A volume behind a line that grows with its pressure: a vessel, a soft actuator (docs/physics/pressure_pi.md).
#pragma once
#include <pneuservo/elements/air.hpp>

namespace pneuservo {

/// V(p) = volume + compliance (p - p_atm), never below the volume; wall heat q = conductance (T_w - T).
template <class S> struct ElasticVolumeParameters {
  S volume_m3{};
  S compliance_m3_per_Pa = S(0);
  S wall_heat_W_per_K = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"volume_m3", "m3", 1e-7, 10, "of the gas at atmosphere, fittings included"}, p.volume_m3...);
    v(Field{"compliance_m3_per_Pa", "m3/Pa", 0, 1e-6, "growth of the volume per pressure above atmosphere; 0: rigid",
            Presence::optional},
      p.compliance_m3_per_Pa...);
    v(Field{"wall_heat_W_per_K", "W/K", 0, 1e4, "heat flow to the wall over gas temperature less air.temperature_K",
            Presence::optional},
      p.wall_heat_W_per_K...);
  }
  S growth_m3(const S& pressure_Pa, const S& atmosphere_Pa) const noexcept {
    return compliance_m3_per_Pa * maximum(pressure_Pa - atmosphere_Pa, S(0));
  }
};

/// Growth [m3] at the end of a step of h [s] of a volume that has grown by `grown_m3` and whose gas is at p and T while
/// `inflow_kgps` comes in. One Newton step of growth = compliance (p - p_atm) with the gas adiabatic, so that the
/// volume is stable however soft it is: its gas answers dV with dp = -kappa p dV / V.
template <class S>
S elastic_growth(const ElasticVolumeParameters<S>& volume, const Air<S>& air, double h, const S& grown_m3, const S& p,
                 const S& T, const S& inflow_kgps) noexcept {
  const S per_volume = S(1) / (volume.volume_m3 + grown_m3);
  const S rise = air.kappa * air.R * T * inflow_kgps * S(h) * per_volume;
  const S wanted = volume.growth_m3(p + rise, air.atmosphere_Pa) - grown_m3;
  const S next = grown_m3 + wanted / (S(1) + air.kappa * p * volume.compliance_m3_per_Pa * per_volume);
  return maximum(next, S(0));
}

}  // namespace pneuservo
