// Machines with a background of small physics: it raises no alarm, what is large beside it is named, and a periodic
// force is seen where the slider moves.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/core/random.hpp>

#include "diagnosis/cylinder_residuals.hpp"
#include "diagnosis/decision.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/search.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

/// What the owner believes: a rig with tolerances where the background will push.
Rig owners_rig() {
  Rig rig = cylinder_rig(2.0);
  rig.tolerances = {{"valve.area_per_volt_m2_per_V", 0.03}, {"supply.pressure_Pa", 0.005}};
  return rig;
}

/// The machine: underlap, a late command and sensors a little off, none of them in the owner's rig.
Rig with_background(Rig rig) {
  ValveEffects<double>& valve = rig.axis.effects.valve;
  valve.valve_dead_band.width_V = -0.012;
  valve.command_delay.delay_s = 2e-4;
  rig.sensor_effects[1].sensor_offset.offset = 120;
  rig.sensor_effects[3].sensor_offset.offset = -150;
  return rig;
}

struct Judged {
  std::string name;
  double size = 0;
  Verdict verdict{};
  Rig rig;  ///< as fitted
};

Judged judge(const Rig& machine) {
  const Rig owner = owners_rig();
  CylinderResiduals model(owner, {simulated_recording(machine, 6.5, 5, all_pressures)});
  FittedRows rows(model, {});
  SearchSettings settings;
  settings.grow_floor = true;
  settings.most_effects = 1;
  const SmallPhysics granted = small_physics(owner, model.channels());
  settings.small_physics = granted.parameters;
  Search search(rows, granted.rig, all_candidates(owner, model.channels(), motion_range(model.rows())), settings, {},
                {});
  search.run();
  model.drop_slow_error();
  const Decision decision = decide_beside_remainder(model, search, {});
  Judged out{"", 0, decision.verdict, decision.chosen->fit.hypothesis().rig};
  if (decision.chosen->members.empty()) return out;
  out.name = search.candidates()[decision.chosen->members.front()].name;
  out.size = decision.chosen->fit.parameters.front().value(decision.chosen->fit.z(0));
  return out;
}

}  // namespace

TEST_CASE("background: underlap, delay and sensors a little off are no alarm") {
  const Judged judged = judge(with_background(owners_rig()));
  CHECK((judged.verdict == Verdict::unknown || judged.verdict == Verdict::consistent));
}

TEST_CASE("background: tolerances at the end of their range together are no proof of the name that they leave") {
  Rig owner = owners_rig();
  owner.tolerances = {{"valve.area_per_volt_m2_per_V", 0.03},
                      {"supply.pressure_Pa", 0.005},
                      {"line_1.length_m", 0.003},
                      {"line_2.length_m", 0.003},
                      {"cylinder.dead_volume_1_m3", 0.03},
                      {"cylinder.dead_volume_2_m3", 0.03}};
  Rig machine = with_background(owner);
  machine.axis.effects.valve.valve_dead_band.width_V = 0.012;  // an overlap, which has a name
  machine.axis.effects.line_branch_1 = {5e-6, 0.01, 0.006, 0.0};
  machine.axis.effects.line_branch_2 = {3e-6, 0.01, 0.006, 0.0};
  const std::vector<Recording> recordings{simulated_recording(machine, 6.5, 5, all_pressures)};
  const Diagnosis believed = diagnose(owner, recordings, {});
  CHECK(believed.verdict == Verdict::missing_physics);
  DiagnoseOptions options;
  options.rules.stretched_count = 2;  // both dead volumes, of the few numbers that are free here
  const Diagnosis doubted = diagnose(owner, recordings, options);
  INFO(doubted.sentence);
  CHECK((doubted.verdict == Verdict::unknown || doubted.verdict == Verdict::consistent));
  options.rules.doubted_left = 0;  // small physics always leaves too much then, and the doubted verdict stands
  CHECK(diagnose(owner, recordings, options).sentence == believed.sentence);
}

