// The machine's rates: valve edges, ports, chambers, supply and slider.
#include "machine.hpp"

namespace proof {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double silencer_m3 = 3e-5;  // of the exhaust channels before the silencer

}  // namespace

Machine::Machine(const MachineData& data)
    : data_(data), tubes_{Tube(data.gas, data.side[0].tube), Tube(data.gas, data.side[1].tube)} {
  std::size_t n = 0;
  const auto take = [&n](std::size_t count) { return std::exchange(n, n + count); };
  for (std::size_t s = 0; s < 2; ++s) {
    at_tube_[s] = take(tubes_[s].size());
    at_port_[s] = take(2);     // mass and inner energy of the port's volume
    at_chamber_[s] = take(2);  // likewise of the chamber
  }
  at_supply_ = take(1);   // pressure in the volume at the valve
  at_exhaust_ = take(1);  // pressure before the silencer
  at_spool_ = take(3);    // lagged command, spool, its speed
  at_x_ = take(2);
  at_bristle_ = take(1);
  at_tail_ = take(2);
  at_book_ = take(2);
  size_ = n;
  for (auto* v : {&state_, &next_, &trial_, &k1_, &k2_, &k3_, &k4_}) v->assign(size_, 0.0);
}

void Machine::start(double position_m, double p1, double p2) {
  const Gas& gas = data_.gas;
  std::fill(state_.begin(), state_.end(), 0.0);
  state_[at_x_] = position_m;
  state_[at_tail_] = position_m;
  for (std::size_t s = 0; s < 2; ++s) {
    const double p = s == 0 ? p1 : p2;
    tubes_[s].fill(state_.data() + at_tube_[s], p, data_.room_K);
    state_[at_chamber_[s]] = p * volume_m3(s, position_m) / (gas.gas_constant * data_.room_K);
    state_[at_chamber_[s] + 1] = state_[at_chamber_[s]] * gas.cv() * data_.room_K;
    state_[at_port_[s]] = p * data_.side[s].port_m3 / (gas.gas_constant * data_.room_K);
    state_[at_port_[s] + 1] = state_[at_port_[s]] * gas.cv() * data_.room_K;
    port_Pa_[s] = p;
  }
  state_[at_supply_] = data_.supply.pressure_Pa;
  state_[at_exhaust_] = gas.atmosphere_Pa;
  time_ = 0.0;
  mode_ = Mode::resting;
  stop_ = 0;
  command(0.0);
  judge_rest();
}

double Machine::volume_m3(std::size_t s, double x) const {
  const double half = data_.motion.stroke_m / 2.0;
  return data_.side[s].dead_m3 + data_.side[s].piston_m2 * (s == 0 ? half + x : half - x);
}

double Machine::chamber_K(const double* y, std::size_t s) const {
  return y[at_chamber_[s] + 1] / (y[at_chamber_[s]] * data_.gas.cv());
}
double Machine::chamber_Pa(const double* y, std::size_t s) const {
  return (data_.gas.heat_ratio - 1.0) * y[at_chamber_[s] + 1] / volume_m3(s, y[at_x_]);
}
double Machine::chamber_Pa(int side) const { return chamber_Pa(state_.data(), static_cast<std::size_t>(side)); }

void Machine::command(double volt) {
  const ValveData& v = data_.valve;
  command_ = volt;
  if (v.sticks_V > 0.0) {
    if (std::abs(volt - played_) > v.sticks_V) played_ = volt;
  } else {
    played_ = std::clamp(played_, volt - v.play_V / 2.0, volt + v.play_V / 2.0);
  }
}

double Machine::spool_V(const double* y) const {
  const ValveData& v = data_.valve;
  if (v.frequency_Hz > 0.0) return y[at_spool_ + 1];
  return v.lag_s > 0.0 ? y[at_spool_] : played_;
}

void Machine::spool_rates(const double* y, double* out) const {
  const ValveData& v = data_.valve;
  const double* s = y + at_spool_;
  double* d = out + at_spool_;
  d[0] = v.lag_s > 0.0 ? (played_ - s[0]) / v.lag_s : 0.0;
  const double wanted = v.lag_s > 0.0 ? s[0] : played_, w = 2.0 * pi * v.frequency_Hz;
  d[1] = w > 0.0 ? s[2] : 0.0;
  d[2] = w > 0.0 ? w * w * (wanted - s[1]) - 2.0 * v.damping * w * s[2] : 0.0;
}

