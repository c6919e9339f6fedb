// Zero-phase Butterworth high-pass of second order, forward and backward.
#include <report/high_pass.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pneuservo {
namespace {

/// H(z) = b (1 - z^-1)^2 / (1 + a1 z^-1 + a2 z^-2)
struct Biquad {
  double b, a1, a2;

  Biquad(double period_s, double corner_Hz) {
    const double k = std::tan(std::numbers::pi * corner_Hz * period_s);
    const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
    b = scale;
    a1 = 2.0 * (k * k - 1.0) * scale;
    a2 = (1.0 - std::numbers::sqrt2 * k + k * k) * scale;
  }

  /// In place; the state starts as if the first sample had stood forever.
  template <class Iterator> void run(Iterator first, Iterator last) const {
    double z1 = -b * *first, z2 = b * *first;
    for (; first != last; ++first) {
      const double in = *first, out = b * in + z1;
      z1 = -2.0 * b * in - a1 * out + z2;
      z2 = b * in - a2 * out;
      *first = out;
    }
  }
};

}  // namespace

std::vector<double> zero_phase_high_pass(const std::vector<double>& samples, double period_s, double corner_Hz) {
  const std::size_t n = samples.size();
  if (n < 2 || corner_Hz * period_s >= 0.5) return std::vector<double>(n, 0.0);
  const auto wanted = static_cast<std::size_t>(std::ceil(3.0 / (corner_Hz * period_s)));
  const std::size_t pad = std::min(wanted, n - 1);
  const auto margin = static_cast<std::ptrdiff_t>(pad);

  std::vector<double> padded(n + 2 * pad);
  std::copy(samples.begin(), samples.end(), padded.begin() + margin);
  for (std::size_t k = 1; k <= pad; ++k) {
    padded[pad - k] = 2.0 * samples.front() - samples[k];
    padded[pad + n - 1 + k] = 2.0 * samples.back() - samples[n - 1 - k];
  }
  const Biquad filter(period_s, corner_Hz);
  filter.run(padded.begin(), padded.end());
  filter.run(padded.rbegin(), padded.rend());
  return std::vector<double>(padded.begin() + margin, padded.end() - margin);
}

}  // namespace pneuservo
