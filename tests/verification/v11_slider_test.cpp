// V11: slider: viscous, gas springs, end stop, Coulomb, Stribeck, sticking.
#include <map>
#include <tuple>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>

#include <pneuservo/rig/plant.hpp>

#include "gas_rig.hpp"

using namespace verification;

namespace {
double given(const Check& check, const char* key, double otherwise) {
  return check.has(key) ? check.number(key) : otherwise;
}

Slider<double> slider_of(double mass, double viscous, const MotionEffects<double>& effects = {}, double stroke = 1e3) {
  Slider<double> slider;
  SliderParameters<double> parameters;
  parameters.mass_kg = mass;
  parameters.viscous_friction_Ns_per_m = viscous;
  slider.configure(parameters, effects, stroke, 0.3);
  return slider;
}

// a) constant force and viscous friction.
double driven(const Check& check, double h) {
  Slider<double> slider = slider_of(2.0, 60.0);
  slider.reset(0.0, 0.0);
  const double end = check.quantity == "final_velocity" ? 2.0 : check.number("t_s");
  for (long i = 0; i < std::lround(end / h); ++i) slider.step(h, 19.6133, {});
  return check.quantity == "position_from_start" ? slider.position() : slider.velocity();
}

// b) the axis with sealed chambers and lines of 10 mm x 0.05 mm (no gas in them to speak of).
AxisParameters<double> sealed_axis(bool servo_table, double wall_heat, double mass, double p_1, double p_2) {
  AxisParameters<double> axis;
  axis.supply.pressure_Pa = 700e3;
  axis.valve = {5.0, 2.6e-6, 1.3e-5, 0.35};
  axis.line_1 = axis.line_2 = line_of(0.01, 0.05);
  axis.cylinder = {0.3, 1.257e-3, 1.056e-3, 2.0e-5, 2.0e-5, wall_heat};
  if (servo_table) axis.cylinder = {0.14, 1.2e-3, 1.2e-3, 1.92e-4 - 1.2e-3 * 0.07, 1.92e-4 - 1.2e-3 * 0.07, wall_heat};
  axis.slider.mass_kg = mass;
  axis.slider.viscous_friction_Ns_per_m = servo_table ? 0.0 : 60.0;
  const auto& c = axis.cylinder;
  axis.effects.motion.constant_force.force_N =
      c.area_1_m2 * p_1 - c.area_2_m2 * p_2 - (c.area_1_m2 - c.area_2_m2) * axis.air.atmosphere_Pa;
  return axis;
}

// Natural frequency [Hz] and damping ratio of a free decay, by Prony's method of the given order on samples dt apart.
struct Decay {
  double natural_Hz, damped_Hz, damping;
};
Decay prony(const std::vector<double>& y, double dt, int order) {
  const int rows = static_cast<int>(y.size()) - order;
  const auto at = [&](int i) { return y[static_cast<std::size_t>(i)]; };
  Eigen::MatrixXd A(rows, order);
  Eigen::VectorXd b(rows);
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < order; ++k) A(i, k) = at(i + k);
    b(i) = -at(i + order);
  }
  const Eigen::VectorXd c = A.colPivHouseholderQr().solve(b);
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(order, order);
  for (int k = 0; k < order; ++k) companion(k, order - 1) = -c(k);
  for (int k = 1; k < order; ++k) companion(k, k - 1) = 1.0;
  const Eigen::VectorXcd roots = companion.eigenvalues();
  std::complex<double> s = 0.0;
  for (int k = 0; k < order; ++k)
    if (const auto candidate = std::log(roots(k)) / dt; candidate.imag() > s.imag()) s = candidate;
  return {std::abs(s) / (2.0 * M_PI), s.imag() / (2.0 * M_PI), -s.real() / std::abs(s)};
}
Decay simulated_decay(const Check& check, Resolution resolution) {
  const bool table = check.is("rig", "servo table");
  const std::string heat = check.text("heat");
  const double wall_heat = heat == "isothermal" ? 1e14 : heat == "adiabatic" ? 0.0 : 50.0;
  const double p_1 = table ? check.number("p_0_Pa") : p_start, p_2 = table ? p_1 : 530e3;
  const double mass = table ? 26.0 : check.number("mass_kg");
  const double sample = table ? 0.08 : 0.012, period = resolution == Resolution::normal ? 1e-3 : 1e-5;
  AxisPlant<double> plant;
  plant.configure(sealed_axis(table, wall_heat, mass, p_1, p_2), period, 100.0);
  plant.reset({0.0, p_1, p_2});
  plant.slider().reset(1e-5, 0.0);
  std::vector<double> y;
  const int keep = static_cast<int>(std::lround(sample / period));
  for (int k = 0; k < (table ? 40 : 26) * keep; ++k) {
    plant.step(0.0);
    if (k % keep == keep - 1) y.push_back(plant.position());
  }
  return prony(y, sample, heat.starts_with("h_c") ? 3 : 2);
}
/// One simulation for the three checks of a decay.
const Decay& free_decay(const Check& check, Resolution resolution) {
  static std::map<std::tuple<bool, std::string, double, Resolution>, Decay> simulated;
  const bool table = check.is("rig", "servo table");
  const auto key = std::tuple(table, check.text("heat"), check.number(table ? "p_0_Pa" : "mass_kg"), resolution);
  const auto found = simulated.find(key);
  return found != simulated.end() ? found->second
                                  : simulated.emplace(key, simulated_decay(check, resolution)).first->second;
}
double stiffness(const Check& check) {
  const double wall_heat = check.is("heat", "isothermal") ? 1e14 : 0.0, d = 1e-5;
  const auto force = [&](double x) {
    Chamber<double> a, b;
    const Air<double> air{nominal_air()};
    a.configure(chamber_1(wall_heat), air), b.configure(chamber_2(wall_heat), air);
    a.reset(p_start, T_start, half_stroke), b.reset(530e3, T_start, half_stroke);
    a.step(1e-3, {}, half_stroke + x), b.step(1e-3, {}, half_stroke - x);
    return 1.257e-3 * a.pressure() - 1.056e-3 * b.pressure();
  };
  return (force(-d) - force(d)) / (2.0 * d);
}

