// Exponential of a small matrix in plain double arithmetic: the same bits in every build, which Eigen's is not.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

namespace pneuservo {

template <std::size_t N> using SquareMatrix = std::array<std::array<double, N>, N>;

template <std::size_t N> SquareMatrix<N> product(const SquareMatrix<N>& a, const SquareMatrix<N>& b) noexcept {
  SquareMatrix<N> out{};
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j)
      for (std::size_t k = 0; k < N; ++k) out[i][j] += a[i][k] * b[k][j];
  return out;
}

/// exp(a) by a Taylor series of a/2^n with row sums below 1/2, squared n times. Exact to some 1e-15 of its largest
/// entry: scale the states so that the entries are alike. Cold.
template <std::size_t N> SquareMatrix<N> exponential(SquareMatrix<N> a) noexcept {
  double norm = 0.0;
  for (const auto& row : a) {
    double sum = 0.0;
    for (const double value : row) sum += std::fabs(value);
    norm = std::fmax(norm, sum);
  }
  const int squarings = norm > 0.5 ? static_cast<int>(std::ceil(std::log2(norm / 0.5))) : 0;
  for (auto& row : a)
    for (double& value : row) value = std::ldexp(value, -squarings);
  SquareMatrix<N> sum{}, term{};
  for (std::size_t i = 0; i < N; ++i) sum[i][i] = term[i][i] = 1.0;
  constexpr int terms = 16;  // 0.5^16/16! < 1e-18
  for (int n = 1; n <= terms; ++n) {
    term = product(term, a);
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < N; ++j) sum[i][j] += (term[i][j] /= n);
  }
  for (int i = 0; i < squarings; ++i) sum = product(sum, sum);
  return sum;
}

}  // namespace pneuservo
