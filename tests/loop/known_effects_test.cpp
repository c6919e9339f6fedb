// What was found and stands under `effects` is known to estimator and cross-checks; what is concealed is told.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/loop/fault.hpp>

#include "loop/loop_rigs.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

constexpr std::uint64_t mismatches =
    fault_flow_mismatch_1 | fault_flow_mismatch_2 | fault_chamber_mismatch_1 | fault_chamber_mismatch_2;

struct Watched {
  std::uint64_t faults = 0;
  double most_share = 0.0;  ///< of what would be a mismatch
  double estimation_error_Pa = 0.0;  ///< root mean square, chamber 1
};

/// Three seconds of the config's sine under supervision.
Watched watched(const std::vector<std::string>& sets, const char* config = "cylinder-5m-6.10mm") {
  std::vector<std::string> all{"duration_s=3", "limits.deviation_m=0", "limits.speed_deviation_mps=0"};
  all.insert(all.end(), sets.begin(), sets.end());
  const Rig rig = config_rig(config, all);
  SimBackend backend(rig);
  backend.configure();
  backend.activate();
  AxisLoop loop;
  loop.configure(rig);
  Watched out;
  double squares = 0.0;
  int counted = 0;
  const std::int64_t ticks = std::llround(rig.duration_s / rig.period_s);
  for (std::int64_t tick = 0; tick < ticks && loop.faults() == 0; ++tick) {
    loop.pass(backend, tick, 0, nullptr, nullptr);
    for (const auto& shares : {loop.supervisor().checks().flow_share(), loop.supervisor().checks().chamber_share()})
      out.most_share = std::max({out.most_share, shares[0], shares[1]});
    if (tick < 1000) continue;
    const double error_Pa = loop.row().p1_estimated_Pa - loop.row().p1_chamber_true_Pa;
    squares += error_Pa * error_Pa;
    ++counted;
  }
  out.faults = loop.faults();
  out.estimation_error_Pa = std::sqrt(squares / std::max(counted, 1));
  return out;
}

}  // namespace

TEST_CASE("a known restriction, leak, branch or hose that swells is no fault and costs the estimate little") {
  for (const char* effect :
       {"line_restriction_1: {area_m2: 5e-6}", "chamber_leak_1: {area_m2: 3e-7}", "piston_leak: {area_m2: 3e-7}",
        "line_leak_1: {area_m2: 3e-7, position: 0.6}",
        "line_branch_1: {volume_m3: 2e-4, neck_length_m: 0.1, neck_diameter_m: 0.004, position: 0.6}",
        "line_compliance_1: {section_growth_per_Pa: 1e-6}"}) {
    CAPTURE(effect);
    const std::string braced = "{" + std::string(effect) + "}";
    const Watched known = watched({"effects=" + braced});
    const Watched concealed =
        watched({"concealed=" + braced, "limits.flow_mismatch_share=0", "limits.chamber_mismatch_Pa=0"});
    CAPTURE(known.most_share, known.estimation_error_Pa, concealed.estimation_error_Pa);
    CHECK(known.faults == 0);
    CHECK(known.most_share < 1.0);
    CHECK(known.estimation_error_Pa < 0.5 * concealed.estimation_error_Pa);
  }
}

TEST_CASE("what the valve's command path does is known to the flow correction") {
  for (const char* effect : {"valve_dead_band: {width_V: 0.2}", "valve_offset: {offset_V: 0.2}",
                             "valve_lag: {time_constant_s: 0.005}", "valve_asymmetry: {exhaust_ratio: 1.3}"}) {
    CAPTURE(effect);
    const std::string braced = "{" + std::string(effect) + "}";
    const Watched known = watched({"effects=" + braced, "controller.force_gain_V_per_N=0.001"});
    CAPTURE(known.most_share, known.estimation_error_Pa);
    CHECK(known.faults == 0);
    CHECK(known.most_share < 1.0);
  }
}

TEST_CASE("losses that depend on frequency count in the estimate where the config asks for them") {
  const std::string known = "effects.frequency_dependent_losses.share=1";
  const std::vector<std::string> exact{known, "sensors.port_pressure.noise_Pa=0", "sensors.port_pressure.quantum_Pa=0"};
  for (const std::vector<std::string>& sets : {std::vector<std::string>{known}, exact}) {
    std::vector<std::string> asked = sets;
    asked.emplace_back("estimator.frequency_dependent_losses=true");
    const Watched without = watched(sets, "cylinder-10m-7.65mm"), with = watched(asked, "cylinder-10m-7.65mm");
    CAPTURE(without.estimation_error_Pa, with.estimation_error_Pa);
    CHECK(with.faults == 0);
    CHECK(with.estimation_error_Pa < 0.5 * without.estimation_error_Pa);
  }
}

TEST_CASE("the estimate is the same to the bit where no losses are known, whether asked for or not") {
  CHECK(watched({"estimator.frequency_dependent_losses=true"}).estimation_error_Pa == watched({}).estimation_error_Pa);
}

TEST_CASE("a concealed leak is told") {
  const Watched concealed = watched({"concealed={chamber_leak_1: {area_m2: 2e-6}}"});
  CHECK((concealed.faults & mismatches) != 0);
}
