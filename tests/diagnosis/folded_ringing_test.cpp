// What a line may ring at the sampling rate: most where a length puts a mode there, nothing under a command at rest.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/residuals/cylinder_residuals.hpp"
#include "diagnosis/residuals/folded_ringing.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

/// A held piston in the middle of its stroke, the valve near its centre under a slow sine of stairs.
ImposedInputs quiet_inputs(double amplitude_V, double period_s) {
  ImposedInputs inputs;
  inputs.period_s = period_s;
  const auto samples = static_cast<std::size_t>(1.5 / period_s);
  for (std::size_t k = 0; k < samples; ++k)
    inputs.command_V[0].push_back(amplitude_V *
                                  std::sin(2.0 * std::numbers::pi * 2.0 * static_cast<double>(k) * period_s));
  inputs.position_m.assign(samples, 0.0);
  inputs.velocity_mps.assign(samples, 0.0);
  for (std::size_t side = 0; side < 2; ++side) {
    inputs.start_Pa[side].assign(samples, 5e5);
    inputs.start_Pa_per_s[side].assign(samples, 0.0);
  }
  inputs.release = 1;
  return inputs;
}

constexpr std::size_t bin = 10;

double mean(const std::vector<double>& values, std::size_t first) {
  double sum = 0;
  for (std::size_t k = first; k < first + bin; ++k) sum += values[k];
  return sum / bin;
}

/// Largest mean over a bin of port 1, of all lengths.
double largest(const PossibleRinging& ringing, std::size_t first) {
  double out = 0;
  for (const PossibleCourse& course : ringing) out = std::max(out, std::abs(mean(course.ringing[0], first)));
  return out;
}
double largest(const PossibleRinging& ringing) {
  double out = 0;
  for (std::size_t first = 100; first + bin <= ringing[0].ringing[0].size(); first += bin)
    out = std::max(out, largest(ringing, first));
  return out;
}

constexpr PlantGrid fine{160, 64};

std::vector<double> port_1_at_length(const ImposedInputs& inputs, double length_m) {
  const Rig rig = cylinder_rig(length_m, 4.15e-3);
  const ImposedRun run{&rig, {}};
  return run_imposed(inputs, std::span(&run, 1), fine)[0][Signal::p1_port];
}

}  // namespace

TEST_CASE("the ringing covers what a length within its tolerance does to a quiet port", "[diagnosis]") {
  const ImposedInputs inputs = quiet_inputs(0.1, 1e-3);
  Rig rig = cylinder_rig(2.0, 4.15e-3);
  rig.tolerances = {{"line_1.length_m", 0.0075}, {"line_2.length_m", 0.0075}};
  const PossibleRinging ringing = possible_ringing(inputs, rig, fine);
  const std::vector<double> shorter = port_1_at_length(inputs, 2.0 * (1 - 0.0075)),
                            longer = port_1_at_length(inputs, 2.0 * (1 + 0.0075));
  int bins = 0, seen = 0, covered = 0;
  for (std::size_t first = 100; first + bin <= shorter.size(); first += bin, ++bins) {
    const double difference = std::abs(mean(longer, first) - mean(shorter, first));
    seen += difference > 60;  // the noise of a bin's mean
    covered += difference < std::hypot(60, 2 * largest(ringing, first));
  }
  INFO(seen << " of " << bins << " seen, " << covered << " covered");
  CHECK(seen > 0.2 * bins);
  CHECK(covered > 0.9 * bins);
}

TEST_CASE("a command at rest makes no ringing, a slow one none that is folded", "[diagnosis]") {
  const Rig rig = cylinder_rig(2.0, 4.15e-3);
  CHECK(largest(possible_ringing(quiet_inputs(0.0, 1e-3), rig, fine)) < 0.01);
  CHECK(possible_ringing(quiet_inputs(0.1, 5e-3), rig, fine).empty());
}