double Machine::area_of(double volt, double t) const {
  const ValveData& v = data_.valve;
  if (volt <= 0.0) return 0.0;
  double area = std::min(v.area_per_volt * volt, v.area_max);
  if (v.wave_share > 0.0) area *= 1.0 + v.wave_share * (std::cos(2.0 * pi * volt / v.wave_V + 1.0) - std::cos(1.0));
  return area * (1.0 + v.drift_per_s * t);
}

double Machine::valve_supply_Pa(const double* y, double t) const {
  const SupplyData& s = data_.supply;
  double p = s.volume_m3 > 0.0 ? y[at_supply_] : s.pressure_Pa;
  if (s.swing_Pa > 0.0) p += s.swing_Pa * std::sin(2.0 * pi * s.swing_Hz * t);
  if (s.dip_Pa > 0.0 && std::fmod(t, s.dip_every_s) < s.dip_lasts_s)
    p -= s.dip_Pa * std::pow(std::sin(pi * std::fmod(t, s.dip_every_s) / s.dip_lasts_s), 2);
  return p;
}

double Machine::exhaust_Pa(const double* y) const {
  return data_.valve.silencer_m2 > 0.0 ? y[at_exhaust_] : data_.gas.atmosphere_Pa;
}

/// Net mass flow into port `side` at pressure `p`; its two parts, each positive in its usual direction.
double Machine::through_edges(const double* y, double t, std::size_t side, double spool, double p, double gas_K,
                              double* from_supply, double* to_exhaust) const {
  const ValveData& v = data_.valve;
  const double signed_V = side == 0 ? spool : -spool, b = v.critical_ratio;
  const double feed = area_of(signed_V - v.dead_band_V, t) + v.neutral_leak_m2;
  const double vent = v.exhaust_ratio * area_of(-signed_V - v.dead_band_V, t) + v.neutral_leak_m2;
  *from_supply = orifice_kg_per_s(data_.gas, feed, b, valve_supply_Pa(y, t), data_.supply.temperature_K, p, gas_K);
  *to_exhaust = orifice_kg_per_s(data_.gas, vent, b, p, gas_K, exhaust_Pa(y), data_.room_K);
  return *from_supply - *to_exhaust;
}

namespace {

/// The pressure at which a flow that rises with it is zero: Newton's step, halved brackets where that leaves them; to 1
/// mPa.
template <class Flow> double balancing_Pa(const Flow& flow, double p, double low, double high) {
  double f = flow(p);
  for (int i = 0; i < 40; ++i) {
    (f > 0.0 ? high : low) = p;
    const double h = 1e-5 * p, slope = (flow(p + h) - f) / h;
    double next = slope > 0.0 ? p - f / slope : 0.5 * (low + high);
    if (next <= low || next >= high) next = 0.5 * (low + high);
    const double moved = std::abs(next - p);
    p = next;
    if (moved < 1e-3) break;
    f = flow(p);
  }
  return p;
}

}  // namespace

/// The pressure in the end plane at which the tube takes what the edges let through: Newton's method in a bracket.
double Machine::port_pressure_without_volume(const double* y, double t, std::size_t side, double spool) {
  const Tube& tube = tubes_[side];
  const double inside_K = tube.beside(0).stagnation_K, ts = data_.supply.temperature_K;
  const double low = 1e3, high = 3e6;
  double a, b;
  const auto missing = [&](double at) {
    return tube.end_flow(0, at, ts).mass - through_edges(y, t, side, spool, at, inside_K, &a, &b);
  };
  return balancing_Pa(missing, std::clamp(port_Pa_[side], low, high), low, high);
}

