// Spool of a servo valve with its coil: a mass that the coil's force and a disturbing force accelerate.
#pragma once
#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// x'' = k_v u + F/M with u the coil's command [V] and k_v = K_Fc K_i/M_s (2.13 to 2.16; docs/physics/spool_loop.md).
template <class S> struct SpoolMassParameters {
  S acceleration_per_volt_mps2_per_V = S(223.28);  ///< Table 2.3
  S mass_kg = S(0.061);                            ///< with the coil; the text's 10 g are the bare spool
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"acceleration_per_volt_mps2_per_V", "m/(s2 V)", 1e-3, 1e6, "of spool and coil", optional},
      p.acceleration_per_volt_mps2_per_V...);
    v(Field{"mass_kg", "kg", 1e-4, 10, "of spool and coil", optional}, p.mass_kg...);
  }
};

/// The spool between two instants with constant command and force: exact. HOT.
template <class S> class SpoolMass {
 public:
  void configure(const SpoolMassParameters<S>& parameters) noexcept {
    parameters_ = parameters;
    reset(S(0));
  }
  /// At rest there [m].
  void reset(const S& position_m) noexcept {
    position_ = position_m;
    velocity_ = S(0);
  }
  /// `force_N`: flow force, friction, anything that the coil does not make.
  void step(const S& command_V, const S& force_N, const S& step_s) noexcept {
    const S acceleration = parameters_.acceleration_per_volt_mps2_per_V * command_V + force_N / parameters_.mass_kg;
    position_ += step_s * (velocity_ + S(0.5) * step_s * acceleration);
    velocity_ += step_s * acceleration;
  }
  const S& position_m() const noexcept { return position_; }
  const S& velocity_mps() const noexcept { return velocity_; }

 private:
  SpoolMassParameters<S> parameters_{};
  S position_{}, velocity_{};
};

}  // namespace pneuservo
