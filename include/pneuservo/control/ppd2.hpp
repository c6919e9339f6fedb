// PPD2 (chapter 2): position, velocity and acceleration feedback from an observer, with feedforward commands.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <pneuservo/control/flatness_law.hpp>
#include <pneuservo/control/law.hpp>
#include <pneuservo/control/limits.hpp>
#include <pneuservo/control/linear_servo_table.hpp>
#include <pneuservo/control/motion_observer.hpp>
#include <pneuservo/control/reference.hpp>

namespace pneuservo {

/// What the observer of ppd2 runs on: the measured position, or its error against the reference.
enum class ObserverInput { measured, error };
inline constexpr std::array<std::string_view, 2> observer_input_names{"measured", "error"};

/// Feedforward of ppd2: inverse of the linear closed loop of that order, or of the nonlinear plant.
enum class FeedforwardKind { none, order_3, order_5, order_7, flatness };
inline constexpr std::array<std::string_view, 5> feedforward_kind_names{"none", "3", "5", "7", "flatness"};

/// What a finished move teaches the next one: the valve's effective area, or the flow that the feedback had to add.
enum class Learning { none, area, flow };
inline constexpr std::array<std::string_view, 3> learning_names{"none", "area", "flow"};

/// Position, velocity and acceleration feedback with observer and feedforward (chapter 2; docs/physics/ppd2.md).
struct Ppd2Parameters {
  double position_gain_V_per_m = 0.0;
  double velocity_gain_Vs_per_m = 0.0;
  double acceleration_gain_Vs2_per_m = 0.0;
  double integral_gain_V_per_m_s = 0.0;
  ObserverInput observer = ObserverInput::error;
  double observer_rad_per_s = 1000.0;
  std::optional<std::vector<double>> observer_gains;  ///< l1 [1/s], l2 [1/s2], l3 [1/s3]
  double command_delay_s = 0.0;
  FeedforwardKind feedforward = FeedforwardKind::none;
  double equilibrium_pressure_Pa = 110000.0;
  double mean_pressure_Pa = 140000.0;
  Learning learning = Learning::none;
  double command_rate_V_per_s = infinite;

  /// Pressures that the law takes: those of the ports hold the mean pressure.
  std::optional<PressureSource> pressures() const noexcept {
    return feedforward == FeedforwardKind::flatness ? std::optional(PressureSource::valve) : std::nullopt;
  }
  /// What the law takes the table's pressure to be before it moves.
  double rest_pressure_Pa() const noexcept {
    return feedforward == FeedforwardKind::flatness ? mean_pressure_Pa : equilibrium_pressure_Pa;
  }
  std::string_view feedforward_name() const noexcept {
    return feedforward_kind_names[static_cast<std::size_t>(feedforward)];
  }

  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"position_gain_V_per_m", "V/m", 0, 1e9, "K_p: command per position error"}, p.position_gain_V_per_m...);
    v(Field{"velocity_gain_Vs_per_m", "V s/m", 0, 1e9, "K_v: command per velocity error"}, p.velocity_gain_Vs_per_m...);
    v(Field{"acceleration_gain_Vs2_per_m", "V s2/m", 0, 1e9, "K_a: command per acceleration error"},
      p.acceleration_gain_Vs2_per_m...);
    v(Field{"integral_gain_V_per_m_s", "V/(m s)", 0, 1e9, "K_i: command per integral of the position error", optional},
      p.integral_gain_V_per_m_s...);
    v(Field{"observer", "", 0, 0, "what the observer of velocity and acceleration runs on", optional,
            observer_input_names},
      p.observer...);
    v(Field{"observer_rad_per_s", "rad/s", 1, 1e6, "w of the observer's gains 2 w, 2 w^2, w^3", optional},
      p.observer_rad_per_s...);
    v(Field{"observer_gains", "", 0, 1e18, "l1, l2, l3 in 1/s, 1/s2, 1/s3 instead of observer_rad_per_s", optional},
      p.observer_gains...);
    v(Field{"command_delay_s", "s", 0, 0.1, "delay from command to valve that the feedforward makes up for", optional},
      p.command_delay_s...);
    v(Field{"feedforward", "", 0, 0, "order of the linear inverse, or the inverse of the nonlinear plant", optional,
            feedforward_kind_names},
      p.feedforward...);
    v(Field{"equilibrium_pressure_Pa", "Pa", 1e4, 2e6, "P0 at which the linear models are taken", optional},
      p.equilibrium_pressure_Pa...);
    v(Field{"mean_pressure_Pa", "Pa", 1e4, 2e6, "mean of both chamber pressures, held", optional},
      p.mean_pressure_Pa...);
    v(Field{"learning", "", 0, 0, "what a finished move teaches the next one", optional, learning_names},
      p.learning...);
    v(Field{"command_rate_V_per_s", "V/s", 1e-6, infinite, "largest rate of the command; .inf: none", optional},
      p.command_rate_V_per_s...);
  }
};

