// PD with force feedback: configuration, start, and the step of one period.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <pneuservo/control/pd_force.hpp>
#include <pneuservo/rig/axis.hpp>

namespace pneuservo {
namespace {

constexpr double no_measurement = std::numeric_limits<double>::quiet_NaN();

/// From 0 to 1 with level ends.
constexpr double smooth_step(double z) noexcept { return z * z * (3.0 - 2.0 * z); }

/// FNV-1a over the reference and the pass' command.
std::uint64_t move_identity(const LawSetup& setup) noexcept {
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto take = [&](double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int shift = 0; shift < 64; shift += 8) hash = (hash ^ (bits >> shift & 0xff)) * 0x100000001b3;
  };
  take(setup.period_s);
  for (std::size_t k = 0; k < setup.pass->rows.size(); ++k)
    take(setup.reference.at(static_cast<double>(k) * setup.period_s).d[0]), take(setup.pass->rows[k].asked_V);
  return hash;
}

}  // namespace

void PdForce::configure(const PdForceParameters& parameters, const AxisParameters<double>& axis,
                        double period_s) noexcept {
  parameters_ = parameters;
  pass_.reset();
  takes_passes_ = false;
  pass_repeats_ = 1;
  fade_ticks_ = std::max<std::int64_t>(std::llround(pass_fade_s / period_s), 1);
  move_ = {};
  feedforward_ = FlowFeedforward(axis);
  compensation_ = DeadBandAndPlayCompensation(axis.effects.valve);
  limiter_ = CommandLimiter(axis.valve.command_max_V, parameters.command_rate_V_per_s, period_s);
  period_s_ = period_s;
  // Exact for a derivative held over the period; a time constant of 0 leaves the plain difference.
  filter_gain_ = parameters.velocity_filter_s > 0.0 ? -std::expm1(-period_s / parameters.velocity_filter_s) : 1.0;
  area_1_m2_ = axis.cylinder.area_1_m2;
  area_2_m2_ = axis.cylinder.area_2_m2;
  atmosphere_force_N_ = (area_1_m2_ - area_2_m2_) * axis.air.atmosphere_Pa;
  line_mode_ = line_mode_filter(axis, period_s);
  reset();
}

void PdForce::configure(const PdForceParameters& parameters, const LawSetup& setup) {
  configure(parameters, setup.axis, setup.period_s);
  if (!parameters.wants_pass()) return;
  if (!setup.pass)
    throw std::invalid_argument(
        "controller.flow_feedforward: found pass, but no command pass was made of the reference");
  takes_passes_ = true;
  if (setup.pass->rows.empty()) return;
  pass_ = std::make_shared<const std::vector<PassTick>>(pass_ticks(*setup.pass, setup.reference));
  followed_ = *pass_;
  followed_repeats_ = pass_repeats_ = static_cast<std::int64_t>(setup.pass->repeats);
  if (!parameters.learns() || setup.pass->response_m_per_V.empty()) return;
  move_ = RepeatedMove(setup.pass->response_m_per_V, learning_window(setup, pass_->size()), setup.period_s,
                       parameters.learned_command_max_V, move_identity(setup));
}

// Nothing is learned where the reference rests: there an error of friction would be learned again and again.
std::vector<double> PdForce::learning_window(const LawSetup& setup, std::size_t ticks) const {
  constexpr double settling_s = 0.25, fade_s = 0.1;
  const auto far = static_cast<std::ptrdiff_t>(std::ceil((settling_s + fade_s) / period_s_));
  std::vector<double> window(ticks, 0.0);
  std::ptrdiff_t last = -1;  // tick of the last motion
  for (std::size_t k = 0; k < ticks; ++k) {
    if (setup.reference.at(static_cast<double>(k) * period_s_).d[1] != 0.0) last = static_cast<std::ptrdiff_t>(k);
    const std::ptrdiff_t since = static_cast<std::ptrdiff_t>(k) - last;
    if (last < 0 || since > far) continue;
    const double faded = std::clamp((static_cast<double>(since) * period_s_ - settling_s) / fade_s, 0.0, 1.0);
    window[k] = 0.5 * (1.0 + std::cos(M_PI * faded));
  }
  return window;
}

