// Polynomials: roots that are known, series, order of the poles.
#include <catch2/catch.hpp>

#include <random>

#include "design/polynomial.hpp"

using namespace pneuservo;
using Complex = std::complex<double>;

TEST_CASE("roots of products of known factors") {
  std::mt19937 random(20261121);
  INFO("seed 20261121");
  std::uniform_real_distribution<double> size(0.1, 3.0), ratio(0.01, 0.99), decade(0.0, 3.0);
  for (int trial = 0; trial < 50; ++trial) {
    const double real = -std::pow(10.0, decade(random)) * size(random);
    Polynomial p{-real, 1.0};
    std::vector<Complex> expected{real};
    for (int pair = 0; pair < 3; ++pair) {
      const double w = std::pow(10.0, decade(random)) * size(random), z = ratio(random);
      p = product(p, {w * w, 2.0 * z * w, 1.0});
      const Complex pole(-z * w, w * std::sqrt(1.0 - z * z));
      expected.push_back(pole);
      expected.push_back(std::conj(pole));
    }
    sort_poles(expected);
    const auto found = roots(p);
    REQUIRE(found.size() == expected.size());
    for (const Complex& pole : expected) {  // near roots are conditioned badly; each is found all the same
      double nearest = 1e300;
      for (const Complex& root : found) nearest = std::min(nearest, std::abs(root - pole));
      CHECK(nearest < 1e-6 * std::abs(pole));
    }
  }
}

TEST_CASE("roots at zero come out exactly, pairs stand together") {
  const auto found = roots({0.0, 0.0, 4.0, 0.0, 1.0});
  REQUIRE(found.size() == 4);
  CHECK(found[0] == Complex(0.0));
  CHECK(found[1] == Complex(0.0));
  CHECK(std::abs(found[2] - Complex(0.0, 2.0)) < 1e-12);
  CHECK(std::abs(found[3] - Complex(0.0, -2.0)) < 1e-12);
}

TEST_CASE("the series of a quotient times the denominator is the numerator") {
  const Polynomial a{1.0, 2.0, 3.0}, b{2.0, -1.0, 0.5, 4.0};
  const Polynomial back = product(series_quotient(a, b, 8), b);
  for (std::size_t i = 0; i < 8; ++i) CHECK(back[i] == Approx(i < a.size() ? a[i] : 0.0).margin(1e-12));
}