Machine::PortFlow Machine::port(const double* y, double t, std::size_t side, double spool, double* out) {
  const SideData& s = data_.side[side];
  const Gas& gas = data_.gas;
  double feed = 0.0, vent = 0.0;
  if (s.port_m3 <= 0.0) {
    const double p = port_pressure_without_volume(y, t, side, spool), inside_K = tubes_[side].beside(0).stagnation_K;
    const double net = through_edges(y, t, side, spool, p, inside_K, &feed, &vent);
    EndFlow flow = tubes_[side].end_flow(0, p, data_.supply.temperature_K);
    if (flow.mass != 0.0 && std::abs(net) < 2.0 * std::abs(flow.mass)) flow.energy *= net / flow.mass;
    flow.mass = net;  // what the edges let through is what counts
    flow.pressure_Pa = p;
    return {flow, net, flow.energy};
  }
  const double m = y[at_port_[side]], energy = y[at_port_[side] + 1];
  const double p = (gas.heat_ratio - 1.0) * energy / s.port_m3, gas_K = energy / (m * gas.cv());
  const double net = through_edges(y, t, side, spool, p, gas_K, &feed, &vent);
  const double brought = gas.cp() * (feed * (feed > 0.0 ? data_.supply.temperature_K : gas_K) -
                                     vent * (vent > 0.0 ? gas_K : data_.room_K));
  EndFlow flow = tubes_[side].end_flow(0, p, gas_K);
  const double heat = 30.0 * 6.0 * std::pow(s.port_m3, 2.0 / 3.0) * (data_.room_K - gas_K);  // through a cube's walls
  out[at_port_[side]] = net - flow.mass;
  out[at_port_[side] + 1] = brought - flow.energy + heat;
  out[at_book_ + 1] += heat;
  flow.pressure_Pa = p;
  return {flow, net, brought};
}

double Machine::opening_m2(std::size_t side, double x, bool out_of_chamber) const {
  const SideData& s = data_.side[side];
  double area = s.end_m2;
  const auto in_line = [&area](double other) {
    area = std::isfinite(area) ? 1.0 / std::hypot(1.0 / area, 1.0 / other) : other;
  };
  if (out_of_chamber && std::isfinite(s.out_of_chamber_m2)) in_line(s.out_of_chamber_m2);
  if (x > s.kink_from_m) in_line(s.kink_m2);
  const double half = data_.motion.stroke_m / 2.0, to_stop = side == 0 ? half + x : half - x;
  if (out_of_chamber && to_stop < s.cushion_m) in_line(s.cushion_m2);
  return area;
}

EndFlow Machine::chamber_end(const double* y, std::size_t side, double x) {
  const Tube& tube = tubes_[side];
  const double pc = chamber_Pa(y, side), tc = chamber_K(y, side);
  const Tube::Beside in = tube.beside(1);
  const bool out = in.pressure_Pa + in.density * in.sound_mps * in.speed_mps < pc;
  const double area = opening_m2(side, x, out);
  if (!std::isfinite(area)) {
    EndFlow flow = tube.end_flow(1, pc, tc);
    const double heads = data_.side[side].inlet_loss;
    for (int i = 0; heads > 0.0 && flow.mass < 0.0 && i < 3; ++i) {
      const double speed = flow.mass / (tube.area_m2() * in.density);
      flow = tube.end_flow(1, pc - heads * 0.5 * in.density * speed * speed, tc);
    }
    return flow;
  }
  const double low = 1e3, high = 3e6;
  const auto surplus = [&](double at) {
    return orifice_kg_per_s(data_.gas, area, data_.valve.critical_ratio, at, in.stagnation_K, pc, tc) -
           tube.end_flow(1, at, tc).mass;
  };
  return tube.end_flow(1, balancing_Pa(surplus, pc, low, high), tc);
}

