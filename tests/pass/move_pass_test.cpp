// Command passes of moves that come at run time: made between command and begin, followed, faded out, replayed.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/control/pd_force.hpp>
#include <pneuservo/core/random.hpp>
#include <pneuservo/loop/axis_loop.hpp>

#include "core/test_seed.hpp"
#include "loop/commanded_loop.hpp"
#include "loop/loop_rigs.hpp"
#include "pass/move_pass.hpp"

using namespace pneuservo;

namespace {

using Axis = test::CommandedLoop<AxisLoop>;

constexpr int wait_ticks = 250, rest_ticks = 1500;

Rig served_rig(const std::vector<std::string>& sets = {}) { return config_rig("served/cylinder-10m-7.65mm", sets); }

AxisCommand move_to(double position_m, double speed_mps = 0.4) { return {CommandKind::move_to, position_m, speed_mps}; }

/// Has moved once, so that its start is proven, and rests at 20 mm.
struct ProvenAxis : Axis {
  explicit ProvenAxis(const Rig& rig = served_rig()) : Axis(rig) {
    enable();
    ask(move_to(0.02));
    run(3000);
    REQUIRE(loop().supervisor().motion().proven());
    REQUIRE(last().v_ref_mps == 0.0);
  }
};

/// Largest distance from the set point since a row.
double error_since_m(const Axis& axis, std::size_t row) {
  double most_m = 0.0;
  for (; row < axis.rows().size(); ++row)
    most_m = std::max(most_m, std::fabs(axis.rows()[row].x_true_m - axis.rows()[row].x_ref_m));
  return most_m;
}

std::size_t begun_passes(const Axis& axis) {
  return static_cast<std::size_t>(
      std::ranges::count_if(axis.rows(), [](const Row& row) { return (row.flags & row_pass_begins) != 0; }));
}

double term(const Row& row, std::string_view name) {
  const auto names = law_columns(kind_of<PdForce>);
  return row.terms[static_cast<std::size_t>(std::ranges::find(names, name) - names.begin())];
}

MovePassRequest request_of(double from_m, double to_m, double speed_mps) {
  return {{1, true, 0, from_m, to_m, speed_mps}, 470e3};
}
bool go_on() { return true; }

}  // namespace

TEST_CASE("a move from rest waits for its pass and errs by a tenth of what it does by the formula") {
  double error_m[2];
  for (const bool makes : {false, true}) {
    ProvenAxis axis;
    axis.makes_passes = makes;
    const std::size_t asked = axis.rows().size();
    const AxisAnswer answer = axis.ask(move_to(-0.1));
    CHECK(answer.target == -0.1);
    axis.run(wait_ticks + rest_ticks);
    const auto& rows = axis.rows();
    // The set point of the begin's own tick still rests.
    CHECK(rows[asked + wait_ticks - 1].x_ref_m == 0.02);
    CHECK(rows[asked + wait_ticks + 10].x_ref_m < 0.02);
    CHECK(rows[static_cast<std::size_t>(answer.end_tick)].x_ref_m == -0.1);
    CHECK(rows[static_cast<std::size_t>(answer.end_tick) - 10].x_ref_m > -0.1);
    CHECK(begun_passes(axis) == (makes ? 1 : 0));
    CHECK(axis.status().follows_pass == makes);
    CHECK(axis.why.empty());
    CHECK(axis.loop().faults() == 0);
    error_m[makes] = error_since_m(axis, asked);
  }
  CAPTURE(error_m[0], error_m[1]);
  CHECK(error_m[1] < 0.15e-3);
  CHECK(error_m[1] < 0.1 * error_m[0]);
}

TEST_CASE("the prediction follows the move's pass as the axis does") {
  ProvenAxis axis(served_rig({"sensors.port_pressure.noise_Pa=0", "sensors.chamber_pressure.noise_Pa=0"}));
  const std::size_t asked = axis.rows().size();
  axis.ask(move_to(-0.1));
  axis.run(wait_ticks + rest_ticks);
  for (std::size_t i = asked; i < axis.rows().size(); ++i)
    REQUIRE(std::fabs(axis.rows()[i].x_predicted_m - axis.rows()[i].x_ref_m) < 0.2e-3);
}

