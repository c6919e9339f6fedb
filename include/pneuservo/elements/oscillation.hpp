// A sine that goes on in time: a disturbance of one frequency.
#pragma once
#include <pneuservo/core/scalar.hpp>

namespace pneuservo {

/// A sin(2 pi f t + phase), t from the last reset.
template <class S> class Oscillation {
 public:
  void configure(const S& amplitude, const S& frequency_Hz, const S& phase_rad) noexcept {
    amplitude_ = amplitude;
    per_s_ = S(6.283185307179586) * frequency_Hz;
    start_ = phase_rad;
    reset();
  }
  void reset() noexcept { phase_ = start_; }
  void step(double h_s) noexcept { phase_ += S(h_s) * per_s_; }
  /// A time from now.
  S value(double ahead_s = 0) const noexcept { return amplitude_ * sine(phase_ + S(ahead_s) * per_s_); }
  /// Whether any lane has one.
  bool is_there() const noexcept { return any(!(amplitude_ == S(0))); }

 private:
  S amplitude_{}, per_s_{}, start_{}, phase_{};
};

}  // namespace pneuservo
