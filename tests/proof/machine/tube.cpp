// The tube's rates: split-form volume terms, acoustic fluxes between elements, walls, leak, memory of the wall layers.
#include "tube.hpp"

#include <cmath>

namespace proof {
namespace {

constexpr double pi = 3.14159265358979323846;
const std::array<double, Tube::nodes> node_places{-1.0, -std::sqrt(0.2), std::sqrt(0.2), 1.0};
constexpr std::array<double, Tube::nodes> node_weights{1.0 / 6, 5.0 / 6, 5.0 / 6, 1.0 / 6};

// Zielke's weighting function as five exponentials of nu t / R^2 (Schohl 1993).
constexpr std::array<double, 5> layer_rates{26.65, 100.0, 669.6, 6497.0, 57990.0};
constexpr std::array<double, 5> layer_sizes{1.051, 2.358, 9.021, 29.47, 79.55};

/// Derivatives of the Lagrange polynomials at the nodes, by barycentric weights.
std::array<std::array<double, Tube::nodes>, Tube::nodes> derivative_matrix() {
  std::array<double, Tube::nodes> b{};
  for (std::size_t i = 0; i < b.size(); ++i) {
    b[i] = 1.0;
    for (std::size_t j = 0; j < b.size(); ++j)
      if (j != i) b[i] /= node_places[i] - node_places[j];
  }
  std::array<std::array<double, Tube::nodes>, Tube::nodes> d{};
  for (std::size_t i = 0; i < b.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j)
      if (i != j) {
        d[i][j] = b[j] / b[i] / (node_places[i] - node_places[j]);
        d[i][i] -= d[i][j];
      }
  return d;
}

/// Friction's force a volume over speed, kg/(m3 s): laminar, Blasius, linear in the Reynolds number between.
double friction_rate(double density, double speed, double diameter, double viscosity) {
  const double flow = density * std::abs(speed), reynolds = flow * diameter / viscosity;
  const double laminar = 32.0 * viscosity / (diameter * diameter);
  const auto turbulent = [&](double re) { return 0.3164 / std::sqrt(std::sqrt(re)); };
  const double at_4000 = turbulent(4000.0), at_2300 = 64.0 / 2300.0;
  const double bridge = at_2300 + (at_4000 - at_2300) * (reynolds - 2300.0) / 1700.0;
  const double lambda = reynolds > 4000.0 ? turbulent(std::max(reynolds, 1.0)) : bridge;
  return reynolds > 2300.0 ? lambda * flow / (2.0 * diameter) : laminar;
}

/// How much faster turbulence renews the layer, in units of nu/R^2 (Vardy and Brown 2003).
double renewal(double reynolds) {
  if (reynolds < 2300.0) return 0.0;
  return std::pow(reynolds, std::log10(15.29 / std::pow(reynolds, 0.0567))) / 12.86;
}

}  // namespace

Tube::Tube(const Gas& gas, const TubeData& data) : gas_(gas), data_(data), derivative_(derivative_matrix()) {
  const double wanted = std::clamp(data.length_m / 4.0, 0.3, 1.0) / data.refine;
  elements_ = static_cast<std::size_t>(std::max(2.0, std::ceil(data.length_m / wanted - 1e-9)));
  points_ = elements_ * nodes;
  element_ = data.length_m / static_cast<double>(elements_);
  area_ = pi / 4.0 * data.diameter_m * data.diameter_m;
  for (auto* v : {&rho_, &u_, &p_, &e_, &t_, &heat_W_per_m3K_, &drag_, &cooling_, &speed_before_, &temperature_before_})
    v->assign(points_, 0.0);
  for (std::size_t k = 0; k < terms; ++k) {
    layer_u_[k].assign(points_, 0.0);
    layer_t_[k].assign(points_, 0.0);
  }
}

void Tube::fill(double* state, double pressure_Pa, double temperature_K) const {
  for (std::size_t i = 0; i < points_; ++i) {
    state[i] = pressure_Pa / (gas_.gas_constant * temperature_K);
    state[points_ + i] = 0.0;
    state[2 * points_ + i] = pressure_Pa / (gas_.heat_ratio - 1.0);
  }
}

double Tube::pressure_at(const double* state, std::size_t i) const {
  const double m = state[points_ + i];
  return (gas_.heat_ratio - 1.0) * (state[2 * points_ + i] - 0.5 * m * m / state[i]);
}

double Tube::fastest(const double* state) const {
  double most = 0.0;
  for (std::size_t i = 0; i < points_; ++i) {
    const double sound = std::sqrt(gas_.heat_ratio * std::max(pressure_at(state, i), 1.0) / state[i]);
    most = std::max(most, sound + std::abs(state[points_ + i] / state[i]));
  }
  return most;
}

double Tube::mass_kg(const double* state) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < points_; ++i) sum += state[i] * node_weights[i % nodes];
  return sum * area_ * element_ / 2.0;
}

