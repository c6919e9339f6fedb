// The one pass of the control loop, the same in simulated time, real time and replay.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/loop/approach.hpp>
#include <pneuservo/loop/encoderless_position.hpp>
#include <pneuservo/loop/gain_mailbox.hpp>
#include <pneuservo/loop/loop_pass.hpp>
#include <pneuservo/loop/motion_twin.hpp>
#include <pneuservo/loop/move_passes.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

class MovePassMaker;

/// What the estimator must know, from the rig; its uncertainty from sensors and tolerances.
EstimatorParameters estimator_parameters(const Rig& rig);

/// read -> supervisor -> estimator -> reference -> controller -> write -> row (loop_pass.hpp).
///
/// The first motion approaches the reference's first value from the measured position with a smooth move (degree 9: as
/// many derivatives are continuous as any law feeds forward) and rests there as long as the law asks for; where the
/// axis is already there (within approach_tolerance_m, and within 100 quanta of its encoder) it starts at once. A fault
/// is latched: from its tick on the valve gets the safe output, until rearm() starts anew from the measured position
/// with estimator and integral reset.
class AxisLoop final : public LoopPass<AxisLoop> {
 public:
  static constexpr double approach_tolerance_m = 5e-4;
  static constexpr double approach_quanta = 100.0;
  /// Standing for so long, by less than the jitter of the encoder, is rest.
  static constexpr double rest_before_motion_s = 0.1;
  /// Longest approach with its rest, over the whole stroke [s].
  static double longest_approach_s(double stroke_m) noexcept {
    return Approach::shortest_s + Approach::peak_over_mean * stroke_m / Approach::speed_mps + Ppd2::settling_s;
  }

  /// Cold: builds estimator, controller and reference from the rig; allocates, may throw std::invalid_argument.
  void configure(const Rig& rig, const LoadPositions& load = {});
  AxisLoop();
  ~AxisLoop() override;

  /// Begins a motion at the next tick: approach from wherever the axis is, then the reference from its time 0. Leads
  /// back from every fault: integral and estimator start anew, the latched faults are cleared.
  void rearm() noexcept;
  /// The reference once more from its time 0 (after an approach), everything else goes on.
  void restart_reference() noexcept override {
    begins_ = moved_ = true;
    learning_due_.store(controller_.learns(), std::memory_order_release);
  }
  /// A finished move waits to be learned from; the reference does not begin before that is done.
  bool learning_due() const noexcept override { return learning_due_.load(std::memory_order_acquire); }
  /// Learns from the finished move (`axis`: the rig's of configure); by one thread only, beside passes if need be: they
  /// keep away from what it works on. Cold.
  void learn(const AxisParameters<double>& axis) override {
    controller_.learn(axis);
    learning_due_.store(false, std::memory_order_release);
  }

  bool makes_passes() const noexcept override { return pass_maker_ != nullptr; }
  bool pass_due() const noexcept override { return move_passes_.is_due(); }
  std::string make_pass() override;
  std::int64_t pass_needed_tick() const noexcept override { return desk_.motion().planned().begin_tick; }

  void begin_with_learned(const LoadLearned& learned) override {
    if (const RepeatedMove* move = controller_.repeated_move()) controller_.begin_with_learned(learned(*move));
  }

  /// Where gains for the running loop come from; null: nowhere. Before the first pass.
  void set_gain_mailbox(GainMailbox* mailbox) noexcept { gain_mailbox_ = mailbox; }

  const Reference& reference() const noexcept { return reference_; }

 private:
  friend class LoopPass<AxisLoop>;

  void note_inputs(const JudgedInputs& inputs, std::int64_t skipped) noexcept {
    if (!supervisor_.is_active()) note_rest(inputs, skipped);
  }
  void watch(const Measurement& measured, const JudgedInputs& inputs, const EstimatorOutput& estimate,
             std::int64_t skipped) noexcept {
    if (encoderless_.is_on()) [[unlikely]]
      watch_position(measured.digital, inputs, estimate, skipped);
  }
  void watch_position(const DigitalInputs& digital, const JudgedInputs& inputs, const EstimatorOutput& estimate,
                      std::int64_t skipped) noexcept;
  void end_tick(std::int64_t tick, const JudgedInputs& inputs) noexcept {
    if (supervisor_.is_active()) twin_.step(control_in_, inputs.supply_Pa, supervisor_.motion().most_command_V());
    if (desk_.is_open()) tell_status(tick);
  }
  void plan_motion(double t_s, const JudgedInputs& inputs) noexcept;
  ReferencePoint reference_at(double t_s) const noexcept;
  bool may_start() const noexcept {
    return desk_.enabled() && (!may_move_still_ || stood_s_ >= rest_before_motion_s) &&
           (!encoderless_.is_on() || encoderless_.is_settled());
  }
  void set_points(double t_s, std::int64_t tick, const JudgedInputs& inputs) noexcept;
  void tell_status(std::int64_t tick) noexcept;
  void follow_passes(std::int64_t tick) noexcept;
  void configure_desk(const Rig& rig);
  std::array<double, 2> control(std::int64_t tick, const JudgedInputs& inputs, const EstimatorOutput& estimate,
                                std::int64_t skipped) noexcept;
  void fill_row(double t_s, std::int64_t skipped, bool stepped, const Measurement& measured, const Truth& truth,
                const EstimatorOutput& estimate) noexcept;
  EstimatorOutput estimate(const JudgedInputs& inputs, std::int64_t skipped) noexcept;
  void note_rest(const JudgedInputs& inputs, std::int64_t skipped) noexcept;
  MotionSample motion_sample(const ControlInput& in, std::int64_t skipped) const noexcept;

  std::size_t valves_ = 1;
  MotionTwin twin_;
  Reference reference_;

  std::unique_ptr<MovePassMaker> pass_maker_;  // null: moves at run time have no pass
  MovePasses move_passes_;
  std::uint64_t planned_ = 0;  // the plan that was seen last
  bool waits_for_pass_ = false, follows_pass_ = false, pass_begins_ = false;
  std::atomic<bool> learning_due_{false};
  GainMailbox* gain_mailbox_ = nullptr;
  bool moved_ = false, twin_waits_ = true;
  ControlInput control_in_;
  double stood_at_m_ = std::numeric_limits<double>::quiet_NaN(), stood_s_ = 0.0;
  bool may_move_still_ = false;
  double area_1_m2_ = 0.0, area_2_m2_ = 0.0, atmosphere_force_N_ = 0.0;
  double tolerance_m_ = approach_tolerance_m;
  Approach approach_;
  double velocity_mps_ = 0.0;
  ReferencePoint now_{};
  EncoderlessPosition encoderless_;
  double encoderless_x_m_ = 0.0, encoderless_bound_m_ = 0.0;  // of this tick; encoderless_ is ahead
};

}  // namespace pneuservo
