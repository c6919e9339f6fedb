// Figures of the printed moves on the linear plant, for tools/servo-table-figures.
#include <catch2/catch.hpp>

#include <cstdio>

#include "control/linear_table_trials.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {
void print(const TableCase& one, const char* what, double way_m, double error_um) {
  std::printf("{\"table\": \"linear\", \"line\": \"%s\", \"what\": \"%s\", \"way_mm\": %.0f, \"error_um\": %.6g}\n",
              one.name, what, 1e3 * way_m, error_um);
}
}  // namespace

// Run by its tag alone: it prints, the tests of control check the same numbers.
TEST_CASE("linear plant, printed moves", "[.servo-table]") {
  using F = FeedforwardKind;
  using O = ObserverInput;
  for (const TableCase* one : {&table_4mm, &table_8mm})
    for (const double way_m : {0.1, 0.07, 0.05, 0.02}) {
      print(*one, "without", way_m, with_ideal_derivatives_um(*one, one->gains_3, 0, way_m));
      print(*one, "3rd", way_m, with_ideal_derivatives_um(*one, one->gains_3, 3, way_m));
      print(*one, "5th", way_m, with_ideal_derivatives_um(*one, one->gains_5, 5, way_m));
      print(*one, "5th, printed observer on x", way_m,
            with_law_um(*one, one->gains_5, {F::order_5, O::measured, printed_observer, false}, way_m));
      print(*one, "5th, error observer, shift", way_m,
            with_law_um(*one, one->gains_5, {F::order_5, O::error, printed_observer, true}, way_m));
      print(*one, "7th, error observer, shift", way_m,
            with_law_um(*one, one->gains_5, {F::order_7, O::error, printed_observer, true}, way_m));
      print(*one, "7th, observer 1000 rad/s", way_m,
            with_law_um(*one, one->gains_5, {F::order_7, O::error, 1000.0, true}, way_m));
    }
  SUCCEED();
}
