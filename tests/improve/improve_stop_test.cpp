// The prediction of improve: a stop in it leaves a config that can be run; gains that swing with what was found go
// down.
#include <algorithm>
#include <atomic>
#include <string>

#include <catch2/catch.hpp>

#include "config/read_rig.hpp"
#include "diagnosis/simulated_recording.hpp"
#include "improve/improve.hpp"

namespace pneuservo {
namespace {

using Catch::Matchers::Contains;

/// Stopped at the wanted look of the prediction; 0: never.
Improvement stopped_at(int wanted, const Rig& rig, const Recording& recording) {
  std::atomic<bool> predicts{false};
  std::atomic<int> looks{0};
  ImproveOptions options;
  options.progress = [&](double share, const std::string&) { predicts = share >= 1.0; };
  options.stop = [&] { return predicts && ++looks == wanted; };
  return improve("owner.yaml", rig, {recording}, options);
}

/// Lines that cannot carry the reference, of an owner who asks for the pass.
TEST_CASE("where there is no pass, a stop leaves a config that asks for none") {
  const Rig rig = read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-10m-4.15mm.yaml",
                           {"controller.flow_feedforward=pass", "duration_s=2"});
  const Recording recording = test::simulated_recording(rig, 2.0, 5, {"p1_port_Pa", "p2_port_Pa"});
  const Improvement whole = stopped_at(0, rig, recording);
  REQUIRE_FALSE(whole.stopped);
  REQUIRE_THAT(whole.without_pass, Contains("the lines cannot carry the reference"));
  for (const int look : {1, 2}) {
    CAPTURE(look);
    const Improvement stopped = stopped_at(look, rig, recording);
    CHECK(stopped.stopped);
    CHECK(stopped.before.rows.empty());
    CHECK(stopped.after.rows.empty());
    const bool asks_for_pass = stopped.improved.controller.of<PdForce>().flow_feedforward == FeedforwardSource::pass;
    CHECK(asks_for_pass == stopped.without_pass.empty());
    const bool says_so = std::ranges::any_of(
        stopped.warnings, [](const std::string& warning) { return warning.find("is formula now") != warning.npos; });
    CHECK(says_so != asks_for_pass);
  }
}

/// The configs' gains suit their valve: with a known lag of 10 ms the loop on 2 m swings by itself.
TEST_CASE("gains that swing with what is known are halved until the axis rests") {
  const Rig rig =
      read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-2m-7.65mm.yaml",
               {"controller.flow_feedforward=formula", "duration_s=2", "effects={valve_lag: {time_constant_s: 0.01}}"});
  Rig calm = rig;
  calm.controller.of<PdForce>().force_gain_V_per_N *= 0.25;
  const Recording recording = test::simulated_recording(calm, 2.0, 5, {"p1_port_Pa", "p2_port_Pa"});
  const Improvement found = stopped_at(0, rig, recording);
  const double was = rig.controller.of<PdForce>().force_gain_V_per_N,
               is = found.improved.controller.of<PdForce>().force_gain_V_per_N;
  CHECK(is <= 0.5 * was);
  CHECK(is >= 0.125 * was);
  CHECK_FALSE(found.after.verdict.oscillates);
  CHECK(std::ranges::any_of(found.warnings, [](const std::string& warning) {
    return warning.find("controller.force_gain_V_per_N was") != warning.npos;
  }));
}

}  // namespace
}  // namespace pneuservo
