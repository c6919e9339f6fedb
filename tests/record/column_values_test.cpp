// What the values of a column say together.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "core/test_seed.hpp"
#include "record/column_values.hpp"

using namespace pneuservo;

TEST_CASE("two quantiles from one copy are those of the sorted finite values") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  std::uniform_int_distribution<int> step(-40, 40);
  for (const int rows : {1, 2, 3, 200, 1001}) {
    std::vector<double> values, sorted;
    for (int i = 0; i < rows; ++i) values.push_back(0.1 * step(generator));
    sorted = values;
    std::sort(sorted.begin(), sorted.end());
    values.insert(values.begin() + rows / 2, NAN);
    values.push_back(INFINITY);
    const auto at = [&](double share) {
      return sorted[static_cast<std::size_t>(std::lround(share * static_cast<double>(rows - 1)))];
    };
    const auto [low, high] = quantiles(values, 0.005, 0.995);
    CHECK(low == at(0.005));
    CHECK(high == at(0.995));
    CHECK(quantile(values, 0.75) == at(0.75));
  }
  CHECK(std::isnan(quantiles({NAN}, 0.1, 0.9).first));
}
