// Checks of the machine against closed forms, conservation and a finer grid; `check NAME` runs one, `check` all.
#include "random.hpp"
#include "recorder.hpp"

#include <algorithm>
#include <functional>
#include <iostream>
#include <sstream>

namespace {

using namespace proof;

constexpr double pi = 3.14159265358979323846;
int failures = 0;

void near(const std::string& what, double got, double expected, double tolerance) {
  const bool good = std::abs(got - expected) <= tolerance;
  if (!good) ++failures;
  std::cout << (good ? "  ok   " : "  FAIL ") << what << ": got " << got << ", expected " << expected << " +- "
            << tolerance << '\n';
}

/// A tube between two ends given as functions, by the classical Runge-Kutta method.
class LoneTube {
 public:
  using Ends = std::function<std::pair<EndFlow, EndFlow>(const Tube&)>;

  LoneTube(const Gas& gas, const TubeData& data, double pressure_Pa) : tube(gas, data), state(tube.size()) {
    tube.fill(state.data(), pressure_Pa, data.wall_K);
  }

  void go(double dt, const Ends& ends) {
    const std::vector<double> from = state;
    std::vector<double> k(state.size()), sum(state.size(), 0.0);
    tube.begin_step(state.data());
    for (int stage = 0; stage < 4; ++stage) {
      tube.look(state.data());
      const auto [first, last] = ends(tube);
      tube.rates(first, last, k.data());
      const double weight = stage == 1 || stage == 2 ? 2.0 : 1.0, ahead = stage == 2 ? dt : dt / 2.0;
      for (std::size_t i = 0; i < state.size(); ++i) {
        sum[i] += weight * k[i];
        state[i] = stage == 3 ? from[i] + dt / 6.0 * sum[i] : from[i] + ahead * k[i];
      }
    }
    tube.end_step(state.data(), dt);
  }

  static std::pair<EndFlow, EndFlow> closed(const Tube& t) {
    const auto wall = [&t](int end) {
      const Tube::Beside in = t.beside(end);
      const double p = in.pressure_Pa + (end == 0 ? -1.0 : 1.0) * in.density * in.sound_mps * in.speed_mps;
      return EndFlow{0.0, t.area_m2() * p, 0.0, p};
    };
    return {wall(0), wall(1)};
  }