// On the reference the position loop asks for what its filter and the sensors make of it; the force that shows there
// less that is what the law asks for beside the position loop.
std::vector<PassTick> PdForce::pass_ticks(const PassTable& pass, const Reference& reference) const {
  std::vector<PassTick> ticks;
  ticks.reserve(pass.rows.size());
  double v_mps = 0.0, previous_x_m = pass.rows.front().x_m;
  PdForceState seen;
  for (const PassRow& row : pass.rows) {
    const double t_s = static_cast<double>(ticks.size()) * period_s_;
    const ReferencePoint now = reference.at(t_s), ahead = reference.at(t_s + lead_s());
    v_mps += filter_gain_ * ((row.x_m - previous_x_m) / period_s_ - v_mps);
    previous_x_m = row.x_m;
    const double asked_N = parameters_.position_gain_N_per_m * (now.d[0] - row.x_m) +
                           parameters_.velocity_gain_Ns_per_m * (now.d[1] - v_mps);
    see_force({.pressure_Pa = {row.p1_Pa, row.p2_Pa}, .port_Pa = {row.port_1_Pa, row.port_2_Pa}, .now = now},
              ticks.empty(), seen);
    ticks.push_back({row.asked_V, feedforward_.command_V(ahead, row.p1_Pa, row.p2_Pa, row.supply_Pa),
                     seen.F_N - asked_N, feedforward_.motion_force_N(now)});
  }
  return ticks;
}

void PdForce::reset(double previous_command_V) noexcept {
  state_ = PdForceState{};
  limiter_.reset(previous_command_V);
  state_.u_V = limiter_.previous_V();
  state_.asked = compensation_.at(state_.u_V);
  followed_ = pass_ ? std::span<const PassTick>(*pass_) : std::span<const PassTick>();
  followed_from_ = fade_left_ = 0;
  followed_repeats_ = pass_repeats_;
  periods_ = 1.0;
  first_ = true;
}

void PdForce::start_bumpless(double x_m, double p1_Pa, double p2_Pa, const ReferencePoint& now,
                             const ReferencePoint& ahead, double command_V) noexcept {
  reset(command_V);
  const double integral_gain = parameters_.force_integral_V_per_Ns;
  if (!(integral_gain > 0.0)) return;
  PdForceState s = state_;
  take_terms({.x_m = x_m, .pressure_Pa = {p1_Pa, p2_Pa}, .port_Pa = {p1_Pa, p2_Pa}, .now = now, .ahead = ahead}, s);
  // The first step adds period * e_F before it uses the integral.
  const double integral_Ns = (state_.asked.asked_V - asked_V(s)) / integral_gain - period_s_ * s.e_F_N;
  if (std::isfinite(integral_Ns)) state_.I_Ns = integral_Ns;
}

// With a modal filter the ports' pressures join with their share, less the loss along the lines, which the piston does
// not feel: that of the reference's flow, which no measurement delays, and the mean of what it misses.
void PdForce::see_force(const ControlInput& in, bool is_first, PdForceState& s) const noexcept {
  const auto& p = in.pressure_Pa;
  s.F_N = area_1_m2_ * p[0] - area_2_m2_ * p[1] - atmosphere_force_N_;
  if (!parameters_.filters_line_mode()) return;
  const auto share_N = [&](const std::array<double, 2>& at_1_and_2_Pa) {
    return line_mode_.port_share[0] * area_1_m2_ * at_1_and_2_Pa[0] -
           line_mode_.port_share[1] * area_2_m2_ * at_1_and_2_Pa[1];
  };
  const double beside_N = share_N({in.port_Pa[0] - p[0], in.port_Pa[1] - p[1]});
  const double expected_N = share_N(feedforward_.line_loss_Pa(in.now, p[0], p[1]));
  const double missed_N = beside_N - expected_N;
  s.line_loss_error_N =
      is_first ? missed_N : s.line_loss_error_N + line_mode_.mean_gain * (missed_N - s.line_loss_error_N);
  s.line_loss_N = expected_N + s.line_loss_error_N;
  s.F_N += beside_N - s.line_loss_N;
}

