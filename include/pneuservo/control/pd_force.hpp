// PD with force feedback (chapter 3): position and velocity errors ask for a force, pressures close the force loop.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <pneuservo/control/dead_band_and_play.hpp>
#include <pneuservo/control/flow_feedforward.hpp>
#include <pneuservo/control/law.hpp>
#include <pneuservo/control/limits.hpp>
#include <pneuservo/control/line_mode.hpp>
#include <pneuservo/control/reference.hpp>
#include <pneuservo/control/repeated_move.hpp>

namespace pneuservo {

/// What adds the command that the reference needs: nothing, the quasi-steady formula, or a command pass (and the
/// formula for what differs from it).
enum class FeedforwardSource { off, formula, pass };
inline constexpr std::array<std::string_view, 3> feedforward_source_names{"off", "formula", "pass"};
inline constexpr std::array<std::string_view, 2> feedforward_source_older_words{"false", "true"};

/// What a run does where the pass that it asks for cannot be had.
enum class WithoutPass { refuse, formula };
inline constexpr std::array<std::string_view, 2> without_pass_names{"refuse", "formula"};

/// What a finished move teaches the next one.
enum class MoveLearning { none, command };
inline constexpr std::array<std::string_view, 2> move_learning_names{"none", "command"};

/// What the force loop does not see: nothing, or the first mode of the lines.
enum class ModalFilter { none, line };
inline constexpr std::array<std::string_view, 2> modal_filter_names{"none", "line"};

/// PD with force feedback (chapter 3; docs/physics/pd_force.md has the law).
struct PdForceParameters {
  PressureSource pressure_source = PressureSource::estimated;
  double position_gain_N_per_m = 0.0;
  double velocity_gain_Ns_per_m = 0.0;
  double velocity_filter_s = 0.002;
  double force_gain_V_per_N = 0.0;
  double force_integral_V_per_Ns = 0.0;
  ModalFilter modal_filter = ModalFilter::none;
  FeedforwardSource flow_feedforward = FeedforwardSource::off;
  WithoutPass without_pass = WithoutPass::refuse;
  MoveLearning learning = MoveLearning::none;
  double learned_command_max_V = 0.5;
  double feedforward_lead_s = 0.0;
  double command_rate_V_per_s = infinite;

  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"pressure_source", "", 0, 0,
            "pressures that close the force loop; differential: the ports' less what the lines are measured to lose",
            Presence::required, pressure_source_names},
      p.pressure_source...);
    visit_outer_loop(v, p...);
    v(Field{"force_gain_V_per_N", "V/N", 0, 1e6, "K_f: command per force error"}, p.force_gain_V_per_N...);
    v(Field{"force_integral_V_per_Ns", "V/(N s)", 0, 1e6, "K_i: command per integral of force error", optional},
      p.force_integral_V_per_Ns...);
    v(Field{"modal_filter", "", 0, 0, "line: the first mode of the lines cancels in the force, by the ports' pressures",
            optional, modal_filter_names},
      p.modal_filter...);
    v(Field{"flow_feedforward", "", 0, 0, "where the command comes from that the reference's flow needs", optional,
            feedforward_source_names, feedforward_source_older_words},
      p.flow_feedforward...);
    v(Field{"without_pass", "", 0, 0, "what a run does where no pass can be made: end, or go on with the formula",
            optional, without_pass_names},
      p.without_pass...);
    v(Field{"learning", "", 0, 0, "what a finished move teaches the next one; needs a pass", optional,
            move_learning_names},
      p.learning...);
    v(Field{"learned_command_max_V", "V", 0, 1e6, "bound of the command that moves have taught", optional},
      p.learned_command_max_V...);
    v(Field{"feedforward_lead_s", "s", 0, 1, "the feedforward looks this far ahead", optional},
      p.feedforward_lead_s...);
    v(Field{"command_rate_V_per_s", "V/s", 1e-6, infinite, "largest rate of the command; .inf: none", optional},
      p.command_rate_V_per_s...);
  }

  /// Pressures that the law takes.
  std::optional<PressureSource> pressures() const noexcept { return pressure_source; }
  /// With the filter on ports there is nothing to weigh.
  bool filters_line_mode() const noexcept {
    return modal_filter == ModalFilter::line && pressure_source != PressureSource::valve;
  }
  bool feeds_back_ports() const noexcept { return pressure_source == PressureSource::valve || filters_line_mode(); }
  std::string_view feedforward_name() const noexcept {
    constexpr std::array<std::string_view, 3> names{"none", "formula", "pass"};
    return names[static_cast<std::size_t>(flow_feedforward)];
  }
  bool learns() const noexcept { return wants_pass() && learning != MoveLearning::none; }
  bool wants_pass() const noexcept { return flow_feedforward == FeedforwardSource::pass; }

  /// The loop of position and velocity alone: all there is where the drive gives its force at once.
  template <class V, class... P> static void visit_outer_loop(V&& v, P&... p) {
    v(Field{"position_gain_N_per_m", "N/m", 0, 1e9, "K_p: force per position error"}, p.position_gain_N_per_m...);
    v(Field{"velocity_gain_Ns_per_m", "N s/m", 0, 1e9, "K_v: force per velocity error"}, p.velocity_gain_Ns_per_m...);
    v(Field{"velocity_filter_s", "s", 0, 1, "time constant of the velocity filter"}, p.velocity_filter_s...);
  }
};

