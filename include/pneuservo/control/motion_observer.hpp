// Observer of position, velocity and acceleration from a measured position (chapter 2; docs/physics/ppd2.md).
#pragma once
#include <array>

namespace pneuservo {

/// Gains l1 [1/s], l2 [1/s2], l3 [1/s3] of x' = v + l1 e, v' = a + l2 e, a' = l3 e, e = y - x.
struct ObserverGains {
  double l1 = 0.0, l2 = 0.0, l3 = 0.0;
  /// All three poles on a Butterworth circle: (s + w)(s^2 + w s + w^2). w > 0 [rad/s].
  static ObserverGains butterworth(double w) noexcept { return {2.0 * w, 2.0 * w * w, w * w * w}; }
};

/// z_k = Phi z_{k-1} + G0 y_{k-1} + G1 y_k: exact for a measurement that is linear between samples (ramp-invariant).
struct DiscreteObserver {
  std::array<std::array<double, 3>, 3> phi{};
  std::array<double, 3> g0{}, g1{};
};

/// Of one exponential of [[A, B, 0], [0, 0, 1/T], [0, 0, 0]] T, A the observer's matrix, B its gains. period_s > 0.
/// Cold.
DiscreteObserver discretise(const ObserverGains& gains, double period_s) noexcept;

/// The observer in discrete time. Plain data.
class MotionObserver {
 public:
  /// Cold.
  void configure(const ObserverGains& gains, double period_s) noexcept {
    discrete_ = discretise(gains, period_s);
    reset();
  }
  /// Forgets all; the next sample is taken as resting there. HOT.
  void reset() noexcept {
    started_ = false;
    z_ = {};
  }
  /// One sample [m] that stands `periods` >= 1 after the one before; between them it is taken as linear. HOT.
  void step(double y_m, int periods = 1) noexcept {
    if (!started_) {
      z_ = {y_m, 0.0, 0.0};
      last_ = y_m;
      started_ = true;
      return;
    }
    const double first = last_;
    for (int i = 1; i <= periods; ++i) {
      const double next = i == periods ? y_m : first + (y_m - first) * i / periods;
      advance(last_, next);
      last_ = next;
    }
  }
  double position_m() const noexcept { return z_[0]; }
  double velocity_mps() const noexcept { return z_[1]; }
  double acceleration_mps2() const noexcept { return z_[2]; }
  const DiscreteObserver& discrete() const noexcept { return discrete_; }

 private:
  void advance(double from, double to) noexcept {
    std::array<double, 3> next{};
    for (std::size_t i = 0; i < 3; ++i)
      next[i] = discrete_.phi[i][0] * z_[0] + discrete_.phi[i][1] * z_[1] + discrete_.phi[i][2] * z_[2] +
                discrete_.g0[i] * from + discrete_.g1[i] * to;
    z_ = next;
  }
  DiscreteObserver discrete_;
  std::array<double, 3> z_{};
  double last_ = 0.0;
  bool started_ = false;
};

}  // namespace pneuservo
