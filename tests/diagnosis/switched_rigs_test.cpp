// The diagnosis' vessel against the exponential of its blow-down, its leaks in series, and the diagnosis of vessels and
// switched cylinders on recordings of their own making (the plants' closed forms: tests/rig/switched_plants_test.cpp).
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include <pneuservo/elements/air.hpp>
#include <pneuservo/rig/vessel_plant.hpp>

#include "config/read_rig.hpp"
#include "config/rig_parameters.hpp"
#include "core/test_seed.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/residuals/stroke_residuals.hpp"
#include "diagnosis/residuals/vessel_residuals.hpp"

using namespace pneuservo;

namespace {

constexpr const char* tank = R"(format: pneuservo-rig/1
name: tank
rig: vessel
period_s: 0.1
valve: {exhaust_area_m2: 2.0e-6}
vessel: {volume_m3: 0.1}
sensors: {pressure: {quantum_Pa: 10.0, noise_Pa: 200.0}}
program: {times_s: [0.0], commands: [-1.0]}
)";

constexpr const char* lift = R"(format: pneuservo-rig/1
name: lift
rig: switched_cylinder
period_s: 0.001
supply: {pressure_Pa: 600000}
valve: {critical_pressure_ratio: 0.36}
throttle_1: {inflow_area_m2: 4.0e-6, outflow_area_m2: 5.0e-7}
throttle_2: {inflow_area_m2: 4.0e-6, outflow_area_m2: 5.0e-7}
cylinder: {stroke_m: 0.2, area_1_m2: 3.1e-4, area_2_m2: 2.6e-4, dead_volume_1_m3: 4.0e-6, dead_volume_2_m3: 4.0e-6, wall_heat_W_per_m2K: 100000}
slider: {mass_kg: 2.0, viscous_friction_Ns_per_m: 5.0}
sensors: {position: {quantum_m: 1.0e-5}}
program: {times_s: [0.0, 0.2, 3.0], commands: [-1.0, 1.0, -1.0]}
model_error: {position_m: 2.0e-4}
tolerances: {throttle_1.inflow_area_m2: 0.05, throttle_1.outflow_area_m2: 0.05, throttle_2.inflow_area_m2: 0.05, throttle_2.outflow_area_m2: 0.05}
)";

Recording recording_of(std::vector<std::string> names, std::vector<std::vector<double>> values) {
  Recording out;
  out.path = "made here";
  out.names = std::move(names);
  out.values = std::move(values);
  out.line_numbers.resize(out.values.front().size());
  return out;
}

std::vector<double> times(double period_s, std::size_t count) {
  std::vector<double> out;
  for (std::size_t k = 0; k < count; ++k) out.push_back(period_s * static_cast<double>(k));
  return out;
}

/// What the rig's own simulation reads at these times, with white noise.
std::vector<double> simulated(ResidualModel& model, const Rig& rig, double noise, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> white(0.0, noise);
  std::vector<double> out = model.courses({rig, {}}).front().simulated;
  for (double& value : out) value += white(generator);
  return out;
}

Recording tank_recording(const Rig& rig, unsigned seed) {
  const std::vector<double> t = times(0.5, 400);
  VesselResiduals model(rig, {recording_of({"t_s", "p1_chamber_Pa"}, {t, std::vector<double>(t.size(), 5e5)})}, 1);
  return recording_of({"t_s", "p1_chamber_Pa"}, {t, simulated(model, rig, 200.0, seed)});
}

Recording lift_recording(const Rig& rig, unsigned seed) {
  const std::vector<double> t = times(0.001, 5000);
  StrokeResiduals model(rig, {recording_of({"t_s", "x_m"}, {t, std::vector<double>(t.size(), -0.1)})}, 1);
  return recording_of({"t_s", "x_m"}, {t, simulated(model, rig, 1e-5, seed)});
}

}  // namespace

