// Slow error: its own residuals come out white, others keep their evidence; without a level nothing changes.
#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

#include <pneuservo/core/random.hpp>

#include "diagnosis/residuals/residual_model.hpp"
#include "diagnosis/residuals/slow_error.hpp"

using namespace pneuservo;

namespace {
/// Residuals as the slow error supposes them, 10 ms apart.
std::vector<double> residuals_of(const SlowError& error, std::size_t count, std::uint64_t random_seed) {
  Random random(random_seed);
  std::vector<double> out;
  const double kept = std::exp(-0.01 / error.memory_s);
  double drift = error.level * random.normal();
  for (std::size_t k = 0; k < count; ++k) {
    out.push_back(drift + random.normal());
    drift = kept * drift + error.level * std::sqrt(1.0 - kept * kept) * random.normal();
  }
  return out;
}
std::vector<double> times(std::size_t count) {
  std::vector<double> out;
  for (std::size_t k = 0; k < count; ++k) out.push_back(0.01 * static_cast<double>(k));
  return out;
}
}  // namespace

TEST_CASE("slow error: what it supposes comes out white with variance 1") {
  const SlowError error{0.5, 8.0};
  std::vector<double> rows = residuals_of(error, 20000, 7);
  CHECK(error.whiten(times(rows.size()), rows) > 0.0);
  double squares = 0, products = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    squares += rows[k] * rows[k];
    products += rows[k] * rows[k - 1];
  }
  CHECK(squares / static_cast<double>(rows.size()) == Approx(1.0).epsilon(0.05));
  CHECK(std::fabs(products / squares) < 0.03);
}

TEST_CASE("slow error: a step and a constant lose evidence, a quick change keeps it") {
  const SlowError error{1.0, 5.0};
  const auto left = [&](auto&& shape) {
    std::vector<double> rows;
    double before = 0;
    for (std::size_t k = 0; k < 1000; ++k) {
      rows.push_back(shape(k));
      before += rows.back() * rows.back();
    }
    error.whiten(times(rows.size()), rows);
    double after = 0;
    for (const double row : rows) after += row * row;
    return after / before;
  };
  CHECK(left([](std::size_t) { return 1.0; }) < 0.02);
  CHECK(left([](std::size_t k) { return k < 500 ? 0.0 : 1.0; }) < 0.03);
  CHECK(left([](std::size_t k) { return k % 2 ? 1.0 : -1.0; }) > 0.5);
}

TEST_CASE("slow error: level 0 leaves residuals as they are") {
  std::vector<double> rows{1.0, -2.0, 3.0};
  CHECK(SlowError{}.whiten(times(3), rows) == 0.0);
  CHECK(rows == std::vector<double>{1.0, -2.0, 3.0});
}

TEST_CASE("slow errors: rows of a channel with one become as it whitens them by itself, all others stay") {
  const std::vector<SlowError> of_channel{{0.5, 8.0}, {}};
  std::vector<ResidualRow> rows;
  std::vector<double> times_s, expected;
  Random random(11);
  for (int k = 0; k < 40; ++k)
    for (const int channel : {0, 1}) {
      ResidualRow row{channel, 0};
      row.time_s = 0.01 * k + (k >= 20 ? 0.7 : 0.0);  // something between is left out
      rows.push_back(row);
    }
  rows.push_back({0, 0});
  rows.back().over_recording = true;
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(rows.size()), 2);
  for (double& value : columns.reshaped()) value = random.normal();
  const Eigen::MatrixXd before = columns;
  for (Eigen::Index i = 0; i + 1 < columns.rows(); i += 2) {
    times_s.push_back(rows[static_cast<std::size_t>(i)].time_s);
    expected.push_back(before(i, 1));
  }
  of_channel[0].whiten(times_s, expected);

  const SlowErrors errors(rows, of_channel);
  errors.take_out(columns);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(2 * k);
    CHECK(columns(at, 1) == Approx(expected[k]).epsilon(1e-12));
    CHECK(columns(at + 1, 1) == before(at + 1, 1));
  }
  CHECK(columns(columns.rows() - 1, 0) == before(columns.rows() - 1, 0));

  errors.put_back(columns);
  CHECK((columns - before).cwiseAbs().maxCoeff() < 1e-12);
}
