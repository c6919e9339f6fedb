// Smoothsteps: the polynomials that go from 0 to 1 at rest, of odd degree 3 to 11.
#pragma once
#include <array>

namespace pneuservo {

/// Smallest and largest degree of a smoothstep; only odd ones exist.
inline constexpr int smoothstep_degree_min = 3, smoothstep_degree_max = 11;

constexpr bool is_smoothstep_degree(int degree) noexcept {
  return degree >= smoothstep_degree_min && degree <= smoothstep_degree_max && degree % 2 == 1;
}

/// Coefficients, ascending, of s(z) = int_0^z w^k (1-w)^k dw / B(k+1, k+1), k = (degree-1)/2: s(0) = 0, s(1) = 1,
/// derivatives 1 to k vanish at both ends, s(z) + s(1-z) = 1. They are integers and exact.
/// `degree` must satisfy is_smoothstep_degree.
constexpr std::array<double, smoothstep_degree_max + 1> smoothstep_coefficients(int degree) noexcept {
  const int k = (degree - 1) / 2;
  double inverse_beta = 1.0;  // 1/B(k+1, k+1) = (2k+1) C(2k, k)
  for (int i = 1; i <= k; ++i) inverse_beta = inverse_beta * (k + i) / i;
  inverse_beta *= 2 * k + 1;
  std::array<double, smoothstep_degree_max + 1> c{};
  double binomial = 1.0;  // C(k, j) (-1)^j
  for (int j = 0; j <= k; ++j) {
    c[static_cast<std::size_t>(k) + static_cast<std::size_t>(j) + 1] = inverse_beta * binomial / (k + j + 1);
    binomial = -binomial * (k - j) / (j + 1);
  }
  return c;
}

}  // namespace pneuservo
