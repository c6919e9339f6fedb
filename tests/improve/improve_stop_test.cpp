// A stop in the prediction: the improved config can be run, and nothing is predicted.
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

}  // namespace
}  // namespace pneuservo
