// Gains that swing with what was found go down.
#include <algorithm>
#include <string>

#include <catch2/catch.hpp>

#include "config/read_rig.hpp"
#include "diagnosis/simulated_recording.hpp"
#include "improve/improve.hpp"

namespace pneuservo {
namespace {

/// The configs' gains suit their valve: with a known lag of 10 ms the loop on 2 m swings by itself.
TEST_CASE("gains that swing with what is known are halved until the axis rests") {
  const Rig rig =
      read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-2m-7.65mm.yaml",
               {"controller.flow_feedforward=formula", "duration_s=2", "effects={valve_lag: {time_constant_s: 0.01}}"});
  Rig calm = rig;
  calm.controller.of<PdForce>().force_gain_V_per_N *= 0.25;
  const Recording recording = test::simulated_recording(calm, 2.0, 5, {"p1_port_Pa", "p2_port_Pa"});
  const Improvement found = improve("owner.yaml", rig, {recording}, {});
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
