// Smooth interpolation of sampled positions: septic Hermite pieces on derivatives from local polynomials.
#include "control/interpolation.hpp"

#include <algorithm>
#include <cstddef>

namespace pneuservo {

namespace {
/// Derivatives 0 to 3 at `node`, of the polynomial through `count` samples from `first`: Newton's divided differences,
/// then Horner's scheme for the Taylor coefficients at the node.
std::array<double, 4> local_derivatives(const std::vector<double>& t, const std::vector<double>& x, std::size_t first,
                                        std::size_t count, std::size_t node) {
  std::array<double, 7> difference{};
  for (std::size_t i = 0; i < count; ++i) difference[i] = x[first + i] - x[node];
  for (std::size_t level = 1; level < count; ++level)
    for (std::size_t i = count - 1; i >= level; --i)
      difference[i] = (difference[i] - difference[i - 1]) / (t[first + i] - t[first + i - level]);
  std::array<double, 4> taylor{};
  for (std::size_t i = count; i-- > 0;) {
    const double w = t[node] - t[first + i];
    for (std::size_t k = 3; k > 0; --k) taylor[k] = taylor[k] * w + taylor[k - 1];
    taylor[0] = taylor[0] * w + difference[i];
  }
  return {x[node], taylor[1], 2.0 * taylor[2], 6.0 * taylor[3]};
}
}  // namespace

std::vector<std::array<double, 8>> interpolate_septic(const std::vector<double>& times_s, const std::vector<double>& positions_m) {
  const std::size_t n = times_s.size(), window = std::min<std::size_t>(n, 7);
  std::vector<std::array<double, 4>> node(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = std::min(i > window / 2 ? i - window / 2 : 0, n - window);
    node[i] = local_derivatives(times_s, positions_m, first, window, i);
  }
  std::vector<std::array<double, 8>> pieces(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double h = times_s[i + 1] - times_s[i];
    const auto& a = node[i];
    const auto& b = node[i + 1];
    // Left end fixes c0..c3; d0..d3 is what is missing at the right end of value and derivatives 1 to 3.
    const double c1 = a[1] * h, c2 = a[2] * h * h / 2.0, c3 = a[3] * h * h * h / 6.0;
    const double d0 = b[0] - a[0] - c1 - c2 - c3;
    const double d1 = b[1] * h - c1 - 2.0 * c2 - 3.0 * c3;
    const double d2 = b[2] * h * h - 2.0 * c2 - 6.0 * c3;
    const double d3 = b[3] * h * h * h - 6.0 * c3;
    pieces[i] = {a[0], c1, c2, c3,
                 35.0 * d0 - 15.0 * d1 + 2.5 * d2 - d3 / 6.0,
                 -84.0 * d0 + 39.0 * d1 - 7.0 * d2 + 0.5 * d3,
                 70.0 * d0 - 34.0 * d1 + 6.5 * d2 - 0.5 * d3,
                 -20.0 * d0 + 10.0 * d1 - 2.0 * d2 + d3 / 6.0};
  }
  return pieces;
}

}  // namespace pneuservo
