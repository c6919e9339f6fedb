// An axis that is commanded: nothing moves before the edge of enable, moves end where they shall, refusals move
// nothing, and a replay of what was obeyed gives the same rows.
#include <catch2/catch.hpp>

#include <cmath>
#include <random>
#include <vector>

#include <pneuservo/loop/axis_loop.hpp>

#include "core/test_seed.hpp"
#include "loop/commanded_loop.hpp"
#include "loop/loop_rigs.hpp"

using namespace pneuservo;

namespace {

Rig served_rig() { return config_rig("served/cylinder-10m-7.65mm"); }

using Axis = test::CommandedLoop<AxisLoop>;

AxisCommand move_to(double position_m, double speed_mps = 0.4) { return {CommandKind::move_to, position_m, speed_mps}; }

}  // namespace

TEST_CASE("nothing moves before enable, and again after disable") {
  Axis axis(served_rig());
  axis.run(500);
  CHECK(axis.ask(move_to(0.05)).result == CommandResult::not_enabled);
  axis.run(500);
  for (const Row& row : axis.rows()) {
    REQUIRE(row.state == static_cast<std::uint32_t>(SupervisorState::inactive));
    REQUIRE(row.u_V == 0.0);
    REQUIRE(row.command_kind == 0);
  }
  axis.enable();
  CHECK(axis.ask({CommandKind::enable}).result == CommandResult::is_enabled);
  axis.run(500);
  CHECK(axis.rows().back().x_ref_m == Approx(0.0).margin(1e-4));
  const AxisAnswer answer = axis.ask(move_to(0.05));
  CHECK(answer.result == CommandResult::taken);
  CHECK(answer.target == 0.05);
  axis.run(2500);
  CHECK(axis.rows().back().x_ref_m == 0.05);
  CHECK(axis.rows().back().x_true_m == Approx(0.05).margin(1e-3));
  CHECK(axis.ask({CommandKind::disable}).result == CommandResult::taken);
  axis.run(10);
  CHECK(axis.rows().back().u_V == 0.0);
  CHECK(axis.ask(move_to(0.0)).result == CommandResult::not_enabled);
  axis.enable();
  CHECK(axis.rows().back().x_ref_m == Approx(axis.rows().back().measured[Signal::x]).margin(1e-4));
}

TEST_CASE("a command is obeyed in the next tick, which has the first new set point") {
  Axis axis(served_rig());
  axis.enable();
  axis.ask(move_to(0.1, 0.05));
  axis.run(1500);
  const double on_way_m = axis.rows().back().x_ref_m;
  const AxisAnswer answer = axis.ask({CommandKind::stop});
  CHECK(answer.tick == static_cast<std::int64_t>(axis.rows().size()) - 1);
  CHECK(axis.rows().back().command_kind == static_cast<std::uint32_t>(CommandKind::stop));
  axis.run(2000);
  CHECK(axis.rows().back().v_ref_mps == 0.0);
  CHECK(axis.rows().back().x_ref_m == answer.target);
  CHECK(answer.target > on_way_m);
  CHECK(answer.target < 0.1);
}

TEST_CASE("the first move is slow until the start is proven, and then has its speed") {
  Axis axis(served_rig());
  axis.enable();
  axis.ask(move_to(0.1));
  double fastest_mps = 0.0;
  while (!axis.loop().supervisor().motion().proven()) {
    axis.run(1);
    CHECK(axis.rows().back().v_ref_mps <= Approach::speed_mps * (1.0 + 1e-12));
    REQUIRE(axis.rows().size() < 5000);
  }
  for (int i = 0; i < 2000; ++i) {
    axis.run(1);
    fastest_mps = std::max(fastest_mps, axis.rows().back().v_ref_mps);
  }
  CHECK(fastest_mps > 0.25);
  CHECK(axis.rows().back().x_ref_m == 0.1);
}

