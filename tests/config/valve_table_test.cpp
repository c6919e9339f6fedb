// A measured valve in a config: areas or flows over the command give the curve that they were made with.
#include <catch2/catch.hpp>

#include <cmath>

#include <fmt/format.h>

#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/valve.hpp>

#include "config/read_rig.hpp"
#include "config/test_rigs.hpp"

using namespace pneuservo;
using Catch::Contains;
using test::refusal;
using test::with;

namespace {

struct Measured {
  std::string commands, areas, flows;
};

/// At 25 commands, with the air of a config that states none.
Measured measured(const ValveParameters<double>& parameters, const ValveEffects<double>& effects) {
  Valve<double> valve;
  valve.configure(parameters, effects, 1e-3);
  const AirParameters<double> air;
  const double flux = orifice_flux(Air<double>(air), 7e5, air.temperature_K, 1e5, parameters.critical_pressure_ratio);
  Measured out;
  for (int i = -12; i <= 12; ++i) {
    const double command = i * 5.0 / 12;
    const PortAreas<double> areas = valve.areas(command);
    const double area = areas.supply + areas.exhaust;
    out.commands += fmt::format("{}{:.6f}", i == -12 ? "" : ", ", command);
    out.areas += fmt::format("{}{:.9e}", i == -12 ? "" : ", ", area);
    out.flows += fmt::format("{}{:.9e}", i == -12 ? "" : ", ", area * flux);
  }
  return out;
}

const std::string areas_of_plain = "  area_per_volt_m2_per_V: 2.6e-6\n  area_max_m2: 1.3e-5\n";
const ValveParameters<double> parameters{5.0, 2.6e-6, 9e-6, 0.35};

ValveEffects<double> bent_effects() {
  ValveEffects<double> effects;
  effects.valve_offset.offset_V = 0.03;
  effects.valve_dead_band.width_V = 0.2;
  effects.valve_curve = {-0.3, 0.15};
  return effects;
}

std::string table_of(const std::string& commands, const std::string& values) {
  return with(test::plain_rig, areas_of_plain, fmt::format("  table:\n    command_V: [{}]\n{}", commands, values));
}

/// The valve that the config has against the one that was measured, at commands between the measured ones.
double largest_miss(const Rig& rig, const ValveEffects<double>& effects) {
  Valve<double> true_valve, read_valve;
  true_valve.configure(parameters, effects, 1e-3);
  read_valve.configure(rig.axis.valve, rig.axis.effects.valve, 1e-3);
  double worst = 0;
  for (double command = -4.9; command < 5.0; command += 0.13) {
    worst = std::max(worst, std::abs(true_valve.areas(command).supply - read_valve.areas(command).supply));
    worst = std::max(worst, std::abs(true_valve.areas(command).exhaust - read_valve.areas(command).exhaust));
  }
  return worst;
}

}  // namespace

TEST_CASE("a table of areas or of flows gives the valve that was measured") {
  const ValveEffects<double> effects = bent_effects();
  const Measured table = measured(parameters, effects);
  const std::string areas = fmt::format("    area_m2: [{}]\n", table.areas);
  const std::string flows =
      fmt::format("    flow_kgps: [{}]\n    upstream_Pa: 7e5\n    downstream_Pa: 1e5\n", table.flows);
  for (const std::string& values : {areas, flows}) {
    CAPTURE(values);
    const Rig rig = parse_rig(table_of(table.commands, values), "rig.yaml");
    CHECK(largest_miss(rig, effects) < 0.01 * parameters.area_max_m2);
    CHECK(rig.axis.valve.area_max_m2 == Approx(9e-6).epsilon(1e-4));
    CHECK(rig.axis.effects.valve.valve_offset.offset_V == Approx(0.03).margin(0.005));
    CHECK(rig.axis.effects.valve.valve_dead_band.width_V == Approx(0.2).margin(0.03));
  }
}

TEST_CASE("a table reads the data sheet beside it: air with its unit, the valve's signal") {
  const Measured table = measured(parameters, bent_effects());
  const std::string flows =
      fmt::format("    flow_kgps: [{}]\n    upstream_Pa: 7e5\n    downstream_Pa: 1e5\n", table.flows);
  const std::string with_signal = with(table_of(table.commands, flows), "command_max_V: 5.0", "signal: 0 to 10 V");
  const Rig rig = parse_rig(with_signal, "rig.yaml");
  CHECK(rig.axis.valve.command_max_V == 5.0);
  CHECK(rig.axis.valve.area_max_m2 == Approx(9e-6).epsilon(1e-3));
  // The same flow of warmer gas needs an area that is larger by the root of the temperatures.
  const Rig warm = parse_rig(with_signal + "air: {temperature: 353 K}\n", "rig.yaml");
  CHECK(warm.axis.valve.area_max_m2 == Approx(9e-6 * std::sqrt(353.0 / 293.0)).epsilon(1e-3));
}

TEST_CASE("the table of an ideal valve gives no effect worth a name") {
  const Measured table = measured(parameters, {});
  const Rig rig = parse_rig(table_of(table.commands, fmt::format("    area_m2: [{}]\n", table.areas)), "rig.yaml");
  CHECK(largest_miss(rig, {}) < 0.002 * parameters.area_max_m2);
  CHECK(rig.axis.valve.area_per_volt_m2_per_V == Approx(2.6e-6).epsilon(0.02));
}

TEST_CASE("what the config states under effects stays beside a table") {
  const Measured table = measured(parameters, bent_effects());
  const Rig rig = parse_rig(table_of(table.commands, fmt::format("    area_m2: [{}]\n", table.areas)) +
                                "effects:\n  valve_dead_band: {width_V: 0.5}\n",
                            "rig.yaml");
  CHECK(rig.axis.effects.valve.valve_dead_band.width_V == 0.5);
  CHECK(rig.axis.effects.valve.valve_offset.offset_V == Approx(0.03).margin(0.005));
}

TEST_CASE("a table that cannot be meant is refused in one sentence") {
  const std::string eight = "-4, -3, -2, -1, 1, 2, 3, 4",
                    values = "    area_m2: [4e-6, 3e-6, 2e-6, 1e-6, 1e-6, 2e-6, 3e-6, 4e-6]\n";
  CHECK(parse_rig(table_of(eight, values), "rig.yaml").axis.valve.area_max_m2 == Approx(4e-6));
  CHECK_THAT(refusal(table_of("-4, -3, 3, 4", values)),
             Contains("valve.table.command_V: found 4 numbers, expected at least 8"));
  CHECK_THAT(refusal(table_of(eight + ", 4.5", values)), Contains("valve.table.area_m2: found 8 numbers, expected 9"));
  CHECK_THAT(refusal(table_of("-7, -3, -2, -1, 1, 2, 3, 4", values)),
             Contains("expected commands within +-command_max_V, 5 V"));
  CHECK_THAT(refusal(table_of(eight, "    area_m2: [0, 0, 0, 0, 0, 0, 0, 0]\n")),
             Contains("expected those of a valve that opens"));
  CHECK_THAT(refusal(table_of(eight, "    flow_kgps: [4, 3, 2, 1, 1, 2, 3, 4]\n")),
             Contains("valve.table.upstream_Pa: found nothing"));
  CHECK_THAT(refusal(table_of(eight, values + "    areas: 3\n")), Contains("valve.table.areas: found an unknown key"));
  CHECK_THAT(refusal(with(table_of(eight, values), "  critical_pressure_ratio",
                          "  area_max_m2: 1e-5\n  critical_pressure_ratio")),
             Contains("valve.table: found it beside area_max_m2"));
}
