// The linear model of a config's axis at its operating point, and its exact frequency response with distributed lines.
#include "design/linearisation.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <pneuservo/control/flow_feedforward.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/rig/plant.hpp>

namespace pneuservo {

namespace {

using Complex = std::complex<double>;
constexpr double rad_per_cycle = 2.0 * std::numbers::pi;

/// Lag that agrees with a transfer of unit static gain up to s^2, taken far below the line's quarter wave.
SecondOrderLag low_frequency_lag(const LineAcoustics& line, const LineEnds& ends) {
  const double w = rad_per_cycle * 0.002 * line.sound_speed_mps() / (4.0 * line.length_m());
  const double static_gain = ends.volume_out_m3 / (ends.volume_out_m3 + line.volume_m3());
  const Complex inverse = static_gain / flow_transfer(line, ends, Complex(0.0, w));
  const double a1 = inverse.imag() / w, a2 = (1.0 - inverse.real()) / (w * w);
  const double frequency = 1.0 / std::sqrt(a2);
  return {frequency, 0.5 * a1 * frequency};
}

void find_lag(AxisSide& side, const LineParameters<double>& line, const LineAcoustics& acoustics, double exponent) {
  const LineEnds ends{0.0, side.chamber_volume_m3 / exponent};
  try {
    side.resonance = first_resonance(acoustics, ends);
  } catch (const std::invalid_argument&) {
    side.resonance.reset();  // friction leaves no peak
  }
  if (line.natural_frequency_Hz > 0.0) {
    side.source = LagSource::config;
    side.lag = {rad_per_cycle * line.natural_frequency_Hz, line.damping_ratio};
  } else if (side.resonance) {
    side.source = LagSource::resonance;
    side.lag = {rad_per_cycle * side.resonance->natural_frequency_Hz, side.resonance->damping_ratio};
  } else {
    side.source = LagSource::low_frequency;
    side.lag = low_frequency_lag(acoustics, ends);
  }
}

LineAcoustics acoustics_of(const LineParameters<double>& line, double pressure_Pa, const AirParameters<double>& air) {
  return {line.length_m, line.diameter_m, pressure_Pa, air, LineLoss::frequency_dependent};
}

/// Mean of the flows that one volt of spool lets in from the supply and out to the atmosphere.
double mean_flow_per_V(const Rig& rig, double pressure_Pa) {
  const Air<double> air(rig.axis.air);
  const double b = rig.axis.valve.critical_pressure_ratio, T = air.temperature_K;
  const double in = orifice_flux(air, rig.axis.supply.pressure_Pa, T, pressure_Pa, b);
  const double out = orifice_flux(air, pressure_Pa, T, air.atmosphere_Pa, b);
  return 0.5 * (in + out) * rig.axis.valve.area_per_volt_m2_per_V;
}

AxisLinearisation with_sides(const Rig& rig, double position_m, double pressure_1_Pa, double pressure_2_Pa,
                             double polytropic_exponent) {
  const auto& axis = rig.axis;
  const auto& c = axis.cylinder;
  AxisLinearisation out;
  out.lines = {acoustics_of(axis.line_1, pressure_1_Pa, axis.air), acoustics_of(axis.line_2, pressure_2_Pa, axis.air)};
  out.polytropic_exponent = polytropic_exponent;
  out.mass_kg = axis.slider.mass_kg + axis.slider.payload_kg;
  out.friction_Ns_per_m = axis.slider.viscous_friction_Ns_per_m;
  const auto place = [](AxisSide& side, double pressure_Pa, double area_m2, double dead_m3, double length_m) {
    side.pressure_Pa = pressure_Pa;
    side.piston_area_m2 = area_m2;
    side.chamber_volume_m3 = dead_m3 + area_m2 * length_m;
  };
  place(out.sides[0], pressure_1_Pa, c.area_1_m2, c.dead_volume_1_m3, 0.5 * c.stroke_m + position_m);
  place(out.sides[1], pressure_2_Pa, c.area_2_m2, c.dead_volume_2_m3, 0.5 * c.stroke_m - position_m);
  find_lag(out.sides[0], axis.line_1, out.lines[0], polytropic_exponent);
  find_lag(out.sides[1], axis.line_2, out.lines[1], polytropic_exponent);
  out.axis.lines = {out.sides[0].lag, out.sides[1].lag};
  out.axis.valve = {rad_per_cycle * axis.valve.natural_frequency_Hz, axis.valve.damping_ratio};
  return out;
}

AxisLinearisation linearise_table(const Rig& rig) {
  const double P0 = rig.controller.in_use([&](const auto& p) {
    if constexpr (requires { p.equilibrium_pressure_Pa; }) return p.equilibrium_pressure_Pa;
    else return rig.initial.pressure_1_Pa;
  });
  AxisLinearisation out = with_sides(rig, 0.0, P0, P0, 1.0);
  const LinearServoTable table = linear_servo_table(rig.axis, P0, out.sides[0].lag);
  out.axis.gain_per_V = table.gain_per_V;
  out.axis.stiffness_per_s2.fill(0.5 * table.natural_frequency_squared);
  out.axis.damping_per_s = out.friction_Ns_per_m / out.mass_kg;
  out.discharge_ratio = table.discharge_ratio;
  out.speed_per_area_per_ms =
      table.gain_per_V / (table.natural_frequency_squared * rig.axis.valve.area_per_volt_m2_per_V);
  // The flow that gives K: x''' = R T (A G_1/V + A G_2/V)/m.
  const double gas = rig.axis.air.gas_constant_J_per_kgK * rig.axis.air.temperature_K;
  for (AxisSide& side : out.sides)
    side.flow_kgps_per_V = table.gain_per_V * out.mass_kg * side.chamber_volume_m3 / (2.0 * side.piston_area_m2 * gas);
  return out;
}

AxisLinearisation linearise_cylinder(const Rig& rig) {
  const double p1 = rig.initial.pressure_1_Pa,
               p2 = rig.initial.pressure_2_Pa.value_or(balancing_pressure_2(rig.axis, p1));
  const double n = feedforward_polytropic_exponent;
  AxisLinearisation out = with_sides(rig, rig.initial.position_m, p1, p2, n);
  const double m = out.mass_kg, gas = rig.axis.air.gas_constant_J_per_kgK * rig.axis.air.temperature_K;
  out.axis.damping_per_s = out.friction_Ns_per_m / m;
  for (std::size_t i = 0; i < 2; ++i) {
    // Slow: chamber (polytropic) and line (isothermal) spring together. The line's half at the chamber moves with it.
    AxisSide& side = out.sides[i];
    side.flow_kgps_per_V = mean_flow_per_V(rig, side.pressure_Pa);
    const double line_m3 = out.lines[i].volume_m3(), chamber_m3 = side.chamber_volume_m3 / n;
    const double per_volume = side.piston_area_m2 / (chamber_m3 + line_m3);
    out.axis.stiffness_per_s2[i] = side.piston_area_m2 * side.pressure_Pa * per_volume / m;
    out.axis.stiffening[i] = (chamber_m3 + line_m3) / (chamber_m3 + 0.5 * line_m3);
    out.axis.weights[i] = gas * side.flow_kgps_per_V * per_volume / m;
    out.axis.gain_per_V += out.axis.weights[i];
  }
  for (double& weight : out.axis.weights) weight /= out.axis.gain_per_V;
  if (rig.controller.is<PdForce>() && rig.controller.of<PdForce>().filters_line_mode())
    out.modal_filter = line_mode_filter(rig.axis, rig.period_s);
  return out;
}

}  // namespace

AxisLinearisation linearise(const Rig& rig) {
  return rig.valves() == 2 ? linearise_table(rig) : linearise_cylinder(rig);
}

AxisResponse exact_response(const AxisLinearisation& linear, Complex s) {
  // Chamber: s V/n p = R T G_c -+ p_0 A v; line: G_v = a G_c + c p, so G_c = (G_v - c p)/a. Side 2 gets -u and -v.
  const Air<double>& air = linear.lines[0].air();
  const double gas = air.R * air.temperature_K;
  const double wv = linear.axis.valve.natural_frequency_rad_per_s;
  const Complex spool = wv > 0.0
                            ? 1.0 / (1.0 + linear.axis.valve.slope_s() * s + linear.axis.valve.curvature_s2() * s * s)
                            : Complex(1.0);
  Complex force_by_command = 0.0, force_by_speed = 0.0;
  std::array<Complex, 2> beside_by_command, beside_by_speed;  // of the port, less the chamber's
  for (std::size_t i = 0; i < 2; ++i) {
    const AxisSide& side = linear.sides[i];
    const LineTwoPort line = linear.lines[i].two_port(s);
    const Complex flow = side.flow_kgps_per_V * spool;
    const Complex yielding = s * side.chamber_volume_m3 / linear.polytropic_exponent + gas * line.c / line.a;
    const Complex by_command = gas * flow / line.a / yielding;  // of the chamber's pressure
    const Complex by_speed = -side.pressure_Pa * side.piston_area_m2 / yielding;
    // p_port = a p + b G_c = p/a + b G_v/a.
    force_by_command += side.piston_area_m2 * by_command;
    force_by_speed += side.piston_area_m2 * by_speed;
    beside_by_command[i] = side.piston_area_m2 * ((by_command + line.b * flow) / line.a - by_command);
    beside_by_speed[i] = side.piston_area_m2 * by_speed * (1.0 / line.a - 1.0);
  }
  AxisResponse out;
  const Complex speed = force_by_command / (linear.mass_kg * s + linear.friction_Ns_per_m - force_by_speed);
  out.position_m = speed / s;
  out.chamber_force_N = force_by_command + force_by_speed * speed;
  for (std::size_t i = 0; i < 2; ++i) out.port_less_chamber_N[i] = beside_by_command[i] + beside_by_speed[i] * speed;
  out.port_force_N = out.chamber_force_N + out.port_less_chamber_N[0] + out.port_less_chamber_N[1];
  return out;
}

Complex seen_force_N(const AxisLinearisation& linear, const AxisResponse& axis, Complex z) {
  if (!linear.modal_filter) return axis.port_force_N;
  const LineModeFilter& filter = *linear.modal_filter;
  const Complex mean = filter.mean_gain / (1.0 - (1.0 - filter.mean_gain) / z);
  return axis.chamber_force_N + (1.0 - mean) * (filter.port_share[0] * axis.port_less_chamber_N[0] +
                                                filter.port_share[1] * axis.port_less_chamber_N[1]);
}

}  // namespace pneuservo
