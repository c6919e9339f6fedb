// Dead-end branch: its resonance and damping in closed form, what fills it, the bound of its neck, the line's mass.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/line.hpp>

using namespace pneuservo;

namespace {

constexpr double p_0 = 600e3, T_0 = 293.0, step_s = 1e-5;
const LineBranch<double> vessel{2e-4, 0.3, 3e-3, 0.5};

/// A branch beside a line that holds its pressure.
struct Tied {
  Air<double> air{AirParameters<double>{}};
  PipeFriction<double> pipe;
  Branch<double> branch;
  double rho_0 = p_0 / (air.R * T_0);
  explicit Tied(double pressure_Pa) { branch.reset(pressure_Pa, pressure_Pa / (air.R * T_0)); }
  double step(double line_Pa = p_0) {
    return branch.step(vessel, air, pipe, step_s, {line_Pa, line_Pa / (air.R * T_0), 1e6});
  }
};

}  // namespace

TEST_CASE("branch: rings as a Helmholtz resonator and decays by the laminar friction of its neck") {
  Tied tied(p_0 - 5.0);
  const double section = 0.25 * std::numbers::pi * 9e-6;
  const double omega = std::sqrt(tied.air.kappa * tied.air.R * T_0 * section / (0.3 * 2e-4));
  const double decay = 16 * tied.air.viscosity_Pas / (tied.rho_0 * 9e-6);
  double before = 0, last_crossing = 0;
  std::vector<double> periods, peaks;
  double peak = 0;
  for (int k = 0; k < 60000; ++k) {
    tied.step();
    const double swing = tied.branch.pressure() - p_0;
    peak = std::max(peak, swing);
    if (before < 0 && swing >= 0) {
      if (last_crossing > 0) {
        periods.push_back((k - last_crossing) * step_s);
        peaks.push_back(peak);
      }
      last_crossing = k;
      peak = 0;
    }
    before = swing;
  }
  REQUIRE(periods.size() >= 5);
  const double mean_period = (periods[0] + periods[1] + periods[2] + periods[3]) / 4;
  CHECK(mean_period == Approx(2 * std::numbers::pi / std::sqrt(omega * omega - decay * decay)).epsilon(2e-3));
  const double implicit = 0.5 * omega * omega * step_s;  // what the scheme itself takes away
  CHECK(std::log(peaks[0] / peaks[4]) == Approx((decay + implicit) * 4 * mean_period).epsilon(0.01));
}

TEST_CASE("branch: gas from the line raises its pressure by kappa R T of the line a density") {
  Tied tied(p_0);
  const double line_Pa = 1.2 * p_0;
  for (int k = 0; k < 300000; ++k) tied.step(line_Pa);
  CHECK(tied.branch.pressure() == Approx(line_Pa).epsilon(1e-6));
  const double added = tied.branch.mass(vessel) / vessel.volume_m3 - tied.rho_0;
  // Swings about the end value mix gas to and fro: a little is not the line's.
  CHECK(added == Approx(0.2 * p_0 / (tied.air.kappa * tied.air.R * T_0)).epsilon(0.02));
}

TEST_CASE("branch: no neck passes more than an orifice of its section") {
  Tied tied(101325.0);
  LineBranch<double> wide = vessel;
  wide.neck_length_m = 1e-3;
  double most = 0;
  for (int k = 0; k < 2000; ++k)
    most = std::max(most, tied.branch.step(wide, tied.air, tied.pipe, step_s, {p_0, tied.rho_0, 1e6}));
  const double choked = tied.air.flow_constant * 0.25 * std::numbers::pi * 9e-6 * p_0 / std::sqrt(tied.air.R * T_0);
  CHECK(most <= choked * (1 + 1e-12));
  CHECK(most > 0.9 * choked);
}

TEST_CASE("branch: what it takes the line loses, to rounding, wherever it stands") {
  const std::uint64_t seed = 12;
  INFO("seed " << seed);
  Random random(seed);
  for (const double place : {0.0, 0.33, 1.0})
    for (const double volume_m3 : {2e-4, 1e-8}) {
      Line<double> line;
      LineParameters<double> parameters;
      parameters.length_m = 10.0;
      parameters.diameter_m = 6.1e-3;
      line.configure(parameters, {}, 10);
      LineEffects<double> effects;
      effects.branch = {volume_m3, 0.3, 3e-3, place};
      line.set_effects(effects);
      const double h = 0.4 * line.cell_length() / 343.0;
      line.set_time_step(h);
      line.reset(470e3, 293.0);
      const double m_0 = line.mass() + line.branch_mass();
      double booked = 0, largest = m_0, p_port = 470e3;
      for (int k = 0; k < 20000; ++k) {
        if (k % 200 == 0) p_port = random.uniform(200e3, 700e3);
        const LineFlow<double> flow = line.step_prescribed(p_port, {450e3, 293.0});
        booked += h * (flow.port_mass_flow_kgps - flow.chamber_mass_flow_kgps);
        largest = std::max(largest, line.mass() + line.branch_mass());
      }
      CAPTURE(place, volume_m3);
      CHECK(std::fabs(line.mass() + line.branch_mass() - m_0 - booked) < 1e-11 * largest);
    }
}