// c) end stop without friction: 0.1 m from the stop at 1 m/s, accelerated by g.
struct Bounces {
  std::vector<double> time, distance;
  double impact_velocity = 0.0, rest_time = NAN, beyond = 0.0;
};
Bounces simulated_bounces(double h) {
  const double g = 9.80665, stroke = 0.3, start = half_stroke - 0.1;
  Slider<double> slider = slider_of(2.0, 0.0, {}, stroke);
  slider.reset(start, 1.0);
  Bounces out;
  double farthest = 0.0, at_rest = 0.0;
  for (long i = 1; static_cast<double>(i) * h < 0.4; ++i) {
    const double v = slider.velocity(), x = slider.position();
    slider.step(h, 2.0 * g, {});
    const double t = static_cast<double>(i) * h;
    out.beyond = std::max(out.beyond, slider.position() - half_stroke);
    farthest = std::max(farthest, half_stroke - slider.position());
    if (v > 0.0 && slider.velocity() <= 0.0 && (slider.velocity() < 0.0 || std::isnan(out.rest_time))) {
      const double way = half_stroke - x, v_end = std::sqrt(v * v + 2.0 * g * way);  // the impact lies inside this step
      if (out.time.empty()) out.impact_velocity = -slider.velocity() / 0.3;
      else out.distance.push_back(farthest);
      out.time.push_back(t - h + (v_end - v) / g);
      farthest = 0.0;
    }
    if (slider.velocity() == 0.0) at_rest = at_rest == 0.0 ? t : at_rest;
    else at_rest = 0.0;
  }
  out.rest_time = at_rest == 0.0 ? NAN : at_rest;
  return out;
}

const Bounces& bounce(double h) {
  static std::map<double, Bounces> simulated;
  const auto found = simulated.find(h);
  return found != simulated.end() ? found->second : simulated.emplace(h, simulated_bounces(h)).first->second;
}

