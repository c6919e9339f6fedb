// Orifice: properties that hold for every state, not only for the numbers of V01.
#include <catch2/catch.hpp>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/valve_port.hpp>

using namespace pneuservo;

TEST_CASE("orifice: swapping the sides turns the sign, exactly, equal pressures give exactly nothing") {
  const std::uint64_t seed = 7;
  INFO("seed " << seed);
  Random random(seed);
  const Air<double> air;
  for (int i = 0; i < 2000; ++i) {
    const double p_1 = random.uniform(1e3, 1e6), p_2 = random.uniform(1e3, 1e6), T_1 = random.uniform(200, 400),
                 T_2 = random.uniform(200, 400);
    const double S = random.uniform(1e-8, 1e-5), b = random.uniform(0.1, 0.6);
    const double G = orifice_mass_flow(air, S, b, p_1, T_1, p_2, T_2);
    REQUIRE(orifice_mass_flow(air, S, b, p_2, T_2, p_1, T_1) == -G);
    REQUIRE((G > 0.0) == (p_1 > p_2));
    REQUIRE(orifice_mass_flow(air, S, b, p_1, T_1, p_1, T_2) == 0.0);
    REQUIRE(orifice_mass_flow(air, 0.0, b, p_1, T_1, p_2, T_2) == 0.0);
  }
}

TEST_CASE("orifice: what flows into a port at a known pressure is the sum of its two orifices") {
  const std::uint64_t seed = 8;
  INFO("seed " << seed);
  Random random(seed);
  const Air<double> air;
  for (int i = 0; i < 2000; ++i) {
    const double b = random.uniform(0.1, 0.6), p = random.uniform(0.5e5, 9e5), T = air.temperature_K;
    const ValvePort<double> valve{random.uniform(0, 1e-5), random.uniform(0, 1e-5), random.uniform(2e5, 8e5), b};
    const double into = orifice_mass_flow(air, valve.supply_area_m2, b, valve.supply_pressure_Pa, T, p, T),
                 out = orifice_mass_flow(air, valve.exhaust_area_m2, b, p, T, air.atmosphere_Pa, T);
    const double flow = valve_port_inflow(PortConstants<double>(air, b), air, valve, p);
    REQUIRE(flow == Approx(into - out).margin(1e-12 + 1e-9 * (std::fabs(into) + std::fabs(out))));
  }
}

TEST_CASE("orifice: flow falls with the downstream pressure and does not see it below the critical ratio") {
  const Air<double> air;
  const double choked = orifice_mass_flow(air, 1e-6, 0.35, 700e3, 293.0, 0.35 * 700e3, 293.0);
  double before = choked;
  for (double r = 0.0; r < 1.0; r += 1e-4) {
    const double G = orifice_mass_flow(air, 1e-6, 0.35, 700e3, 293.0, r * 700e3, 293.0);
    if (r <= 0.35) REQUIRE(G == Approx(choked).epsilon(1e-14));
    else REQUIRE(G < before);
    before = G;
  }
}

TEST_CASE("orifice: the form without a division is the same flow below equal pressures") {
  const std::uint64_t seed = 9;
  INFO("seed " << seed);
  Random random(seed);
  for (int i = 0; i < 2000; ++i) {
    const double up = random.uniform(1e5, 1e6), b = random.uniform(0.1, 0.6);
    const double down = up * random.uniform(0.0, 1.0 - orifice_linear_width);
    REQUIRE(orifice_pressure_psi(up, down, b) == Approx(up * orifice_psi(down / up, b)).epsilon(1e-10));
  }
}

TEST_CASE("orifice: choked flow goes with pressure and with the root of temperature") {
  const Air<double> air;
  const double G = orifice_flux(air, 4e5, 293.0, 1e5, 0.35);
  CHECK(orifice_flux(air, 8e5, 293.0, 1e5, 0.35) == Approx(2.0 * G).epsilon(1e-14));
  CHECK(orifice_flux(air, 4e5, 4.0 * 293.0, 1e5, 0.35) == Approx(0.5 * G).epsilon(1e-14));
  CHECK(G == Approx(0.6847314563773 * 4e5 / std::sqrt(287.0 * 293.0)).epsilon(1e-12));
}

TEST_CASE("orifice: enthalpy comes from the upstream side") {
  const Air<double> air;
  CHECK(orifice_enthalpy_flow(air, 0.01, 300.0, 250.0) == Approx(air.cp * 0.01 * 300.0));
  CHECK(orifice_enthalpy_flow(air, -0.01, 300.0, 250.0) == Approx(-air.cp * 0.01 * 250.0));
}
