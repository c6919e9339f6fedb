// Levels of a model: held-out stretches fit worse by what the numbers of a fit are uncertain by, and that is no excess.
#include <catch2/catch.hpp>

#include <array>
#include <cmath>

#include <pneuservo/core/random.hpp>

#include "config/rig_parameters.hpp"
#include "diagnosis/closed_form_model.hpp"
#include "diagnosis/verdict/decision.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

constexpr std::array paths{"effects.valve_edge_overlaps.supply_1", "effects.valve_edge_overlaps.exhaust_1",
                           "effects.valve_edge_overlaps.supply_2", "effects.valve_edge_overlaps.exhaust_2",
                           "effects.valve_offset.offset_V",        "effects.valve_dead_band.width_V",
                           "effects.constant_force.force_N",       "effects.periodic_force.phase_rad"};
constexpr std::size_t fitted_rows = 16, all_rows = 40;

/// A straight line of eight numbers in noise of one, which is `beyond` higher on held-out rows.
ClosedFormModel line_in_noise(Random& random, double beyond) {
  Eigen::MatrixXd slopes(all_rows, paths.size());
  for (double& slope : slopes.reshaped()) slope = 5 * random.normal();
  std::vector<double> noise(all_rows);
  for (std::size_t i = 0; i < all_rows; ++i) noise[i] = random.normal() + (i < fitted_rows ? 0 : beyond);
  ClosedFormModel model([slopes, noise](const Rig& rig) {
    std::vector<double> out(noise);
    for (std::size_t p = 0; p < paths.size(); ++p) {
      const double off = get_parameter(rig, paths[p]);
      for (std::size_t i = 0; i < out.size(); ++i)
        out[i] += slopes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(p)) * off;
    }
    return out;
  });
  model.hold_out_from(fitted_rows);
  return model;
}

ModelLevels fitted_levels(ClosedFormModel& model) {
  FittedRows rows(model, {});
  Fit fit;
  for (const char* path : paths) {
    FreeParameter parameter = free_number(fit.base.rig, path);
    parameter.center = 0;
    parameter.spread = 1;
    fit.parameters.push_back(parameter);
  }
  fit.own_count = paths.size();
  fit.z.setZero(static_cast<Eigen::Index>(paths.size()));
  improve(rows, {&fit}, 6, Columns::all);
  DecisionRules rules;
  rules.worse_fit = 0;  // the expected ratio is computed above it alone
  return model_levels(model, fit, rules);
}

/// Means of the logarithms of ratio and excess over trials.
std::array<double, 2> mean_logarithms(double beyond) {
  constexpr std::uint64_t seed = 3;
  constexpr int trials = 60;
  std::array<double, 2> sum{};
  for (int trial = 0; trial < trials; ++trial) {
    Random random(seed, static_cast<std::uint64_t>(trial));
    ClosedFormModel model = line_in_noise(random, beyond);
    const ModelLevels levels = fitted_levels(model);
    sum[0] += std::log(levels.held_out_ratio()) / trials;
    sum[1] += std::log(levels.held_out_excess()) / trials;
  }
  INFO("seed " << seed);
  return sum;
}

}  // namespace

TEST_CASE("model levels: a right model with many numbers fits held-out rows as well as is expected of it") {
  const auto [ratio, excess] = mean_logarithms(0);
  CHECK(ratio > std::log(2.0));
  CHECK(std::abs(excess) < std::log(1.3));
}

TEST_CASE("model levels: what is missing on held-out rows alone stays an excess") {
  CHECK(mean_logarithms(6)[1] > std::log(3.0));
}