TEST_CASE("an effect that the owner knows is not missing: its size may be wrong") {
  Rig owner = owners_rig();
  owner.axis.effects.motion.coulomb_friction.force_N = 5;
  const auto has = [](const Rig& rig, const std::string& name) {
    const std::vector<Candidate> all = all_candidates(rig, {}, {});
    return std::any_of(all.begin(), all.end(), [&](const Candidate& c) { return c.name == name; });
  };
  CHECK(has(owner, "coulomb_friction"));  // without a tolerance its size is exact, and more of it may be there
  owner.tolerances["effects.coulomb_friction.force_N"] = 0.15;
  CHECK_FALSE(has(owner, "coulomb_friction"));
  CHECK(has(owner, "parameter:effects.coulomb_friction.force_N"));
  CHECK(has(owner, "stribeck_friction"));
}

TEST_CASE(
    "background: losses that depend on frequency and volumes at the ports are found, beside a leak that is named") {
  Rig machine = with_background(owners_rig());
  machine.axis.effects.chamber_leak_1.area_m2 = 3e-8;
  machine.axis.effects.frequency_dependent_losses.share = 1;
  machine.axis.effects.line_branch_1 = {6e-6, 0.01, 0.006, 0.0};
  machine.axis.effects.line_branch_2 = {3e-6, 0.01, 0.006, 0.0};
  const Judged judged = judge(machine);
  CHECK(judged.name == "chamber_leak_1");
  const AxisEffects<double>& found = judged.rig.axis.effects;
  CHECK(found.frequency_dependent_losses.share == Approx(1).epsilon(0.25));
  CHECK(found.line_branch_1.volume_m3 == Approx(6e-6).epsilon(0.25));
  CHECK(found.line_branch_2.volume_m3 == Approx(3e-6).epsilon(0.25));
}

TEST_CASE("losses that depend on frequency are granted, and no name of their own") {
  for (const Candidate& candidate : all_candidates(owners_rig(), {}, {})) {
    CAPTURE(candidate.name);
    CHECK(candidate.name != "frequency_dependent_losses");
  }
}

TEST_CASE("background: a leak beside it is named") {
  Rig machine = with_background(owners_rig());
  machine.axis.effects.chamber_leak_1.area_m2 = 3e-8;
  const Judged judged = judge(machine);
  CHECK(judged.verdict == Verdict::missing_physics);
  CHECK((judged.name == "chamber_leak_1" || judged.name == "line_leak_1"));  // with sensors at both ends: nearly alike
  CHECK(judged.size == Approx(3e-8).epsilon(0.05));
}

TEST_CASE("background: a constant load beside it is named, and not taken for a floor of the force") {
  Rig machine = with_background(owners_rig());
  machine.axis.effects.motion.constant_force.force_N = 12.0;
  const Judged judged = judge(machine);
  CHECK(judged.verdict == Verdict::missing_physics);
  CHECK(judged.name == "constant_force");
  CHECK(judged.size == Approx(12.0).epsilon(0.05));
}

TEST_CASE("background: a periodic force is found where the slider moves, and noise is none") {
  Random random(11);
  std::vector<ResidualRow> rows;
  Eigen::VectorXd sine(1400), noise(1400);
  for (int i = 0; i < 1400; ++i) {
    ResidualRow row;
    row.recording = i / 700;
    row.time_s = 0.01 * (i % 700);
    row.velocity_mps = std::fmod(row.time_s, 2.0) < 1.2 ? 0.2 : 0.0;  // at rest friction holds against the force
    row.sigma = 0.2;
    const double moving = row.velocity_mps > 0 ? 1.0 : 0.0;
    noise(i) = 2 * random.normal();
    sine(i) = moving * 12 * std::sin(2 * M_PI * 7.35 * row.time_s + 1.3 * row.recording) + noise(i);
    rows.push_back(row);
  }
  const auto found = line_in_motion(rows, sine, 0);
  REQUIRE(found);
  CHECK(found->frequency_Hz == Approx(7.35).margin(0.05));
  CHECK(found->amplitude == Approx(12 * 0.2).epsilon(0.05));
  CHECK(found->ratio > 0.9);
  const auto none = line_in_motion(rows, noise, 0);
  CHECK((!none || none->ratio < 0.1));
}
