// The quick answer to the command: projections keep what follows the command's steps and nothing that is slow; with
// them dead time and lag are told apart, which means over a bin cannot.
#include <catch2/catch.hpp>

#include <cmath>

#include <pneuservo/core/random.hpp>

#include "config/rig_parameters.hpp"
#include "diagnosis/residuals/command_answer.hpp"
#include "diagnosis/residuals/cylinder_residuals.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

constexpr std::uint64_t seed = 20;

std::vector<double> white(std::size_t count, double size, std::uint64_t stream) {
  Random random(seed, stream);
  std::vector<double> out(count);
  for (double& value : out) value = size * random.normal();
  return out;
}

double squares(const Eigen::VectorXd& values) { return values.squaredNorm(); }

/// Squared residual of the rows over the whole recording.
double of_answers(CylinderResiduals& model, const Rig& rig) {
  const Eigen::VectorXd column = model.residuals(std::vector<Hypothesis>{{rig, {}}}).col(0);
  double sum = 0;
  for (std::size_t i = 0; i < model.rows().size(); ++i)
    if (model.rows()[i].over_recording) sum += std::pow(column(static_cast<Eigen::Index>(i)), 2);
  return sum;
}

}  // namespace

TEST_CASE("command answer: what follows the command's steps is kept whole, what is slow is taken out") {
  constexpr std::size_t count = 4000;
  const std::vector<double> command = white(count, 0.003, 1);
  const CommandAnswer answer(command, std::vector<char>(count, 1));
  REQUIRE(answer.rows() == static_cast<Eigen::Index>(CommandAnswer::latest));
  std::vector<double> slow(count), late(count), early(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) * 1e-3;
    slow[k] = 5e5 + 3e4 * t * t - 2e4 * t;
    late[k] = k >= 3 ? 4e4 * command[k - 3] : 0.0;
    early[k] = 4e4 * command[k];  // not an answer: the row is taken before its command acts
  }
  INFO("seed " << seed);
  CHECK(squares(answer.of(slow)) < 1e-6);
  const double all = std::pow(answer.quick_part(late), 2) * count;
  CHECK(squares(answer.of(late)) > 0.5 * all);
  // Twelve random directions of some 4000.
  CHECK(squares(answer.of(early)) < 0.02 * all);
}

TEST_CASE("command answer: noise that a loop brings into its command is no answer to it") {
  constexpr std::size_t count = 8000;
  constexpr int trials = 12;
  double sum = 0, rows = 0;
  for (std::uint64_t trial = 0; trial < trials; ++trial) {
    const std::vector<double> noise = white(count, 300.0, 40 + trial);
    std::vector<double> command(count);
    for (std::size_t k = 0; k < count; ++k) command[k] = -2e-6 * noise[k];
    const CommandAnswer answer(command, std::vector<char>(count, 1));
    sum += squares(answer.of(noise)) / (300.0 * 300.0);
    rows += static_cast<double>(answer.rows());
  }
  INFO("seed " << seed);
  // Of a chi-squared of 144 degrees of freedom over them: standard deviation 0.12.
  CHECK(sum / rows == Approx(1.0).margin(0.5));
}

TEST_CASE("command answer: white noise has the same size in every row, a command without steps has no rows") {
  constexpr std::size_t count = 20000;
  const CommandAnswer answer(white(count, 0.003, 2), std::vector<char>(count, 1));
  double sum = 0;
  for (std::uint64_t trial = 0; trial < 20; ++trial) sum += squares(answer.of(white(count, 1.0, 10 + trial)));
  INFO("seed " << seed);
  // 20 x 12 values of variance 1: standard deviation of their mean square 0.09.
  CHECK(sum / 20 / static_cast<double>(answer.rows()) == Approx(1.0).margin(0.45));
  std::vector<double> ramp(count);
  for (std::size_t k = 0; k < count; ++k) ramp[k] = 1e-4 * static_cast<double>(k);
  CHECK(CommandAnswer(ramp, std::vector<char>(count, 1)).rows() == 0);
}

TEST_CASE("command answer: rows are turned so that few carry what is uncertain, and nothing is lost") {
  constexpr std::size_t count = 4000;
  const std::vector<double> command = white(count, 0.003, 3);
  CommandAnswer answer(command, std::vector<char>(count, 1));
  std::vector<double> late(count), later(count);
  for (std::size_t k = 5; k < count; ++k) {
    late[k] = 4e4 * command[k - 2];
    later[k] = 1e4 * command[k - 5];
  }
  const std::vector<Eigen::VectorXd> possible{answer.of(late), answer.of(later)};
  const Eigen::VectorXd sizes = answer.turn_along(possible);
  INFO("seed " << seed);
  CHECK(squares(sizes) == Approx((squares(possible[0]) + squares(possible[1])) / 2));
  CHECK(squares(answer.of(late)) == Approx(squares(possible[0])));
  const double largest = sizes.maxCoeff();
  int uncertain = 0;
  for (Eigen::Index i = 0; i < sizes.size(); ++i) {
    if (sizes(i) > 1e-6 * largest) ++uncertain;
    else CHECK(std::abs(answer.of(late)(i)) < 1e-5 * largest);
  }
  CHECK(uncertain == 2);
}

TEST_CASE("command answer: dead time and lag of the same length are told apart") {
  Rig truth = cylinder_rig(2.0, 6.1e-3), lag = truth;
  const Rig owner = truth;
  set_parameter(truth, "effects.command_delay.delay_s", 1.5e-3);
  set_parameter(lag, "effects.valve_lag.time_constant_s", 1.5e-3);
  CylinderResiduals model(owner, {simulated_recording(truth, 8.0, 5, {"p1_port_Pa", "p2_port_Pa"})});
  const double right = of_answers(model, truth), wrong = of_answers(model, lag), none = of_answers(model, owner);
  CAPTURE(right, wrong, none);
  CHECK(right < 40);  // 24 rows
  CHECK(wrong - right > 1);  // the model error of a tenth is wide
  CHECK(none - right > 20);
}
