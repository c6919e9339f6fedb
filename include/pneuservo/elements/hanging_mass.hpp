// A mass on a spring and a damper that is carried along, with play or without: the load of a coupling.
#pragma once
#include <algorithm>
#include <cmath>

#include <pneuservo/elements/effects.hpp>

namespace pneuservo {

/// m_l y'' = k (x - y) + d (x' - y'), carried at x with speed x'; y, its own place beside its length at rest, starts
/// with the carrier. k = m_l w^2, d = 2 zeta m_l w with w = 2 pi natural_frequency_Hz, the frequency that it has where
/// the carrier stands still. With play g the coupling pushes where |x - y| > g/2 alone, on what is beyond, and never
/// pulls.
template <class S> class HangingMass {
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
    carrier_position_ = position_m;
    carrier_velocity_ = velocity_mps;
  }
  /// h [s] later the carrier is at position_m with velocity_mps. Without play by the trapezoidal rule, which no
  /// stiffness upsets; with it in steps that resolve a contact.
  void step(double h_s, const S& position_m, const S& velocity_mps) noexcept {
    if (has_play_) step_contact(h_s, position_m, velocity_mps);
    else step_linear(h_s, position_m, velocity_mps);
    carrier_position_ = position_m;
    carrier_velocity_ = velocity_mps;
  }
  /// On the carrier [N]; with play the mean over the last step.
  S force() const noexcept { return -mass_ * acceleration_; }
  /// Whether any lane has such a mass.
  bool is_there() const noexcept { return any(mass_ > S(0)); }

 private:
  void configure(const S& mass_kg, const S& natural_frequency_Hz, const S& damping_ratio, const S& play_m) noexcept {
    mass_ = mass_kg;
    const S w = S(6.283185307179586) * natural_frequency_Hz;
    stiffness_ = w * w;
    damping_ = S(2) * damping_ratio * w;
    half_play_ = S(0.5) * play_m;
    has_play_ = any(play_m > S(0));
    fastest_per_s_ = largest(w);
    reset(S(0), S(0));
  }
  void step_linear(double h_s, const S& position_m, const S& velocity_mps) noexcept {
    const S half(0.5 * h_s);
    const S v = velocity_ + half * acceleration_, y = position_ + half * velocity_;
    const S next = (v + half * (stiffness_ * (position_m - y) + damping_ * velocity_mps)) /
                   (S(1) + half * (damping_ + half * stiffness_));
    position_ = y + half * next;
    velocity_ = next;
    acceleration_ = stiffness_ * (position_m - position_) + damping_ * (velocity_mps - velocity_);
  }
  void step_contact(double h_s, const S& position_m, const S& velocity_mps) noexcept {
    const int n = std::clamp(static_cast<int>(std::ceil(h_s * fastest_per_s_ / resolved)), 1, 1000);
    const S h(h_s / n), before = velocity_;
    for (int i = 1; i <= n; ++i) {
      const S share(double(i) / n);
      const S x = carrier_position_ + share * (position_m - carrier_position_),
              v = carrier_velocity_ + share * (velocity_mps - carrier_velocity_);
      const S way = x - position_, beyond = way - clamp(way, -half_play_, half_play_);
      const S pushed = stiffness_ * beyond + damping_ * (v - velocity_);
      velocity_ += h * select(beyond * pushed > S(0), pushed, S(0));
      position_ += h * velocity_;
    }
    acceleration_ = (velocity_ - before) / S(h_s);
  }
  static constexpr double resolved = 0.1;  ///< of a radian of the coupling's own swing

  S mass_{}, stiffness_{}, damping_{}, half_play_{};
  S position_{}, velocity_{}, acceleration_{}, carrier_position_{}, carrier_velocity_{};
  double fastest_per_s_ = 0.0;
  bool has_play_ = false;
};

}  // namespace pneuservo
