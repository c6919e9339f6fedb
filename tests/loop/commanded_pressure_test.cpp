// A pressure that is commanded: nothing moves before enable, set points end where they shall within rate and range, the
// true pressure follows, and a replay of what was obeyed gives the same rows.
#include <catch2/catch.hpp>

#include <cmath>
#include <random>
#include <vector>

#include <pneuservo/loop/pressure_loop.hpp>

#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "loop/commanded_loop.hpp"
#include "loop/loop_rigs.hpp"

using namespace pneuservo;

namespace {

/// Away from the ends of the range, where noise begins outside of it.
Rig served_pressure(const std::vector<std::string>& sets = {}) {
  std::vector<std::string> all{"initial.pressure_1_Pa=300000"};
  all.insert(all.end(), sets.begin(), sets.end());
  return config_rig("served/pressure-3m-4mm", all);
}

using CommandedPressure = test::CommandedLoop<PressureLoop>;

AxisCommand to_pressure(double pressure_Pa, double rate_Pa_per_s = 8e4) {
  return {CommandKind::move_to, pressure_Pa, rate_Pa_per_s};
}

}  // namespace

TEST_CASE("a commanded pressure: shut before enable, obeyed in the next tick, shut again after disable") {
  CommandedPressure rig(served_pressure());
  rig.run(300);
  for (const Row& row : rig.rows()) CHECK(row.u_V == 0.0);
  CHECK(rig.ask(to_pressure(4e5)).result == CommandResult::not_enabled);
  rig.enable();
  const double begin_Pa = rig.last().p_ref_Pa;
  CHECK(begin_Pa == Approx(3e5).margin(1e3));
  const std::size_t before = rig.rows().size();
  const AxisAnswer answer = rig.ask(to_pressure(4e5));
  CHECK((answer.result == CommandResult::taken && answer.target == 4e5));
  CHECK(rig.rows()[before].p_ref_Pa > begin_Pa);
  rig.run(4000);
  CHECK(rig.last().p_ref_Pa == 4e5);
  CHECK(rig.last().p1_chamber_true_Pa == Approx(4e5).margin(1e3));
  CHECK(rig.status().p_Pa == Approx(rig.last().p1_chamber_true_Pa).margin(1e3));
  CHECK(rig.ask({CommandKind::disable}).result == CommandResult::taken);
  rig.run(500);
  CHECK((rig.last().u_V == 0.0 && std::isnan(rig.last().p_ref_Pa)));
  CHECK(rig.ask(to_pressure(3e5)).result == CommandResult::not_enabled);
  rig.enable();
  CHECK(rig.last().p_ref_Pa == Approx(rig.last().p1_chamber_true_Pa).margin(1e3));
}

TEST_CASE("a commanded pressure: a fault shuts the valve, refuses commands, and ends by reset and enable alone") {
  CommandedPressure rig(served_pressure());
  rig.enable();
  rig.ask(to_pressure(5e5));
  rig.run(200);
  rig.loop().note_slept(2'000'000'000);
  rig.run(1);
  REQUIRE(rig.loop().faults() != 0);
  CHECK(rig.last().u_V == 0.0);
  CHECK(rig.ask(to_pressure(3e5)).result == CommandResult::in_fault);
  CHECK(rig.ask({CommandKind::enable}).result == CommandResult::in_fault);
  CHECK(rig.ask({CommandKind::reset}).result == CommandResult::taken);
  rig.run(200);
  CHECK(rig.last().u_V == 0.0);
  rig.enable();
  CHECK(rig.ask(to_pressure(4e5)).result == CommandResult::taken);
  rig.run(4000);
  CHECK(rig.last().p1_chamber_true_Pa == Approx(4e5).margin(1e3));
}

TEST_CASE("random commands of a pressure: no fault, within rate and range, and what was obeyed replays bit for bit") {
  const auto seed = test::new_seed();
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const Rig config = served_pressure();
  CommandedPressure rig(config);
  rig.enable();
  for (int i = 0; i < 120; ++i) {
    const double rate = uniform(1e3, 8e4);
    switch (random() % 8) {
      case 0: rig.ask({CommandKind::stop}); break;
      case 1: rig.ask({CommandKind::jog, 0.0, random() % 2 == 0 ? rate : -rate}); break;
      case 2: rig.ask({CommandKind::move_by, uniform(-5e4, 5e4), rate}); break;
      case 3: rig.ask({CommandKind::follow, uniform(2e5, 6e5), 0.0, 0, 0.05}); break;
      default: rig.ask(to_pressure(uniform(2e5, 6e5), rate));
    }
    rig.run(1 + static_cast<int>(random() % 600));
    REQUIRE(rig.loop().faults() == 0);
  }
  double last_Pa = Row::none;
  for (const Row& row : rig.rows()) {
    if (std::isfinite(row.p_ref_Pa)) {
      REQUIRE((row.p_ref_Pa >= 2e5 - 1e-3 && row.p_ref_Pa <= 6e5 + 1e-3));
      if (std::isfinite(last_Pa))
        REQUIRE(std::fabs(row.p_ref_Pa - last_Pa) <= 8e4 * config.period_s * (1.0 + 1e-6) + 1e-3);
      last_Pa = row.p_ref_Pa;
    }
  }
  test::require_replay<PressureLoop>(config, rig.rows(), &Row::p_ref_Pa, &Row::command_Pa, &Row::command_Pa_per_s);
}

TEST_CASE("what may be commanded of a pressure is held to valve, supply and atmosphere") {
  const auto refused = [](const std::vector<std::string>& sets) {
    try {
      served_pressure(sets);
    } catch (const InputError& error) { return std::string(error.what()); }
    return std::string("accepted");
  };
  CHECK_THAT(refused({"reference.highest_Pa=750000"}), Catch::Contains("less than supply.pressure_Pa"));
  CHECK_THAT(refused({"reference.lowest_Pa=50000"}), Catch::Contains("at least air.atmosphere_Pa"));
  CHECK_THAT(refused({"reference.lowest_Pa=600000"}), Catch::Contains("reference.highest_Pa"));
  CHECK_THAT(refused({"reference.rate_Pa_per_s=150000"}), Catch::Contains("at most controller.rate_max_Pa_per_s"));
  CHECK_THAT(refused({"reference.rate_Pa_per_s=1e7", "controller.rate_max_Pa_per_s=.inf", "reference.ramp_s=0.01"}),
             Catch::Contains("which the open valve feeds"));
  CHECK_THAT(refused({"serve.drive={interface: can1, node_id: 5}"}), Catch::Contains("CiA 402 is of axes"));
}