TEST_CASE("another command in motion fades the pass out within 50 ms and goes on by the formula") {
  ProvenAxis axis;
  axis.ask(move_to(-0.1, 0.2));
  axis.run(wait_ticks + 400);
  const double before_V = term(axis.last(), "u_feedforward_V");
  REQUIRE(std::fabs(term(axis.last(), "u_pass_V")) > 0.1);
  axis.ask(move_to(0.1));
  CHECK(term(axis.last(), "u_pass_V") == 0.0);
  CHECK_FALSE(axis.status().follows_pass);
  // Nothing jumps: what the pass had beside the formula fades.
  CHECK(term(axis.last(), "u_feedforward_V") == Approx(before_V).margin(0.02));
  axis.run(2500);
  CHECK(axis.last().x_true_m == Approx(0.1).margin(0.5e-3));
  CHECK(begun_passes(axis) == 1);
  CHECK(axis.loop().faults() == 0);
  // From rest again there is a pass again.
  axis.ask(move_to(0.0));
  axis.run(wait_ticks + 10);
  CHECK(begun_passes(axis) == 2);
}

TEST_CASE("commands while a move waits: stop takes it back, hold keeps it, another target replaces it") {
  ProvenAxis axis;
  axis.ask(move_to(-0.1));
  axis.run(100);
  CHECK(axis.ask({CommandKind::stop}).target == 0.02);
  axis.run(1000);
  CHECK(axis.last().x_ref_m == 0.02);
  CHECK(begun_passes(axis) == 0);
  axis.ask(move_to(-0.1));
  axis.run(100);
  CHECK(axis.ask({CommandKind::hold}).target == 0.02);
  axis.run(1000);
  CHECK(axis.last().x_ref_m == 0.02);
  CHECK(axis.ask({CommandKind::resume}).target == -0.1);
  axis.run(100);
  const std::size_t asked = axis.rows().size();
  axis.ask(move_to(0.1));
  axis.run(wait_ticks + rest_ticks);
  CHECK(axis.last().x_ref_m == 0.1);
  CHECK(begun_passes(axis) == 1);
  CHECK(error_since_m(axis, asked) < 0.15e-3);
}

TEST_CASE("a pass that comes after the begin of its move is never followed") {
  ProvenAxis axis;
  axis.makes_passes = false;
  axis.ask(move_to(-0.1));
  axis.run(wait_ticks + 5);
  REQUIRE(axis.loop().pass_due());
  axis.loop().make_pass();
  axis.run(rest_ticks);
  CHECK(begun_passes(axis) == 0);
  CHECK(axis.last().x_true_m == Approx(-0.1).margin(1e-3));
}

TEST_CASE("a pass that is ready is not followed by another move than its own") {
  ProvenAxis axis;
  axis.ask(move_to(-0.1));
  axis.run(100);
  axis.makes_passes = false;
  axis.ask(move_to(0.1));
  axis.run(wait_ticks + rest_ticks);
  CHECK(begun_passes(axis) == 0);
  CHECK(axis.last().x_true_m == Approx(0.1).margin(1e-3));
  CHECK(axis.loop().make_pass() ==
        "the move from 0.02 to 0.1 m goes by the formula: its pass was not ready within reference.pass_within_s");
}

TEST_CASE("a move that is taken back is no work, and no refusal is told of it") {
  ProvenAxis axis;
  axis.makes_passes = false;
  axis.ask(move_to(-0.1));
  axis.ask({CommandKind::stop});
  REQUIRE(axis.loop().pass_due());
  CHECK(axis.loop().make_pass().empty());
  axis.makes_passes = true;
  axis.ask(move_to(-0.1));
  axis.run(wait_ticks + 10);
  CHECK(begun_passes(axis) == 1);
}

