// Line: conservation, rest, wave speed, symmetry, limits of the friction law, leak and restriction.
#include <catch2/catch.hpp>

#include <functional>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/line_with_chamber.hpp>

using namespace pneuservo;

namespace {
LineParameters<double> parameters(double L = 10.0, double D = 7.65e-3) {
  LineParameters<double> line;
  line.length_m = L;
  line.diameter_m = D;
  return line;
}
Line<double> make_line(int cells, double L = 10.0, double D = 7.65e-3) {
  Line<double> line;
  line.configure(parameters(L, D), {}, cells);
  line.set_time_step(0.4 * line.cell_length() / 343.0);
  line.reset(470e3, 293.0);
  return line;
}
ChamberEnd<double> wall(const Line<double>& line) {
  return {line.cell_pressure(line.cells() - 1), line.cell_temperature(line.cells() - 1)};
}
}  // namespace

TEST_CASE("line: mass is conserved to rounding whatever the ends do") {
  const std::uint64_t seed = 11;
  INFO("seed " << seed);
  Random random(seed);
  for (const int cells : {1, 2, 3, 17}) {
    for (const bool valve : {false, true}) {
      Line<double> line = make_line(cells);
      LineEffects<double> effects;
      effects.frequency_dependent_losses.share = cells == 2 ? 0 : 1;
      line.set_effects(effects);
      const double m_0 = line.mass();
      double booked = 0.0, largest = m_0, p_port = 470e3;
      ChamberEnd<double> end{470e3, 293.0};
      ValvePort<double> port{0.0, 0.0, 700e3, 0.35};
      const double h = 0.4 * line.cell_length() / 343.0;
      for (int k = 0; k < 20000; ++k) {
        if (k % 40 == 0) {  // reversal and choking: jumps between vacuum-like and supply-like pressures
          p_port = random.uniform(100e3, 700e3);
          end = {random.uniform(100e3, 700e3), random.uniform(250.0, 350.0)};
          port.supply_area_m2 = random.uniform() < 0.5 ? random.uniform(0.0, 1.3e-5) : 0.0;
          port.exhaust_area_m2 = random.uniform() < 0.5 ? random.uniform(0.0, 1.3e-5) : 0.0;
        }
        const LineFlow<double> flow = valve ? line.step_valve(port, end) : line.step_prescribed(p_port, end);
        booked += h * (flow.port_mass_flow_kgps - flow.chamber_mass_flow_kgps);
        largest = std::max(largest, line.mass());
      }
      CAPTURE(cells, valve, line.guard_actions());
      CHECK(std::fabs(line.mass() - m_0 - booked) < 1e-12 * largest);
      CHECK(std::isfinite(line.mass()));
    }
  }
}

TEST_CASE("line: energy balance of the losses-free line closes with the enthalpy at the ends") {
  // Smooth filling through a held pressure difference, walls adiabatic: dE = H_in - H_out, kinetic energy included.
  double error_coarse = 0.0;
  for (const int cells : {20, 80}) {
    Line<double> line = make_line(cells);
    line.set_adiabatic(true);
    const double h = 0.4 * line.cell_length() / 343.0, A = line.cross_section();
    const double E_0 = line.internal_energy();
    double in = 0.0, out = 0.0;
    for (double t = 0.0; t < 2.0; t += h) {
      const double ramp = std::min(1.0, t / 0.5), p = 470e3 + 30e3 * ramp * ramp * (3.0 - 2.0 * ramp);
      const LineFlow<double> flow = line.step_prescribed(p, {470e3, 293.0});
      in += h * flow.port_mass_flow_kgps * line.air().cp *
            (flow.port_mass_flow_kgps > 0.0 ? 293.0 : line.cell_temperature(0));
      out += h * flow.chamber_enthalpy_flow_W;
    }
    double kinetic = 0.0;
    for (int i = 0; i < cells; ++i) {
      const double u = 0.5 * (line.face_velocity(i) + line.face_velocity(i + 1));
      kinetic += 0.5 * line.cell_density(i) * u * u * A * line.cell_length();
    }
    const double error = std::fabs(line.internal_energy() + kinetic - E_0 - (in - out)) / in;
    CAPTURE(cells, error);
    CHECK(error < 2e-3);
    if (cells == 20) error_coarse = error;
    else CHECK(error < 0.5 * error_coarse);  // the scheme is not in conservation form: the error is that of the grid
  }
}

