// Exponential of a small matrix in plain double arithmetic: the same bits in every build, which Eigen's is not;
// and without the twenty seconds that Eigen's takes to compile.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

namespace pneuservo {

template <std::size_t N> using SquareMatrix = std::array<std::array<double, N>, N>;

/// exp(a) of an n x n matrix of any kind by a Taylor series of a/2^m with row sums below 1/2, squared m times. Exact to
/// some 1e-15 of its largest entry: scale the states so that the entries are alike. `zero` is such a matrix of zeros,
/// entry(matrix, i, j) one of its numbers.
template <class Matrix, class Entry>
Matrix exponential_of(Matrix a, const Matrix& zero, std::size_t n,
                      const Entry& entry) noexcept(noexcept(Matrix(zero))) {
  const auto product = [&](Matrix& left, Matrix& right) {
    Matrix out = zero;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t k = 0; k < n; ++k) entry(out, i, j) += entry(left, i, k) * entry(right, k, j);
    return out;
  };
  double norm = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j < n; ++j) sum += std::fabs(entry(a, i, j));
    norm = std::fmax(norm, sum);
  }
  const int squarings = norm > 0.5 ? static_cast<int>(std::ceil(std::log2(norm / 0.5))) : 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) entry(a, i, j) = std::ldexp(entry(a, i, j), -squarings);
  Matrix sum = zero, term = zero;
  for (std::size_t i = 0; i < n; ++i) entry(sum, i, i) = entry(term, i, i) = 1.0;
  constexpr int terms = 16;  // 0.5^16/16! < 1e-18
  for (int order = 1; order <= terms; ++order) {
    term = product(term, a);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) entry(sum, i, j) += (entry(term, i, j) /= order);
  }
  for (int i = 0; i < squarings; ++i) sum = product(sum, sum);
  return sum;
}

/// Allocates nothing.
template <std::size_t N> SquareMatrix<N> exponential(const SquareMatrix<N>& a) noexcept {
  return exponential_of(a, SquareMatrix<N>{}, N,
                        [](SquareMatrix<N>& m, std::size_t i, std::size_t j) -> double& { return m[i][j]; });
}

}  // namespace pneuservo