  Tube tube;
  std::vector<double> state;
};

/// A machine whose chambers are cut off from their tubes; only what a check sets acts.
MachineData quiet() {
  MachineData m;
  for (SideData& s : m.side) s.end_m2 = 1e-14;
  return m;
}

void orifice() {
  const Gas gas;
  const double choked = std::sqrt(1.4 / 287.0) * std::pow(2.0 / 2.4, 3.0) * 1e-6 * 7e5 / std::sqrt(293.0);
  near("choked flow, kg/s", orifice_kg_per_s(gas, 1e-6, 0.35, 7e5, 293, 2e5, 293), choked, 1e-12);
  const double half = choked * std::sqrt(1 - std::pow((0.8 - 0.35) / 0.65, 2));
  near("subsonic flow, kg/s", orifice_kg_per_s(gas, 1e-6, 0.35, 7e5, 293, 5.6e5, 300), half, 1e-12);
  near("reversed", orifice_kg_per_s(gas, 1e-6, 0.35, 5.6e5, 300, 7e5, 293), -half, 1e-12);
}

void discharge() {
  for (const bool isothermal : {true, false}) {
    MachineData m = quiet();
    m.motion.forward_N = m.motion.backward_N = 1e9;
    m.side[0].leak_m2 = 1e-7;
    m.side[0].heat_W_per_m2K = isothermal ? 1e5 : 0.0;
    Machine machine(m);
    machine.start(0.0, 7e5, 3e5);
    machine.advance(0.2);
    const double volume = m.side[0].dead_m3 + m.side[0].piston_m2 * 0.15;
    const double tau = volume / (0.684731 * 1e-7 * std::sqrt(287.0 * 293.0)), t = 0.2 / tau;
    near(isothermal ? "isothermal discharge, Pa" : "adiabatic discharge, Pa", machine.chamber_Pa(0),
         isothermal ? 7e5 * std::exp(-t) : 7e5 * std::pow(1 + 0.2 * t, -7.0), isothermal ? 80.0 : 0.5);
  }
}

void modes() {
  Gas gas;
  gas.viscosity_Pas = 1e-30;
  gas.prandtl = 0.0;
  TubeData data;
  data.length_m = 5.0;
  data.least_nusselt = 0.0;
  LoneTube lone(gas, data, 6e5);
  const std::size_t n = lone.tube.points();
  const double rho = 6e5 / (287.0 * 293.0), sound = gas.sound_mps(293.0);
  for (std::size_t i = 0; i < n; ++i) {
    const double inside[4] = {0.0, 0.5 - std::sqrt(0.05), 0.5 + std::sqrt(0.05), 1.0};
    const double x = (static_cast<double>(i / 4) + inside[i % 4]) * lone.tube.element_m();
    lone.state[n + i] = rho * 0.1 * std::sin(pi * x / data.length_m);
    lone.state[2 * n + i] += 0.5 * rho * std::pow(lone.state[n + i] / rho, 2);
  }
  const double mass = lone.tube.mass_kg(lone.state.data()), energy = lone.tube.energy_J(lone.state.data());
  double last = 0.0, crossed = 0.0, most = 0.0;
  int crossings = 0;
  for (int k = 1; k * 2e-4 < 1.0; ++k) {
    lone.go(2e-4, LoneTube::closed);
    const double p = lone.tube.pressure_at(lone.state.data(), 0) - 6e5;
    if (last < 0.0 && p >= 0.0 && ++crossings <= 20) crossed = (k - p / (p - last)) * 2e-4;
    if (k * 2e-4 > 0.9) most = std::max(most, std::abs(p));
    last = p;
  }
  // The pressure at the first end begins as minus a sine: its n-th upward crossing is at n - 1/2 periods.
  near("closed tube, first mode, Hz", 19.5 / crossed, sound / 10.0, 0.003 * sound / 10.0);
  near("its amplitude after 0.9 s, Pa", most, rho * sound * 0.1, 0.02 * rho * sound * 0.1);
  near("mass kept, relative", lone.tube.mass_kg(lone.state.data()) / mass, 1.0, 1e-12);
  near("energy kept, relative", lone.tube.energy_J(lone.state.data()) / energy, 1.0, 1e-12);
}

/// Kirchhoff's attenuation in wide tubes: a mode fades with sqrt(nu w/2)/R (1 + (kappa - 1)/sqrt(Pr)).
void layers() {
  const Gas gas;
  TubeData data;
  data.length_m = 1.0;
  data.diameter_m = 0.008;
  data.memory_share = 1.0;
  data.refine = 2.0;
  LoneTube lone(gas, data, 6e5);
  const std::size_t n = lone.tube.points();
  const double rho = 6e5 / (287.0 * 293.0), w = pi * gas.sound_mps(293.0);
  for (std::size_t i = 0; i < n; ++i) {
    const double inside[4] = {0.0, 0.5 - std::sqrt(0.05), 0.5 + std::sqrt(0.05), 1.0};
    const double x = (static_cast<double>(i / 4) + inside[i % 4]) * lone.tube.element_m();
    lone.state[n + i] = rho * 1e-3 * std::sin(pi * x);
  }
  double early = 0.0, late = 0.0;
  const double dt = 2e-5;
  for (int k = 1; k * dt < 0.2; ++k) {
    lone.go(dt, LoneTube::closed);
    const double p = std::abs(lone.tube.pressure_at(lone.state.data(), 0) - 6e5);
    if (k * dt > 0.02 && k * dt < 0.035) early = std::max(early, p);
    if (k * dt > 0.12 && k * dt < 0.135) late = std::max(late, p);
  }
  const double nu = gas.viscosity_Pas / rho, pr = gas.viscosity_Pas * gas.cp() / Gas::conductivity(293.0);
  const double theory = std::sqrt(nu * w / 2.0) / 0.004 * (1.0 + 0.4 / std::sqrt(pr));
  near("a mode's fading with layers, 1/s", std::log(early / late) / 0.1, theory, 0.06 * theory);
}

void steady_loss() {
  Gas gas;
  for (const double p2 : {5.9995e5, 5.7e5}) {  // laminar, turbulent
    TubeData data;
    data.length_m = 5.0;
    data.least_nusselt = 1.5e4;  // isothermal
    LoneTube lone(gas, data, 6e5);
    EndFlow out;
    for (int k = 0; k < 20000; ++k)
      lone.go(1.5e-4, [&](const Tube& t) {
        out = t.end_flow(1, p2, 293.0);
        return std::pair{t.end_flow(0, 6e5, 293.0), out};
      });
    const double d = data.diameter_m, area = pi / 4.0 * d * d, flow = out.mass / area,
                 re = flow * d / gas.viscosity_Pas;
    const double lambda = re < 2300.0 ? 64.0 / re : 0.3164 * std::pow(re, -0.25);
    const double loss = 0.5 * flow * flow * 287.0 * 293.0 * (lambda * 5.0 / d + 2.0 * std::log(6e5 / p2));
    near("isothermal flow at Re " + std::to_string(static_cast<int>(re)) + ", (p1^2 - p2^2)/2",
         loss / (0.5 * (6e5 * 6e5 - p2 * p2)), 1.0, 4e-3);
  }
}

void slider() {
  MachineData m = quiet();
  for (SideData& s : m.side) s.piston_m2 = 1e-12;
  m.motion = {};
  m.motion.viscous = 0.0;
  m.motion.load_N = 2.0 * 9.81;
  m.motion.stroke_m = 1.0;
  Machine falling(m);
  falling.start(0.4, 3e5, 3e5);
  falling.advance(0.25);
  near("free fall, m", falling.position_m(), 0.4 - 0.5 * 9.81 * 0.0625, 1e-6);
  falling.advance(3.0);
  near("at rest on the stop, m", falling.position_m(), -0.5, 1e-9);
  near("and still, m/s", falling.speed_mps(), 0.0, 0.0);
  m.motion.forward_N = m.motion.backward_N = 20.0;
  Machine stuck(m);
  stuck.start(0.1, 3e5, 3e5);
  stuck.advance(2.0);
  near("held by friction, exactly, m", stuck.position_m(), 0.1, 0.0);
  m.motion.forward_N = m.motion.backward_N = 15.62;
  Machine slides(m);
  slides.start(0.1, 3e5, 3e5);
  slides.advance(0.2);
  near("sliding against friction, m", slides.position_m(), 0.1 - 0.5 * 2.0 * 0.04, 1e-6);
}

void budgets() {
  MachineData m;
  m.gas.prandtl = 0.0;
  for (SideData& s : m.side) s.tube.least_nusselt = 0.0;  // tubes without heat: what is left is booked
  m.side[0].port_m3 = 2e-6;
  Machine machine(m);
  machine.start(0.0, 5e5, 5e5);
  const double mass = machine.gas_kg(), energy = machine.gas_J();
  for (int k = 0; k < 300; ++k) {
    machine.command(std::sin(0.05 * k));
    machine.advance(1e-3);
  }
  near("mass against what passed, relative", (machine.gas_kg() - machine.gained_kg()) / mass, 1.0, 1e-10);
  near("energy against what passed, relative", (machine.gas_J() - machine.gained_J()) / energy, 1.0, 1e-6);
}

void refinement() {
  std::array<std::vector<double>, 2> port, place;
  for (std::size_t fine = 0; fine < 2; ++fine) {
    MachineData m;
    for (SideData& s : m.side) {
      s.tube.length_m = 5.0;
      s.tube.refine = fine == 0 ? 1.0 : 2.0;
    }
    Machine machine(m);
    machine.start(0.0, 4.7e5, 4.7e5);
    for (int k = 0; k < 1500; ++k) {
      machine.command(0.6 * std::sin(2.0 * pi * 1.5e-3 * k));
      machine.advance(1e-3);
      port[fine].push_back(machine.port_Pa(0));
      place[fine].push_back(machine.position_m());
    }
  }
  double squares = 0.0, most = 0.0;
  for (std::size_t k = 0; k < port[0].size(); ++k) {
    squares += std::pow(port[0][k] - port[1][k], 2) / static_cast<double>(port[0].size());
    most = std::max(most, std::abs(place[0][k] - place[1][k]));
  }
  near("port on a grid twice as fine, Pa rms", std::sqrt(squares), 0.0, 20.0);
  near("position on a grid twice as fine, m", most, 0.0, 1e-6);
}

void noise() {
  Random random(7);
  double mean = 0.0, square = 0.0, fourth = 0.0;
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    const double z = random.normal();
    mean += z / count;
    square += z * z / count;
    fourth += z * z * z * z / count;
  }
  near("mean of normal numbers", mean, 0.0, 0.01);
  near("their variance", square, 1.0, 0.015);
  near("their fourth moment", fourth, 3.0, 0.12);
}