TEST_CASE("line: rest stays rest, exactly") {
  for (const int cells : {1, 2, 3, 17}) {
    Line<double> line = make_line(cells);
    const double p = line.cell_pressure(0), m = line.mass();
    for (int k = 0; k < 1000; ++k) line.step_prescribed(p, {p, 293.0});
    const ValvePort<double> shut{0.0, 0.0, 700e3, 0.35};
    for (int k = 0; k < 1000; ++k) line.step_valve(shut, {line.cell_pressure(cells - 1), 293.0});
    // The open port lets in what the temperatures round by while they settle: some 1e-14, and no more with time.
    CHECK(line.mass() == Approx(m).epsilon(1e-13));
    CHECK(line.largest_speed() < 1e-9);
    CHECK(line.cell_pressure(cells / 2) == Approx(p).epsilon(1e-12));
  }
}

TEST_CASE("line: a small front travels at the speed of sound") {
  Line<double> line = make_line(400);
  line.set_adiabatic(true);
  line.set_frictionless(true);
  const double c = std::sqrt(1.4 * 287.0 * 293.0), h = 0.99 * line.cell_length() / c;
  line.set_time_step(h);
  double t = 0.0;
  while (line.cell_pressure(399) < 470e3 + 20.0 && t < 1.0) {
    line.step_prescribed(470e3 + 20.0, wall(line));
    t += h;
  }
  CHECK(t == Approx(10.0 / c).epsilon(0.004));
}

TEST_CASE("line: the mirrored problem has the mirrored solution") {
  // Pressures of the ends exchanged, gas of the same temperature at both: only the direction changes.
  for (const int cells : {1, 2, 3, 17}) {
    Line<double> a = make_line(cells), b = make_line(cells);
    const std::uint64_t seed = 5;
    INFO("seed " << seed << ", cells " << cells);
    Random random(seed);
    double left = 470e3, right = 470e3, worst = 0.0;
    for (int k = 0; k < 4000; ++k) {
      if (k % 100 == 0) left = random.uniform(300e3, 600e3), right = random.uniform(300e3, 600e3);
      a.step_prescribed(left, {right, 293.0});
      b.step_prescribed(right, {left, 293.0});
      for (int i = 0; i < cells; ++i)
        worst = std::max(worst, std::fabs(a.cell_pressure(i) - b.cell_pressure(cells - 1 - i)));
    }
    CHECK(worst < 1e-3);
  }
}

TEST_CASE(
    "line: without friction of the wall a column of gas keeps its motion, with it the laminar rate is 32 nu/D^2") {
  Line<double> line = make_line(1, 0.05, 4.15e-3);
  const double h = 1e-5, u_0 = 0.1;
  line.set_time_step(h);
  line.set_face_velocity(0, u_0);
  line.set_face_velocity(1, u_0);
  for (int k = 0; k < 10000; ++k) line.step_prescribed(470e3, {470e3, 293.0});
  const double nu = 1.8e-5 / line.cell_density(0), rate = 32.0 * nu / (4.15e-3 * 4.15e-3);
  CHECK(line.face_velocity(0) == Approx(u_0 * std::exp(-rate * 0.1)).epsilon(1e-3));
}

TEST_CASE("line: friction law, its bridge, and the jump of the thesis") {
  const Air<double> air;
  const PipeFriction<double> nominal(parameters(), air);
  CHECK(nominal(1000.0).lambda_reynolds == Approx(64.0));
  CHECK(nominal(2300.0).lambda_reynolds == Approx(64.0));
  CHECK(nominal(4000.0).lambda_reynolds / 4000.0 == Approx(0.3164 / std::pow(4000.0, 0.25)).epsilon(1e-6));
  CHECK(nominal(1e5).lambda_reynolds / 1e5 == Approx(0.3164 / std::pow(1e5, 0.25)).epsilon(1e-6));
  double before = nominal(2300.0).lambda_reynolds / 2300.0;
  for (double Re = 2310.0; Re <= 4000.0; Re += 10.0) {  // linear in Re, no jump
    const double lambda = nominal(Re).lambda_reynolds / Re;
    CHECK(lambda > before);
    CHECK(lambda - before < 2e-4);
    before = lambda;
  }
  LineParameters<double> thesis = parameters();
  thesis.laminar_reynolds = thesis.turbulent_reynolds = 2300.0;
  const PipeFriction<double> printed(thesis, air);
  CHECK(printed(2300.0).lambda_reynolds / 2300.0 == Approx(64.0 / 2300.0));
  CHECK(printed(2301.0).lambda_reynolds / 2301.0 == Approx(0.3164 / std::pow(2301.0, 0.25)).epsilon(1e-6));
  CHECK(nominal(0.0).nusselt == Approx(3.66));
  for (const double Re : {3e3, 1e4, 1e5, 1e6})
    CHECK(nominal(Re).nusselt == Approx(0.046 * std::pow(Re, 0.8) * std::pow(0.71, 0.4)).epsilon(0.0025));
}

