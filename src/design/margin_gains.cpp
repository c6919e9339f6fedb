// The highest gains of the force law that keep their margins over stroke, payload range and supply tolerance.
#include "design/margin_gains.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "design/linearisation.hpp"
#include "design/sampled_laws.hpp"
#include "design/sampled_loop.hpp"

namespace pneuservo {

namespace {

using Complex = std::complex<double>;

/// Frequencies lie one per cent apart: a resonance of damping 0.05 is ten of them wide.
constexpr double frequency_step = 1.01, grid_lowest_Hz = 0.05;
/// Gains are sought on ratios of 1.12, twenty a decade.
constexpr double gain_step = 1.122;
constexpr double deviations_kept = 2.0;
/// Of a valve without a stated one, as the shipped configs have it.
constexpr double usual_area_tolerance = 0.03;

/// Loop transfer per gain at one operating point: L = k_f (k_p position + k_v velocity + force).
struct OperatingPoint {
  std::vector<Complex> position, velocity, force;
};

std::vector<double> frequencies_Hz(double period_s) {
  std::vector<double> out;
  for (double f = grid_lowest_Hz; f < 0.5 / period_s; f *= frequency_step) out.push_back(f);
  return out;
}

PdForceParameters unit_gains(PdForceParameters p, double position, double velocity) {
  p.force_gain_V_per_N = 1.0, p.position_gain_N_per_m = position, p.velocity_gain_Ns_per_m = velocity;
  p.force_integral_V_per_Ns = 0.0;
  return p;
}

/// The law with a force gain of 1 V/N and these position and velocity gains.
StateSpace unit_law(const Rig& rig, const AxisLinearisation& linear, double position, double velocity) {
  return sampled_law(unit_gains(rig.controller.of<PdForce>(), position, velocity),
                     MovedMass{linear.mass_kg, linear.friction_Ns_per_m}, rig.period_s);
}

/// On distributed lines.
OperatingPoint exact_point(const Rig& rig, const std::vector<double>& frequencies) {
  const AxisLinearisation linear = linearise(rig);
  const StateSpace force = unit_law(rig, linear, 0, 0), position = unit_law(rig, linear, 1, 0),
                   velocity = unit_law(rig, linear, 0, 1);
  const double T = rig.period_s, dead_s = delay_s(rig);
  OperatingPoint out;
  for (const double f : frequencies) {
    const Complex s(0.0, 2.0 * std::numbers::pi * f), z = std::exp(s * T);
    const AxisResponse axis = exact_response(linear, s);
    Eigen::Vector4cd y(axis.position_m, s * axis.position_m, s * s * axis.position_m, 0.0), forced = y;
    if (rig.controller.feeds_back_ports()) forced(1) = 0.0, forced(2) = seen_force_N(linear, axis, z) / linear.mass_kg;
    const Complex hold = -(1.0 - 1.0 / z) / (s * T) * std::exp(-s * dead_s);
    const auto through = [&](const StateSpace& of, const Eigen::Vector4cd& measured) {
      return (of.transfer(z) * measured)(0) * hold;
    };
    const Complex none = through(force, y);
    out.force.push_back(through(force, forced));
    out.position.push_back(through(position, y) - none);
    out.velocity.push_back(through(velocity, y) - none);
  }
  return out;
}

/// The same by the linear model, in which a lag stands for each line.
OperatingPoint lag_point(const Rig& rig, const std::vector<double>& frequencies) {
  const AxisLinearisation linear = linearise(rig);
  const auto loop = [&](double position, double velocity) {
    return SampledLoop{held(continuous_axis(linear.axis), rig.period_s, delay_s(rig)),
                       unit_law(rig, linear, position, velocity), rig.period_s};
  };
  const SampledLoop force = loop(0, 0), position = loop(1, 0), velocity = loop(0, 1);
  OperatingPoint out;
  for (const double f : frequencies) {
    out.force.push_back(force.open(f));
    out.position.push_back(position.open(f) - out.force.back());
    out.velocity.push_back(velocity.open(f) - out.force.back());
  }
  return out;
}

/// Stroke, payload range and supply: the numbers in which the machine may stand while it is the same machine.
std::vector<OperatingPoint> operating_points(const Rig& rig) {
  const std::vector<double> frequencies = frequencies_Hz(rig.period_s);
  const auto tolerance = rig.tolerances.find("supply.pressure_Pa");
  const double supply_share = tolerance != rig.tolerances.end() ? deviations_kept * tolerance->second : 0.0;
  std::vector<double> payloads{rig.axis.slider.payload_kg};
  if (const double most = rig.limits.payload_max_kg.value_or(0.0); most > payloads[0]) payloads.push_back(most);
  std::vector<OperatingPoint> out;
  for (const double place : {-1.0, 0.0, 1.0})
    for (const double payload_kg : payloads)
      for (const double supply : {1.0 - supply_share, 1.0 + supply_share}) {
        Rig at = rig;
        at.initial.position_m = place * 0.5 * rig.axis.cylinder.stroke_m;
        at.axis.slider.payload_kg = payload_kg;
        at.axis.supply.pressure_Pa *= supply;
        at.initial.pressure_1_Pa *= supply;
        if (at.initial.pressure_2_Pa) *at.initial.pressure_2_Pa *= supply;
        out.push_back(exact_point(at, frequencies));
        if (!rig.controller.feeds_back_ports()) out.push_back(lag_point(at, frequencies));  // it does not know them
        if (supply_share == 0.0) break;
      }
  return out;
}

/// Stable with the margins: 1 + L turns by +90 deg from its integrator on and no crossing is too near to -1.
bool keeps_margins(const OperatingPoint& point, double k_p, double k_v, double k_f) {
  const auto loop = [&](std::size_t i) {
    return k_f * (k_p * point.position[i] + k_v * point.velocity[i] + point.force[i]);
  };
  const double least_angle = (180.0 - least_phase_margin_deg) / 180.0 * std::numbers::pi;
  Complex before = loop(0);
  double turned = 0.0;
  for (std::size_t i = 1; i < point.force.size(); ++i) {
    const Complex now = loop(i);
    turned += std::arg((1.0 + now) / (1.0 + before));
    if (before.imag() * now.imag() < 0.0) {
      const double share = before.imag() / (before.imag() - now.imag());
      const double real = before.real() + share * (now.real() - before.real());
      if (real < -1.0 / least_gain_margin && real > -least_gain_margin) return false;
    }
    if ((std::norm(before) - 1.0) * (std::norm(now) - 1.0) < 0.0 &&
        std::max(std::fabs(std::arg(before)), std::fabs(std::arg(now))) > least_angle)
      return false;
    before = now;
  }
  // From -90 deg (the integrator, at the lowest frequency) to a real number above 0 at half the sampling rate.
  const double start = std::arg(1.0 + loop(0));
  return std::fabs(start + turned) < 0.5 * std::numbers::pi;
}

bool all_keep(const std::vector<OperatingPoint>& points, double k_p, double k_v, double k_f) {
  return std::ranges::all_of(points, [&](const OperatingPoint& point) { return keeps_margins(point, k_p, k_v, k_f); });
}

/// What the loop has to hold out against.
struct Disturbance {
  double force_N = 0.0, command_V = 0.0;
  double error_m(double k_p, double k_f) const { return force_N / k_p + command_V / (k_f * k_p); }
};

double largest_speed_mps(const Rig& rig) {
  if (needs_file(rig.reference)) return 0.0;
  const ReferenceExtremes speed = Reference(rig.reference).extremes(1, rig.duration_s);
  return std::max(speed.maximum, -speed.minimum);
}

Disturbance disturbance(const Rig& rig) {
  const MotionEffects<double>& motion = rig.axis.effects.motion;
  const double dry_N = std::max(motion.coulomb_friction.force_N,
                                motion.stribeck_friction.coulomb_force_N + motion.stribeck_friction.extra_force_N);
  const auto tolerance = rig.tolerances.find("valve.area_per_volt_m2_per_V");
  const double share = deviations_kept * (tolerance != rig.tolerances.end() ? tolerance->second : usual_area_tolerance);
  return {rig.axis.slider.viscous_friction_Ns_per_m * largest_speed_mps(rig) + dry_N +
              std::fabs(motion.constant_force.force_N),
          share * 0.5 * rig.axis.valve.command_max_V};
}

/// Position and velocity gain are a wanted motion m (x'' + 2 zeta w x' + w^2 x); w from the force loop's reach down.
std::optional<MarginGains> search(const Rig& rig, const std::vector<OperatingPoint>& points) {
  const AxisLinearisation linear = linearise(rig);
  const double mass_kg = linear.mass_kg, wn = std::sqrt(linear.axis.natural_frequency_squared());
  const double per_force = linear.axis.gain_per_V * mass_kg;  // change of force per volt and second
  const Disturbance against = disturbance(rig);
  std::optional<MarginGains> best;
  for (const double zeta : {0.5, 0.7, 1.0, 1.4, 2.0, 3.0, 5.0})
    for (double w = 10.0 * wn; w > 1e-3 * wn; w /= gain_step) {
      const double k_p = mass_kg * w * w, k_v = std::max(0.0, 2.0 * zeta * mass_kg * w - linear.friction_Ns_per_m);
      // The force loop alone crosses gain one at k_f per_force [rad/s].
      for (double reach = 0.5 / rig.period_s; reach > 1e-3 * wn; reach /= gain_step) {
        const double k_f = reach / per_force;
        const double error_m = against.error_m(k_p, k_f);
        if (best && error_m >= best->error_m) break;
        if (!all_keep(points, k_p, k_v, k_f)) continue;
        best = MarginGains{k_f, k_p, k_v, error_m, static_cast<int>(points.size())};
        break;
      }
    }
  return best;
}

}  // namespace

std::optional<MarginGains> highest_gains(const Rig& rig) {
  if (rig.kind != RigKind::cylinder || !rig.controller.is<PdForce>())
    throw std::invalid_argument("method margins finds gains of pd_force; expected rig: cylinder with that law");
  return search(rig, operating_points(rig));
}

Rig with_margin_gains(Rig rig, const MarginGains& gains) {
  PdForceParameters& p = rig.controller.of<PdForce>();
  p.force_gain_V_per_N = gains.force_gain_V_per_N;
  p.position_gain_N_per_m = gains.position_gain_N_per_m;
  p.velocity_gain_Ns_per_m = gains.velocity_gain_Ns_per_m;
  p.force_integral_V_per_Ns = 0.0;
  return rig;
}

std::string obstacle_words(const Rig& rig, const std::optional<MarginGains>& found) {
  struct Variant {
    std::string words;
    std::function<void(Rig&)> change;
  };
  std::vector<Variant> variants{
      {fmt::format("half the length of both lines ({:g} and {:g} m)", rig.axis.line_1.length_m,
                   rig.axis.line_2.length_m),
       [](Rig& r) { r.axis.line_1.length_m *= 0.5, r.axis.line_2.length_m *= 0.5; }},
      {fmt::format("half the control period ({:g} s) and velocity filter", rig.period_s),
       [](Rig& r) { r.period_s *= 0.5, r.controller.of<PdForce>().velocity_filter_s *= 0.5; }},
      {fmt::format("half the largest payload"), [](Rig& r) {
         if (r.limits.payload_max_kg) *r.limits.payload_max_kg *= 0.5;
         r.axis.slider.payload_kg *= 0.5;
       }}};
  if (rig.axis.valve.natural_frequency_Hz > 0.0)
    variants.push_back({fmt::format("a valve of twice the frequency ({:g} Hz)", rig.axis.valve.natural_frequency_Hz),
                        [](Rig& r) { r.axis.valve.natural_frequency_Hz *= 2.0; }});
  double least = found ? found->error_m : infinite;
  std::string words = "no single number: lines, period, payload and valve were tried one by one";
  for (const Variant& variant : variants) {
    Rig other = rig;
    variant.change(other);
    const auto gains = highest_gains(other);
    if (!gains || gains->error_m >= least) continue;
    least = gains->error_m;
    words = found ? fmt::format("{} would leave {:.2g} of the error that forces and flow make", variant.words,
                                least / found->error_m)
                  : fmt::format("{} would allow some", variant.words);
  }
  return words;
}

}  // namespace pneuservo
