// What the verb design finds out of a config.
#include "design/axis_design.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include <pneuservo/control/flatness_plan.hpp>

#include "design/gain_rules.hpp"
#include "design/sampled_laws.hpp"

namespace pneuservo {

namespace {

using Complex = std::complex<double>;
constexpr double step_shown_s = 1.0;
constexpr double largest_number = 1e12;  // of a request: far beyond any gain, and its powers are still numbers

MovedMass moved_mass(const AxisLinearisation& linear) { return {linear.mass_kg, linear.friction_Ns_per_m}; }

Ppd2Gains gains_of(const ControllerParameters& controller, const AxisLinearisation& linear) {
  return with_linear_law(controller, [&](const auto& p) { return linear_gains(p, moved_mass(linear)); });
}

ControllerParameters with_gains(ControllerParameters controller, const Ppd2Gains& gains,
                                const AxisLinearisation& linear) {
  with_linear_law(controller, [&](auto& p) { set_linear_gains(p, gains, moved_mass(linear)); });
  return controller;
}

Ppd2Gains designed_gains(const DesignRequest& request, const AxisDesign& design) {
  const LinearAxis& axis = design.linear.axis;
  const double Kp = request.position_gain_V_per_m.value_or(design.gains_before.position_V_per_m);
  if (!(Kp > 0.0))
    throw std::invalid_argument("a rule needs a position gain above 0; expected --position-gain or one in the config");
  switch (request.method) {
    case DesignMethod::alpha_beta: return alpha_beta_gains(axis, Kp, request.alpha, request.beta);
    case DesignMethod::itae_7: return coefficient_gains(axis, Kp, request.c_1, request.c_2);
    case DesignMethod::itae_min: return least_itae_gains(axis, Kp);
    case DesignMethod::margins:
    case DesignMethod::config: break;
  }
  return design.gains_before;
}

/// Those of the search over all operating points; throws with what stands in the way.
Ppd2Gains gains_with_margins(const Rig& rig, const AxisLinearisation& linear) {
  const std::optional<MarginGains> found = highest_gains(rig);
  if (!found)
    throw std::invalid_argument(fmt::format("no gains keep a gain margin of {:g} and a phase margin of {:g} deg over "
                                            "stroke, payload and supply; in the way: {}",
                                            least_gain_margin, least_phase_margin_deg, obstacle_words(rig, found)));
  return as_ppd2_gains(with_margin_gains(rig, *found).controller.of<PdForce>(), linear.mass_kg,
                       linear.friction_Ns_per_m);
}

std::optional<NamedGain> unusable(const ControllerParameters& controller, const Ppd2Gains& gains,
                                  const AxisLinearisation& linear) {
  return with_linear_law(controller, [&](const auto& p) { return unusable_gain(p, gains, moved_mass(linear)); });
}

ModelFigures figures_of(const LinearAxis& axis, const Ppd2Gains& gains) {
  const Polynomial loop = closed_loop(axis, gains);
  return {axis, roots(loop), normalised_coefficients(loop), inverse_of_closed_loop(axis, gains),
          itae_of_loop(axis, gains)};
}

StateSpace law_of(const Rig& rig, const ControllerParameters& controller, const AxisLinearisation& linear) {
  return with_linear_law(controller, [&](const auto& p) { return sampled_law(p, moved_mass(linear), rig.period_s); });
}

SampledLoop loop_of(const Rig& rig, const ControllerParameters& controller, const AxisLinearisation& linear) {
  return {held(continuous_axis(linear.axis), rig.period_s, delay_s(rig)), law_of(rig, controller, linear),
          rig.period_s};
}

bool all_decay(const std::vector<Complex>& poles) {
  return std::all_of(poles.begin(), poles.end(), [](const Complex& pole) { return pole.real() < 0.0; });
}

void require_lines(const Rig& rig) {
  if (!rig.is_pneumatic())
    throw std::invalid_argument("a driven_axis has no lines to design for; expected rig: cylinder or servo_table");
}

void require_above_zero(const char* name, double value) {
  if (!(value > 0.0 && value <= largest_number))
    throw std::invalid_argument(
        fmt::format("design: {}: found {:g}, expected a number above 0, at most {:g}", name, value, largest_number));
}

/// A search over gains would not end at others.
void require_numbers(const DesignRequest& request) {
  if (request.position_gain_V_per_m) require_above_zero("position gain", *request.position_gain_V_per_m);
  require_above_zero("alpha", request.alpha);
  require_above_zero("beta", request.beta);
  require_above_zero("c6", request.c_1);
  require_above_zero("c5", request.c_2);
}

/// Position gains of a rule that were tried: those whose gains the law takes, and those whose loop is stable.
struct RuleRange {
  double usable_from = 0.0, usable_to = 0.0, stable_from = 0.0, stable_to = 0.0;  ///< V/m; 0: none
};

/// Lowest and highest position gain that are tried: three decades to either side of the request's and the config's
/// [V/m].
std::array<double, 2> tried_gains(const AxisDesign& design) {
  const double asked = design.gains.position_V_per_m, before = design.gains_before.position_V_per_m;
  const double other = before > 0.0 ? before : asked;
  return {1e-3 * std::min(asked, other), 1e3 * std::max(asked, other)};
}

RuleRange rule_range(const Rig& rig, DesignRequest request, const AxisDesign& design) {
  const double ratio = std::pow(10.0, 1.0 / 12.0);
  // Its search takes seconds at each gain, and finds nothing where its start is unstable.
  if (request.method == DesignMethod::itae_min) request.method = DesignMethod::alpha_beta;
  const auto [lowest, highest] = tried_gains(design);
  RuleRange out;
  for (double Kp = lowest; Kp <= highest; Kp *= ratio) {
    request.position_gain_V_per_m = Kp;
    const Ppd2Gains gains = designed_gains(request, design);
    const ControllerParameters controller = with_gains(rig.controller, gains, design.linear);
    if (unusable(controller, gains, design.linear)) continue;
    if (out.usable_from == 0.0) out.usable_from = Kp;
    out.usable_to = Kp;
    if (!all_decay(loop_of(rig, controller, design.linear).poles())) continue;
    if (out.stable_from == 0.0) out.stable_from = Kp;
    out.stable_to = Kp;
  }
  return out;
}

/// Which way the position gain has to go, or what stands in the way of every one.
std::string rule_advice(const Rig& rig, const DesignRequest& request, const AxisDesign& design) {
  const RuleRange range = rule_range(rig, request, design);
  const double asked = design.gains.position_V_per_m;
  if (range.stable_to > 0.0)
    return fmt::format("{}: the loop{} is stable from {:.3g} to {:.3g} V/m", asked > range.stable_to ? "down" : "up",
                       request.method == DesignMethod::itae_min ? " of alpha_beta, its start," : "", range.stable_from,
                       range.stable_to);
  const LinearAxis& axis = design.linear.axis;
  const SecondOrderLag& line = design.linear.sides[0].lag;
  const double wn = std::sqrt(axis.natural_frequency_squared()), w = std::cbrt(asked * axis.gain_per_V);
  const auto [lowest, highest] = tried_gains(design);
  if (range.usable_to == 0.0)
    return fmt::format("none from {:.3g} to {:.3g} V/m helps: the air spring's {:.3g} rad/s stands against the rule's "
                       "{:.3g} rad/s; judge gains of your own (--method config) instead",
                       lowest, highest, wn, w);
  const char* way = asked < range.usable_from ? "up: " : asked > range.usable_to ? "down: " : "of no help: ";
  return fmt::format(
      "{}the law takes the gains from {:.3g} V/m on, but every loop from there to {:.3g} V/m is unstable: the "
      "lag of the lines at {:.3g} Hz (damping {:.2g}) stands in the way; lower the config's gains by hand "
      "and judge them (--method config)",
      way, range.usable_from, range.usable_to, line.natural_frequency_rad_per_s / (2.0 * std::numbers::pi),
      line.damping_ratio);
}

/// A law refuses gains below 0, so a rule that ends there has no answer.
void require_usable(const Rig& rig, const DesignRequest& request, const AxisDesign& design) {
  const auto gain = unusable(design.controller, design.gains, design.linear);
  if (!gain) return;
  throw std::invalid_argument(fmt::format(
      "method {} gives {} {:.4g} at a position gain of {:.4g} V/m, which the law does not take; expected another "
      "position gain: {}",
      design_method_names[static_cast<std::size_t>(design.method)], gain->name, gain->value,
      design.gains.position_V_per_m, rule_advice(rig, request, design)));
}

/// rms of the command that white noise of the position makes while the slider rests: from the sum of the law's squared
/// impulse response. Without the integral: what it gathers the loop takes away.
double command_noise_V(const Rig& rig, ControllerParameters controller, const AxisLinearisation& linear) {
  with_linear_law(controller, [](auto& p) { drop_integral(p); });
  const StateSpace law = law_of(rig, controller, linear);
  double square = law.D(0, 0) * law.D(0, 0);
  Eigen::VectorXd state = law.B.col(0);
  const double start = state.norm();
  for (int k = 0; k < 200000 && state.norm() > 1e-12 * start; ++k) {
    square += std::pow((law.C * state)(0), 2);
    state = law.A * state;
  }
  return std::sqrt(square) * rig.sensors.position.rms_m();
}

void find_mean_pressure(const Rig& rig, const LoadPositions& load, AxisDesign& design) {
  const Reference reference(rig.reference, load);
  FlatnessSettings settings;
  settings.period_s = rig.period_s;
  settings.command_delay_s = rig.controller.command_delay_s();
  const double end_s = reference.is_move() ? std::min(rig.duration_s, reference.end_s() + 0.1) : rig.duration_s;
  design.mean_pressure_needed_Pa = mean_pressure_needed_Pa(rig.axis, reference, end_s, settings);
}

void find_spool(const Rig& rig, AxisDesign& design) {
  if (!(rig.axis.valve.natural_frequency_Hz > 0.0)) return;
  SpoolLoopParameters parameters;
  parameters.natural_frequency_Hz = rig.axis.valve.natural_frequency_Hz;
  parameters.damping_ratio = rig.axis.valve.damping_ratio;
  design.spool_in_range = parameters.natural_frequency_Hz >= 50.0 && parameters.natural_frequency_Hz <= 300.0 &&
                          parameters.damping_ratio < 1.0;
  if (design.spool_in_range) design.spool = spool_loop_gains(parameters);
}

void warn_of_margins(std::string_view where, const LoopMargins& margins, std::vector<std::string>& warnings) {
  if (margins.gain_up < least_gain_margin)
    warnings.push_back(fmt::format("{}: the gain may grow by {:.3g} only (at {:.3g} Hz); less than {:g}", where,
                                   margins.gain_up, margins.gain_up_Hz, least_gain_margin));
  if (margins.gain_down > 1.0 / least_gain_margin)
    warnings.push_back(fmt::format("{}: the gain must not fall below {:.3g} (at {:.3g} Hz); more than {:g}", where,
                                   margins.gain_down, margins.gain_down_Hz, 1.0 / least_gain_margin));
  if (margins.phase_deg < least_phase_margin_deg)
    warnings.push_back(fmt::format("{}: phase margin {:.3g} deg (at {:.3g} Hz); less than {:g} deg", where,
                                   margins.phase_deg, margins.phase_Hz, least_phase_margin_deg));
}

void warn_of_instability(const Rig& rig, const DesignRequest& request, AxisDesign& design) {
  if (design.is_stable) return;
  std::string text = "the loop is unstable with these gains";
  const bool has_rule = request.method != DesignMethod::config && request.method != DesignMethod::margins;
  if (has_rule) text += "; position gain " + rule_advice(rig, request, design);
  else if (design.margins.gain_down > 0.0)
    text += fmt::format("; gain down: it is stable below {:.3g} of them", design.margins.gain_down);
  design.warnings.push_back(std::move(text));
  if (request.method == DesignMethod::itae_min && !std::isfinite(design.models.back().itae_s2))
    design.warnings.emplace_back("itae_min found no stable loop: its gains are its start, those of alpha_beta");
}

void find_warnings(const Rig& rig, const DesignRequest& request, AxisDesign& design) {
  auto& warnings = design.warnings;
  warn_of_instability(rig, request, design);
  if (!design.controller.feeds_back_ports()) warn_of_margins("linear model", design.margins, warnings);
  warn_of_margins("distributed lines", design.exact_margins, warnings);
  if (!design.spool_in_range)
    warnings.push_back(
        fmt::format("valve.natural_frequency_Hz {:g} with damping_ratio {:g} is none that the inner loop "
                    "makes; expected 50 to 300 Hz and less than 1",
                    rig.axis.valve.natural_frequency_Hz, rig.axis.valve.damping_ratio));
  if (!design.mean_pressure_needed_Pa) return;
  const double needed = *design.mean_pressure_needed_Pa, has = rig.controller.of<Ppd2>().mean_pressure_Pa;
  if (needed == 0.0) warnings.emplace_back("no mean pressure below the supply suffices for the reference");
  else if (needed > has)
    warnings.push_back(
        fmt::format("controller.mean_pressure_Pa {:g} does not suffice for the reference: it needs {:g}", has, needed));
}

}  // namespace

Complex exact_open(const AxisDesign& design, double frequency_Hz) {
  const double T = design.loop.period_s;
  const Complex s(0.0, 2.0 * std::numbers::pi * frequency_Hz), z = std::exp(s * T);
  const AxisResponse axis = exact_response(design.linear, s);
  // The law's columns of velocity and acceleration make the force; what it sees stands for m x'' + B x' there.
  Eigen::Vector4cd y(axis.position_m, s * axis.position_m, s * s * axis.position_m, 0.0);
  if (design.controller.feeds_back_ports()) {
    y(1) = 0.0;
    y(2) = seen_force_N(design.linear, axis, z) / design.linear.mass_kg;
  }
  const Complex hold = (1.0 - 1.0 / z) / (s * T) * std::exp(-s * design.delay_s);
  return -(design.loop.law.transfer(z) * y)(0) * hold;
}

namespace {

/// On distributed lines, of a loop that the linear model does not know.
LoopPoint distributed_point(const Rig& rig, bool with_margins) {
  AxisDesign design(linearise(rig));
  design.controller = rig.controller;
  design.delay_s = delay_s(rig);
  design.loop = loop_of(rig, rig.controller, design.linear);
  const auto open = [&](double f) { return exact_open(design, f); };
  const double highest_Hz = 0.5 / rig.period_s;
  const NyquistVerdict verdict = nyquist_verdict(open, highest_Hz);
  LoopPoint out{rig.initial.position_m, rig.axis.slider.payload_kg, verdict.is_stable, verdict.nearest_Hz, {}};
  if (with_margins) out.margins = margins_of(open, highest_Hz);
  return out;
}

}  // namespace

LoopPoint loop_point(const Rig& rig, bool with_margins) {
  require_lines(rig);
  if (rig.controller.feeds_back_ports()) return distributed_point(rig, with_margins);
  const SampledLoop loop = loop_of(rig, rig.controller, linearise(rig));
  const std::vector<Complex> poles = loop.poles();
  LoopPoint out{rig.initial.position_m, rig.axis.slider.payload_kg, all_decay(poles), 0.0, {}};
  const auto weakest = std::max_element(poles.begin(), poles.end(),
                                        [](const Complex& a, const Complex& b) { return a.real() < b.real(); });
  if (weakest != poles.end()) out.weakest_Hz = std::fabs(weakest->imag()) / (2.0 * std::numbers::pi);
  if (with_margins) out.margins = margins_of([&](double f) { return loop.open(f); }, 0.5 / rig.period_s);
  return out;
}

AxisDesign design_axis(const Rig& rig, const DesignRequest& request, const LoadPositions& load) {
  require_lines(rig);
  require_numbers(request);
  AxisDesign out(linearise(rig));
  out.method = request.method;
  out.gains_before = gains_of(rig.controller, out.linear);
  out.gains =
      request.method == DesignMethod::margins ? gains_with_margins(rig, out.linear) : designed_gains(request, out);
  out.controller =
      request.method == DesignMethod::config ? rig.controller : with_gains(rig.controller, out.gains, out.linear);
  if (request.method != DesignMethod::config) require_usable(rig, request, out);

  const LinearAxis &full = out.linear.axis, fifth = matched_at_low_frequency(full);
  for (const LinearAxis& axis : {without_lags(full), fifth, full})
    if (out.models.empty() || axis.order() > out.models.back().axis.order())
      out.models.push_back(figures_of(axis, out.gains));
  out.matched = fifth.lines[0];
  out.by_distance = reduced_by_pole_distance(full, out.gains).lines[0];

  out.delay_s = delay_s(rig);
  out.loop = loop_of(rig, out.controller, out.linear);
  out.poles = out.loop.poles();
  const double highest_Hz = 0.5 / rig.period_s;
  out.is_stable = out.controller.feeds_back_ports()
                      ? nyquist_verdict([&](double f) { return exact_open(out, f); }, highest_Hz).is_stable
                      : all_decay(out.poles);
  out.margins = margins_of([&](double f) { return out.loop.open(f); }, highest_Hz);
  out.exact_margins = margins_of([&](double f) { return exact_open(out, f); }, highest_Hz);
  out.step = step_response(out.loop, step_shown_s);
  out.command_noise_V = command_noise_V(rig, out.controller, out.linear);
  if (rig.controller.is<Ppd2>() && request.needs_mean_pressure) find_mean_pressure(rig, load, out);
  find_spool(rig, out);
  find_warnings(rig, request, out);
  return out;
}

}  // namespace pneuservo