TEST_CASE("an isothermal tank empties through a choked orifice by its exponential") {
  const Rig rig =
      parse_rig(std::string(tank) + "effects: {wall_heat_exchange: {conductance_W_per_K: 900000}}\n", "tank");
  const Recording recording = tank_recording(rig, 1);
  VesselResiduals model(rig, {recording}, 1);
  const ResidualCourse course = model.courses({rig, {}}).front();
  const Air<double> air(rig.axis.air);
  const double tau = 0.1 / (2.0e-6 * air.flow_constant * std::sqrt(air.R * air.temperature_K));
  for (std::size_t k = 0; k < course.time_s.size() && course.simulated[k] > 2.0 * air.atmosphere_Pa; k += 20)
    CHECK(course.simulated[k] == Approx(course.simulated[0] * std::exp(-course.time_s[k] / tau)).epsilon(2e-3));
}

TEST_CASE("a laminar and an orifice resistance in series pass less than either and tend to the narrower one") {
  VesselEffects<double> effects;
  const Air<double> air;
  const double p = 7e5, T = 293, K = 1e-16, area = 2e-8, b = 0.528;
  effects.laminar_leak_1.conductance_kgps_per_Pa2 = K;
  const double laminar = vessel_leak_flow(effects, air, b, p, T);
  effects = {};
  effects.chamber_leak_1.area_m2 = area;
  const double orifice = vessel_leak_flow(effects, air, b, p, T);
  effects = {};
  effects.porous_leak_1 = {K, area};
  const double both = vessel_leak_flow(effects, air, b, p, T);
  CHECK(both < std::min(laminar, orifice));
  CHECK(both > 0.5 * std::min(laminar, orifice));
  effects.porous_leak_1 = {K, 1e-3};
  CHECK(vessel_leak_flow(effects, air, b, p, T) == Approx(laminar).epsilon(1e-3));
  effects.porous_leak_1 = {1e-10, area};
  CHECK(vessel_leak_flow(effects, air, b, p, T) == Approx(orifice).epsilon(1e-3));
}

TEST_CASE("a tank's wall heat and a wrong orifice come out of its blow-down") {
  const Rig owner = parse_rig(tank, "tank");
  Rig machine = owner;
  set_parameter(machine, "effects.wall_heat_exchange.conductance_W_per_K", 8.0);
  const Diagnosis found = diagnose(owner, {tank_recording(machine, 5)});
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers[0].effect == "wall_heat_exchange");
  CHECK(found.answers[0].parameters[0].value == Approx(8.0).epsilon(0.05));
}

TEST_CASE("a wall that creeps under a closed isothermal vessel takes the pressure that Boyle's law says") {
  const Rig rig = parse_rig(R"(format: pneuservo-rig/1
name: bottle
rig: vessel
period_s: 0.1
valve: {exhaust_area_m2: 2.0e-6}
vessel: {volume_m3: 1.0e-3, wall_heat_W_per_K: 100000}
sensors: {pressure: {quantum_Pa: 10.0, noise_Pa: 100.0}}
effects: {wall_creep: {growth_per_Pa: 2.0e-8, time_constant_s: 5.0}}
)",
                            "bottle");
  const double start_Pa = 6e5, atmosphere_Pa = rig.axis.air.atmosphere_Pa;
  VesselPlant charged(rig, start_Pa), settled(rig, start_Pa, true);
  for (int i = 0; i < 10000; ++i) {
    charged.step(0.01, 0.0, 0.0);
    settled.step(0.01, 0.0, 0.0);
  }
  // p (1 + c (p - p_a)) = p_0 after twenty time constants.
  const double p = charged.chamber_Pa();
  CHECK(p * (1 + 2.0e-8 * (p - atmosphere_Pa)) == Approx(start_Pa).epsilon(1e-5));
  CHECK(settled.chamber_Pa() == Approx(start_Pa).epsilon(1e-9));
}

