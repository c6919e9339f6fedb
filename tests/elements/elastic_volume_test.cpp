// A volume that grows with its pressure: known answers, and stable however soft it is.
#include <catch2/catch.hpp>

#include <cmath>

#include <pneuservo/elements/chamber.hpp>
#include <pneuservo/elements/elastic_volume.hpp>

using namespace pneuservo;

TEST_CASE("a soft volume that is filled slowly keeps mass, and its growth follows its pressure") {
  const Air<double> air;
  // 0.1 l that grows by 0.1 l a bar: kappa p c / V is 2.8 at 2 bar, where a growth one step late would run away.
  const ElasticVolumeParameters<double> volume{.volume_m3 = 1e-4, .compliance_m3_per_Pa = 1e-9};
  constexpr double area_m2 = 0.5, h = 1e-3, flow = 1e-5;
  Chamber<double> chamber;
  chamber.configure({area_m2, volume.volume_m3, 0.0}, air);
  chamber.reset(air.atmosphere_Pa, air.temperature_K, 0.0);
  const double mass_kg = chamber.mass(), energy_J = chamber.internal_energy();
  double grown_m3 = 0.0, work_J = 0.0;
  constexpr int steps = 50000;
  for (int i = 0; i < steps; ++i) {
    const double before_Pa = chamber.pressure(), was_m3 = grown_m3;
    grown_m3 = elastic_growth(volume, air, h, grown_m3, chamber.pressure(), chamber.temperature(), flow);
    chamber.step(h, {flow, flow * air.cp * air.temperature_K}, grown_m3 / area_m2);
    work_J += 0.5 * (before_Pa + chamber.pressure()) * (grown_m3 - was_m3);
    REQUIRE(std::fabs(grown_m3 - volume.growth_m3(chamber.pressure(), air.atmosphere_Pa)) < 1e-3 * volume.volume_m3);
  }
  CHECK(chamber.mass() == Approx(mass_kg + steps * h * flow).epsilon(1e-9));
  CHECK(chamber.pressure() > 2e5);
  // First law: what came in less what pushed the wall.
  CHECK(chamber.internal_energy() ==
        Approx(energy_J + steps * h * flow * air.cp * air.temperature_K - work_J).epsilon(1e-4));
}

TEST_CASE("a rigid volume does not grow, and none shrinks below its size") {
  const Air<double> air;
  const ElasticVolumeParameters<double> rigid{.volume_m3 = 1e-4};
  CHECK(elastic_growth(rigid, air, 1e-3, 0.0, 5e5, 293.0, 1e-3) == 0.0);
  const ElasticVolumeParameters<double> soft{.volume_m3 = 1e-4, .compliance_m3_per_Pa = 1e-9};
  CHECK(elastic_growth(soft, air, 1e-3, 0.0, 0.5e5, 293.0, 0.0) == 0.0);
  CHECK(soft.growth_m3(air.atmosphere_Pa + 1e5, air.atmosphere_Pa) == Approx(1e-4));
}
