// A refit finds stated sizes together with their errors, with a flow meter at the supply and without.
#include <catch2/catch.hpp>

#include <cmath>

#include "config/input_error.hpp"
#include "diagnosis/refit.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

const std::vector<std::string> wear{"coulomb_friction", "chamber_leak_1", "chamber_leak_2", "valve_lag"};
const std::vector<std::string> usual{"p1_port_Pa", "p2_port_Pa", "p_supply_Pa"};

DiagnoseOptions one_thread() {
  DiagnoseOptions options;
  options.jobs = 1;
  return options;
}

/// What a machine with these sizes records, and what a refit of the config without them finds.
Refit refit_of(const std::vector<double>& sizes, std::uint64_t seed, const std::vector<std::string>& channels) {
  const Rig known = toleranced_cylinder_rig(2.0, 6.1e-3);
  Rig machine = known;
  machine.axis.effects.motion.coulomb_friction.force_N = sizes[0];
  machine.axis.effects.chamber_leak_1.area_m2 = sizes[1];
  machine.axis.effects.chamber_leak_2.area_m2 = sizes[2];
  machine.axis.effects.valve.valve_lag.time_constant_s = sizes[3];
  return refit(known, {simulated_recording(machine, 8.0, seed, channels)}, wear, one_thread());
}

double standard_error(const Refit& found, Eigen::Index i) { return std::sqrt(found.covariance(i, i)); }

/// Of both leaks together.
double leak_error(const Refit& found) { return std::sqrt(found.covariance.block(1, 1, 2, 2).sum()); }

}  // namespace

TEST_CASE("refit: sizes of a worn machine are found within their errors", "[optimised]") {
  const std::vector<double> sizes{6.0, 1e-8, 5e-9, 2e-3};
  const Refit found = refit_of(sizes, 11, usual);
  REQUIRE(found.paths.size() == 4);
  CHECK(found.paths[0] == "effects.coulomb_friction.force_N");
  for (Eigen::Index i = 0; i < 4; ++i) {
    CAPTURE(found.paths[static_cast<std::size_t>(i)], found.values(i), standard_error(found, i));
    CHECK(standard_error(found, i) > 0.0);
    CHECK(std::abs(found.values(i) - sizes[static_cast<std::size_t>(i)]) < 4.5 * standard_error(found, i));
  }
  CHECK(found.misfit < 1.5);
  CHECK(found.refitted.axis.effects.motion.coulomb_friction.force_N == found.values(0));
}

TEST_CASE("refit: a flow meter at the supply agrees with the leak and takes nothing away", "[optimised]") {
  std::vector<std::string> with_flow = usual;
  with_flow.emplace_back("supply_flow_kgps");
  const std::vector<double> sizes{6.0, 1e-8, 0.0, 0.0};
  const Refit without = refit_of(sizes, 12, usual), with = refit_of(sizes, 12, with_flow);
  CAPTURE(leak_error(without), leak_error(with), with.values(1) + with.values(2));
  CHECK(leak_error(with) < 1.02 * leak_error(without));
  CHECK(with.misfit < 1.5);
  CHECK(std::abs(with.values(1) + with.values(2) - 1e-8) < 4.5 * leak_error(with) + 1e-9);
}

TEST_CASE("refit: what has no size of its own is refused by name") {
  const Rig rig = cylinder_rig();
  const Recording recording = simulated_recording(rig, 4.0, 13, usual);
  CHECK_THROWS_WITH(refit(rig, {recording}, {"coulomb_frictoin"}, one_thread()),
                    Catch::Matchers::Contains("found the effect coulomb_frictoin, expected effects whose sizes") &&
                        Catch::Matchers::Contains("coulomb_friction"));
  CHECK_THROWS_WITH(refit(rig, {recording}, {}, one_thread()), Catch::Matchers::Contains("found no effect"));
  CHECK_THROWS_WITH(refit(rig, {}, wear, one_thread()), Catch::Matchers::Contains("refit: no recording"));
}
