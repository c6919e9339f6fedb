// The load of a coupling: a mass on a spring and a damper that is carried along, with play or without.
#pragma once
#include <pneuservo/elements/effects.hpp>

namespace pneuservo {

/// m_l y'' = k (x - y) + d (x' - y'), carried at x with speed x'; y, its own place beside its length at rest, starts
/// with the carrier. k = m_l w^2, d = 2 zeta m_l w with w = 2 pi natural_frequency_Hz, the frequency that it has where
/// the carrier stands still. With play g the coupling pushes where |x - y| > g/2 alone, on what is beyond, and never
/// pulls. By the trapezoidal rule, which no stiffness upsets: the speed at a step's end is affine in the carrier's.
template <class S> class CoupledLoad {
 public:
  void configure(const ElasticLoad<S>& load) noexcept {
    configure(load.mass_kg, load.natural_frequency_Hz, load.damping_ratio, S(0));
  }
  void configure(const LoadBacklash<S>& load) noexcept {
    configure(load.mass_kg, load.contact_frequency_Hz, load.contact_damping_ratio, load.play_m);
  }
  void reset(const S& position_m, const S& velocity_mps) noexcept {
    position_ = position_m;
    velocity_ = velocity_mps;
    acceleration_ = S(0);
  }

  /// Momentum that a carrier gives away in a step of h [s] from position and velocity on: free [N s] +
  /// by_velocity [kg] times its speed at the step's end. A carrier that solves its own step with these two and the load
  /// stay together whatever the stiffness.
  struct Given {
    S free, by_velocity;
  };
  Given given(double h_s, const S& position_m, const S& velocity_mps) const noexcept {
    const Step step = prepared(h_s, position_m, velocity_mps);
    return {mass_ * (step.free - velocity_), mass_ * step.by_velocity};
  }
  /// h [s] later the carrier, which was at position and velocity, is at the next ones.
  void step(double h_s, const S& position_m, const S& velocity_mps, const S& next_position_m,
            const S& next_velocity_mps) noexcept {
    const Step step = prepared(h_s, position_m, velocity_mps);
    const S half(0.5 * h_s);
    // Where the carrier did not end as it would by its mean speed (an end stop), its place counts.
    const S astray = next_position_m - (position_m + half * (velocity_mps + next_velocity_mps));
    const S next = step.free + step.by_velocity * next_velocity_mps + step.by_place * astray;
    position_ += half * (velocity_ + next);
    velocity_ = next;
    const S way = next_position_m - position_;
    acceleration_ = pushed(way - edge(way), next_velocity_mps - velocity_);
  }
  /// On the carrier at the last step's end [N].
  S force() const noexcept { return -mass_ * acceleration_; }
  /// Whether any lane has such a mass.
  bool is_there() const noexcept { return any(mass_ > S(0)); }

 private:
  struct Step {
    S free, by_velocity, by_place;  ///< speed at the end: free + by_velocity x' + by_place x, x beside the mean speed's
  };
  void configure(const S& mass_kg, const S& natural_frequency_Hz, const S& damping_ratio, const S& play_m) noexcept {
    mass_ = mass_kg;
    const S w = S(6.283185307179586) * natural_frequency_Hz;
    stiffness_ = w * w;
    damping_ = S(2) * damping_ratio * w;
    half_play_ = S(0.5) * play_m;
    has_play_ = any(play_m > S(0));
    reset(S(0), S(0));
  }
  // End of the play that is touched at this way of the carrier ahead of the mass; 0 without play.
  S edge(const S& way) const noexcept { return has_play_ ? clamp(way, -half_play_, half_play_) : S(0); }
  // Acceleration of the mass where the carrier is beyond the play.
  S pushed(const S& beyond, const S& faster) const noexcept {
    const S both = stiffness_ * beyond + damping_ * faster;
    return has_play_ ? select(both * beyond > S(0), both, S(0)) : both;
  }
  Step prepared(double h_s, const S& position_m, const S& velocity_mps) const noexcept {
    const S half(0.5 * h_s);
    // Contact by where both would be half a step on; one that would pull is none.
    const S halfway = position_m - position_ + half * (velocity_mps - velocity_), at = edge(halfway);
    S k = stiffness_, d = damping_;
    if (has_play_) {
      const auto touches = pushed(halfway - at, velocity_mps - velocity_) * halfway > S(0);
      k = select(touches, k, S(0));
      d = select(touches, d, S(0));
    }
    const S way = position_m - at - position_, faster = velocity_mps - velocity_;
    const S start = k * way + d * faster, now = has_play_ ? select(start * halfway > S(0), start, S(0)) : start;
    const S inverse = S(1) / (S(1) + half * (d + half * k));
    // y_1 = y_0 + h/2 (y'_0 + y'_1), x_1 likewise; y'_1 = y'_0 + h/2 (y''_0 + k (x_1 - y_1) + d (x'_1 - y'_1)).
    const S free = inverse * (velocity_ + half * (now + k * (way + half * faster)));
    return {free, inverse * half * (d + half * k), inverse * half * k};
  }

  S mass_{}, stiffness_{}, damping_{}, half_play_{};
  S position_{}, velocity_{}, acceleration_{};
  bool has_play_ = false;
};

}  // namespace pneuservo
