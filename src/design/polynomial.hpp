// Real polynomials in s: product, value, roots.
#pragma once
#include <complex>
#include <vector>

namespace pneuservo {

/// Coefficients by rising power; never empty.
using Polynomial = std::vector<double>;

Polynomial product(const Polynomial& a, const Polynomial& b);
Polynomial sum(const Polynomial& a, const Polynomial& b);
Polynomial scaled(Polynomial a, double factor);
std::complex<double> value_at(const Polynomial& a, std::complex<double> s);

/// All roots, sorted by size, those of a pair beside each other with the positive imaginary part first. The leading
/// coefficient must not be zero. The companion matrix is scaled by the roots' geometric mean; each root is polished.
std::vector<std::complex<double>> roots(const Polynomial& a);

/// By size, then the positive imaginary part first.
void sort_poles(std::vector<std::complex<double>>& poles);

/// The first `terms` coefficients of the power series of a/b; b[0] must not be zero.
Polynomial series_quotient(const Polynomial& a, const Polynomial& b, std::size_t terms);

}  // namespace pneuservo
