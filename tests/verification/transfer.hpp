// Small-signal transfer from port pressure to chamber pressure, measured from the response to a smooth pulse.
#pragma once
#include <Eigen/Dense>

#include "gas_rig.hpp"

namespace verification {

/// Line 1 and chamber 1 at mid-stroke, 470 kPa, 293 K; the port pressure makes one Gaussian pulse of 10 Pa. The
/// transfer function at any frequency is the ratio of the Fourier integrals of response and pulse: no start-up to wait
/// for.
class PulseResponse {
 public:
  PulseResponse(Resolution resolution, double L, double D_mm, bool adiabatic, bool with_memory = false)
      : PulseResponse(L, D_mm, adiabatic, resolution == Resolution::normal ? 10 : 100,
                      resolution == Resolution::normal ? 1e-3 : 2.5e-5, with_memory) {}
  /// with_memory: the line's losses depend on frequency.
  PulseResponse(double L, double D_mm, bool adiabatic, int cells, double period, bool with_memory = false) {
    LineWithChamber<double> side;
    side.configure(line_of(L, D_mm), chamber_1(adiabatic ? 0.0 : 50.0), nominal_air(), cells);
    side.reset(p_start, T_start, half_stroke);
    side.line().set_adiabatic(adiabatic);
    LineEffects<double> effects;
    effects.frequency_dependent_losses.share = with_memory ? 1.0 : 0.0;
    side.line().set_effects(effects);
    double t = 0.0, end = 14.0;
    while (t < end) {
      const int n = side.begin_period(period);
      step_ = side.step_s();
      for (int i = 0; i < n; ++i) {
        side.step_prescribed(p_start + pulse(t), half_stroke);
        t += step_;
        response_.push_back(side.chamber().pressure() - p_start);
      }
    }
  }
  /// Chamber over port pressure at frequency f [Hz].
  Complex operator()(double f) const {
    const double w = 2.0 * M_PI * f;
    const Complex turn = std::exp(Complex(0.0, -w * step_));
    Complex phase = 1.0, sum = 0.0;
    for (std::size_t k = 0; k < response_.size(); ++k) {
      phase = (k & 1023) == 0 ? std::exp(Complex(0.0, -w * step_ * static_cast<double>(k + 1))) : phase * turn;
      sum += phase * response_[k];
    }
    const Complex in = height * width * std::sqrt(2.0 * M_PI) * std::exp(-0.5 * w * w * width * width) *
                       std::exp(Complex(0.0, -w * centre));
    return sum * step_ / in;
  }
  /// Frequency where the gain is largest between two frequencies, by golden section.
  double peak_frequency(double low, double high) const {
    const double g = 0.5 * (std::sqrt(5.0) - 1.0);
    for (int i = 0; i < 40; ++i) {
      const double a = high - g * (high - low), b = low + g * (high - low);
      (std::abs((*this)(a)) > std::abs((*this)(b)) ? high : low) = std::abs((*this)(a)) > std::abs((*this)(b)) ? b : a;
    }
    return 0.5 * (low + high);
  }
  /// The pole near s = i 2 pi f: 1/H has no singularity there, so a polynomial through its values on the imaginary axis
  /// continues it to its zero.
  Complex pole(double f) const {
    constexpr int points = 9, degree = 4;
    Eigen::MatrixXcd A(points, degree + 1);
    Eigen::VectorXcd b(points);
    for (int i = 0; i < points; ++i) {
      const double d = 0.12 * (2.0 * i / (points - 1) - 1.0);
      const Complex z(0.0, d);
      for (int k = 0; k <= degree; ++k) A(i, k) = std::pow(z, k);
      b(i) = 1.0 / (*this)(f * (1.0 + d));
    }
    const Eigen::VectorXcd c = A.colPivHouseholderQr().solve(b);
    Complex z = 0.0;
    for (int iteration = 0; iteration < 50; ++iteration) {
      Complex value = 0.0, slope = 0.0;
      for (int k = degree; k >= 0; --k) slope = slope * z + value, value = value * z + c(k);
      z -= value / slope;
    }
    return 2.0 * M_PI * f * (Complex(0.0, 1.0) + z);
  }

 private:
  static constexpr double height = 10.0, width = 0.005, centre = 0.04;
  static double pulse(double t) { return height * std::exp(-0.5 * (t - centre) * (t - centre) / (width * width)); }
  double step_ = 0.0;
  std::vector<double> response_;
};

}  // namespace verification
