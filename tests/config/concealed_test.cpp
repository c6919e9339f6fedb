// The section `concealed`: what the simulated machine has in place of the known effects.
#include <catch2/catch.hpp>

#include "config/dump_rig.hpp"
#include "config/rig_parameters.hpp"
#include "config/same_rig.hpp"
#include "test_rigs.hpp"

using namespace pneuservo;

namespace {

Rig line_rig(const std::vector<std::string>& sets) {
  return read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/cylinder-2m-6.10mm.yaml", sets);
}

std::string concealed_refusal(const std::vector<std::string>& sets) {
  try {
    line_rig(sets);
  } catch (const InputError& error) { return error.what(); }
  return "";
}

}  // namespace

TEST_CASE("concealed effects are the simulated machine's alone, known ones are both") {
  const Rig rig = line_rig({"effects={coulomb_friction: {force_N: 10}, valve_dead_band: {width_V: 0.03}}",
                            "concealed.coulomb_friction.force_N=12", "concealed.sensor_offset:x.offset=0.001"});
  REQUIRE(rig.axis.effects.motion.coulomb_friction.force_N == 10.0);
  REQUIRE(rig.sensor_effects[Signal::x].sensor_offset.offset == 0.0);
  const Rig machine = simulated_rig(rig);
  REQUIRE(machine.axis.effects.motion.coulomb_friction.force_N == 12.0);
  REQUIRE(machine.axis.effects.valve.valve_dead_band.width_V == 0.03);
  REQUIRE(machine.sensor_effects[Signal::x].sensor_offset.offset == 0.001);
}

TEST_CASE("a concealed effect replaces the whole known one, also by none") {
  const Rig rig = line_rig({"effects={line_leak_1: {area_m2: 1e-8, position: 0.7}, piston_leak: {area_m2: 1e-8}}",
                            "concealed={line_leak_1: {area_m2: 2e-8, position: 0.2}, piston_leak: {area_m2: 0}}"});
  const Rig machine = simulated_rig(rig);
  REQUIRE(machine.axis.effects.line_leak_1.area_m2 == 2e-8);
  REQUIRE(machine.axis.effects.line_leak_1.position == 0.2);
  REQUIRE(machine.axis.effects.piston_leak.area_m2 == 0.0);
}

TEST_CASE("concealed effects are written and read back, neutral ones too") {
  const Rig rig = line_rig({"effects.coulomb_friction.force_N=10",
                            "concealed={coulomb_friction: {force_N: 0}, valve_lag: {time_constant_s: 0.01}, "
                            "'sensor_gain:p1_port': {gain: 1.02}}"});
  const std::string text = dump_rig(rig);
  const Rig again = parse_rig(text, "dumped");
  REQUIRE(again.concealed == rig.concealed);
  REQUIRE(again.concealed.size() == 3);
  REQUIRE(same_rig(simulated_rig(again), simulated_rig(rig)));
}

TEST_CASE("concealed effects are refused as known ones are, by their own path") {
  REQUIRE_THAT(concealed_refusal({"concealed.piston_leek.area_m2=1e-8"}),
               Catch::Contains("concealed.piston_leek") && Catch::Contains("piston_leak"));
  REQUIRE_THAT(concealed_refusal({"concealed.coulomb_friction.force_N=-1"}),
               Catch::Contains("concealed.coulomb_friction.force_N: found -1"));
  REQUIRE_THAT(concealed_refusal({"concealed={elastic_load: {mass_kg: 50, frequency_Hz: 20, damping_ratio: 0.05}}"}),
               Catch::Contains("concealed.elastic_load"));
}
