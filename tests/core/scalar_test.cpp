// Scalars: every operation of a pack or dual number agrees with the built-in scalar, lane by lane and bit for bit.
#include <catch2/catch.hpp>

#include <pneuservo/core/dual.hpp>

using namespace pneuservo;

namespace {
constexpr double samples[8] = {-2.5, -1e-3, 0.0, 1e-7, 0.4, 1.0, 3.75, 1e6};
}

TEMPLATE_TEST_CASE("pack arithmetic is the scalar's, bit for bit", "", (Pack<double, 2>), (Pack<double, 4>),
                   (Pack<double, 8>)) {
  constexpr int n = ScalarTraits<TestType>::lanes;
  const TestType a = TestType::load(samples), b = TestType::load(samples + 8 - n);
  const TestType sum = a + b, product = a * b, quotient = a / (b + TestType(3.0)), root = square_root(absolute(a));
  const TestType chosen = select(a < b, a, b), smaller = minimum(a, b);
  for (int i = 0; i < n; ++i) {
    REQUIRE(sum[i] == a[i] + b[i]);
    REQUIRE(product[i] == a[i] * b[i]);
    REQUIRE(quotient[i] == a[i] / (b[i] + 3.0));
    REQUIRE(root[i] == std::sqrt(std::fabs(a[i])));
    REQUIRE(chosen[i] == (a[i] < b[i] ? a[i] : b[i]));
    REQUIRE(smaller[i] == std::min(a[i], b[i]));
  }
  const auto pair = join(a, b);
  for (int i = 0; i < n; ++i) REQUIRE((low(pair)[i] == a[i] && high(pair)[i] == b[i]));
}

TEST_CASE("dual numbers carry the derivative of sums, products, quotients and roots") {
  using D = Dual<double, 2>;
  const double x = 0.7, y = 2.3;
  const D dx = D::variable(x, 0), dy = D::variable(y, 1);
  const D f = square_root(dx * dy + dx / dy) - exponential(dx) * sine(dy);
  const double inner = x * y + x / y;
  REQUIRE(f.value == Approx(std::sqrt(inner) - std::exp(x) * std::sin(y)));
  REQUIRE(f.derivative[0] == Approx(0.5 / std::sqrt(inner) * (y + 1 / y) - std::exp(x) * std::sin(y)));
  REQUIRE(f.derivative[1] == Approx(0.5 / std::sqrt(inner) * (x - x / (y * y)) - std::exp(x) * std::cos(y)));
}
