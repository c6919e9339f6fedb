// Sensors, the user's loop and the rows of a recording.
#include "recorder.hpp"

#include <cstdio>

namespace proof {
namespace {

constexpr double pi = 3.14159265358979323846;

/// Minimum jerk from 0 to 1, and its slope.
std::pair<double, double> smooth(double s) {
  if (s <= 0.0) return {0.0, 0.0};
  if (s >= 1.0) return {1.0, 0.0};
  return {s * s * s * (10.0 - s * (15.0 - 6.0 * s)), 30.0 * s * s * (1.0 - s) * (1.0 - s)};
}

/// One channel: lag, play, bend, gain, offset, noise, quantum.
class Sensor {
 public:
  Sensor(const SensorData& data, double value, double middle, double swing)
      : data_(data), lagged_(value), played_(value), middle_(middle), swing_(swing) {}

  double read(double value, double dt, Random& random) {
    lagged_ = data_.lag_s > 0.0 ? value + (lagged_ - value) * std::exp(-dt / data_.lag_s) : value;
    played_ = std::clamp(played_, lagged_ - data_.play / 2.0, lagged_ + data_.play / 2.0);
    double y = played_;
    if (data_.bend != 0.0) y += data_.bend * swing_ * (std::pow((y - middle_) / swing_, 2) - 0.25);
    y = data_.gain * y + data_.offset + data_.noise * random.normal();
    return data_.quantum > 0.0 ? data_.quantum * std::round(y / data_.quantum) : y;
  }

 private:
  SensorData data_;
  double lagged_, played_, middle_, swing_;
};

std::array<double, 6> truth(const Machine& m) {
  return {m.position_m(), m.port_Pa(0), m.port_Pa(1), m.chamber_Pa(0), m.chamber_Pa(1), m.supply_Pa()};
}

/// Force from position and speed, command from force, as many a user writes it.
class Loop {
 public:
  Loop(const Scenario& s, double position_m) : s_(s), last_(position_m) {}

  double command(const std::array<double, 6>& y, double wanted_m, double wanted_mps) {
    const LoopData& g = s_.loop;
    speed_ += s_.period_s / (g.filter_s + s_.period_s) * ((y[0] - last_) / s_.period_s - speed_);
    last_ = y[0];
    const std::size_t p = g.at_chambers ? 3 : 1;
    const double air = s_.machine.gas.atmosphere_Pa;
    const double force = s_.area_1_m2 * (y[p] - air) - s_.area_2_m2 * (y[p + 1] - air);
    const double asked = g.position_gain * (wanted_m - y[0]) + g.speed_gain * (wanted_mps - speed_) + g.bias_N;
    const double most = s_.machine.valve.command_max_V, u = std::clamp(g.force_gain * (asked - force), -most, most);
    return g.step_V > 0.0 ? g.step_V * std::round(u / g.step_V) : u;
  }

 private:
  const Scenario& s_;
  double last_, speed_ = 0.0;
};

/// Goes on by a period, the command taking effect after the valve's delay.
void go_on(Machine& machine, std::vector<double>& waiting, double command, double period, double delay) {
  const auto whole = static_cast<std::size_t>(delay / period);
  const double part = delay - static_cast<double>(whole) * period;
  waiting.push_back(command);
  const double due = waiting.size() > whole ? waiting[waiting.size() - 1 - whole] : waiting.front();
  const double before = std::min(part, period);
  if (before > 0.0) machine.advance(before);
  machine.command(due);
  if (period > before) machine.advance(period - before);
}

}  // namespace

std::pair<double, double> wanted(const MoveData& move, double t) {
  if (!move.points.empty()) {
    for (std::size_t i = 1; i < move.points.size(); ++i) {
      const auto [t0, x0] = move.points[i - 1];
      const auto [t1, x1] = move.points[i];
      if (t >= t1) continue;
      const auto [share, slope] = smooth((t - t0) / (t1 - t0));
      return {x0 + share * (x1 - x0), slope * (x1 - x0) / (t1 - t0)};
    }
    return {move.points.back().second, 0.0};
  }
  const auto [ramp, slope] = smooth((t - move.start_s) / move.ramp_s);
  double x = 0.0, v = 0.0;
  for (const auto& [amplitude, frequency, phase] : move.waves) {
    const double w = 2.0 * pi * frequency, angle = w * (t - move.start_s) + phase;
    x += amplitude * std::sin(angle);
    v += amplitude * w * std::cos(angle);
  }
  return {move.center_m + ramp * x, ramp * v + slope / move.ramp_s * x};
}

void record(const Scenario& s, std::ostream& out, const std::vector<double>* commands) {
  Machine machine(s.machine);
  const double x0 = wanted(s.move, 0.0).first, stroke = s.machine.motion.stroke_m;
  const MotionData& m = s.machine.motion;
  const double air = s.machine.gas.atmosphere_Pa, a1 = s.machine.side[0].piston_m2, a2 = s.machine.side[1].piston_m2;
  const double balance = air + (a1 * (s.start_Pa - air) - m.load_N - m.spring_N_per_m * (x0 - m.spring_at_m)) / a2;
  machine.start(x0, s.start_Pa,
                s.start_2_Pa > 0.0 ? s.start_2_Pa : std::clamp(balance, air, s.machine.supply.pressure_Pa));
  machine.advance(1e-9);
  Random random(s.seed);
  const auto first = truth(machine);
  std::vector<Sensor> sensors;
  for (std::size_t i = 0; i < 6; ++i)
    sensors.emplace_back(s.sensors[i], first[i], i == 0 ? 0.0 : 4e5, i == 0 ? stroke : s.machine.supply.pressure_Pa);
  Loop loop(s, x0);
  std::vector<double> waiting;
  out << "t_s,x_ref_m,x_m,u_V,p1_port_Pa,p2_port_Pa,p1_chamber_Pa,p2_chamber_Pa,p_supply_Pa\n";
  const auto lead = static_cast<long>(std::round(s.first_s / s.period_s)),
             rows = static_cast<long>(std::round(s.length_s / s.period_s));
  double shift = 0.0;
  for (long k = -lead; k < rows; ++k) {
    const double t = static_cast<double>(k) * s.period_s;
    const auto [x_ref, v_ref] = wanted(s.move, t);
    const auto now = truth(machine);
    std::array<double, 6> y{};
    for (std::size_t i = 0; i < 6; ++i) y[i] = sensors[i].read(now[i], s.period_s, random);
    double u = loop.command(y, x_ref, v_ref);
    if (commands != nullptr) u = k < 0 ? 0.0 : commands->at(static_cast<std::size_t>(k));
    if (k >= 0) {
      char row[256];
      std::snprintf(row, sizeof row, "%.9g,%.6f,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", t, x_ref, y[0], u, y[1], y[2],
                    y[3], y[4], y[5]);
      out << row;
    }
    const double next_shift = s.jitter_s * std::clamp(random.normal(), -3.0, 3.0);
    go_on(machine, waiting, u, s.period_s + next_shift - shift, s.machine.valve.delay_s);
    shift = next_shift;
  }
}

}  // namespace proof