void scenarios() {
  std::istringstream good("motion.mass 3\nmove.wave 0.05 1 0\nfirst 0.1\nlength 0.2\n"), bad("motion.mas 3\n");
  std::ostringstream rows;
  record(read_scenario(good), rows);
  const std::string text = rows.str();
  near("rows of a recording", static_cast<double>(std::count(text.begin(), text.end(), '\n')), 201.0, 0.0);
  bool refused = false;
  try {
    read_scenario(bad);
  } catch (const std::exception& error) { refused = std::string(error.what()).find("motion.mas") != std::string::npos; }
  near("an unknown key is refused by name", refused, 1.0, 0.0);
}

}  // namespace

int main(int count, char** words) {
  const std::map<std::string, void (*)()> checks{
      {"orifice", orifice},    {"discharge", discharge},     {"modes", modes},
      {"layers", layers},      {"steady_loss", steady_loss}, {"slider", slider},
      {"budgets", budgets},    {"refinement", refinement},   {"noise", noise},
      {"scenarios", scenarios}};
  int ran = 0;
  for (const auto& [name, check] : checks) {
    if (count > 1 && name != words[1]) continue;
    std::cout << name << '\n';
    check();
    ++ran;
  }
  if (ran == 0) std::cout << "no such check\n";
  return failures > 0 || ran == 0 ? 1 : 0;
}
