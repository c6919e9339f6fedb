// Dead-end branch of a line: a volume behind a neck, as a T-piece with the hose of a gauge has.
#pragma once
#include <pneuservo/core/scalar.hpp>
#include <pneuservo/elements/air.hpp>
#include <pneuservo/elements/effects.hpp>
#include <pneuservo/elements/pipe_friction.hpp>

namespace pneuservo {

/// l/A dG/dt = p_line - p - r G, V d(rho)/dt = G, V dp/dt = kappa R T_s G with the temperature T_s of where the gas
/// comes from: a Helmholtz resonator without heat through its walls (in a vessel of 200 cm3 the wall takes seconds),
/// whose neck has the friction of a pipe in r and passes no more than an orifice of its section. Losses at the neck's
/// ends are not counted.
template <class S> class Branch {
 public:
  /// The line beside the neck: its gas, and the volume that answers the branch within a step.
  struct Beside {
    S pressure_Pa, density_kg_per_m3, volume_m3;
  };

  /// Gas at rest.
  void reset(const S& pressure_Pa, const S& density_kg_per_m3) noexcept {
    pressure_ = pressure_Pa;
    density_ = density_kg_per_m3;
    flow_ = S(0);
  }
  /// Multiplies pressure and temperature of the gas.
  void scale_gas(const S& pressure, const S& temperature) noexcept {
    pressure_ *= pressure;
    density_ *= pressure / temperature;
  }

  /// One step; mass flow into the branch [kg/s]. Implicit in both pressures, so that no neck is too short for it.
  S step(const LineBranch<S>& branch, const Air<S>& air, const PipeFriction<S>& pipe, double step_s,
         const Beside& line) noexcept {
    const auto present = branch.volume_m3 > S(0);
    const S h(step_s), d = branch.neck_diameter_m, section = bore_area_m2(d);
    const S inverse_inertance = section / branch.neck_length_m;
    const S phi = pipe(absolute(flow_) * d / (section * air.viscosity_Pas)).lambda_reynolds;
    const S friction = phi * air.viscosity_Pas / (S(2) * line.density_kg_per_m3 * d * d);  // r A/l
    const S inverse_volume = S(1) / select(present, branch.volume_m3, S(1));
    const S R_T_line = line.pressure_Pa / line.density_kg_per_m3, R_T = pressure_ / density_;
    const S answer = air.kappa * (maximum(R_T_line, R_T) * inverse_volume + R_T_line / line.volume_m3);
    const S flow = (flow_ + h * inverse_inertance * (line.pressure_Pa - pressure_)) /
                   (S(1) + h * friction + h * h * inverse_inertance * answer);
    const S sonic = air.flow_constant * section * maximum(line.pressure_Pa, pressure_) / square_root(R_T_line);
    flow_ = select(present, clamp(flow, -sonic, sonic), S(0));
    const S added = h * flow_ * inverse_volume;
    pressure_ += air.kappa * select(flow_ > S(0), R_T_line, R_T) * added;
    density_ += added;
    return flow_;
  }

  S pressure() const noexcept { return pressure_; }
  S temperature(const Air<S>& air) const noexcept { return pressure_ / (density_ * air.R); }
  /// Gas behind the neck [kg].
  S mass(const LineBranch<S>& branch) const noexcept { return density_ * branch.volume_m3; }

 private:
  S pressure_{}, density_{}, flow_{};
};

}  // namespace pneuservo