TEST_CASE("line: a leak takes what its orifice law says, and the mass books stay closed") {
  for (const double place : {0.0, 0.5, 1.0}) {
    Line<double> line = make_line(10);
    LineEffects<double> effects;
    effects.leak.area_m2 = 2e-7;
    effects.leak.position = place;
    line.set_effects(effects);
    const double h = 0.4 * line.cell_length() / 343.0, m_0 = line.mass();
    double booked = 0.0;
    LineFlow<double> flow;
    for (double t = 0.0; t < 20.0; t += h) {
      flow = line.step_prescribed(470e3, {470e3, 293.0});
      booked += h * (flow.port_mass_flow_kgps - flow.chamber_mass_flow_kgps - line.leak_mass_flow());
    }
    CAPTURE(place);
    CHECK(std::fabs(line.mass() - m_0 - booked) < 1e-12 * m_0);
    CHECK(line.leak_mass_flow() == Approx(2e-7 * orifice_flux(line.air(), 470e3, 293.0, 101325.0, 0.35)).epsilon(2e-3));
    CHECK(flow.port_mass_flow_kgps - flow.chamber_mass_flow_kgps == Approx(line.leak_mass_flow()).epsilon(1e-5));
    if (place == 0.5) CHECK(flow.port_mass_flow_kgps == Approx(-flow.chamber_mass_flow_kgps).epsilon(0.2));
    if (place == 0.0) CHECK(flow.port_mass_flow_kgps > 10.0 * std::fabs(flow.chamber_mass_flow_kgps));
  }
}

TEST_CASE("line: steady flow through a restriction at its end obeys the orifice law, both ways") {
  for (const bool outward : {true, false}) {
    Line<double> line = make_line(10, 2.0, 7.65e-3);
    LineEffects<double> effects;
    effects.restriction.area_m2 = 2e-6;
    line.set_effects(effects);
    const double h = 0.4 * line.cell_length() / 343.0, p_port = outward ? 600e3 : 400e3, p_chamber = 500e3;
    LineFlow<double> flow;
    for (double t = 0.0; t < 4.0; t += h) flow = line.step_prescribed(p_port, {p_chamber, 293.0});
    // The line's own drop (a few hundred Pa here) lies between port and restriction.
    const double p_end = line.cell_pressure(9) + 0.5 * (line.cell_pressure(9) - line.cell_pressure(8));
    const double expected =
        orifice_mass_flow(line.air(), 2e-6, 0.35, p_end, line.cell_temperature(9), p_chamber, 293.0);
    CAPTURE(outward, p_end);
    CHECK(flow.chamber_mass_flow_kgps == Approx(expected).epsilon(0.01));
  }
}

TEST_CASE("line: guards keep a jump of the port pressure physical and count what they do") {
  Line<double> line = make_line(10);
  line.set_time_step(1e-3);
  for (int k = 0; k < 500; ++k) {
    line.step_prescribed((k / 50) % 2 ? 700e3 : 100e3, {300e3, 293.0});
    for (int i = 0; i < 10; ++i) {
      REQUIRE(std::isfinite(line.cell_pressure(i)));
      REQUIRE(line.cell_temperature(i) >= 150.0);
      REQUIRE(line.cell_temperature(i) <= 600.0);
    }
    for (int j = 0; j <= 10; ++j) REQUIRE(std::fabs(line.face_velocity(j)) < 500.0);
  }
  CHECK(line.guard_actions() > 0);
}
