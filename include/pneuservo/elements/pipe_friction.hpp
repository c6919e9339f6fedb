// Quasi-steady friction and wall heat transfer of a pipe as functions of the Reynolds number (thesis 3.6, 3.7, 3.9).
#pragma once
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
  S laminar, turbulent;         ///< Re_1, Re_2
  S lambda_laminar, slope;      ///< lambda at Re_1 and d(lambda)/d(Re) between
  S nusselt_factor;             ///< 0.046 Pr^0.4
  S nusselt_laminar;            ///< 3.66

  PipeFriction() noexcept : PipeFriction(LineParameters<S>{}, Air<S>{}) {}
  PipeFriction(const LineParameters<S>& line, const Air<S>& air) noexcept
      : laminar(line.laminar_reynolds), turbulent(line.turbulent_reynolds), lambda_laminar(S(64) / laminar),
        slope(S(0)), nusselt_factor(S(0.046) * exponential(S(0.4) * logarithm(air.prandtl))), nusselt_laminar(S(3.66)) {
    const S lambda_turbulent = S(0.3164) / square_root(square_root(turbulent));
    const auto gap = turbulent > laminar;
    slope = select(gap, (lambda_turbulent - lambda_laminar) / select(gap, turbulent - laminar, S(1)), S(0));
  }

  /// The same correlation for several elements at once.
  template <class G> PipeFriction<G> grouped() const noexcept {
    PipeFriction<G> out;
    out.laminar = replicate(laminar);
    out.turbulent = replicate(turbulent);
    out.lambda_laminar = replicate(lambda_laminar);
    out.slope = replicate(slope);
    out.nusselt_factor = replicate(nusselt_factor);
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
    const S between = Re * (lambda_laminar + slope * (Re - laminar));
    const S phi = select(Re <= laminar, S(64), select(Re >= turbulent, S(0.3164) * q3, between));
    const S q02 = S(1.15736) + q * (S(0.0543533) + q * (S(-1.33480e-3) + q * S(1.42215e-5)));
    return {phi, maximum(nusselt_laminar, nusselt_factor * q3 * q02)};
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
