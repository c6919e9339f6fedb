// The supervisor: judges every input, the devices, the loop's own lateness and the motion; latches the reason, keeps
// the state, and says whether the law may command the valves. The only layer that does so.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <pneuservo/core/rt.hpp>
#include <pneuservo/hal/channel.hpp>
#include <pneuservo/loop/calm_pressures.hpp>
#include <pneuservo/loop/cross_check.hpp>
#include <pneuservo/loop/fault.hpp>
#include <pneuservo/loop/input_guard.hpp>
#include <pneuservo/loop/motion_supervision.hpp>
#include <pneuservo/loop/sensor_correction.hpp>
#include <pneuservo/loop/supervision_health.hpp>
#include <pneuservo/loop/supervisor_state.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// What the loop works with in a tick: readings behind the sensors' known gain and offset, bad samples replaced where
/// that is allowed, NaN before the first good one.
struct JudgedInputs {
  double position_m = 0.0;
  std::array<double, 2> port_Pa{}, chamber_Pa{};  ///< a pressure rig's one port in both
  double supply_Pa = 0.0;  ///< the config's where there is no sensor
  /// Measured along the lines; NaN where there is no sensor or it is at the end of its range.
  std::array<double, 2> loss_Pa{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};

  bool is_beyond_range() const noexcept { return std::isnan(loss_Pa[0]) || std::isnan(loss_Pa[1]); }
  /// Chamber pressures by the ports' and the measured loss, `otherwise` where that is not known.
  std::array<double, 2> port_less_loss_Pa(const std::array<double, 2>& otherwise) const noexcept {
    const auto side = [&](std::size_t i) { return std::isnan(loss_Pa[i]) ? otherwise[i] : port_Pa[i] - loss_Pa[i]; };
    return {side(0), side(1)};
  }
  /// By its own sensor, else by what the line loses; NaN: by neither.
  std::array<double, 2> known_chamber_Pa() const noexcept {
    const auto side = [&](std::size_t i) {
      return std::isnan(chamber_Pa[i]) ? port_Pa[i] - loss_Pa[i] : chamber_Pa[i];
    };
    return {side(0), side(1)};
  }
};

/// What the law did and where the axis shall be, for the checks of the motion.
struct MotionCheck {
  MotionSample motion;
  bool command_good = true;    ///< finite and within the valve's range
  bool estimate_usable = true; ///< or not needed
};

/// One object an axis. Called in this order every tick: judge, cross_check, then (where active) check_motion, then
/// note_commands. All of it but configure is HOT.
class Supervisor {
 public:
  /// An encoder that did not change for so long while the prediction went this share of the stroke is frozen.
  static constexpr double standstill_s = 0.5;
  static constexpr double standstill_share = 0.2;
  /// A channel without any value yet is waited for so long, and for three periods at least.
  static constexpr double first_value_within_s = 0.1;
  static int first_value_ticks(double period_s) noexcept {
    return std::max(3, static_cast<int>(std::lround(first_value_within_s / period_s)));
  }

  /// Cold. `needs_chambers`: the law cannot do without measured chamber pressures.
  void configure(const Rig& rig, bool needs_chambers, const MotionLimits& motion = {});
  /// The one way back from every fault: causes, guards and cross-checks are forgotten.
  void rearm() noexcept;
  void stop() noexcept { go(SupervisorEvent::stop_asked); }

  /// Judges inputs, digital lines, devices and the tick's own lateness (`skipped` slots before it). `measured`: as the
  /// sensors show it; what is known of their gain and offset is taken out here, and nowhere else in a loop.
  JudgedInputs judge(const Measurement& measured, std::int64_t skipped) noexcept PNEUSERVO_NONBLOCKING;
  /// Inputs against the model.
  void cross_check(const JudgedInputs& inputs, const EstimatorOutput& estimate, std::int64_t skipped) noexcept;
  void check_motion(const MotionCheck& motion) noexcept;
  /// What the valves were given in this tick.
  void note_commands(const std::array<double, 2>& command_V) noexcept;
  void latch(std::uint64_t faults) noexcept;
  /// What stands for the encoder in the next tick where the rig has none.
  void tell_position(double position_m) noexcept { told_position_m_ = position_m; }
  /// Whether ready inputs may make the axis active; of an axis that moves they may not.
  void allow_motion(bool allowed) noexcept { may_move_ = allowed; }
  /// It has been active since it was configured.
  bool has_moved() const noexcept { return has_moved_; }
  /// Time that the machine has been suspended so far [ns], before judge.
  void note_slept(std::int64_t slept_ns) noexcept { health_.note_slept(slept_ns); }