/// The gains that may change while the loop runs.
struct Ppd2GainSet {
  double position_gain_V_per_m = 0.0, velocity_gain_Vs_per_m = 0.0, acceleration_gain_Vs2_per_m = 0.0,
         integral_gain_V_per_m_s = 0.0;
  friend bool operator==(const Ppd2GainSet&, const Ppd2GainSet&) = default;
};
inline Ppd2GainSet gain_set(const Ppd2Parameters& p) noexcept {
  return {p.position_gain_V_per_m, p.velocity_gain_Vs_per_m, p.acceleration_gain_Vs2_per_m, p.integral_gain_V_per_m_s};
}

/// Of the config: `observer_gains` where they are stated, or all poles at `observer_rad_per_s`.
ObserverGains observer_gains(const Ppd2Parameters& p) noexcept;

/// Every term of the law at the last step.
struct Ppd2State {
  double e_m = 0.0;                      ///< x_measured - x_ref
  double x_m = 0.0, v_mps = 0.0, a_mps2 = 0.0;  ///< of the observer: of the position, or of its error
  double speed_mps = 0.0;                ///< of the slider, whatever the observer runs on
  double I_ms = 0.0;                     ///< integral of -e
  double u_feedback_V = 0.0, u_feedforward_V = 0.0;
  double u_bump_V = 0.0;                 ///< what a change of gains left behind, fading
  std::array<double, 2> u_unlimited_V{};  ///< before range and rate, a valve
  std::array<double, 2> u_V{};           ///< commands
  std::array<std::uint8_t, 2> limit{};   ///< CommandLimit that acted, a valve
  bool finite = true;                    ///< false: an input or gain gave no finite command; the last ones were kept
  Ppd2GainSet gains;                     ///< in force

  /// v(term, member...) for what is recorded; speed, commands and fault have columns of every run.
  template <class V, class... S> static constexpr void visit(V&& v, S&... s) {
    v(LawTerm{"x_minus_x_ref_m", "m", "x - x_ref as measured"}, s.e_m...);
    v(LawTerm{"observer_x_m", "m", "observer's position, or its error where it runs on that"}, s.x_m...);
    v(LawTerm{"observer_v_mps", "m/s", "the same, velocity"}, s.v_mps...);
    v(LawTerm{"observer_a_mps2", "m/s2", "the same, acceleration"}, s.a_mps2...);
    v(LawTerm{"error_integral_m_s", "m s", "integral of x_ref - x"}, s.I_ms...);
    v(LawTerm{"u_feedback_V", "V", "feedback with its integral, of valve 1"}, s.u_feedback_V...);
    v(LawTerm{"u_feedforward_V", "V", "linear feedforward, of valve 1"}, s.u_feedforward_V...);
    v(LawTerm{"u_bump_V", "V", "what a change of gains left behind, fading"}, s.u_bump_V...);
    v(LawTerm{"u1_unlimited_V", "V", "command of valve 1 before range and rate"}, s.u_unlimited_V[0]...);
    v(LawTerm{"u2_unlimited_V", "V", "command of valve 2 before range and rate"}, s.u_unlimited_V[1]...);
    v(LawTerm{"command_limit_1", "", "bits: 1 at the upper range, 2 the lower, 4 held back rising, 8 falling"},
      s.limit[0]...);
    v(LawTerm{"command_limit_2", "", "the same of valve 2"}, s.limit[1]...);
    v(LawTerm{"position_gain_V_per_m", "V/m", "K_p in force", true}, s.gains.position_gain_V_per_m...);
    v(LawTerm{"velocity_gain_Vs_per_m", "V s/m", "K_v in force", true}, s.gains.velocity_gain_Vs_per_m...);
    v(LawTerm{"acceleration_gain_Vs2_per_m", "V s2/m", "K_a in force", true}, s.gains.acceleration_gain_Vs2_per_m...);
    v(LawTerm{"integral_gain_V_per_m_s", "V/(m s)", "K_i in force", true}, s.gains.integral_gain_V_per_m_s...);
  }
};