TEST_CASE("creep of a wall is named where the pressure goes up and down") {
  const Rig owner = parse_rig(R"(format: pneuservo-rig/1
name: bottle
rig: vessel
period_s: 0.05
air: {atmosphere_Pa: 101325}
supply: {pressure_Pa: 400000}
valve: {supply_area_m2: 3.0e-7, exhaust_area_m2: 3.0e-7}
vessel: {volume_m3: 1.0e-3, wall_heat_W_per_K: 1.0}
sensors: {pressure: {quantum_Pa: 10.0, noise_Pa: 100.0}}
tolerances: {valve.supply_area_m2: 0.1, valve.exhaust_area_m2: 0.1, supply.pressure_Pa: 0.01, vessel.wall_heat_W_per_K: 0.05}
)",
                              "bottle");
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  const std::vector<double> t = times(0.05, 3600);
  std::vector<double> command(t.size(), 0.0), still(t.size(), owner.axis.air.atmosphere_Pa);
  for (std::size_t k = 0; k < t.size(); ++k)
    command[k] = t[k] < 1 ? 0.0 : t[k] < 11 ? 1.0 : t[k] < 71 ? 0.0 : t[k] < 74 ? -1.0 : 0.0;
  Rig machine = owner;
  set_parameter(machine, "effects.wall_creep.growth_per_Pa", 6e-8);
  set_parameter(machine, "effects.wall_creep.time_constant_s", 20);
  const std::vector<std::string> names{"t_s", "u_V", "p1_chamber_Pa"};
  VesselResiduals model(machine, {recording_of(names, {t, command, still})}, 1);
  const Diagnosis found = diagnose(owner, {recording_of(names, {t, command, simulated(model, machine, 100.0, seed)})});
  INFO(found.sentence);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers[0].effect == "wall_creep");
  CHECK(found.answers[0].parameters[0].value == Approx(6e-8).epsilon(0.2));
  CHECK(found.answers[0].parameters[1].value == Approx(20).epsilon(0.3));
}

TEST_CASE("pump and orifice agree on the pressure between them, no pump is a constant supply") {
  const Air<double> air;
  const double area = 1e-6, b = 0.528, stalled = 1.5e5, p = 1.1e5, T = 293;
  const double R = 2e7, between = pressure_behind_pump({R}, air, area, b, stalled, p, T);
  CHECK((between > p && between < stalled));
  CHECK(between == Approx(stalled - R * orifice_mass_flow(air, area, b, between, air.temperature_K, p, T)));
  CHECK(pressure_behind_pump({0.0}, air, area, b, stalled, p, T) == stalled);
  CHECK(pressure_behind_pump({R}, air, area, b, stalled, stalled, T) == stalled);
  // Against a wide orifice the pump alone gives: R (p_s - p)/R, what a first-order filling is made of.
  CHECK(pressure_behind_pump({R}, air, 1e-2, b, stalled, p, T) == Approx(p).epsilon(1e-3));
}

TEST_CASE("a supply that is a pump is named with its curve, and a recording may begin long after the command") {
  const Rig owner = parse_rig(R"(format: pneuservo-rig/1
name: pumped
rig: vessel
period_s: 0.05
supply: {pressure_Pa: 147000}
valve: {supply_area_m2: 3.0e-7, exhaust_area_m2: 2.0e-7}
vessel: {volume_m3: 1.0e-3, wall_heat_W_per_K: 100}
sensors: {pressure: {quantum_Pa: 10.0, noise_Pa: 30.0}}
tolerances: {valve.supply_area_m2: 0.3, valve.exhaust_area_m2: 0.3}
)",
                              "pumped");
  const std::vector<double> t = times(0.05, 1600);
  std::vector<double> command(t.size(), -1.0), still(t.size(), owner.axis.air.atmosphere_Pa);
  for (std::size_t k = 0; k < t.size(); ++k)
    if (t[k] >= 1 && t[k] < 41) command[k] = 1.0;
  const auto made = [&](const Rig& machine) {
    VesselResiduals model(machine, {recording_of({"t_s", "u_V", "p1_chamber_Pa"}, {t, command, still})}, 1);
    return recording_of({"t_s", "u_V", "p1_chamber_Pa"}, {t, command, simulated(model, machine, 30.0, 11)});
  };
  Rig machine = owner;
  set_parameter(machine, "effects.pump_curve.resistance_Pa_s_per_kg", 8e8);
  const Diagnosis found = diagnose(owner, {made(machine)});
  INFO(found.sentence);
  REQUIRE(found.answers.size() == 1);
  CHECK(found.answers[0].effect == "pump_curve");
  CHECK(found.answers[0].element == "supply");
  CHECK(found.answers[0].parameters[0].value == Approx(8e8).epsilon(0.05));
  // The emptying alone, cut out of the healthy machine's recording: it starts from what is recorded there.
  Recording cut = made(owner);
  for (auto& values : cut.values) values.erase(values.begin(), values.begin() + 850);
  cut.line_numbers.resize(cut.values.front().size());
  const Diagnosis healthy = diagnose(owner, {cut});
  INFO(healthy.sentence);
  CHECK(healthy.verdict == Verdict::consistent);
}