TEST_CASE("a command in the tick after the begin of a move ends its pass, and moves at once") {
  ProvenAxis axis;
  axis.ask(move_to(-0.1));
  axis.run(wait_ticks - 1);
  const std::size_t asked = axis.rows().size();
  axis.ask(move_to(0.1));
  CHECK(begun_passes(axis) == 1);
  axis.run(rest_ticks);
  CHECK(axis.last().x_ref_m == 0.1);
  CHECK(term(axis.rows()[asked], "u_pass_V") == 0.0);
  for (std::size_t i = asked + 50; i < axis.rows().size(); ++i)
    REQUIRE(std::fabs(axis.rows()[i].x_true_m - axis.rows()[i].x_ref_m) < 3e-3);
}

TEST_CASE("commands in quick succession do not keep the axis where it is") {
  ProvenAxis axis;
  for (int i = 0; i < 10; ++i) axis.ask(move_to(i % 2 == 0 ? 0.1 : 0.09)), axis.run(40);
  CHECK(axis.last().x_ref_m > 0.021);
  for (int i = 0; i < 60; ++i) axis.ask(move_to(0.1)), axis.run(40);
  CHECK(axis.last().x_ref_m == 0.1);
  CHECK(axis.loop().faults() == 0);
}

TEST_CASE("random commands with rests: no fault, and what was obeyed replays with the same passes, bit for bit") {
  const auto seed = test::new_seed();
  CAPTURE(seed);
  Random random(seed);
  const Rig rig = served_rig({"reference.pass_within_s=0.05"});
  ProvenAxis axis(rig);
  for (int i = 0; i < 40; ++i) {
    axis.makes_passes = random.uniform(0.0, 1.0) < 0.75;
    switch (static_cast<int>(random.uniform(0.0, 6.0))) {
      case 0: axis.ask({CommandKind::stop}); break;
      case 1: axis.ask({CommandKind::jog, 0.0, random.uniform(0.01, 0.4)}); break;
      case 2: axis.ask({CommandKind::move_by, random.uniform(-0.05, 0.05), random.uniform(0.01, 0.4)}); break;
      default: axis.ask(move_to(random.uniform(-0.12, 0.12), random.uniform(0.05, 0.4)));
    }
    axis.run(static_cast<int>(random.uniform(1.0, 1500.0)));
    REQUIRE(axis.loop().faults() == 0);
  }
  CHECK(begun_passes(axis) > 0);
  test::require_replay<AxisLoop>(rig, axis.rows(), &Row::x_ref_m, &Row::command_m, &Row::command_mps);
}

TEST_CASE("a move that the lines cannot carry goes by the formula and says so") {
  const std::string fast = "reference={kind: live, lowest_m: -0.12, highest_m: 0.12, speed_mps: 1.0, "
                           "acceleration_mps2: 12.0}";
  const Rig rig = config_rig("cylinder-10m-4.15mm", {fast});
  MovePassMaker maker(rig);
  MovePass pass;
  const std::string why = maker.make(request_of(-0.1, 0.1, 1.0), pass, go_on);
  CHECK_THAT(why, Catch::Contains("the move from -0.1 to 0.1 m goes by the formula: the lines cannot carry") &&
                      Catch::Contains("N of the force are missing"));
  CHECK(pass.law.empty());
  CHECK(maker.make(request_of(-0.01, 0.01, 0.02), pass, go_on).empty());
  CHECK(pass.law.size() > 1000);
  CHECK(pass.prediction.size() == pass.law.size());
}

TEST_CASE("work for nobody ends at the next run of the model") {
  MovePassMaker maker(served_rig());
  MovePass pass;
  int asked = 0;
  CHECK(maker.make(request_of(-0.1, 0.1, 0.4), pass, [&] { return ++asked < 3; }).empty());
  CHECK(pass.law.empty());
  CHECK(asked <= 5);
}