/// The controller of docs/physics/ppd2.md.
class Ppd2 {
 public:
  using Parameters = Ppd2Parameters;
  using Terms = Ppd2State;
  static constexpr std::string_view name = "ppd2";
  static constexpr int valves = 2;

  /// A change of gains that the integral cannot take up fades with this time constant.
  static constexpr double bump_time_s = 0.2;
  /// The mean pressure is settled this long after a change.
  static constexpr double settling_s = 2.0;
  /// A measured mean pressure nearer than this to mean_pressure_Pa needs no settling: noise of port sensors.
  static constexpr double mean_pressure_tolerance_Pa = 1000.0;

  Ppd2() noexcept = default;
  /// Cold: takes parameters (in the ranges of their fields), period_s > 0, and resets. Feedforward of order 5 and 7
  /// needs the lag of the lines (line_1.natural_frequency_Hz, damping_ratio). Feedforward `flatness` plans the
  /// reference from 0 to duration_s: that takes as long as FlatnessPlan says, and throws std::invalid_argument where
  /// mean_pressure_Pa does not suffice for it.
  void configure(const Ppd2Parameters& parameters, const AxisParameters<double>& axis, double period_s,
                 const Reference& reference = {}, double duration_s = 0.0);
  void configure(const Ppd2Parameters& parameters, const LawSetup& setup) {
    configure(parameters, setup.axis, setup.period_s, setup.reference, setup.duration_s);
  }
  /// Forgets observer and integral; the commands' rates count from previous_V. HOT.
  void reset(const std::array<double, 2>& previous_V = {}) noexcept;

  /// Commands [V] of one period. Always finite; HOT.
  ControlOutput step(const ControlInput& in) noexcept {
    update(in);
    return {state_.u_V, state_.speed_mps, state_.limit[0] != limit_none || state_.limit[1] != limit_none,
            state_.finite};
  }
  /// A move of the reference is over: learns from it what `learning` names, if anything. Between moves only (ticks
  /// below 0), by a thread of its own where the steps must not wait; `axis` is that of configure. Cold: as long as
  /// FlatnessPlan takes.
  void learn(const AxisParameters<double>& axis);
  bool learns() const noexcept { return learning_ != Learning::none; }
  /// Periods passed without a step (a late loop skipped its slots). HOT.
  void skip(std::int64_t periods) noexcept { periods_ += periods; }
  /// Other gains from the next step on, without a jump of the commands. Values must be those of a valid config. HOT.
  void change_gains(const Ppd2GainSet& gains) noexcept;

  const Ppd2State& state() const noexcept { return state_; }
  const Ppd2State& terms() const noexcept { return state_; }
  Ppd2GainSet gains() const noexcept { return gains_; }
  /// How far ahead of t the second reference point of a step lies [s]: half a period for the hold and the valve's
  /// command delay. 0 where the observer runs on the measured position: that law shifts nothing.
  double lead_s() const noexcept { return lead_s_; }
  /// How long to rest before the reference begins [s]: `moved` says whether a move has been before it.
  double rest_s(bool moved, const std::array<double, 2>& port_Pa) const noexcept;
  /// Moves that taught nothing because the loop was late.
  int moves_not_learned() const noexcept { return flatness_.moves_not_learned(); }
  /// What feedforward and learning know.
  const FlatnessLaw& flatness() const noexcept { return flatness_; }

 private:
  void update(const ControlInput& in) noexcept;
  double total_V(const Ppd2GainSet& gains, const Ppd2State& s, const ControlInput& in,
                 double* feedforward_V) const noexcept;
  void smooth_change(Ppd2State& s, const ControlInput& in) noexcept;
  std::array<double, 2> commands(const ControlInput& in, double across_V) noexcept;

  ObserverInput input_ = ObserverInput::error;
  bool follows_ = false, flat_ = false;
  Learning learning_ = Learning::none;
  double mean_pressure_Pa_ = 0.0;
  std::array<double, 8> inverse_{};  // V s^i/m: what the open loop needs; all zero without feedforward
  Ppd2GainSet gains_, next_gains_;
  bool gains_change_ = false;
  MotionObserver observer_;
  FlatnessLaw flatness_;
  std::array<CommandLimiter, 2> limiter_;
  Ppd2State state_;
  double period_s_ = 2e-4, lead_s_ = 0.0, bump_decay_ = 0.0;
  std::int64_t periods_ = 1;
};

template <> struct LawAt<1> {
  using Law = Ppd2;
};

}  // namespace pneuservo