TEST_CASE("heat of a small tank's wall is told from a leak beside its orifice, and beside the pump that fills it") {
  const Rig owner = parse_rig(R"(format: pneuservo-rig/1
name: warm
rig: vessel
period_s: 0.05
supply: {pressure_Pa: 147000}
valve: {supply_area_m2: 1.0e-6, exhaust_area_m2: 1.2e-7}
vessel: {volume_m3: 1.0e-3}
sensors: {pressure: {quantum_Pa: 10.0, noise_Pa: 30.0}}
model_error: {pressure_Pa: 300.0}
tolerances: {valve.supply_area_m2: 0.3, valve.exhaust_area_m2: 1.0, supply.pressure_Pa: 0.02}
)",
                              "warm");
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  const std::vector<double> t = times(0.05, 1600);
  std::vector<double> command(t.size(), -1.0), still(t.size(), owner.axis.air.atmosphere_Pa);
  for (std::size_t k = 0; k < t.size(); ++k)
    if (t[k] >= 1 && t[k] < 41) command[k] = 1.0;
  Rig machine = owner;
  set_parameter(machine, "effects.wall_heat_exchange.conductance_W_per_K", 0.3);  // 5 W/(m2 K) on 0.06 m2
  set_parameter(machine, "effects.pump_curve.resistance_Pa_s_per_kg", 4.1e8);
  VesselResiduals model(machine, {recording_of({"t_s", "u_V", "p1_chamber_Pa"}, {t, command, still})}, 1);
  const Recording whole =
      recording_of({"t_s", "u_V", "p1_chamber_Pa"}, {t, command, simulated(model, machine, 30.0, seed)});
  const auto size_of = [](const Diagnosis& found, const std::string& name) {
    for (const DiagnosisAnswer& answer : found.answers)
      if (answer.effect == name) return answer.parameters[0].value;
    return 0.0;
  };
  const Diagnosis filled = diagnose(owner, {whole});
  INFO(filled.sentence);
  REQUIRE(filled.answers.size() == 2);
  CHECK(size_of(filled, "wall_heat_exchange") == Approx(0.3).epsilon(0.1));
  CHECK(size_of(filled, "pump_curve") == Approx(4.1e8).epsilon(0.1));
  Recording emptied = whole;
  for (auto& values : emptied.values) values.erase(values.begin(), values.begin() + 822);
  emptied.line_numbers.resize(emptied.values.front().size());
  const Diagnosis alone = diagnose(owner, {emptied});
  INFO(alone.sentence);
  REQUIRE(alone.answers.size() == 1);
  CHECK(size_of(alone, "wall_heat_exchange") == Approx(0.3).epsilon(0.1));
}

TEST_CASE("an exhaust throttle that was opened is named, and a healthy cylinder is not") {
  const Rig owner = parse_rig(lift, "lift");
  Rig machine = owner;
  set_parameter(machine, "throttle_2.outflow_area_m2", 8.0e-7);
  const Diagnosis found = diagnose(owner, {lift_recording(machine, 3)});
  REQUIRE(found.answers.size() == 1);
  CHECK(found.verdict == Verdict::parameter_error);
  CHECK(found.answers[0].effect == "parameter:throttle_2.outflow_area_m2");
  CHECK(found.answers[0].parameters[0].value == Approx(8.0e-7).epsilon(0.03));
  CHECK(diagnose(owner, {lift_recording(owner, 4)}).verdict == Verdict::consistent);
}
