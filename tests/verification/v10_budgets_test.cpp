// V10: budgets: mass and energy of a sealed axis, adiabatic and isothermal compression, loop area with wall heat.
#include "gas_rig.hpp"

using namespace verification;

namespace {
constexpr double isothermal_wall = 1e14;
double minimum_jerk(double z) { return z * z * z * (10.0 - 15.0 * z + 6.0 * z * z); }

struct Compressed {
  double pressure, temperature, work;
};

// a) the chamber alone, moved from mid-stroke to x in one second.
Compressed compress(double wall_heat, double x, double h) {
  Chamber<double> chamber;
  chamber.configure(chamber_1(wall_heat), Air<double>{nominal_air()});
  chamber.reset(p_start, T_start, half_stroke);
  const long n = std::lround(1.0 / h);
  double work = 0.0;
  for (long i = 1; i <= n; ++i) {
    const double p = chamber.pressure(), V = chamber.volume();
    chamber.step(h, {}, half_stroke + x * minimum_jerk(static_cast<double>(i) / static_cast<double>(n)));
    work += 0.5 * (p + chamber.pressure()) * (chamber.volume() - V);
  }
  return {chamber.pressure(), chamber.temperature(), work};
}

// b) chamber with a line of 10 m x 7.65 mm without losses, valve shut, moved to x in 20 s.
double compress_with_line(Resolution resolution, double x) {
  LineWithChamber<double> side;
  side.configure(line_of(10.0, 7.65), chamber_1(0.0), nominal_air(), resolution == Resolution::normal ? 10 : 50);
  side.reset(p_start, T_start, half_stroke);
  side.line().set_adiabatic(true);
  side.line().set_frictionless(true);
  const ValvePort<double> shut{0.0, 0.0, 700e3, 0.35};
  for (double t = 0.0; t < 20.5;) {
    const int n = side.begin_period(1e-3);
    for (int i = 0; i < n; ++i) {
      t += side.step_s();
      side.step_valve(shut, half_stroke + x * minimum_jerk(std::min(1.0, t / 20.0)));
    }
  }
  return side.chamber().pressure();
}

// c) one side of the sealed axis, 10 m x 7.65 mm, full physics, x = 0.1 sin(2 pi 2 t) for 10 s.
struct Budget {
  double mass_change, energy_change, heat, work, largest_work;
};
double kinetic_energy(const Line<double>& line) {
  double sum = 0.0;
  for (int j = 1; j < line.cells(); ++j)
    sum += 0.25 * (line.cell_density(j - 1) + line.cell_density(j)) * line.face_velocity(j) * line.face_velocity(j);
  const double end = line.face_velocity(line.cells());
  sum += 0.25 * line.cell_density(line.cells() - 1) * end * end;
  return sum * line.cross_section() * line.cell_length();
}
// Heat that the wall gives to the line's gas in one sub-step, from the states before it (friction law) and after it.
double line_heat(const Line<double>& line, const std::vector<double>& nusselt, double D, double h) {
  double sum = 0.0;
  for (int i = 0; i < line.cells(); ++i) {
    const double T = line.cell_temperature(i), k = Air<double>::conductivity(T);
    const double Nu = 0.5 * (nusselt[static_cast<std::size_t>(i)] + nusselt[static_cast<std::size_t>(i) + 1]);
    sum += 4.0 * Nu * k / (D * D) * (T_start - T);
  }
  return h * sum * line.cross_section() * line.cell_length();
}
Budget sealed_side(double sign, const ChamberGeometry<double>& geometry, int cells, double period) {
  const double D = 7.65e-3;
  LineWithChamber<double> side;
  side.configure(line_of(10.0, 7.65), geometry, nominal_air(), cells);
  side.reset(p_start, T_start, half_stroke);
  const Line<double>& line = side.line();
  const Chamber<double>& chamber = side.chamber();
  const PipeFriction<double> friction(line_of(10.0, 7.65), line.air());
  const auto energy = [&] { return line.internal_energy() + chamber.internal_energy() + kinetic_energy(line); };
  const auto mass = [&] { return line.mass() + chamber.mass(); };
  const double E_0 = energy(), m_0 = mass();
  const ValvePort<double> shut{0.0, 0.0, 700e3, 0.35};
  std::vector<double> nusselt(static_cast<std::size_t>(cells) + 1);
  double heat = 0.0, work = 0.0, largest = 0.0, s = half_stroke;
  for (double t = 0.0; t < 10.0 - 1e-9;) {
    const int n = side.begin_period(period);
    for (int i = 0; i < n; ++i) {
      const double h = side.step_s(), p = chamber.pressure(), V = chamber.volume(), T = chamber.temperature(),
                   s_old = s;
      for (int j = 0; j <= cells; ++j) {
        const double rho = 0.5 * (line.cell_density(std::max(0, j - 1)) + line.cell_density(std::min(cells - 1, j)));
        nusselt[static_cast<std::size_t>(j)] =
            friction(rho * std::fabs(line.face_velocity(j)) * D / line.air().viscosity_Pas).nusselt;
      }
      t += h;
      s = half_stroke + sign * 0.1 * std::sin(2.0 * M_PI * 2.0 * t);
      side.step_valve(shut, s);
      work += 0.5 * (p + chamber.pressure()) * (chamber.volume() - V);
      heat += line_heat(line, nusselt, D, h);
      heat += h * geometry.wall_heat_W_per_m2K * geometry.wall_area_m2(0.5 * (s + s_old)) *
              (T_start - 0.5 * (T + chamber.temperature()));
      largest = std::max(largest, std::fabs(work));
    }
  }
  return {mass() / m_0 - 1.0, energy() - E_0, heat, work, largest};
}

// d) work put in per cycle in the periodic state, chamber alone with h_c = 50.
double loop_work(double f, double h) {
  Chamber<double> chamber;
  chamber.configure(chamber_1(50.0), Air<double>{nominal_air()});
  chamber.reset(p_start, T_start, half_stroke);
  const int cycles = std::max(8, static_cast<int>(16.0 * f));
  const long n = std::lround(1.0 / (f * h));
  double work = 0.0;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    work = 0.0;
    for (long i = 1; i <= n; ++i) {
      const double p = chamber.pressure(), V = chamber.volume();
      chamber.step(h, {}, half_stroke + 0.05 * std::sin(2.0 * M_PI * static_cast<double>(i) / static_cast<double>(n)));
      work -= 0.5 * (p + chamber.pressure()) * (chamber.volume() - V);
    }
  }
  return work;
}

