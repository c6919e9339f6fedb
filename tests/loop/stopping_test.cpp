// Stopping table: against runs with an emergency stop at top speed, against closed forms, and its dependences.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "inject/injecting_backend.hpp"
#include "loop/loop_rigs.hpp"
#include "loop/runner.hpp"
#include "loop/stopping.hpp"

using namespace pneuservo;

namespace {

/// Way after an emergency stop at `at_s`, of the program's own loop on its own simulated plant, noise and all.
double run_distance_m(const Rig& rig, double at_s) {
  InjectingBackend backend(rig, {{.kind = InjectedKind::emergency_stop, .target = {}, .value = {}, .start_s = at_s}},
                           "test");
  backend.configure();
  const RunOutcome outcome = run_loop(rig, backend, {});
  double start = NAN, way = 0.0;
  for (const Row& row : outcome.rows) {
    if (row.fault == 0) continue;
    if (std::isnan(start)) start = row.x_true_m;
    way = std::max(way, std::fabs(row.x_true_m - start));
  }
  return way;
}

}  // namespace

TEST_CASE("stated stopping distances are those of runs with an emergency stop at top speed, within 10 %") {
  const std::string name = GENERATE("cylinder-10m-7.65mm", "cylinder-2m-4.15mm", "servo-table-1m-8mm");
  const Rig rig = config_rig(name, {name.starts_with("servo") ? "simulation.cells_per_m=8" : "duration_s=3"});
  const StoppingTable table = stopping_table(rig, {});
  INFO(name << " from " << table.own_reference.speed_mps << " m/s at " << table.own_reference.at_s << " s");
  REQUIRE(table.own_reference.speed_mps > 0.8 * table.top_speed_mps);
  const double run_m = run_distance_m(rig, table.own_reference.at_s);
  REQUIRE(run_m > 0.0);
  REQUIRE(table.own_reference.distance_m == Approx(run_m).epsilon(0.1));
  // The worst stop from up to the top speed is no shorter than this one, and slower speeds stop no later.
  REQUIRE(table.rows.back().worst.distance_m >= table.own_reference.distance_m);
  for (std::size_t i = 1; i < table.rows.size(); ++i)
    REQUIRE(table.rows[i].worst.distance_m >= table.rows[i - 1].worst.distance_m);
}

TEST_CASE("a payload that the limits allow lengthens the stop, and the watchdog's time adds its way") {
  const Rig light = config_rig("can/cylinder-10m-7.65mm", {"duration_s=2"});
  const Rig heavy = config_rig("can/cylinder-10m-7.65mm", {"duration_s=2", "limits.payload_max_kg=5"});
  const StoppingTable a = stopping_table(light, {}), b = stopping_table(heavy, {});
  REQUIRE(b.rows.back().worst.distance_m > 1.1 * a.rows.back().worst.distance_m);
  REQUIRE(a.own_reference.distance_m == b.own_reference.distance_m);
  REQUIRE(a.watchdog_s == 0.06);
  REQUIRE(a.watchdog_distance_m > a.own_reference.distance_m + 0.5 * a.watchdog_s * a.own_reference.speed_mps);
}

TEST_CASE("shut-in gas keeps its energy and its force, vented gas does not") {
  // Coarse lines and one supply pressure: what holds of the gas holds on any grid.
  const auto table_rig = [](const std::string& action) {
    return config_rig("servo-table-1m-8mm",
                      {"safe_output.action=" + action, "simulation.cells_per_m=8", "tolerances.supply.pressure_Pa=0"});
  };
  const Rig hold = table_rig("hold"), vent = table_rig("vent");
  const StoppingTable shut = stopping_table(hold, {}), open = stopping_table(vent, {});
  REQUIRE(std::isinf(shut.vent_s));
  REQUIRE(open.vent_s < 20.0);
  // Both chambers and lines at most at supply pressure: no more than p V ln(p / p_atm) - (p - p_atm) V of all their
  // room.
  const auto& axis = hold.axis;
  const double bore_m2 = 0.25 * M_PI * std::pow(std::max(axis.line_1.diameter_m, axis.line_2.diameter_m), 2);
  const double room_m3 = axis.cylinder.dead_volume_1_m3 + axis.cylinder.dead_volume_2_m3 +
                         std::max(axis.cylinder.area_1_m2, axis.cylinder.area_2_m2) * axis.cylinder.stroke_m +
                         bore_m2 * (axis.line_1.length_m + axis.line_2.length_m);
  const double p = axis.supply.pressure_Pa, p_atm = axis.air.atmosphere_Pa;
  REQUIRE(shut.stored_energy_J > 0.0);
  REQUIRE(shut.stored_energy_J < room_m3 * (p * std::log(p / p_atm) - p + p_atm));
}

TEST_CASE("an upright axis falls faster than it sinks, and not faster than free fall") {
  const Rig rig = config_rig("cylinder-10m-7.65mm", {"duration_s=1", "slider.payload_kg=10"});
  const StoppingTable table = stopping_table(rig, {});
  const double way_m = 0.5 * rig.axis.cylinder.stroke_m;
  REQUIRE(table.drop_speed_mps > 0.05);
  // Chamber 2 pushes down as well: more than free fall is possible only by its gauge pressure.
  const double push_mps2 = 9.81 + (rig.axis.supply.pressure_Pa - rig.axis.air.atmosphere_Pa) *
                                      rig.axis.cylinder.area_2_m2 /
                                      (rig.axis.slider.mass_kg + rig.axis.slider.payload_kg);
  REQUIRE(table.drop_speed_mps < std::sqrt(2.0 * push_mps2 * way_m));
}
