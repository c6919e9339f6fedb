// A hose that swells: no gas is lost, and its wave is slower by what its section gives way beside the gas.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/elements/line.hpp>

using namespace pneuservo;

namespace {

constexpr double start_Pa = 500e3;

Line<double> hose(double growth_per_Pa, int cells) {
  Line<double> line;
  LineParameters<double> parameters;
  parameters.length_m = 10.0;
  parameters.diameter_m = 6.1e-3;
  line.configure(parameters, {}, cells);
  LineEffects<double> effects;
  effects.compliance.section_growth_per_Pa = growth_per_Pa;
  line.set_effects(effects);
  line.set_time_step(0.4 * line.cell_length() / 343.0);
  line.reset(start_Pa, 293.0);
  return line;
}

/// Time [s] until half of a small step of the port's pressure has come to the middle of the line.
double arrival_s(double growth_per_Pa) {
  constexpr int cells = 200;
  Line<double> line = hose(growth_per_Pa, cells);
  line.set_adiabatic(true);
  line.set_frictionless(true);
  const double h = 0.4 * line.cell_length() / 343.0, step_Pa = 100.0;
  for (int k = 1; k < 4000; ++k) {
    line.step_prescribed(start_Pa + step_Pa, {start_Pa, 293.0});
    if (line.cell_pressure(cells / 2) > start_Pa + 0.5 * step_Pa) return k * h;
  }
  return 0;
}

}  // namespace

TEST_CASE("line compliance: the wave of a soft hose has c^2 = kappa R T/(1 + kappa p C)") {
  const double rigid_s = arrival_s(0.0);
  for (const double growth_per_Pa : {1e-7, 5e-7}) {
    CAPTURE(growth_per_Pa);
    CHECK(arrival_s(growth_per_Pa) / rigid_s == Approx(std::sqrt(1 + 1.4 * start_Pa * growth_per_Pa)).epsilon(0.01));
  }
}

TEST_CASE("line compliance: what the section takes up the bore loses, to rounding") {
  Line<double> line = hose(3e-7, 10);
  const double h = 0.4 * line.cell_length() / 343.0, m_0 = line.mass();
  double booked = 0, largest = m_0;
  for (int k = 0; k < 20000; ++k) {
    const double port_Pa = 450e3 + 200e3 * std::sin(1e-3 * k) + 50e3 * std::sin(0.11 * k);
    const LineFlow<double> flow = line.step_prescribed(port_Pa, {450e3, 293.0});
    booked += h * (flow.port_mass_flow_kgps - flow.chamber_mass_flow_kgps);
    largest = std::max(largest, line.mass());
  }
  CHECK(std::fabs(line.mass() + line.swollen_mass() - m_0 - booked) < 1e-11 * largest);
}

TEST_CASE("line compliance: at rest a swollen hose holds rho A C (p - p_0) more a metre") {
  Line<double> line = hose(3e-7, 10);
  for (int k = 0; k < 40000; ++k) line.step_prescribed(600e3, {600e3, 293.0});
  CHECK(line.swollen_mass() == Approx(3e-7 * 100e3 * line.mass()).epsilon(1e-3));
}