  SupervisorState state() const noexcept { return state_; }
  bool is_active() const noexcept { return state_ == SupervisorState::active; }
  std::uint64_t faults() const noexcept { return faults_; }
  /// Bits of the tick in which the first fault came: the reason.
  std::uint64_t first_faults() const noexcept { return first_faults_; }
  /// A sample of this tick was bad and was replaced.
  bool bridged() const noexcept { return bridged_; }
  const std::array<double, 2>& safe_V() const noexcept { return safe_V_; }
  const std::array<double, 2>& command_V() const noexcept { return command_V_; }
  const CrossCheck& checks() const noexcept { return cross_check_; }
  const MotionSupervision& motion() const noexcept { return motion_; }
  const SupervisionHealth& health() const noexcept { return health_; }
  const SensorCorrection& sensors() const noexcept { return sensors_; }

 private:
  void go(SupervisorEvent event) noexcept { state_ = next_state(state_, event); }
  template <class Extra>
  double judge_channel(Signal signal, const Channel& channel, double periods, Extra&& extra, std::uint64_t& faults,
                       bool at_end_stop = false) noexcept;
  std::uint64_t doubt(Signal signal) noexcept;
  JudgedInputs judge_corrected(const Measurement& measured, std::int64_t skipped) noexcept;
  std::uint64_t judge_position(const Channel& position, double periods, JudgedInputs& in) noexcept;
  std::uint64_t judge_pressures(const Measurement& measured, double periods, JudgedInputs& in) noexcept;
  std::uint64_t judge_losses(const Measurement& measured, double periods, JudgedInputs& in) noexcept;
  std::uint64_t judge_supply(const Channel& supply, double periods, JudgedInputs& in) noexcept;
  std::uint64_t judge_digital(const DigitalInputs& digital) noexcept;
  double chamber_step_Pa(double dead_volume_m3, double area_m2, double way_m) const noexcept;
  bool inputs_ready() const noexcept;
  PerSignal<bool> bad_samples() const noexcept;

  SupervisorState state_ = SupervisorState::unconfigured;
  std::uint64_t faults_ = 0, first_faults_ = 0;
  bool has_slider_ = true, needs_chambers_ = false, bridged_ = false, all_good_ = false, may_move_ = true,
       has_moved_ = false, on_bus_ = false, has_losses_ = false, needs_losses_ = false, is_told_position_ = false;
  SensorCorrection sensors_;
  PerSignal<InputGuard> guards_;
  CalmPressures calm_;
  PerSignal<bool> judged_;  ///< there is a sensor, or the law cannot do without it
  std::array<LineState, 2> limits_{};
  CrossCheck cross_check_;
  MotionSupervision motion_;
  SupervisionHealth health_;
  CylinderParameters<double> cylinder_;
  std::array<double, 2> safe_V_{}, command_V_{};
  double period_s_ = 1e-3, position_limit_m_ = 0.155, half_stroke_m_ = 0.15, pressure_limit_Pa_ = 1e6, supply_Pa_ = 7e5,
         supply_limit_Pa_ = 0.0, lateness_limit_s_ = 0.1;
  double loss_range_Pa_ = 0.0, told_position_m_ = 0.0;
  double port_step_Pa_per_V_ = 0.0;  // of the narrower line: what a change of command does to a port at once
  double fill_step_Pa_m3_ = 0.0;  // largest flow into a chamber over a period: its volume times the step
  double activity_V_ = 0.0, activity_decay_ = 0.0;
  double standstill_predicted_m_ = 0.0;
};

}  // namespace pneuservo
