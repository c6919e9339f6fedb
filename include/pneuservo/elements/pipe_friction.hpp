// Quasi-steady friction and wall heat transfer of a pipe as functions of the Reynolds number (thesis 3.6, 3.7, 3.9).
#pragma once
#include <array>

#include <pneuservo/core/group.hpp>
#include <pneuservo/elements/air.hpp>
#include <pneuservo/elements/parameters.hpp>

namespace pneuservo {

/// phi = lambda Re [-] and the Nusselt number [-].
template <class S> struct PipeFrictionValue {
  S lambda_reynolds;
  S nusselt;
};

/// lambda = 64/Re up to Re_1, 0.3164 Re^-1/4 (Blasius) from Re_2, linear in Re between.
/// Nu = max(3.66, 0.046 Re^0.8 Pr^0.4); the floor is the laminar value at constant wall temperature.
/// Both come from q = Re^1/4 (single precision inside, 1e-7): Re^0.8 = q^3 q^0.2 with a cubic for q^0.2, within 0.21 %
/// for Re 2e3..2e6, far inside the correlation's own 10 to 20 %; std::pow would cost more than the rest of the cell.
template <class S> struct PipeFriction {
  S laminar, turbulent;  ///< Re_1, Re_2
  S phi_laminar = S(64), phi_blasius = S(0.3164);  ///< phi up to Re_1, and over Re^3/4 from Re_2
  S lambda_offset, lambda_slope = S(0);  ///< of lambda between
  std::array<S, 4> nusselt;  ///< 0.046 Pr^0.4 times the cubic for q^0.2
  S nusselt_laminar = S(3.66);

  PipeFriction() noexcept : PipeFriction(LineParameters<S>{}, Air<S>{}) {}
  PipeFriction(const LineParameters<S>& line, const Air<S>& air) noexcept
      : laminar(line.laminar_reynolds), turbulent(line.turbulent_reynolds) {
    const S lambda_laminar = phi_laminar / laminar,
            lambda_turbulent = phi_blasius / square_root(square_root(turbulent));
    const auto gap = turbulent > laminar;
    lambda_slope = select(gap, (lambda_turbulent - lambda_laminar) / select(gap, turbulent - laminar, S(1)), S(0));
    lambda_offset = lambda_laminar - lambda_slope * laminar;
    const S factor = S(0.046) * exponential(S(0.4) * logarithm(air.prandtl));
    nusselt = {factor * S(1.15736), factor * S(0.0543533), factor * S(-1.33480e-3), factor * S(1.42215e-5)};
  }

  /// With a multiple of phi.
  PipeFriction multiplied(const S& factor) const noexcept {
    PipeFriction out(*this);
    for (S* phi : {&out.phi_laminar, &out.phi_blasius, &out.lambda_offset, &out.lambda_slope}) *phi *= factor;
    return out;
  }

  /// The same correlation for several elements at once.
  template <class G> PipeFriction<G> grouped() const noexcept {
    PipeFriction<G> out;
    out.laminar = replicate(laminar);
    out.turbulent = replicate(turbulent);
    out.phi_laminar = replicate(phi_laminar);
    out.phi_blasius = replicate(phi_blasius);
    out.lambda_offset = replicate(lambda_offset);
    out.lambda_slope = replicate(lambda_slope);
    for (std::size_t i = 0; i < nusselt.size(); ++i) out.nusselt[i] = replicate(nusselt[i]);
    out.nusselt_laminar = replicate(nusselt_laminar);
    return out;
  }

  /// Re >= 0.
  [[gnu::always_inline]] PipeFrictionValue<S> operator()(const S& Re) const noexcept { return at_root(Re, root(Re)); }
  /// q = Re^1/4, the long part of the chain.
  [[gnu::always_inline]] static S root(const S& Re) noexcept { return fourth_root(Re + S(1e-9)); }
  /// The correlation from Re and q.
  [[gnu::always_inline]] PipeFrictionValue<S> at_root(const S& Re, const S& q) const noexcept {
    const S q3 = q * q * q;
    const S between = Re * (lambda_offset + lambda_slope * Re);
    const S phi = select(Re <= laminar, phi_laminar, select(Re >= turbulent, phi_blasius * q3, between));
    const S turbulent_nusselt = q3 * (nusselt[0] + q * (nusselt[1] + q * (nusselt[2] + q * nusselt[3])));
    return {phi, maximum(nusselt_laminar, turbulent_nusselt)};
  }
  /// How fast turbulence renews the layer at the wall, in nu/R^2 (Vardy and Brown 2003, smooth wall): Re^k/12.86 with
  /// k = log10(15.29 Re^-0.0567), which 0.523 Re^0.75 follows within 7 % for Re 4e3..4e4; none in laminar flow, linear
  /// between.
  S renewal(const S& Re) const noexcept {
    const S q = root(Re), gap = turbulent - laminar;
    const S between = maximum(S(0), Re - laminar) / select(gap > S(0), gap, S(1));
    return S(0.523) * (q * q * q) * select(Re >= turbulent, S(1), minimum(S(1), between));
  }
};

}  // namespace pneuservo