double Tube::energy_J(const double* state) const { return mass_kg(state + 2 * points_); }

void Tube::look(const double* state) {
  const double* m = state + points_;
  const double* energy = state + 2 * points_;
  for (std::size_t i = 0; i < points_; ++i) {
    const double density = state[i], speed = m[i] / density;
    rho_[i] = density;
    u_[i] = speed;
    e_[i] = energy[i] / density;
    p_[i] = (gas_.heat_ratio - 1.0) * (energy[i] - 0.5 * m[i] * speed);
    t_[i] = p_[i] / (density * gas_.gas_constant);
  }
}

Tube::Beside Tube::beside(int end) const {
  const std::size_t i = end == 0 ? 0 : points_ - 1;
  return {rho_[i], u_[i], p_[i], t_[i] + 0.5 * u_[i] * u_[i] / gas_.cp(),
          std::sqrt(gas_.heat_ratio * std::max(p_[i], 1.0) / rho_[i])};
}

EndFlow Tube::end_flow(int end, double pressure_Pa, double outside_K) const {
  const Beside in = beside(end);
  const double inward = end == 0 ? 1.0 : -1.0, impedance = in.density * in.sound_mps;
  double entering = inward * in.speed_mps + (pressure_Pa - in.pressure_Pa) / impedance;
  double pressure = pressure_Pa, density = 0.0, total = 0.0;
  if (entering < 0.0) {
    if (entering < -in.sound_mps) {  // choked: the pressure in the end plane floats above the outside's
      entering = -in.sound_mps;
      pressure = in.pressure_Pa + impedance * (entering - inward * in.speed_mps);
    }
    density = in.density + (pressure - in.pressure_Pa) / (in.sound_mps * in.sound_mps);
  } else {
    entering = std::min(entering, gas_.sound_mps(outside_K) * 0.91);  // the static sound speed where Mach is 1
    density = pressure / (gas_.gas_constant * (outside_K - entering * entering / (2.0 * gas_.cp())));
  }
  total = gas_.heat_ratio / (gas_.heat_ratio - 1.0) * pressure / density + 0.5 * entering * entering;
  const double speed = inward * entering, mass = area_ * density * speed;
  return {mass, mass * speed + area_ * pressure, mass * total, pressure};
}

std::array<double, 3> Tube::between(std::size_t l, std::size_t r) const {
  const double k = gas_.heat_ratio;
  const double impedance =
      0.5 * (std::sqrt(k * std::max(p_[l], 1.0) * rho_[l]) + std::sqrt(k * std::max(p_[r], 1.0) * rho_[r]));
  const double pressure = 0.5 * (p_[l] + p_[r]) + 0.5 * impedance * (u_[l] - u_[r]);
  const double speed = 0.5 * (u_[l] + u_[r]) + 0.5 * (p_[l] - p_[r]) / impedance;
  const std::size_t up = speed >= 0.0 ? l : r;
  const double mass = rho_[up] * speed;
  return {mass, mass * u_[up] + pressure, mass * e_[up] + pressure * speed};
}

void Tube::volume_terms(double* out) const {
  const double scale = 2.0 / element_;
  for (std::size_t base = 0; base < points_; base += nodes)
    for (std::size_t a = 0; a < nodes; ++a)
      for (std::size_t b = a + 1; b < nodes; ++b) {
        const std::size_t i = base + a, j = base + b;
        const double speed = 0.5 * (u_[i] + u_[j]), pressure = 0.5 * (p_[i] + p_[j]);
        const double mass = 0.5 * (rho_[i] + rho_[j]) * speed;
        const double momentum = mass * speed + pressure, energy = 0.5 * mass * (e_[i] + e_[j]) + pressure * speed;
        const double to_i = 2.0 * scale * derivative_[a][b], to_j = 2.0 * scale * derivative_[b][a];
        out[i] -= to_i * mass;
        out[j] -= to_j * mass;
        out[points_ + i] -= to_i * momentum;
        out[points_ + j] -= to_j * momentum;
        out[2 * points_ + i] -= to_i * energy;
        out[2 * points_ + j] -= to_j * energy;
      }
}

/// With Gauss-Lobatto nodes the diagonal volume terms cancel the inner fluxes at the faces: only the common flux is
/// left.
void Tube::surface_terms(const EndFlow& first, const EndFlow& last, double* out) const {
  const double scale = 2.0 / (element_ * node_weights[0]);
  const auto add = [&](std::size_t point, const std::array<double, 3>& flux, double sign) {
    for (std::size_t c = 0; c < 3; ++c) out[c * points_ + point] += sign * scale * flux[c];
  };
  add(0, {first.mass / area_, first.momentum / area_, first.energy / area_}, 1.0);
  for (std::size_t k = 1; k < elements_; ++k) {
    const auto flux = between(k * nodes - 1, k * nodes);
    add(k * nodes - 1, flux, -1.0);
    add(k * nodes, flux, 1.0);
  }
  add(points_ - 1, {last.mass / area_, last.momentum / area_, last.energy / area_}, -1.0);
}

