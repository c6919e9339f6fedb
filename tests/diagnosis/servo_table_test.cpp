// A servo table's recordings: two valves with commands of their own, micrometres of motion.
#include <cmath>
#include <numbers>

#include <catch2/catch.hpp>

#include "config/input_error.hpp"
#include "config/rig_parameters.hpp"
#include "core/test_seed.hpp"
#include "diagnosis/recordings/stretches.hpp"
#include "diagnosis/residuals/cylinder_residuals.hpp"
#include "diagnosis/table_recording.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

/// Root mean square over a channel's rows, in floors.
double rms_of(const ResidualModel& model, const Eigen::VectorXd& column, const std::string& channel) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < model.rows().size(); ++i) {
    if (model.channels()[static_cast<std::size_t>(model.rows()[i].channel)].name != channel) continue;
    sum += column(static_cast<Eigen::Index>(i)) * column(static_cast<Eigen::Index>(i));
    ++count;
  }
  return std::sqrt(sum / count);
}

Rig with(Rig rig, const char* path, double value) {
  set_parameter(rig, path, value);
  return rig;
}

}  // namespace

TEST_CASE("servo table: at the truth every channel is at its noise, and each side follows its own valve") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  const Rig rig = test::table_rig();
  const Recording recording = test::table_recording(rig, 5.0, seed);
  CylinderResiduals model(rig, {recording});
  REQUIRE(model.channels().size() == 3);
  CHECK(model.channels()[2].floor == Approx(0.021).epsilon(0.01));  // 0.07 N at 5 bar of gauge supply, here 1.5 bar
  const std::vector<Hypothesis> tried{{rig, {}},
                                      {with(rig, "effects.chamber_leak_2.area_m2", 2e-8), {}},
                                      {with(rig, "effects.coulomb_friction.force_N", 1.0), {}},
                                      {with(rig, "effects.valve_offset.offset_V", 0.01), {}}};
  const Eigen::MatrixXd columns = model.residuals(tried);
  for (const char* channel : {"p1_port", "p2_port", "F"}) {
    CAPTURE(channel);
    CHECK(rms_of(model, columns.col(0), channel) < 1.2);
  }
  const auto change = [&](Eigen::Index i, const char* channel) {
    return rms_of(model, columns.col(i) - columns.col(0), channel);
  };
  CHECK(change(1, "p2_port") > 1.0);
  CHECK(change(1, "p1_port") == 0.0);
  CHECK(change(2, "F") > 1.0);
  CHECK(change(2, "p1_port") == 0.0);
  CHECK(change(3, "p1_port") > 1.0);
  CHECK(change(3, "p2_port") > 1.0);

  Recording other_valve = recording;
  for (double& volts : other_valve.column("u2_V")) volts += 0.01;
  CylinderResiduals other(rig, {other_valve});
  const Eigen::MatrixXd off = other.residuals(std::span(tried).first(1));
  CHECK(rms_of(other, off.col(0), "p1_port") == Approx(rms_of(model, columns.col(0), "p1_port")).epsilon(0.05));
  CHECK(rms_of(other, off.col(0), "p2_port") > 10.0);
}

TEST_CASE("servo table: a linear model is at its noise on its own recording and far off on the table's") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  const Rig linear = read_rig(PNEUSERVO_SOURCE_DIR "/config/servo-table-0.5m-4mm.yaml",
                              {"controller.feedforward=none", "cylinder.linear_about_Pa=140000",
                               "line_1.model=second_order_lag", "line_2.model=second_order_lag"});
  const std::vector<Hypothesis> truth{{linear, {}}};
  CylinderResiduals own(linear, {test::table_recording(linear, 5.0, seed)});
  const Eigen::MatrixXd at_noise = own.residuals(truth);
  CylinderResiduals other(linear, {test::table_recording(test::table_rig(), 5.0, seed)});
  const Eigen::MatrixXd off = other.residuals(truth);
  for (const char* channel : {"p1_port", "p2_port", "F"}) {
    CAPTURE(channel);
    CHECK(rms_of(own, at_noise.col(0), channel) < 1.2);
    // The force hardly shows it: what differs is the pressure of both sides alike.
    if (channel[0] == 'p') CHECK(rms_of(other, off.col(0), channel) > 10.0);
  }
}

TEST_CASE("servo table: a command that is missing is told") {
  const Rig rig = test::table_rig();
  Recording missing = test::table_recording(rig, 2.0, 1);
  missing.names.erase(missing.names.begin() + 3);
  missing.values.erase(missing.values.begin() + 3);
  CHECK_THROWS_WITH(CylinderResiduals(rig, {missing}), Contains("u2_V"));
}

TEST_CASE("servo table: friction has its size in micrometres of motion, and a gap begins anew") {
  const Rig rig = test::table_rig();
  const double amplitude_m = 5e-6, rate = 2.0 * std::numbers::pi * 1.5, friction_N = 0.8;
  const auto samples = static_cast<std::size_t>(2.0 / rig.period_s);
  std::vector<double> x(samples), drive(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    const double phase = rate * static_cast<double>(k) * rig.period_s;
    x[k] = std::round(amplitude_m * std::sin(phase) / 62.5e-12) * 62.5e-12;
    drive[k] = -rig.axis.slider.mass_kg * amplitude_m * rate * rate * std::sin(phase) +
               (std::cos(phase) > 0 ? friction_N : -friction_N);
  }
  const ForceBalance balance(x, rig.period_s, rig.sensors.resolution(Signal::x));
  const std::vector<double> smooth = balance.kernel().apply(drive, 0);
  for (const double share : {0.5, 1.0, 2.0}) {
    CAPTURE(share);
    const Rig rubbed = with(rig, "effects.coulomb_friction.force_N", share * friction_N);
    const std::vector<double> needed = balance.required_force(rubbed, smooth, {});
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < samples; ++k)
      if (balance.usable()[k]) sum += std::pow(needed[k] - smooth[k], 2), ++count;
    // Less by the rows that see a turn: there friction may be anything up to its size.
    CHECK(std::sqrt(sum / count) == Approx(std::abs(share - 1.0) * friction_N).margin(0.04 * friction_N));
  }

  Recording recording = test::table_recording(rig, 4.0, 3);
  for (auto& values : recording.values) values.erase(values.begin() + 8000, values.begin() + 10000);
  recording.line_numbers.erase(recording.line_numbers.begin() + 8000, recording.line_numbers.begin() + 10000);
  std::vector<std::string> notes;
  const std::vector<Recording> parts = compared_stretches(rig, {recording}, notes);
  REQUIRE(parts.size() == 2);
  CHECK(parts[0].t_s().back() == Approx(1.5998));
  CHECK(parts[1].t_s().front() == Approx(2.0));
}
