// PPD2 (chapter 2): position, velocity and acceleration feedback from an observer, with feedforward commands.
#pragma once
#include <array>
#include <cstdint>

#include <pneuservo/control/flatness_law.hpp>
#include <pneuservo/control/limits.hpp>
#include <pneuservo/control/linear_servo_table.hpp>
#include <pneuservo/control/motion_observer.hpp>
#include <pneuservo/control/parameters.hpp>
#include <pneuservo/control/reference.hpp>

namespace pneuservo {

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

/// Every term of the law at the last step, as it can be recorded.
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
};

/// What the law sees in a period.
struct Ppd2Input {
  double x_m = 0.0;                   ///< measured position
  std::array<double, 2> port_Pa{};    ///< measured, absolute; for the hold of the mean pressure alone
  ReferencePoint now, ahead;          ///< reference at t and at t + lead_s()
  std::int64_t tick = 0;              ///< periods since the reference's own time 0; negative: on the way to it
};

/// The controller of docs/physics/ppd2.md.
class Ppd2 {
 public:
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
  /// Forgets observer and integral; the commands' rates count from previous_V. HOT.
  void reset(const std::array<double, 2>& previous_V = {}) noexcept;

  /// Commands [V] of one period. Always finite; HOT.
  const std::array<double, 2>& step(const Ppd2Input& in) noexcept;
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
  Ppd2GainSet gains() const noexcept { return gains_; }
  /// How far ahead of t the second reference point of a step lies [s]: half a period for the hold and the valve's
  /// command delay. 0 where the observer runs on the measured position: that law shifts nothing.
  double lead_s() const noexcept { return lead_s_; }
  /// How long to rest before the reference begins [s]: `moved` says whether a move has been before it.
  double rest_s(bool moved, const std::array<double, 2>& port_Pa) const noexcept;
  /// What feedforward and learning know.
  const FlatnessLaw& flatness() const noexcept { return flatness_; }

 private:
  double total_V(const Ppd2GainSet& gains, const Ppd2State& s, const Ppd2Input& in,
                 double* feedforward_V) const noexcept;
  void smooth_change(Ppd2State& s, const Ppd2Input& in) noexcept;
  std::array<double, 2> commands(const Ppd2Input& in, double across_V) noexcept;

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

}  // namespace pneuservo