void Tube::wall_terms(double* out) const {
  for (std::size_t i = 0; i < points_; ++i) {
    out[points_ + i] -= friction_rate(rho_[i], u_[i], data_.diameter_m, gas_.viscosity_Pas) * u_[i] + drag_[i];
    out[2 * points_ + i] += heat_W_per_m3K_[i] * (data_.wall_K - t_[i]) - cooling_[i];
  }
}

void Tube::leak_terms(double* out) const {
  const double place = std::clamp(data_.leak_place, 0.0, 1.0) * static_cast<double>(elements_);
  const auto element = std::min(static_cast<std::size_t>(place), elements_ - 1);
  const double inside = 2.0 * (place - static_cast<double>(element)) - 1.0;
  std::size_t node = 0;
  for (std::size_t a = 1; a < nodes; ++a)
    if (std::abs(node_places[a] - inside) < std::abs(node_places[node] - inside)) node = a;
  const std::size_t i = element * nodes + node;
  const double lost =
      orifice_kg_per_s(gas_, data_.leak_m2, data_.critical_ratio, p_[i], t_[i], gas_.atmosphere_Pa, data_.wall_K);
  const double a_volume = lost / (area_ * node_weights[node] * element_ / 2.0);
  out[i] -= a_volume;
  out[points_ + i] -= a_volume * u_[i];
  out[2 * points_ + i] -= a_volume * (gas_.cp() * t_[i] + 0.5 * u_[i] * u_[i]);
}

void Tube::rates(const EndFlow& first, const EndFlow& last, double* out) const {
  std::fill(out, out + size(), 0.0);
  volume_terms(out);
  surface_terms(first, last, out);
  wall_terms(out);
  if (data_.leak_m2 > 0.0) leak_terms(out);
  if (data_.swelling_per_Pa > 0.0)  // a bore that grows stores more: all densities change more slowly
    for (std::size_t i = 0; i < points_; ++i) {
      const double slower = 1.0 / (1.0 + data_.swelling_per_Pa * gas_.heat_ratio * p_[i]);
      out[i] *= slower;
      out[2 * points_ + i] *= slower;
    }
}

void Tube::begin_step(const double* state) {
  look(state);
  const double d = data_.diameter_m, radius2 = d * d / 4.0, share = data_.memory_share;
  const double least = data_.least_nusselt + std::min(share, 1.0) * (8.0 - data_.least_nusselt);
  for (std::size_t i = 0; i < points_; ++i) {
    const double reynolds = rho_[i] * std::abs(u_[i]) * d / gas_.viscosity_Pas, k = Gas::conductivity(t_[i]);
    double nusselt = least;
    if (reynolds > 100.0) nusselt = std::max(least, 0.046 * std::pow(reynolds, 0.8) * std::pow(gas_.prandtl, 0.4));
    heat_W_per_m3K_[i] = 4.0 * nusselt * k / (d * d);
    if (share <= 0.0) continue;
    double sum_u = 0.0, sum_t = 0.0;
    for (std::size_t n = 0; n < terms; ++n) {
      sum_u += layer_u_[n][i];
      sum_t += layer_t_[n][i];
    }
    drag_[i] = share * 4.0 * gas_.viscosity_Pas / radius2 * sum_u;
    cooling_[i] = share * 4.0 * k / radius2 * sum_t;
  }
  if (share > 0.0) {
    speed_before_ = u_;
    temperature_before_ = t_;
  }
}

void Tube::end_step(const double* state, double dt) {
  if (data_.memory_share <= 0.0) return;
  look(state);
  const double radius2 = data_.diameter_m * data_.diameter_m / 4.0;
  double density = 0.0, speed = 0.0, temperature = 0.0;
  for (std::size_t i = 0; i < points_; ++i) {
    density += rho_[i] / static_cast<double>(points_);
    speed += std::abs(u_[i]) / static_cast<double>(points_);
    temperature += t_[i] / static_cast<double>(points_);
  }
  const double faster = renewal(density * speed * data_.diameter_m / gas_.viscosity_Pas);
  const double nu = gas_.viscosity_Pas / density, alpha = Gas::conductivity(temperature) / (density * gas_.cp());
  for (std::size_t n = 0; n < terms; ++n) {
    const double half_u = std::exp(-0.5 * (layer_rates[n] + faster) * nu * dt / radius2);
    const double half_t = std::exp(-0.5 * (layer_rates[n] + faster) * alpha * dt / radius2);
    for (std::size_t i = 0; i < points_; ++i) {
      layer_u_[n][i] = half_u * (half_u * layer_u_[n][i] + layer_sizes[n] * (u_[i] - speed_before_[i]));
      layer_t_[n][i] = half_t * (half_t * layer_t_[n][i] + layer_sizes[n] * (t_[i] - temperature_before_[i]));
    }
  }
}

}  // namespace proof