Answer budget_answer(Resolution resolution, const Check& check) {
  const bool fine = resolution == Resolution::fine;
  const std::string part = check.text("part"), &q = check.quantity;
  if (part == "a") {
    const Compressed c =
        compress(check.is("heat", "isothermal") ? isothermal_wall : 0.0, check.number("x_m"), fine ? 1e-5 : 1e-3);
    return q == "pressure" ? c.pressure : q == "temperature" ? c.temperature : c.work;
  }
  if (part == "b") return compress_with_line(resolution, check.number("x_m"));
  if (part == "c") {
    const int cells = fine ? 160 : 10;
    const double period = fine ? 1e-4 : 1e-3;
    const Budget a = sealed_side(1.0, chamber_1(50.0), cells, period),
                 b = sealed_side(-1.0, chamber_2(50.0), cells, period);
    if (q == "relative_change_of_total_mass") return std::max(std::fabs(a.mass_change), std::fabs(b.mass_change));
    return (std::fabs(a.energy_change - a.heat + a.work) + std::fabs(b.energy_change - b.heat + b.work)) /
           std::max(a.largest_work, b.largest_work);
  }
  if (q == "thermal_rate_a_c") {
    const auto g = chamber_1(50.0);
    return g.wall_heat_W_per_m2K * g.wall_area_m2(half_stroke) * 0.4 * T_start / (p_start * g.volume_m3(half_stroke));
  }
  return loop_work(check.number("frequency_Hz"), fine ? 2e-6 : 1e-3);
}
}  // namespace

TEST_CASE("V10 budgets of a sealed axis", "[V10]") {
  Case v10("V10");
  for (const auto resolution : {Resolution::normal, Resolution::fine})
    v10.run(resolution, [&](const Check& check) { return budget_answer(resolution, check); });
}
