// A second-order lag of unit static gain: the spool of a valve, the linear model of a line (thesis 2.17, 2.18).
#pragma once
#include <pneuservo/core/scalar.hpp>

namespace pneuservo {

/// y'' + 2 zeta w y' + w^2 y = w^2 u, stepped exactly for an input that is constant over a step.
template <class S> class SecondOrderFilter {
 public:
  /// natural_frequency_Hz 0: the output follows at once.
  void configure(const S& natural_frequency_Hz, const S& damping_ratio, double step_s) noexcept {
    immediate_ = !(natural_frequency_Hz > S(0));
    const S w = S(6.2831853071795865) * natural_frequency_Hz;
    exponentiate(w * w, S(2) * damping_ratio * w, S(step_s));
    const S per_step = select(immediate_, S(0), S(1.0 / step_s) / select(immediate_, S(1), w));
    mean_by_change_ = S(2) * damping_ratio * per_step;
    mean_by_rate_ = per_step / select(immediate_, S(1), w);
  }
  void reset(const S& value) noexcept {
    value_ = mean_ = value;
    rate_ = S(0);
  }
  void step(const S& input) noexcept {
    const S error = value_ - input;
    const S next = input + a11_ * error + a12_ * rate_;
    const S rate = a21_ * error + a22_ * rate_;
    // The equation integrated over the step: w^2 (u - mean) h = y'_1 - y'_0 + 2 zeta w (y_1 - y_0).
    mean_ = input - mean_by_change_ * (next - value_) - mean_by_rate_ * (rate - rate_);
    rate_ = rate;
    value_ = select(immediate_, input, next);
  }
  /// Output at the end of the last step.
  S value() const noexcept { return value_; }
  /// Exact mean of the output over the last step.
  S mean() const noexcept { return mean_; }

 private:
  // exp([[0, 1], [-k, -d]] h) by a Taylor series of the matrix over 2^10, squared ten times: the same for every
  // damping.
  void exponentiate(const S& k, const S& d, const S& h) noexcept {
    const S t = h * S(1.0 / 1024.0);
    S b11(1), b12(0), b21(0), b22(1);
    a11_ = a22_ = S(1);
    a12_ = a21_ = S(0);
    for (int n = 1; n <= 10; ++n) {  // term_n = term_{n-1} A t / n
      const S f = t / S(n);
      const S c11 = -k * b12 * f, c12 = (b11 - d * b12) * f, c21 = -k * b22 * f, c22 = (b21 - d * b22) * f;
      b11 = c11, b12 = c12, b21 = c21, b22 = c22;
      a11_ += b11, a12_ += b12, a21_ += b21, a22_ += b22;
    }
    for (int i = 0; i < 10; ++i) {
      const S c11 = a11_ * a11_ + a12_ * a21_, c12 = a11_ * a12_ + a12_ * a22_;
      const S c21 = a21_ * a11_ + a22_ * a21_, c22 = a21_ * a12_ + a22_ * a22_;
      a11_ = c11, a12_ = c12, a21_ = c21, a22_ = c22;
    }
  }
  Mask<S> immediate_{};
  S a11_{}, a12_{}, a21_{}, a22_{};
  S mean_by_change_{}, mean_by_rate_{};
  S value_{}, rate_{}, mean_{};
};

}  // namespace pneuservo