/// Bits of PdForceState::fault.
enum ControllerFault : std::uint8_t {
  controller_healthy = 0,
  controller_command_not_finite = 1,  ///< an input or gain made the command NaN or infinite; the last command was kept
};

/// What a pass adds to the formula.
struct PassPart {
  double u_V = 0.0, F_N = 0.0;
};

/// Every term of the law at the last step.
struct PdForceState {
  double e_m = 0.0;  ///< x_ref - x
  double v_mps = 0.0;  ///< filtered velocity
  double F_N = 0.0;  ///< force of the pressures in use on the piston
  double line_loss_N = 0.0;  ///< what the lines' loss makes of the ports' share; with a modal filter
  double line_loss_error_N = 0.0;  ///< mean of what the loss of the reference's flow misses, a part of line_loss_N
  double F_ref_N = 0.0;  ///< force asked for
  double e_F_N = 0.0;  ///< F_ref - F
  double I_Ns = 0.0;  ///< integral of e_F
  double u_feedforward_V = 0.0;
  double u_pass_V = 0.0;  ///< the pass' command, a part of u_feedforward_V
  double u_learned_V = 0.0;  ///< what earlier moves taught, a part of u_feedforward_V
  double F_pass_N = 0.0;  ///< the force that shows on the reference, a part of F_ref_N
  PassPart pass;  ///< what the pass adds to the formula
  DeadBandAndPlayCompensation::State asked;  ///< command before the valve's known dead band or play
  double u_unlimited_V = 0.0;  ///< command before range and rate
  double u_V = 0.0;  ///< command
  std::uint8_t limit = limit_none;  ///< CommandLimit that acted
  std::uint8_t fault = controller_healthy;  ///< ControllerFault bits

  /// v(term, member...) for what is recorded; velocity, command and fault have columns of every run.
  template <class V, class... S> static constexpr void visit(V&& v, S&... s) {
    v(LawTerm{"position_error_m", "m", "x_ref - x"}, s.e_m...);
    v(LawTerm{"chamber_force_N", "N", "force of the pressures in use on the piston"}, s.F_N...);
    v(LawTerm{"line_loss_N", "N", "share of the lines' pressure loss, taken from the force; with a modal filter"},
      s.line_loss_N...);
    v(LawTerm{"force_reference_N", "N", "force that position and velocity errors ask for"}, s.F_ref_N...);
    v(LawTerm{"force_error_N", "N", "force_reference_N - chamber_force_N"}, s.e_F_N...);
    v(LawTerm{"force_error_integral_Ns", "N s", "integral of the force error"}, s.I_Ns...);
    v(LawTerm{"u_feedforward_V", "V", "command that the reference's flow needs"}, s.u_feedforward_V...);
    v(LawTerm{"u_pass_V", "V", "command of the pass, a part of u_feedforward_V"}, s.u_pass_V...);
    v(LawTerm{"u_learned_V", "V", "command that earlier moves taught, a part of u_feedforward_V"}, s.u_learned_V...);
    v(LawTerm{"force_pass_N", "N", "force that shows on the reference by the pass, a part of force_reference_N"},
      s.F_pass_N...);
    v(LawTerm{"u_unlimited_V", "V", "command before range and rate"}, s.u_unlimited_V...);
    v(LawTerm{"command_limit", "", "bits: 1 at the upper range, 2 the lower, 4 held back rising, 8 falling"},
      s.limit...);
  }
};

/// The controller of docs/physics/pd_force.md. Copying it copies its whole state.
class PdForce {
 public:
  using Parameters = PdForceParameters;
  using Terms = PdForceState;
  static constexpr std::string_view name = "pd_force";
  static constexpr int valves = 1;

  PdForce() noexcept = default;
  PdForce(const PdForceParameters& parameters, const AxisParameters<double>& axis, double period_s) noexcept {
    configure(parameters, axis, period_s);
  }
  /// Cold: takes parameters (in the ranges of their fields), period_s > 0, and resets.
  void configure(const PdForceParameters& parameters, const AxisParameters<double>& axis, double period_s) noexcept;
  /// Cold; allocates where the law follows a pass. Throws std::invalid_argument where it wants one and has none.
  void configure(const PdForceParameters& parameters, const LawSetup& setup);
  /// Forgets velocity and integral; the command's rate counts from previous_command_V. HOT.
  void reset(double previous_command_V = 0.0) noexcept;
  void reset(const std::array<double, 2>& previous_V) noexcept { reset(previous_V[0]); }
  /// Bumpless start at the measured position and pressures: the velocity starts at 0 and the integral (if there is
  /// one) such that a step with these inputs gives command_V. HOT.
  void start_bumpless(double x_m, double p1_Pa, double p2_Pa, const ReferencePoint& now, const ReferencePoint& ahead,
                      double command_V) noexcept;