TEST_CASE("a pass begins at the pressure that the chambers have") {
  MovePassMaker maker(served_rig());
  MovePass low, high;
  MovePassRequest request = request_of(-0.1, 0.1, 0.4);
  request.pressure_1_Pa = 400e3;
  REQUIRE(maker.make(request, low, go_on).empty());
  request.pressure_1_Pa = 500e3;
  REQUIRE(maker.make(request, high, go_on).empty());
  const auto most = [](const MovePass& pass) { return std::ranges::max(pass.law, {}, &PassTick::u_V).u_V; };
  CHECK(std::fabs(most(low) - most(high)) > 0.01);
  // Resting, both ask for the force that carries no load, and for no flow.
  for (const MovePass* pass : {&low, &high}) {
    CHECK(pass->law.front().F_N == Approx(0.0).margin(0.5));
    CHECK(pass->law.front().u_V == Approx(0.0).margin(0.01));
  }
}

TEST_CASE("a planned move as a reference has the set points that the loop's planner gives, bit for bit") {
  const Rig rig = served_rig();
  CommandedMotion motion;
  motion.configure(live_limits(rig.reference), rig.period_s, 0.0, 0.25);
  motion.start(0, 0.013);
  CommandResult result{};
  for (std::int64_t tick = 1; tick < 10; ++tick) motion.pass(tick, true);
  REQUIRE(motion.obey(move_to(-0.0417, 0.23), 10, result));
  const PlannedMove& move = motion.planned();
  CHECK(move.from_rest);
  CHECK(move.begin_tick == 9 + wait_ticks);
  auto planner = std::make_shared<LivePlanner>();
  planner->configure(live_limits(rig.reference), rig.period_s);
  planner->start(0, move.from_m);
  planner->move_to(0, move.to_m, move.speed_mps);
  const Reference reference(planner);
  CHECK(reference.is_move());
  for (std::int64_t tick = 10; tick < motion.end_tick() + 10; ++tick) {
    motion.pass(tick, true);
    const auto since = tick - move.begin_tick;
    REQUIRE(reference.at(static_cast<double>(since) * rig.period_s).d[0] == Approx(motion.at(tick).d[0]).margin(1e-15));
    REQUIRE(reference.at(static_cast<double>(since) * rig.period_s).d[2] == Approx(motion.at(tick).d[2]).margin(1e-9));
  }
}

TEST_CASE("the law fades from what a pass adds to what the next one adds, without a jump") {
  const Rig rig = served_rig();
  PdForce law;
  law.configure(rig.controller.of<PdForce>(),
                LawSetup{rig.axis, rig.period_s, Reference(), 1.0, std::make_shared<PassTable>()});
  const std::vector<PassTick> first{{1.0, 0.25, 30.0, 10.0}}, second{{0.5, 0.0, -40.0, 0.0}};
  ControlInput in;
  in.pressure_Pa = in.port_Pa = {470e3, 540e3};
  const auto added = [&] {
    law.step(in);
    ++in.tick;
    return law.state().pass;
  };
  CHECK(added().u_V == 0.0);
  law.follow_pass(first, 1);
  double last_V = 0.0;
  for (int i = 0; i < 50; ++i) {
    const PassPart now = added();
    CHECK(now.u_V - last_V >= 0.0);
    CHECK(now.u_V - last_V < 0.75 * 1.5 / 50.0 + 1e-12);  // the steepest of the smooth step
    CHECK(now.F_N == Approx(20.0 / 0.75 * now.u_V));
    last_V = now.u_V;
  }
  CHECK(added().u_V == Approx(0.75));
  law.follow_pass(second, in.tick);
  CHECK(added().u_V == Approx(0.75));
  for (int i = 0; i < 50; ++i) added();
  CHECK(added().u_V == 0.5);
  CHECK(law.state().u_pass_V == 0.5);
  law.follow_pass({}, 0);
  CHECK(added().F_N == Approx(-40.0));
  for (int i = 0; i < 50; ++i) added();
  CHECK(added().u_V == 0.0);
  law.follow_pass(first, in.tick);
  law.reset();
  CHECK(added().u_V == 0.0);
}
