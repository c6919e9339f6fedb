// Real polynomials in s: product, value, roots.
#include "design/polynomial.hpp"

#include <algorithm>
#include <cmath>

#include "design/eigenvalues.hpp"

namespace pneuservo {

Polynomial product(const Polynomial& a, const Polynomial& b) {
  Polynomial out(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) out[i + j] += a[i] * b[j];
  return out;
}

Polynomial sum(const Polynomial& a, const Polynomial& b) {
  Polynomial out(std::max(a.size(), b.size()), 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) out[i] += a[i];
  for (std::size_t i = 0; i < b.size(); ++i) out[i] += b[i];
  return out;
}

Polynomial scaled(Polynomial a, double factor) {
  for (double& value : a) value *= factor;
  return a;
}

std::complex<double> value_at(const Polynomial& a, std::complex<double> s) {
  std::complex<double> value = 0.0;
  for (std::size_t i = a.size(); i-- > 0;) value = value * s + a[i];
  return value;
}

void sort_poles(std::vector<std::complex<double>>& poles) {
  std::sort(poles.begin(), poles.end(), [](const auto& a, const auto& b) {
    const double sizes = std::abs(a) - std::abs(b);
    if (std::fabs(sizes) > 1e-9 * std::abs(a)) return sizes < 0.0;
    if (std::fabs(a.real() - b.real()) > 1e-9 * std::abs(a)) return a.real() < b.real();
    return a.imag() > b.imag();
  });
}

std::vector<std::complex<double>> roots(const Polynomial& a) {
  std::size_t zeros = 0;  // roots at s = 0 come out exactly
  while (zeros + 1 < a.size() && a[zeros] == 0.0) ++zeros;
  const Polynomial rest(a.begin() + static_cast<std::ptrdiff_t>(zeros), a.end());
  std::vector<std::complex<double>> out(zeros, 0.0);
  const auto n = static_cast<Eigen::Index>(rest.size()) - 1;
  if (n == 0) return out;
  const double scale = std::pow(std::fabs(rest.front() / rest.back()), 1.0 / static_cast<double>(n));
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  double power = rest.back() * std::pow(scale, static_cast<double>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    companion(0, n - 1 - i) = -rest[static_cast<std::size_t>(i)] * std::pow(scale, static_cast<double>(i)) / power;
    if (i > 0) companion(i, i - 1) = 1.0;
  }
  Polynomial slope;
  for (std::size_t i = 1; i < rest.size(); ++i) slope.push_back(static_cast<double>(i) * rest[i]);
  const Eigen::VectorXcd values = unsorted_eigenvalues(companion);
  for (Eigen::Index i = 0; i < n; ++i) {
    std::complex<double> s = scale * values(i);
    for (int pass = 0; pass < 2; ++pass) {  // Newton; a double root, where the slope vanishes, stays as it is
      const auto step = value_at(rest, s) / value_at(slope, s);
      if (std::isfinite(std::abs(step)) && std::abs(step) < 1e-3 * std::abs(s)) s -= step;
    }
    out.push_back(s);
  }
  sort_poles(out);
  return out;
}

Polynomial series_quotient(const Polynomial& a, const Polynomial& b, std::size_t terms) {
  Polynomial out(terms, 0.0);
  for (std::size_t i = 0; i < terms; ++i) {
    double rest = i < a.size() ? a[i] : 0.0;
    for (std::size_t j = 1; j <= i && j < b.size(); ++j) rest -= b[j] * out[i - j];
    out[i] = rest / b[0];
  }
  return out;
}

}  // namespace pneuservo
