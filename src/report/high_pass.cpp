// Zero-phase Butterworth high-pass of second order, forward and backward.
#include <report/high_pass.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

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

using Samples = std::vector<double>;

double product(const Samples& a, const Samples& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); }

/// Forward and backward; the extensions of `pad` samples at both ends are cut off.
Samples filtered(const Biquad& filter, Samples padded, std::size_t pad) {
  filter.run(padded.begin(), padded.end());
  filter.run(padded.rbegin(), padded.rend());
  const auto margin = static_cast<std::ptrdiff_t>(pad);
  return Samples(padded.begin() + margin, padded.end() - margin);
}

}  // namespace

std::vector<double> zero_phase_high_pass(const std::vector<double>& samples, double period_s, double corner_Hz) {
  const std::size_t n = samples.size();
  if (n < 2 || corner_Hz * period_s >= 0.5) return Samples(n, 0.0);
  const auto wanted = static_cast<std::size_t>(std::ceil(3.0 / (corner_Hz * period_s)));
  const std::size_t pad = std::min(wanted, n - 1);

  Samples padded(n + 2 * pad), front(padded.size(), 0.0), back(padded.size(), 0.0);
  std::copy(samples.begin(), samples.end(), padded.begin() + static_cast<std::ptrdiff_t>(pad));
  for (std::size_t k = 1; k <= pad; ++k) {
    padded[pad - k] = 2.0 * samples.front() - samples[k];
    padded[pad + n - 1 + k] = 2.0 * samples.back() - samples[n - 1 - k];
    front[pad - k] = back[pad + n - 1 + k] = 2.0;
  }
  const Biquad filter(period_s, corner_Hz);
  Samples out = filtered(filter, padded, pad);
  const Samples by_front = filtered(filter, front, pad), by_back = filtered(filter, back, pad);

  // Pivots moved by c and d give out + c by_front + d by_back; least squares over the run (two normal equations).
  const double ff = product(by_front, by_front), bb = product(by_back, by_back), fb = product(by_front, by_back);
  const double fo = product(by_front, out), bo = product(by_back, out), determinant = ff * bb - fb * fb;
  if (!(determinant > 1e-12 * ff * bb)) return out;
  const double c = (fb * bo - bb * fo) / determinant, d = (fb * fo - ff * bo) / determinant;
  for (std::size_t k = 0; k < n; ++k) out[k] += c * by_front[k] + d * by_back[k];
  return out;
}

}  // namespace pneuservo