  /// Command [V] of one period from measured position [m], the pressures that pressure_source names [Pa, absolute], the
  /// reference at t and at t + lead_s(). The ports show the same. Always finite; HOT.
  double step(double x_m, double p1_Pa, double p2_Pa, const ReferencePoint& now, const ReferencePoint& ahead) noexcept {
    return update({.x_m = x_m, .pressure_Pa = {p1_Pa, p2_Pa}, .port_Pa = {p1_Pa, p2_Pa}, .now = now, .ahead = ahead});
  }
  ControlOutput step(const ControlInput& in) noexcept {
    const double u_V = update(in);
    return {{u_V, 0.0}, state_.v_mps, state_.limit != limit_none, state_.fault == controller_healthy};
  }

  /// Periods passed without a step (a late loop skipped its slots): the next velocity counts over all of them. HOT.
  void skip(std::int64_t periods) noexcept { periods_ += static_cast<double>(periods); }

  const PdForceState& state() const noexcept { return state_; }
  const PdForceState& terms() const noexcept { return state_; }
  /// A finished move teaches the next one.
  bool learns() const noexcept { return move_.is_on(); }
  /// Between moves only (ticks below 0). Cold.
  void learn(const AxisParameters<double>&) { move_.learn(); }
  /// A move that learns begins from rest each time, as its pass does.
  double rest_s(bool, const std::array<double, 2>&) const noexcept { return learns() ? PassTable::rest_s : 0.0; }
  int moves_not_learned() const noexcept { return move_.progress().moves_not_learned; }
  const RepeatedMove& repeated_move() const noexcept { return move_; }
  /// What earlier runs of this move learned; before the run. Cold.
  void begin_with_learned(std::vector<double> learned_V) { move_.begin_with(std::move(learned_V)); }

  /// What this law takes of a pass of the reference; from its configuration alone. Cold.
  std::vector<PassTick> pass_ticks(const PassTable& pass, const Reference& reference) const;
  /// Over which another pass, or none, takes the place of the one before. On lines of 2 to 10 m the error is the same
  /// within 2 % from 1 to 200 ms; below 25 ms the command steps by up to 0.14 V, above not beyond its noise.
  static constexpr double pass_fade_s = 0.05;
  /// From the next step on follows a pass whose first row is that of ControlInput::tick `from`; none: the formula
  /// alone. The rows stay the caller's, and last as long as they are followed. HOT.
  void follow_pass(std::span<const PassTick> rows, std::int64_t from) noexcept {
    if (!takes_passes_) return;
    faded_ = state_.pass;
    fade_left_ = fade_ticks_;
    followed_ = rows;
    followed_from_ = from;
    followed_repeats_ = 1;
  }

  /// How far ahead of t the second reference point of a step lies [s]; 0 without flow feedforward.
  double lead_s() const noexcept { return feeds_forward() ? parameters_.feedforward_lead_s : 0.0; }

 private:
  std::vector<double> learning_window(const LawSetup& setup, std::size_t ticks) const;
  double update(const ControlInput& in) noexcept;
  // `s` holds the last step's terms and gets those of this one.
  void take_terms(const ControlInput& in, PdForceState& s) const noexcept;
  void feed_forward(const ControlInput& in, PdForceState& s) const noexcept;
  void take_pass(std::int64_t tick, PdForceState& s) const noexcept;
  bool feeds_forward() const noexcept { return parameters_.flow_feedforward != FeedforwardSource::off; }
  void see_force(const ControlInput& in, bool is_first, PdForceState& s) const noexcept;
  double asked_V(const PdForceState& s) const noexcept {
    return parameters_.force_gain_V_per_N * s.e_F_N + parameters_.force_integral_V_per_Ns * s.I_Ns + s.u_feedforward_V;
  }

  PdForceParameters parameters_{};
  FlowFeedforward feedforward_{};
  DeadBandAndPlayCompensation compensation_{};
  bool takes_passes_ = false;
  std::shared_ptr<const std::vector<PassTick>> pass_;  ///< of the reference; copies of the law share it
  std::span<const PassTick> followed_;  ///< empty: the formula alone
  std::int64_t followed_from_ = 0, followed_repeats_ = 1, pass_repeats_ = 1;
  std::int64_t fade_ticks_ = 1, fade_left_ = 0;
  PassPart faded_{};  ///< of the last tick before another pass, or none, was followed
  RepeatedMove move_{};  ///< is off without learning
  CommandLimiter limiter_{};
  PdForceState state_{};
  double period_s_ = 0.001, filter_gain_ = 1.0;
  double area_1_m2_ = 0.0, area_2_m2_ = 0.0, atmosphere_force_N_ = 0.0;
  LineModeFilter line_mode_{};
  double previous_x_m_ = 0.0, periods_ = 1.0;  ///< last good position and its age
  bool first_ = true;
};

template <> struct LawAt<0> {
  using Law = PdForce;
};

}  // namespace pneuservo