// d, e) sliding to a stop; the instant lies where the last step's way says.
struct Stop {
  double time, distance, velocity_after;
};
Stop slide(double mass, double viscous, const MotionEffects<double>& effects, double v_0, double h) {
  Slider<double> slider = slider_of(mass, viscous, effects);
  slider.reset(0.0, v_0);
  double t = 0.0, v = v_0, x = 0.0;
  while (slider.velocity() > 0.0 && t < 1.0)
    v = slider.velocity(), x = slider.position(), slider.step(h, 0.0, {}), t += h;
  const double time = t - h + 2.0 * (slider.position() - x) / v, distance = slider.position();
  for (int i = 0; i < 1000; ++i) slider.step(h, 0.0, {});
  return {time, distance, slider.position() == distance ? slider.velocity() : NAN};
}
MotionEffects<double> coulomb(double force) {
  MotionEffects<double> effects;
  effects.coulomb_friction.force_N = force;
  return effects;
}
MotionEffects<double> stribeck() {
  MotionEffects<double> effects;
  effects.stribeck_friction = {15.0, 0.02, 20.0};
  return effects;
}
// Breakaway under a force ramp of 50 N/s, force of the middle of each step.
double ramped(const Check& check, double h) {
  Slider<double> slider = slider_of(2.0, 60.0, stribeck());
  slider.reset(0.0, 0.0);
  const bool breakaway = check.quantity == "breakaway_time";
  for (long i = 0; i < std::lround((breakaway ? 1.0 : check.number("t_s")) / h); ++i) {
    slider.step(h, 50.0 * (static_cast<double>(i) + 0.5) * h, {});
    if (breakaway && slider.velocity() != 0.0) return static_cast<double>(i) * h;
  }
  return slider.velocity();
}

Answer sticking(const Check& check, double h) {
  Slider<double> slider = slider_of(2.0, 60.0, stribeck());
  slider.reset(0.02, 0.0);
  for (long i = 0; i < std::lround(1.0 / h); ++i) slider.step(h, check.number("force_N"), {});
  return check.quantity == "displacement_after_1_s" ? slider.position() - 0.02 : slider.velocity();
}

Answer end_stop(const Check& check, double h) {
  const std::string& q = check.quantity;
  if (q == "rebound_velocity") {
    Slider<double> slider = slider_of(2.0, 0.0, {}, 0.3);
    slider.reset(0.1, check.number("impact_velocity_mps"));
    for (int i = 0; i < 1e9 && slider.velocity() > 0.0; ++i) slider.step(h, 0.0, {});
    return -slider.velocity();
  }
  const Bounces& b = bounce(h);
  if (q == "time_of_first_impact") return b.time.at(0);
  if (q == "first_impact_velocity") return b.impact_velocity;
  if (q == "rebound_distance") return b.distance.at(check.at["bounce"].as<std::size_t>() - 1);
  if (q == "time_of_impact") return b.time.at(check.at["bounce"].as<std::size_t>() - 1);
  if (q == "time_at_rest_on_the_stop") return b.rest_time;
  if (q == "position_beyond_the_stop") return b.beyond;
  throw std::runtime_error("quantity is unknown");
}

Answer slider_answer(Resolution resolution, const Check& check) {
  const bool fine = resolution == Resolution::fine;
  const std::string part = check.text("part"), &q = check.quantity;
  if (part == "a") return driven(check, fine ? 1e-6 : 1e-3);
  if (part == "b") {
    if (q == "gas_spring_stiffness") return stiffness(check);
    const Decay& decay = free_decay(check, resolution);
    return q == "natural_frequency" ? decay.natural_Hz : q == "damped_frequency" ? decay.damped_Hz : decay.damping;
  }
  if (part == "c") return end_stop(check, fine ? 1e-7 : 2.5e-4);
  const double h = fine ? 2e-7 : 2.5e-4;
  if (part == "f") return sticking(check, fine ? 1e-5 : 1e-3);
  if (q == "friction_force") return slider_of(2.0, 60.0, stribeck()).dry_friction(check.number("v_mps"), 1.0, 0.0, {});
  if (q == "breakaway_time" || q == "velocity") return ramped(check, fine ? 1e-6 : 1e-3);
  const bool is_e = part == "e";
  const Stop stop = slide(2.0, is_e ? 60.0 : given(check, "viscous_Ns_per_m", 60.0), is_e ? stribeck() : coulomb(20.0),
                          given(check, "start_velocity_mps", 0.5), h);
  return q == "stop_time" ? stop.time : q == "stop_distance" ? stop.distance : stop.velocity_after;
}
}  // namespace

TEST_CASE("V11 slider", "[V11]") {
  Case v11("V11");
  for (const auto resolution : {Resolution::normal, Resolution::fine})
    v11.run(resolution, [&](const Check& check) { return slider_answer(resolution, check); });
}