TEST_CASE("a line shorter than sound goes in a stair has no ringing, whatever the tolerance", "[diagnosis]") {
  Rig rig = cylinder_rig(0.01, 4.15e-3);
  rig.tolerances = {{"line_1.length_m", 0.7}, {"line_2.length_m", 10}};  // a length that is none must not be tried
  CHECK(possible_ringing(quiet_inputs(0.1, 1e-3), rig, {4, 160}).empty());
  rig.axis.line_2.length_m = 2.0;
  rig.axis.line_1.length_m = 0.3;
  const PossibleRinging ringing = possible_ringing(quiet_inputs(0.1, 1e-3), rig, grid_for(rig, 500, 1e-3));
  REQUIRE(ringing.size() == imposed_lanes);
  CHECK(ringing[0].ringing[0].empty());
  CHECK(ringing[0].pressure[0].empty());
  CHECK(*std::max_element(ringing[0].ringing[1].begin(), ringing[0].ringing[1].end()) > 0);
}

TEST_CASE("rows of ports allow for the ringing, rows of chambers need not", "[diagnosis]") {
  const Rig rig = cylinder_rig(1.973, 4.15e-3);
  const CylinderResiduals model(rig, {simulated_recording(rig, 4.0, 3, all_pressures)});
  double widest_port = 0, narrowest_port = 1e9, widest_chamber = 0;
  for (const ResidualRow& row : model.rows()) {
    const std::string& channel = model.channels()[static_cast<std::size_t>(row.channel)].name;
    if (row.over_recording || row.time_s < 2.5) continue;  // the start's own error has faded
    if (channel == "p1_port") {
      widest_port = std::max(widest_port, row.sigma);
      narrowest_port = std::min(narrowest_port, row.sigma);
    }
    if (channel == "p1_chamber") widest_chamber = std::max(widest_chamber, row.sigma);
  }
  INFO("ports " << narrowest_port << " to " << widest_port << " Pa, chambers up to " << widest_chamber << " Pa");
  CHECK(widest_port > 1.3 * narrowest_port);
  CHECK(narrowest_port < 1.3 * widest_chamber);
}

namespace {

/// The rows over the whole recording of a machine whose lines are `longer` than the owner says.
struct Answers {
  double narrowest = 1e9, widest = 0;  ///< sigma
  double squares = 0;                  ///< residual of the owner's rig
};

Answers answers_of(Rig machine, double longer) {
  const Rig owner = machine;
  for (LineParameters<double>* line : {&machine.axis.line_1, &machine.axis.line_2}) line->length_m *= 1 + longer;
  CylinderResiduals model(owner, {simulated_recording(machine, 5.0, 3, all_pressures)});
  const Eigen::VectorXd column = model.residuals(std::vector<Hypothesis>{{owner, {}}}).col(0);
  Answers out;
  for (std::size_t i = 0; i < model.rows().size(); ++i) {
    if (!model.rows()[i].over_recording) continue;
    out.narrowest = std::min(out.narrowest, model.rows()[i].sigma);
    out.widest = std::max(out.widest, model.rows()[i].sigma);
    out.squares += std::pow(column(static_cast<Eigen::Index>(i)), 2);
  }
  return out;
}

Rig rig_with_spool(double length_m, double natural_frequency_Hz) {
  Rig rig = cylinder_rig(length_m, 7.65e-3);
  rig.axis.valve.natural_frequency_Hz = natural_frequency_Hz;
  rig.axis.valve.damping_ratio = 0.7;
  return rig;
}

}  // namespace

TEST_CASE("answers to the command allow for the ringing of a quick spool's stairs, each row for its own",
          "[diagnosis]") {
  const Answers quick = answers_of(rig_with_spool(2.0, 0.0), 0.006);
  CHECK(quick.widest > 2.5 * quick.narrowest);
  CHECK(quick.squares < 30);  // 24 rows
  const Answers slow = answers_of(rig_with_spool(5.0, 100.0), 0.0);
  CHECK(slow.widest < 1.2 * slow.narrowest);
}

TEST_CASE("answers to the command allow for no more where the owner's sensors are slow", "[diagnosis]") {
  const Rig rig = rig_with_spool(5.0, 100.0);
  Rig slow = rig;
  for (const Signal port : port_signals) slow.sensor_effects[port].sensor_lag.time_constant_s = 3e-3;
  CHECK(answers_of(slow, 0.0).widest < 1.2 * answers_of(rig, 0.0).widest);
}