void PdForce::take_terms(const ControlInput& in, PdForceState& s) const noexcept {
  s.e_m = in.now.d[0] - in.x_m;
  s.v_mps = first_ ? 0.0 : s.v_mps + filter_gain_ * ((in.x_m - previous_x_m_) / (periods_ * period_s_) - s.v_mps);
  see_force(in, first_, s);
  s.F_ref_N = parameters_.position_gain_N_per_m * s.e_m + parameters_.velocity_gain_Ns_per_m * (in.now.d[1] - s.v_mps);
  if (feeds_forward()) feed_forward(in, s);
  s.e_F_N = s.F_ref_N - s.F_N;
}

// The formula, and with a pass what it has beside the formula. The formula alone keeps the axis' own supply; the pass
// needs the measured one for what differs from it.
void PdForce::feed_forward(const ControlInput& in, PdForceState& s) const noexcept {
  s.F_ref_N += feedforward_.motion_force_N(in.now);
  const double supply_Pa = takes_passes_ ? in.supply_Pa : no_measurement;
  s.u_feedforward_V = feedforward_.command_V(in.ahead, in.pressure_Pa[0], in.pressure_Pa[1], supply_Pa);
  if (!takes_passes_) return;
  take_pass(in.tick, s);
  s.u_learned_V = move_.command_V(in.tick);
  s.F_ref_N += s.pass.F_N;
  s.u_feedforward_V += s.pass.u_V + s.u_learned_V;
}

void PdForce::take_pass(std::int64_t tick, PdForceState& s) const noexcept {
  PassTick now;
  if (!followed_.empty()) {
    const auto last = static_cast<std::int64_t>(followed_.size()) - 1;
    std::int64_t at = std::max<std::int64_t>(tick - followed_from_, 0);
    if (at > last) at = last - followed_repeats_ + 1 + (at - last - 1) % followed_repeats_;
    now = followed_[static_cast<std::size_t>(at)];
  }
  s.u_pass_V = now.u_V;
  s.F_pass_N = now.F_N;
  s.pass = {now.u_V - now.formula_V, now.F_N - now.motion_N};
  if (fade_left_ == 0) return;
  const double share = smooth_step(static_cast<double>(fade_left_) / static_cast<double>(fade_ticks_));
  s.pass.u_V += share * (faded_.u_V - s.pass.u_V);
  s.pass.F_N += share * (faded_.F_N - s.pass.F_N);
}

// In place: a copy made of terms that were just written waits until their bytes have left the processor.
double PdForce::update(const ControlInput& in) noexcept {
  const PdForceState before = state_;
  PdForceState& s = state_;
  take_terms(in, s);
  const auto ask = [&] {
    s.asked = compensation_.next(before.asked, asked_V(s));
    s.u_unlimited_V = compensation_.command_V(s.asked);
  };
  ask();
  // The integral rests while the command is limited in the direction in which it would grow.
  if (std::isfinite(s.u_unlimited_V)) {
    const std::uint8_t limit = limiter_.preview(s.u_unlimited_V).limit;
    const bool frozen = (s.e_F_N > 0.0 && (limit & limits_upward)) || (s.e_F_N < 0.0 && (limit & limits_downward));
    if (!frozen) {
      s.I_Ns += period_s_ * s.e_F_N;
      if (parameters_.force_integral_V_per_Ns != 0.0) ask();
    }
  }
  if (!std::isfinite(s.u_unlimited_V) || !std::isfinite(s.v_mps)) {
    // State stays as it was before this sample: filter, integral and command survive a single bad measurement.
    state_ = before;
    state_.fault = controller_command_not_finite;
    state_.limit = limit_none;
    periods_ += 1.0;
    return state_.u_V;
  }
  const CommandLimiter::Result result = limiter_.limit(s.u_unlimited_V);
  s.u_V = result.command_V;
  s.limit = result.limit;
  s.fault = controller_healthy;
  move_.note(in.tick, s.e_m);
  if (fade_left_ > 0) --fade_left_;
  previous_x_m_ = in.x_m;
  periods_ = 1.0;
  first_ = false;
  return s.u_V;
}

}  // namespace pneuservo
