// V04: line without losses: natural frequencies, travel time, ring-down.
#include "gas_rig.hpp"

using namespace verification;

namespace {
constexpr double disturbance = 100.0, volume = 2.0e-5 + 1.257e-3 * half_stroke;

enum class PortEnd { held, closed };
enum class FarEnd { closed, chamber };

struct Ringing {
  std::vector<double> t, amplitude;  // projection of the pressure on the mode shape
};

// Wave number beta = k L of a mode and its shape: sin from a held port, cos from a closed one.
double wave_number(PortEnd port, FarEnd far, double V_line, int mode) {
  const double pi = M_PI;
  if (far == FarEnd::closed) return port == PortEnd::held ? (2 * mode - 1) * pi / 2 : mode * pi;
  const auto f = [&](double beta) {
    return port == PortEnd::held ? beta * std::sin(beta) - V_line / volume * std::cos(beta)
                                 : beta * std::cos(beta) + V_line / volume * std::sin(beta);
  };
  double low = port == PortEnd::held ? (mode - 1) * pi + 1e-9 : (2 * mode - 1) * pi / 2,
         high = port == PortEnd::held ? (2 * mode - 1) * pi / 2 : mode * pi;
  if (port == PortEnd::closed) low += 1e-12;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (f(low) * f(middle) <= 0.0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

Ringing ring(Resolution resolution, PortEnd port, FarEnd far, double L, double D_mm, int mode, double periods) {
  const int cells = resolution == Resolution::normal ? 10 : 120;
  LineWithChamber<double> side;
  side.configure(line_of(L, D_mm), chamber_1(0.0), nominal_air(), cells);
  side.reset(p_start, T_start, half_stroke);
  Line<double>& line = side.line();
  line.set_adiabatic(true);
  line.set_frictionless(true);
  const double beta = wave_number(port, far, line.volume(), mode);
  const auto shape = [&](double z) { return port == PortEnd::held ? std::sin(beta * z) : std::cos(beta * z); };
  std::vector<double> weight(static_cast<std::size_t>(cells));
  const auto isentropic = [](double p) { return T_start * std::pow(p / p_start, 0.4 / 1.4); };
  for (int i = 0; i < cells; ++i) {
    weight[static_cast<std::size_t>(i)] = shape((i + 0.5) / cells);
    const double p = p_start + disturbance * weight[static_cast<std::size_t>(i)];
    line.set_cell_state(i, p, isentropic(p));
  }
  if (far == FarEnd::chamber) {
    const double p = p_start + disturbance * shape(1.0);
    side.chamber().reset(p, isentropic(p), half_stroke);
  }
  const double c = std::sqrt(1.4 * 287.0 * T_start), end = periods * 2.0 * M_PI * L / (beta * c);
  Ringing out;
  const ValvePort<double> shut{0.0, 0.0, 700e3, 0.35};
  for (double t = 0.0; t < end;) {
    const int n = side.begin_period(1e-3);
    for (int i = 0; i < n; ++i) {
      t += side.step_s();
      if (far == FarEnd::chamber)
        port == PortEnd::held ? side.step_prescribed(p_start, half_stroke) : side.step_valve(shut, half_stroke);
      else
        port == PortEnd::held ? line.step_prescribed(p_start, closed_end(line))
                              : line.step_valve(shut, closed_end(line));
      double sum = far == FarEnd::chamber
                       ? (side.chamber().pressure() - p_start) * shape(1.0) * volume / line.volume() * cells
                       : 0.0;
      for (int j = 0; j < cells; ++j) sum += (line.cell_pressure(j) - p_start) * weight[static_cast<std::size_t>(j)];
      out.t.push_back(t), out.amplitude.push_back(sum);
    }
  }
  return out;
}

// Frequency from the zero crossings of the projection, over all of them.
double frequency(const Ringing& r) {
  double first = NAN, last = NAN;
  int crossings = -1;
  for (std::size_t i = 1; i < r.t.size(); ++i) {
    const double a = r.amplitude[i - 1], b = r.amplitude[i];
    if (a * b >= 0.0) continue;
    last = r.t[i - 1] + (r.t[i] - r.t[i - 1]) * a / (a - b);
    if (++crossings == 0) first = last;
  }
  return 0.5 * crossings / (last - first);
}

// Amplitude of a sine of frequency f fitted over the period that starts at t_0.
double amplitude_over_period(const Ringing& r, double f, double t_0) {
  double cc = 0, cs = 0, ss = 0, yc = 0, ys = 0;
  for (std::size_t i = 0; i < r.t.size(); ++i) {
    if (r.t[i] < t_0 || r.t[i] >= t_0 + 1.0 / f) continue;
    const double c = std::cos(2 * M_PI * f * r.t[i]), s = std::sin(2 * M_PI * f * r.t[i]), y = r.amplitude[i];
    cc += c * c, cs += c * s, ss += s * s, yc += y * c, ys += y * s;
  }
  const double det = cc * ss - cs * cs;
  return std::hypot((yc * ss - ys * cs) / det, (ys * cc - yc * cs) / det);
}

// Half height of the first front at the closed end after a step of the port pressure.
double travel_time(double L) {
  Line<double> line;
  line.configure(line_of(L, 7.65), nominal_air(), 1000);
  line.set_adiabatic(true);
  line.set_frictionless(true);
  line.reset(p_start, T_start);
  const double h = 0.99 * line.cell_length() / std::sqrt(1.4 * 287.0 * T_start);
  line.set_time_step(h);
  std::vector<double> t, p;
  for (int i = 1; i <= 1500; ++i) {
    line.step_prescribed(p_start + (i == 1 ? 0.5 : 1.0) * disturbance,
                         closed_end(line));  // the mean at the jump itself
    t.push_back(i * h), p.push_back(line.cell_pressure(line.cells() - 1));
  }
  return time_of_level(t, p, p_start + disturbance);
}

Answer answer(Resolution resolution, const Check& check) {
  const Air<double> air{nominal_air()};
  if (check.quantity == "speed_of_sound") return std::sqrt(air.kappa * air.R * T_start);
  if (check.quantity == "speed_of_sound_isothermal") return std::sqrt(air.R * T_start);
  const double L = check.number("L_m");
  if (check.quantity == "travel_time") return travel_time(L);
  const std::string ends = check.text("ends");
  const PortEnd port = ends.starts_with("closed/") ? PortEnd::closed : PortEnd::held;
  const FarEnd far = ends.ends_with("/chamber") ? FarEnd::chamber : FarEnd::closed;
  const double D_mm = check.has("D_mm") ? check.number("D_mm") : 7.65;
  if (check.quantity == "natural_frequency")
    return frequency(ring(resolution, port, far, L, D_mm, check.at["mode"].as<int>(), 20.0));
  const int mode = check.quantity.ends_with("1") ? 1 : 2;
  const Ringing r = ring(resolution, port, far, L, D_mm, mode, 12.0);
  const double f = frequency(r);
  return std::pow(amplitude_over_period(r, f, 10.0 / f) / amplitude_over_period(r, f, 0.0), 0.1);
}
}  // namespace

TEST_CASE("V04 line without losses", "[V04]") {
  Case v04("V04");
  for (const auto resolution : {Resolution::normal, Resolution::fine})
    v04.run(resolution, [&](const Check& check) { return answer(resolution, check); });
}