void Machine::chamber_rates(const double* y, std::size_t side, const EndFlow& in, double* out) {
  const SideData& s = data_.side[side];
  const Gas& gas = data_.gas;
  const double x = y[at_x_], v = y[at_x_ + 1], p = chamber_Pa(y, side), gas_K = chamber_K(y, side);
  double opening = s.leak_m2;
  if (p > s.relief_Pa) opening += s.relief_m2_per_Pa * (p - s.relief_Pa);
  const double lost =
      orifice_kg_per_s(gas, opening, data_.valve.critical_ratio, p, gas_K, gas.atmosphere_Pa, data_.room_K);
  const double half = data_.motion.stroke_m / 2.0, length = side == 0 ? half + x : half - x;
  const double wall_m2 = 2.0 * s.piston_m2 + std::sqrt(4.0 * pi * s.piston_m2) * std::max(length, 0.0);
  const double growing = s.piston_m2 * (side == 0 ? v : -v);
  const double taken = lost * gas.cp() * (lost > 0.0 ? gas_K : data_.room_K);
  const double heat = s.heat_W_per_m2K * wall_m2 * (data_.room_K - gas_K);
  out[at_chamber_[side]] = in.mass - lost;
  out[at_chamber_[side] + 1] = in.energy - taken - p * growing + heat;
  out[at_book_] -= lost;
  out[at_book_ + 1] += heat - taken - p * growing;
}

void Machine::piston_leak_rates(const double* y, double* out) const {
  const double from = (y[at_x_] - data_.piston_zone_at_m) / data_.piston_zone_m;
  const double area = data_.piston_leak_m2 + data_.piston_zone_m2 * std::exp(-from * from);
  if (area <= 0.0) return;
  const double t1 = chamber_K(y, 0), t2 = chamber_K(y, 1);
  const double flow =
      orifice_kg_per_s(data_.gas, area, data_.valve.critical_ratio, chamber_Pa(y, 0), t1, chamber_Pa(y, 1), t2);
  const double energy = flow * data_.gas.cp() * (flow > 0.0 ? t1 : t2);
  out[at_chamber_[0]] -= flow;
  out[at_chamber_[1]] += flow;
  out[at_chamber_[0] + 1] -= energy;
  out[at_chamber_[1] + 1] += energy;
}

/// Volumes at ambient temperature: at the valve behind the regulator's hose, and before the silencer.
void Machine::supply_rates(const double* y, double t, double drawn, double blown, double* out) const {
  const SupplyData& s = data_.supply;
  const Gas& gas = data_.gas;
  const double b = data_.valve.critical_ratio;
  if (s.volume_m3 > 0.0) {
    const double p = valve_supply_Pa(y, t);
    const bool open = s.regulator_gap_Pa <= 0.0 || regulator_open_;
    const double set = s.pressure_Pa + (s.regulator_gap_Pa > 0.0 ? 0.6 * s.regulator_gap_Pa : 0.0);
    const double in = open ? orifice_kg_per_s(gas, s.hose_m2, b, set, s.temperature_K, p, s.temperature_K) : 0.0;
    out[at_supply_] = gas.gas_constant * s.temperature_K / s.volume_m3 * (in - drawn);
  }
  if (data_.valve.silencer_m2 > 0.0) {
    const double gone = orifice_kg_per_s(gas, data_.valve.silencer_m2, b, y[at_exhaust_], data_.room_K,
                                         gas.atmosphere_Pa, data_.room_K);
    out[at_exhaust_] = gas.gas_constant * data_.room_K / silencer_m3 * (blown - gone);
  }
}

double Machine::mass_kg(double t) const {
  const MotionData& m = data_.motion;
  return m.mass_kg - m.tail_kg + (t >= m.gained_at_s ? m.gained_kg : 0.0);
}

double Machine::push_N(const double* y, double t) const {
  const MotionData& m = data_.motion;
  const double x = y[at_x_], v = y[at_x_ + 1], a1 = data_.side[0].piston_m2, a2 = data_.side[1].piston_m2;
  double force = a1 * chamber_Pa(y, 0) - a2 * chamber_Pa(y, 1) - (a1 - a2) * data_.gas.atmosphere_Pa;
  force -= m.viscous * v + m.drag * std::abs(v) * v + m.load_N + m.spring_N_per_m * (x - m.spring_at_m);
  if (m.bristle_N > 0.0) force -= y[at_bristle_];
  if (m.periodic_N > 0.0) force += m.periodic_N * std::sin(2.0 * pi * m.periodic_Hz * t);
  if (x > m.bumper_at_m) force -= m.bumper_N_per_m * (x - m.bumper_at_m);
  if (t >= m.gained_at_s) force -= m.gained_weight_N;
  if (m.blow_N > 0.0 && std::fmod(t, m.blow_every_s) < m.blow_lasts_s)
    force -= m.blow_N * std::sin(pi * std::fmod(t, m.blow_every_s) / m.blow_lasts_s);
  if (m.tail_kg > 0.0) {
    const double w = 2.0 * pi * m.tail_Hz, k = m.tail_kg * w * w, d = 2.0 * m.tail_damping * w * m.tail_kg;
    force += k * (y[at_tail_] - x) + d * (y[at_tail_ + 1] - v);
  }
  return force;
}

