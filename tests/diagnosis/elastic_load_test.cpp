// Diagnosis of a cylinder whose load hangs on a soft coupling or on one with play, and of one that is shaken.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <catch2/catch.hpp>

#include "core/run_length.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/simulated_recording.hpp"
#include "diagnosis/synthetic_axis.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

TEST_CASE("a load on a soft coupling is named with mass, frequency and damping, and the fit comes to the floors") {
  const Rig owner = toleranced_cylinder_rig(2.0, 6.1e-3);
  Rig machine = owner;
  machine.axis.effects.motion.elastic_load = {1.2, 8.0, 0.05};
  const Diagnosis found = diagnose(owner, {simulated_recording(machine, 9.0, 41, all_pressures)});
  CAPTURE(found.sentence);
  CHECK(found.verdict == Verdict::missing_physics);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().effect == "elastic_load");
  const ElasticLoad<double>& load = found.improved.axis.effects.motion.elastic_load;
  CHECK(load.mass_kg == Approx(1.2).epsilon(0.1));
  // These 9 s tell the frequency to 2 or 3 %: it lies within three standard errors, and those are no wider.
  const auto& parameters = found.answers.front().parameters;
  const auto frequency = std::ranges::find(parameters, "natural_frequency_Hz", &EstimatedParameter::name);
  REQUIRE(frequency != parameters.end());
  CHECK(frequency->standard_error < 0.25);
  CHECK(std::abs(load.natural_frequency_Hz - 8.0) < 3.0 * frequency->standard_error);
  CHECK(load.damping_ratio == Approx(0.05).epsilon(0.3));
  CHECK(found.over_noise < 1.3);
}

TEST_CASE("an axis whose load swings across a gap in its recording keeps its name and its size", "[long]") {
  const Rig owner = testing::driven_axis_rig();
  Rig machine = owner;
  machine.axis.effects.motion.elastic_load = {2.0, 7.0, 0.02};
  Recording recording = testing::axis_recording(machine, 45, testing::no_extra);
  const double from_s = GENERATE(from_range(and_in_the_long_run({2.2, 9.1}, {20.0, 5.0})));  // 20: whole
  CAPTURE(from_s);
  Recording kept = recording;
  kept.line_numbers.clear();
  for (auto& values : kept.values) values.clear();
  for (std::size_t row = 0; row < recording.t_s().size(); ++row) {
    const double t = recording.t_s()[row];
    if (t >= from_s && t < from_s + 0.3) continue;
    for (std::size_t c = 0; c < kept.values.size(); ++c) kept.values[c].push_back(recording.values[c][row]);
    kept.line_numbers.push_back(recording.line_numbers[row]);
  }
  const Diagnosis found = diagnose(owner, {kept});
  CAPTURE(found.sentence);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().effect == "elastic_load");
  const ElasticLoad<double>& load = found.improved.axis.effects.motion.elastic_load;
  CHECK(load.mass_kg == Approx(2.0).epsilon(0.1));
  CHECK(load.natural_frequency_Hz == Approx(7.0).epsilon(0.02));
}

TEST_CASE("a cylinder that is shaken is no elastic load: unknown at the motion, with the frequency", "[long]") {
  const Rig owner = toleranced_cylinder_rig(2.0, 6.1e-3);
  Rig machine = owner;
  const double amplitude_N = GENERATE(from_range(and_in_the_long_run({5.0}, {0.5})));
  CAPTURE(amplitude_N);
  machine.axis.effects.motion.periodic_force = {amplitude_N, 7.9, 1.0};
  const Recording first = simulated_recording(machine, 6.0, 42, all_pressures);
  machine.axis.effects.motion.periodic_force.phase_rad = 2.5;
  const Diagnosis found = diagnose(owner, {first, simulated_recording(machine, 6.0, 44, all_pressures)});
  CAPTURE(found.sentence);
  CHECK(found.verdict == Verdict::unknown);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().element == "motion");
  const std::string& note = found.answers.front().note;
  const std::size_t at = note.find("a periodic force of ");
  REQUIRE(at != std::string::npos);
  double told_N = 0, told_Hz = 0;
  REQUIRE(std::sscanf(note.c_str() + at, "a periodic force of %lf N at %lf Hz", &told_N, &told_Hz) == 2);
  CHECK(told_Hz == Approx(7.9).margin(0.05));
  // The smoothing of F passes 0.97 of it; tolerances take up to a tenth.
  CHECK(told_N == Approx(amplitude_N).epsilon(0.14));
}

TEST_CASE("a load that is coupled with play is told with its play, and is no elastic load", "[long]") {
  const Rig owner = toleranced_cylinder_rig(2.0, 6.1e-3);
  Rig machine = owner;
  const double play_m = GENERATE(from_range(and_in_the_long_run({6e-4}, {1.5e-3})));
  CAPTURE(play_m);
  machine.axis.effects.motion.load_backlash = {1.2, play_m, 70.0, 0.2};
  const Diagnosis found = diagnose(owner, {simulated_recording(machine, 6.5, 43, all_pressures)});
  CAPTURE(found.sentence);
  CHECK(found.verdict == Verdict::unknown);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers.front().element == "motion");
  CHECK(found.answers.front().note.find("load_backlash") != std::string::npos);
  CHECK(found.improved.axis.effects.motion.load_backlash.play_m == Approx(play_m).epsilon(0.2));
}
