// Nyquist's criterion against the poles of the same loop.
#include <catch2/catch.hpp>

#include <string>

#include "config/read_rig.hpp"
#include "design/axis_design.hpp"
#include "design/sampled_loop.hpp"

using namespace pneuservo;

TEST_CASE("Nyquist's criterion and the poles say the same of a loop's stability") {
  for (const char* name : {"cylinder-2m-7.65mm", "cylinder-10m-7.65mm"})
    for (const double factor : {0.3, 1.0, 1.8, 4.0, 10.0}) {
      Rig rig = read_rig(std::string(PNEUSERVO_SOURCE_DIR "/config/") + name + ".yaml", {});
      rig.controller.of<PdForce>().force_gain_V_per_N *= factor;
      const AxisDesign design = design_axis(rig, {});
      INFO(name << " with " << factor << " of its force gain");
      const auto open = [&](double f) { return design.loop.open(f); };
      CHECK(nyquist_verdict(open, 0.5 / rig.period_s).is_stable == design.is_stable);
    }
}