/// Dry friction where it slides, or could slide, in a direction.
double Machine::dry_N(const double* y, double t, double speed, int direction) const {
  const MotionData& m = data_.motion;
  double force = direction > 0 ? m.forward_N : m.backward_N;
  if (m.extra_N > 0.0) force += m.extra_N * std::exp(-(speed / m.stribeck_mps) * (speed / m.stribeck_mps));
  if (m.seal_N_per_Pa > 0.0)
    for (std::size_t s = 0; s < 2; ++s)
      force += 0.5 * m.seal_N_per_Pa * std::max(chamber_Pa(y, s) - data_.gas.atmosphere_Pa, 0.0);
  if (m.zone_N > 0.0) force += m.zone_N * std::exp(-std::pow((y[at_x_] - m.zone_at_m) / m.zone_m, 2));
  if (m.warm_N > 0.0) force += m.warm_N * std::exp(-t / m.warm_s);
  return force;
}

bool Machine::has_dry_friction() const {
  const MotionData& m = data_.motion;
  return m.forward_N + m.backward_N + m.extra_N + m.seal_N_per_Pa + m.zone_N + m.warm_N > 0.0;
}

void Machine::slider_rates(const double* y, double t, double* out) const {
  const MotionData& m = data_.motion;
  const double v = y[at_x_ + 1];
  if (mode_ == Mode::sliding) {
    double force = push_N(y, t);
    if (has_dry_friction()) force -= direction_ * dry_N(y, t, v, direction_);
    out[at_x_] = v;
    out[at_x_ + 1] = force / mass_kg(t);
    if (m.bristle_N > 0.0) out[at_bristle_] = v / m.bristle_m * (m.bristle_N - y[at_bristle_] * (v > 0.0 ? 1.0 : -1.0));
  }
  if (m.tail_kg > 0.0) {
    const double w = 2.0 * pi * m.tail_Hz;
    out[at_tail_] = y[at_tail_ + 1];
    out[at_tail_ + 1] = w * w * (y[at_x_] - y[at_tail_]) + 2.0 * m.tail_damping * w * (v - y[at_tail_ + 1]);
  }
}

void Machine::rates(const double* y, double t, double* out) {
  std::fill(out, out + size_, 0.0);
  const double spool = spool_V(y) + data_.valve.offset_V;
  double drawn = 0.0, blown = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    tubes_[s].look(y + at_tube_[s]);
    const PortFlow port_flow = port(y, t, s, spool, out);
    port_Pa_[s] = port_flow.into_tube.pressure_Pa;
    (port_flow.valve_kg_per_s > 0.0 ? drawn : blown) += std::abs(port_flow.valve_kg_per_s);
    const EndFlow end = chamber_end(y, s, y[at_x_]);
    tubes_[s].rates(port_flow.into_tube, end, out + at_tube_[s]);
    out[at_book_] += port_flow.valve_kg_per_s;
    out[at_book_ + 1] += port_flow.valve_W;
    chamber_rates(y, s, end, out);
  }
  piston_leak_rates(y, out);
  supply_rates(y, t, drawn, blown, out);
  spool_rates(y, out);
  slider_rates(y, t, out);
}

double Machine::gas_kg() const {
  double sum = 0.0;
  for (std::size_t s = 0; s < 2; ++s)
    sum += tubes_[s].mass_kg(state_.data() + at_tube_[s]) + state_[at_chamber_[s]] + state_[at_port_[s]];
  return sum;
}

double Machine::gas_J() const {
  double sum = 0.0;
  for (std::size_t s = 0; s < 2; ++s)
    sum += tubes_[s].energy_J(state_.data() + at_tube_[s]) + state_[at_chamber_[s] + 1] + state_[at_port_[s] + 1];
  return sum;
}

}  // namespace proof
