// A wish to stop: how often it is looked for, and that nothing is simulated after it.
#include <atomic>
#include <cmath>
#include <memory>

#include <catch2/catch.hpp>

#include <pneuservo/core/random.hpp>

#include "config/rig_parameters.hpp"
#include "core/test_seed.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/driven_axis_residuals.hpp"
#include "diagnosis/residuals/gas_runs.hpp"
#include "diagnosis/result_text.hpp"
#include "diagnosis/simulated_recording.hpp"
#include "diagnosis/synthetic_axis.hpp"

namespace pneuservo {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

constexpr auto no_extra = [](double, double, double) { return 0.0; };

/// Answers yes from the wanted look on, and counts.
struct CountedStop {
  long wanted = -1;  ///< never
  std::atomic<long> looks{0};
  std::function<void()> at_stop;

  StopQuestion question() {
    return [this] {
      const long look = ++looks;
      if (look == wanted && at_stop) at_stop();
      return wanted > 0 && look >= wanted;
    };
  }
};

/// Another model, with what is asked of its simulation counted.
class CountedModel final : public ResidualModel {
 public:
  explicit CountedModel(std::unique_ptr<ResidualModel> model) : model_(std::move(model)) {}
  const std::vector<ResidualChannel>& channels() const override { return model_->channels(); }
  const std::vector<ResidualRow>& rows() const override { return model_->rows(); }
  void set_stop(StopQuestion stop) override { model_->set_stop(std::move(stop)); }
  Eigen::MatrixXd residuals(std::span<const Hypothesis> hypotheses) override {
    ++asked;
    return model_->residuals(hypotheses);
  }
  std::vector<ChannelMisfit> sample_misfit(const Hypothesis& hypothesis) override {
    ++asked;
    return model_->sample_misfit(hypothesis);
  }
  std::vector<ResidualCourse> courses(const Hypothesis& hypothesis) override {
    ++asked;
    return model_->courses(hypothesis);
  }
  long asked = 0;

 private:
  std::unique_ptr<ResidualModel> model_;
};

/// As CountedModel, of an axis with dry friction that its config does not know.
CountedModel axis_with_friction() {
  Rig machine = testing::driven_axis_rig();
  set_parameter(machine, "effects.coulomb_friction.force_N", 6);
  return CountedModel(
      make_residual_model(testing::driven_axis_rig(), {testing::axis_recording(machine, 1, no_extra)}, 1));
}

TEST_CASE("a run along a recording looks for a stop every hundred steps of the plant, however many a row has") {
  const int steps = GENERATE(1, 7, 250);
  const Rig rig = test::cylinder_rig();
  ImposedInputs inputs;
  inputs.period_s = rig.period_s * steps;
  inputs.steps = steps;
  const std::size_t rows = 2001 / static_cast<std::size_t>(steps) + 2;
  for (auto* values : {&inputs.command_V[0], &inputs.position_m, &inputs.velocity_mps}) values->assign(rows, 0.0);
  for (std::size_t side = 0; side < 2; ++side) {
    inputs.start_Pa[side].assign(rows, 500e3);
    inputs.start_Pa_per_s[side].assign(rows, 0.0);
  }
  const ImposedRun run{&rig, {}};
  CountedStop stop;
  run_imposed(inputs, std::span(&run, 1), {4, 8}, stop.question());
  const long plant_steps = static_cast<long>(rows - 1) * steps;
  CHECK(stop.looks >= plant_steps / (steps_between_looks + steps));
  CHECK(stop.looks <= plant_steps / steps_between_looks);
  CountedStop second;
  second.wanted = 2;
  CHECK_THROWS_AS(run_imposed(inputs, std::span(&run, 1), {4, 8}, second.question()), DiagnosisStopped);
  CHECK(second.looks == 2);
}

TEST_CASE("the first failure ends what other threads have not begun") {
  std::atomic<int> begun{0};
  CHECK_THROWS_AS(in_parallel(1000, 2,
                              [&](std::size_t) {
                                ++begun;
                                throw DiagnosisStopped();
                              }),
                  DiagnosisStopped);
  CHECK(begun <= 2);
}

TEST_CASE("after a stop in any phase nothing is simulated, and what is known by then is told") {
  const Rig rig = testing::driven_axis_rig();
  CountedStop never;
  DiagnoseOptions options;
  options.stop = never.question();
  CountedModel whole = axis_with_friction();
  const Diagnosis finished = diagnose(rig, whole, options);
  REQUIRE_FALSE(finished.stopped);
  const std::uint64_t seed = test::new_seed();
  INFO("seed " << seed);
  Random random(seed, 0);
  std::size_t named = 0, unknown_yet = 0;
  constexpr int stops = 12;  // one in each twelfth of the work
  for (int i = 0; i < stops; ++i) {
    CountedStop stop;
    stop.wanted = 1 + static_cast<long>((i + random.uniform()) / stops * static_cast<double>(never.looks.load()));
    INFO("stopped at look " << stop.wanted << " of " << never.looks.load());
    CountedModel model = axis_with_friction();
    long asked_at_stop = 0;
    stop.at_stop = [&] { asked_at_stop = model.asked; };
    options.stop = stop.question();
    try {
      const Diagnosis early = diagnose(rig, model, options);
      CHECK(early.stopped);
      CHECK_THAT(early.sentence, StartsWith("Stopped early"));
      REQUIRE(early.channels.size() == 1);
      const ChannelFit& force = early.channels[0];
      CHECK(force.noise < 1.01 * finished.channels[0].noise);  // of means over rows
      CHECK(force.noise > 0.2 * finished.channels[0].noise);
      CHECK(std::isnan(force.held_out_after));
      CHECK(std::isnan(early.error_left));
      CHECK_THAT(diagnosis_text(early), !Contains("held out of every fit") && !Contains("nan") && Contains("–"));
      CHECK(early.courses_after.empty());
      named += !early.answers.empty() && early.answers[0].effect == "coulomb_friction";
    } catch (const DiagnosisStopped&) { ++unknown_yet; }
    CHECK(model.asked == asked_at_stop);
    CHECK(stop.looks <= stop.wanted + 1);
  }
  CHECK(named > 0);
  CHECK(unknown_yet < 6);
}

TEST_CASE("a cylinder's recordings are made ready and searched with a look at every turn") {
  const Rig rig = test::cylinder_rig();
  const Recording recording = test::simulated_recording(rig, 3.0, 5, {"p1_port_Pa", "p2_port_Pa"});
  CountedStop ready;
  const auto model = make_residual_model(rig, {recording}, 2, ready.question());
  // The grid's error, the ringing and the channels' levels are runs along all 3000 rows, and each is looked into.
  CHECK(ready.looks >= 3 * 3000 / (steps_between_looks + 1));
  for (const long wanted : {1L, ready.looks / 2, ready.looks.load()}) {
    CountedStop stop;
    stop.wanted = wanted;
    CHECK_THROWS_AS(make_residual_model(rig, {recording}, 2, stop.question()), DiagnosisStopped);
    CHECK(stop.looks <= wanted + 2);  // each of two threads once more
  }
}

}  // namespace
}  // namespace pneuservo
