// Inverse of one side of the servo table.
#include "control/flatness_side.hpp"

#include <cmath>
#include <utility>

namespace pneuservo {
namespace {
/// Energy balance of a volume with its gas integrated: the flow through the face that feeds it. enthalpy_W(i, T) is
/// what has to come in beside what `outflow` takes; the feeding face's gas has beyond_K. Mass by Heun's method.
template <class Enthalpy>
void integrate_gas(double R, double cp, double step_s, const std::vector<double>& pressure_volume,
                   const std::vector<double>& beyond_K, const std::vector<double>* outflow, double start_K,
                   Enthalpy&& enthalpy_W, std::vector<double>& flow, std::vector<double>& temperature) {
  const std::size_t n = pressure_volume.size();
  flow.resize(n);
  temperature.resize(n);
  const auto net = [&](std::size_t i, double mass) {
    const double T = pressure_volume[i] / (mass * R), power = enthalpy_W(i, T);
    temperature[i] = T;
    flow[i] = power / (cp * (power >= 0.0 ? beyond_K[i] : T));
    return outflow != nullptr ? flow[i] - (*outflow)[i] : flow[i];
  };
  double mass = pressure_volume[0] / (R * start_K), now = net(0, mass);
  for (std::size_t i = 1; i < n; ++i) {
    const double next = net(i, mass + step_s * now);
    mass += 0.5 * step_s * (now + next);
    now = net(i, mass);
  }
}
}  // namespace

FlatnessSide::FlatnessSide(const AirParameters<double>& air, const LineParameters<double>& line,
                           const ChamberGeometry<double>& chamber, int cells, double step_s,
                           SmoothingDifferentiator rate)
    : air_(air), line_(line), chamber_(chamber), friction_(line, air_), rate_(std::move(rate)), cells_(cells),
      step_s_(step_s), section_m2_(line.section_m2()), cell_m_(line.length_m / cells), cell_m3_(section_m2_ * cell_m_) {
}

PortMotion FlatnessSide::invert(const SideMotion& motion, int passes) const {
  const Row wall(motion.pressure_Pa.size(), air_.temperature_K);
  if (line_.model == LineModel::second_order_lag) return through_lag(chamber_gas(motion, wall));
  std::vector<Row> cell_K(static_cast<std::size_t>(cells_), wall), flow_before(static_cast<std::size_t>(cells_));
  PortMotion port;
  for (int pass = 0; pass < passes; ++pass)
    port = through_line(chamber_gas(motion, cell_K.back()), cell_K, flow_before);
  return port;
}

// (pV)'/(kappa-1) + p V' - h_c S_c (T_w - T) = c_p T_a G.
FlatnessSide::Gas FlatnessSide::chamber_gas(const SideMotion& motion, const Row& line_K) const {
  const std::size_t n = motion.pressure_Pa.size();
  Row pV(n);
  for (std::size_t i = 0; i < n; ++i) pV[i] = motion.pressure_Pa[i] * chamber_.volume_m3(motion.distance_m[i]);
  Gas gas{{}, motion.pressure_Pa, motion.pressure_rate_Paps, {}};
  integrate_gas(
      air_.R, air_.cp, step_s_, pV, line_K, nullptr, air_.temperature_K,
      [&](std::size_t i, double T) {
        const double s = motion.distance_m[i], work = motion.pressure_Pa[i] * chamber_.area_m2 * motion.speed_mps[i];
        const double heat = chamber_.wall_heat_W_per_m2K * chamber_.wall_area_m2(s) * (air_.temperature_K - T);
        return (motion.pressure_rate_Paps[i] * chamber_.volume_m3(s) + air_.kappa * work) / (air_.kappa - 1.0) - heat;
      },
      gas.flow, gas.temperature);
  return gas;
}

// Momentum from one place to the next towards the valve:
// -dp/dx = (G' - 2 G p'/p)/A + lambda/(2D) rho |u| u, with (rho u^2)_x = -2 G p'/(p A) by continuity at even
// temperature.
FlatnessSide::Row FlatnessSide::pressure_across(const Gas& gas, const Row& beyond_K, double distance_m) const {
  const std::size_t n = gas.flow.size();
  const double reynolds_per_flow = line_.diameter_m / (section_m2_ * air_.viscosity_Pas);
  const double friction = air_.viscosity_Pas / (2.0 * line_.diameter_m * line_.diameter_m * section_m2_);
  Row pressure;
  rate_(gas.flow, pressure);
  for (std::size_t i = 0; i < n; ++i) {
    const double G = gas.flow[i], p = gas.pressure[i], T = 0.5 * (gas.temperature[i] + beyond_K[i]);
    const double inertia = (pressure[i] - 2.0 * G * gas.pressure_rate[i] / p) / section_m2_;
    const double loss = friction * friction_(std::fabs(G) * reynolds_per_flow).lambda_reynolds * G * air_.R * T;
    double step = distance_m * (inertia + loss / p);
    step = distance_m * (inertia + loss / (p + 0.5 * step));  // density of the middle
    pressure[i] = p + step;
  }
  return pressure;
}

// V p'/(kappa-1) + c_p T_b G_out - h pi D dx (T_w - T) = c_p T_a G_in, T upwind at both faces.
FlatnessSide::Gas FlatnessSide::cell_gas(const Gas& gas, Row pressure, const Row& beyond_K,
                                         const Row& flow_before) const {
  Gas cell{{}, std::move(pressure), {}, {}};
  rate_(cell.pressure, cell.pressure_rate);
  Row pV(cell.pressure);
  for (double& value : pV) value *= cell_m3_;
  const double reynolds_per_flow = line_.diameter_m / (section_m2_ * air_.viscosity_Pas);
  const double storage = cell_m3_ / (air_.kappa - 1.0), wall = M_PI * cell_m_;
  integrate_gas(
      air_.R, air_.cp, step_s_, pV, beyond_K, &gas.flow, air_.temperature_K,
      [&](std::size_t i, double T) {
        const double G = gas.flow[i], mean_G = flow_before.empty() ? G : 0.5 * (G + flow_before[i]);
        const double nusselt = friction_(std::fabs(mean_G) * reynolds_per_flow).nusselt;
        const double heat = wall * nusselt * Air<double>::conductivity(T) * (air_.temperature_K - T);
        return storage * cell.pressure_rate[i] + air_.cp * G * (G >= 0.0 ? T : gas.temperature[i]) - heat;
      },
      cell.flow, cell.temperature);
  return cell;
}

// Cells N-1 .. 0; cell_K and flow_before (through the valve's side of each cell) are those of the pass before, and
// become those of this one.
PortMotion FlatnessSide::through_line(Gas gas, std::vector<Row>& cell_K, std::vector<Row>& flow_before) const {
  const Row supply_K(gas.flow.size(), air_.temperature_K);
  for (std::size_t i = cell_K.size(); i-- > 0;) {
    const double distance_m = i + 1 == cell_K.size() ? 0.5 * cell_m_ : cell_m_;
    Row pressure = pressure_across(gas, cell_K[i], distance_m);
    gas = cell_gas(gas, std::move(pressure), i > 0 ? cell_K[i - 1] : supply_K, flow_before[i]);
    cell_K[i] = gas.temperature;
    flow_before[i] = gas.flow;
  }
  PortMotion port{{}, pressure_across(gas, supply_K, 0.5 * cell_m_), {}};
  port.flow_kgps = std::move(gas.flow);
  port.temperature_K = std::move(gas.temperature);
  return port;
}

// G_valve = G + 2 zeta/w G^(1) + G^(2)/w^2; the port has the chamber's pressure and temperature.
PortMotion FlatnessSide::through_lag(const Gas& gas) const {
  const double w = 2.0 * M_PI * line_.natural_frequency_Hz;
  PortMotion port{gas.flow, gas.pressure, gas.temperature};
  Row rate, curvature;
  rate_(gas.flow, rate);
  rate_(rate, curvature);
  for (std::size_t i = 0; i < rate.size(); ++i)
    port.flow_kgps[i] += 2.0 * line_.damping_ratio / w * rate[i] + curvature[i] / (w * w);
  return port;
}

}  // namespace pneuservo
