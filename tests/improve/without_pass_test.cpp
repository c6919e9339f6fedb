// What an improved config does where there is no command pass.
#include <algorithm>
#include <string>

#include <catch2/catch.hpp>

#include "config/read_rig.hpp"
#include "diagnosis/simulated_recording.hpp"
#include "improve/improve.hpp"

namespace pneuservo {
namespace {

TEST_CASE("where the lines cannot carry the reference, the formula comes if it errs less on the model") {
  const Rig rig = read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-10m-4.15mm.yaml",
                           {"duration_s=2", "controller.flow_feedforward=off"});
  const Recording recording = test::simulated_recording(rig, 2.0, 5, {"p1_port_Pa", "p2_port_Pa"});
  const Improvement found = improve("owner.yaml", rig, {recording}, {});
  REQUIRE_FALSE(found.without_pass.empty());
  CHECK(found.improved.controller.of<PdForce>().flow_feedforward == FeedforwardSource::formula);
  CHECK(found.error_ratio() < 1.0);
  CHECK(std::ranges::any_of(found.warnings, [](const std::string& warning) {
    return warning.find("was off and is formula now") != warning.npos;
  }));
}

TEST_CASE("an axis that is commanded gets passes of its moves, and its reference stays live") {
  const Rig rig =
      read_rig(PNEUSERVO_SOURCE_DIR "/config/served/cylinder-10m-7.65mm.yaml", {"controller.flow_feedforward=off"});
  Rig moved = rig;
  moved.reference = live_moves(rig.reference);
  const Recording recording = test::simulated_recording(moved, 2.0, 5, {"p1_port_Pa", "p2_port_Pa"});
  const Improvement found = improve("owner.yaml", rig, {recording}, {});
  CHECK(found.without_pass.empty());
  CHECK(found.error_ratio() < 0.1);
  CHECK(found.improved.reference.kind == ReferenceKind::live);
  CHECK(found.improved.duration_s == rig.duration_s);
  const PdForceParameters& law = found.improved.controller.of<PdForce>();
  CHECK(law.flow_feedforward == FeedforwardSource::pass);
  CHECK(law.without_pass == WithoutPass::formula);
}

}  // namespace
}  // namespace pneuservo