TEST_CASE("relative moves, hold and resume, what is outside moves nothing") {
  Axis axis(served_rig());
  axis.enable();
  axis.ask(move_to(0.05, 0.05));
  axis.ask({CommandKind::move_by, 0.02, 0.05});
  CHECK(axis.status().target == Approx(0.07));
  CHECK(axis.ask({CommandKind::move_by, 0.1, 0.4}).result == CommandResult::outside);
  CHECK(axis.status().target == Approx(0.07));
  CHECK(axis.ask({CommandKind::resume}).result == CommandResult::nothing_held);
  axis.run(800);
  CHECK(axis.ask({CommandKind::hold}).target < 0.07);
  axis.run(1000);
  CHECK(axis.rows().back().v_ref_mps == 0.0);
  CHECK(axis.ask({CommandKind::resume}).target == Approx(0.07));
  axis.run(2000);
  CHECK(axis.rows().back().x_ref_m == Approx(0.07));
  axis.ask({CommandKind::jog, 0.0, -0.1});
  axis.run(500);
  const double jogged_m = axis.rows().back().x_ref_m;
  CHECK(axis.ask({CommandKind::move_by, 0.01, 0.4}).target == Approx(jogged_m + 0.01).margin(1e-3));
}

TEST_CASE("random commands: no fault, within limits, and what was obeyed replays bit for bit") {
  const auto seed = test::new_seed();
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const Rig rig = served_rig();
  Axis axis(rig);
  axis.enable();
  for (int i = 0; i < 150; ++i) {
    const double speed_mps = uniform(0.01, 0.4);
    switch (random() % 6) {
      case 0: axis.ask({CommandKind::stop}); break;
      case 1: axis.ask({CommandKind::jog, 0.0, random() % 2 == 0 ? speed_mps : -speed_mps}); break;
      case 2: axis.ask({CommandKind::move_by, uniform(-0.05, 0.05), speed_mps}); break;
      default: axis.ask(move_to(uniform(-0.12, 0.12), speed_mps));
    }
    axis.run(1 + static_cast<int>(random() % 600));
    REQUIRE(axis.loop().faults() == 0);
  }
  for (const Row& row : axis.rows()) CHECK(std::fabs(row.measured[Signal::x]) < 0.15);
  test::require_replay<AxisLoop>(rig, axis.rows(), &Row::x_ref_m, &Row::command_m, &Row::command_mps);
}

TEST_CASE("a stream of set points moves the axis, rests when it stops, and replays bit for bit") {
  const Rig rig = served_rig();
  Axis axis(rig);
  axis.enable();
  axis.ask(move_to(0.0, 0.4));  // proves the start
  axis.ask(move_to(0.03, 0.1));
  axis.run(300);
  // Set points while it still moves wait for rest; every 10 ticks one more comes.
  double set_point_m = 0.0;
  for (int i = 0; i < 400; ++i) {
    set_point_m = 0.03 + 0.05 * std::sin(0.01 * 3.0 * i);
    AxisCommand follow{CommandKind::follow, set_point_m};
    follow.interval_s = 0.01;
    REQUIRE(axis.ask(follow).result == CommandResult::taken);
    axis.run(9);
  }
  AxisCommand outside{CommandKind::follow, 0.2};
  outside.interval_s = 0.01;
  CHECK(axis.ask(outside).result == CommandResult::outside);
  CHECK(axis.loop().faults() == 0);
  axis.run(1500);
  CHECK(axis.rows().back().x_ref_m == Approx(set_point_m).margin(1e-12));
  CHECK(axis.rows().back().v_ref_mps == 0.0);
  CHECK(axis.rows().back().x_true_m == Approx(set_point_m).margin(1e-3));
  // Moves go on from there; in the midst of a stream, too.
  AxisCommand follow{CommandKind::follow, set_point_m + 0.002};
  follow.interval_s = 0.02;
  axis.ask(follow);
  axis.run(30);
  CHECK(axis.ask(move_to(-0.05)).target == Approx(-0.05));
  axis.run(2500);
  CHECK(axis.rows().back().x_ref_m == Approx(-0.05).margin(1e-12));
  axis.ask(move_to(0.05));
  axis.run(2500);
  CHECK(axis.rows().back().x_ref_m == 0.05);
  CHECK(axis.loop().faults() == 0);
  double last_mps = 0.0;
  for (const Row& row : axis.rows()) {
    if (!std::isfinite(row.v_ref_mps)) continue;
    REQUIRE(std::fabs(row.v_ref_mps) <= rig.reference.speed_mps * (1.0 + 1e-9));
    REQUIRE(std::fabs(row.v_ref_mps - last_mps) <= rig.reference.acceleration_mps2 * rig.period_s * (1.0 + 1e-6));
    last_mps = row.v_ref_mps;
  }
  test::require_replay<AxisLoop>(rig, axis.rows(), &Row::x_ref_m, &Row::command_m, &Row::command_mps);
}
