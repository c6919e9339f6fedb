// Chamber: mass and energy balance, adiabatic and isothermal change.
#include <catch2/catch.hpp>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/chamber.hpp>

using namespace pneuservo;

TEST_CASE("chamber: what flows in is what it holds, in mass and, piston and wall apart, in energy") {
  const std::uint64_t seed = 3;
  INFO("seed " << seed);
  Random random(seed);
  Chamber<double> chamber;
  const Air<double> air;
  chamber.configure({1.257e-3, 2e-5, 0.0}, air);
  chamber.reset(470e3, 293.0, 0.15);
  double m = chamber.mass(), U = chamber.internal_energy();
  for (int k = 0; k < 5000; ++k) {
    const double G = random.uniform(-1e-4, 1e-4), H = air.cp * G * (G > 0.0 ? 293.0 : chamber.temperature());
    chamber.step(1e-3, {G, H}, 0.15);
    m += 1e-3 * G;
    U += 1e-3 * H;
  }
  CHECK(chamber.mass() == Approx(m).epsilon(1e-13));
  CHECK(chamber.internal_energy() == Approx(U).epsilon(1e-13));
  CHECK(chamber.pressure() * chamber.volume() == Approx(chamber.mass() * air.R * chamber.temperature()).epsilon(1e-13));
}

TEST_CASE("chamber: fast compression keeps p V^kappa, goes and comes back to the start") {
  Chamber<double> chamber;
  const Air<double> air;
  chamber.configure({1.257e-3, 2e-5, 0.0}, air);
  chamber.reset(470e3, 293.0, 0.15);
  const double invariant = 470e3 * std::pow(chamber.volume(), 1.4);
  for (int k = 1; k <= 100; ++k) chamber.step(1e-3, {}, 0.15 - 0.001 * k);
  CHECK(chamber.pressure() * std::pow(chamber.volume(), 1.4) == Approx(invariant).epsilon(1e-4));
  CHECK(chamber.temperature() > 350.0);
  for (int k = 99; k >= 0; --k) chamber.step(1e-3, {}, 0.15 - 0.001 * k);
  CHECK(chamber.pressure() == Approx(470e3).epsilon(1e-12));  // (1-c)/(1+c) and back is exactly 1
}

TEST_CASE("chamber: gas settles at the wall's temperature with the rate h_c S_c/(m c_v)") {
  Chamber<double> chamber;
  const Air<double> air;
  const ChamberGeometry<double> geometry{1.257e-3, 2e-5, 50.0};
  chamber.configure(geometry, air);
  chamber.reset(470e3, 393.0, 0.15);
  const double rate = 50.0 * geometry.wall_area_m2(0.15) / (chamber.mass() * air.cv);
  for (int k = 0; k < 10000; ++k) chamber.step(1e-4, {}, 0.15);
  CHECK(chamber.temperature() - 293.0 == Approx(100.0 * std::exp(-rate)).epsilon(1e-3));
  for (int k = 0; k < 100000; ++k) chamber.step(1e-3, {}, 0.15);
  CHECK(chamber.temperature() == Approx(293.0).epsilon(1e-12));
}

TEST_CASE("chamber: wall area is both faces and the mantle of a circle's cylinder") {
  const ChamberGeometry<double> geometry{M_PI * 0.02 * 0.02, 1e-5, 50.0};
  CHECK(geometry.wall_area_m2(0.1) == Approx(2.0 * M_PI * 0.02 * 0.02 + 2.0 * M_PI * 0.02 * 0.1).epsilon(1e-12));
  CHECK(geometry.volume_m3(0.1) == Approx(1e-5 + M_PI * 0.02 * 0.02 * 0.1));
}
