// The pass that all control loops share: read, supervisor, estimator, law, write, row.
#pragma once
#include <array>
#include <cstdint>

#include <pneuservo/control/axis_controller.hpp>
#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/loop/command_desk.hpp>
#include <pneuservo/loop/control_loop.hpp>
#include <pneuservo/loop/supervisor.hpp>

namespace pneuservo {

/// The pass with the parts that every loop has. Loop, which is derived from this, does what is its own in it, in this
/// order: note_inputs, estimate, watch, control (while active), fill_row, end_tick. The pass allocates
/// nothing, locks nothing, throws nothing, and reads no clock of its own: t = tick * period.
template <class Loop> class LoopPass : public ControlLoop {
 public:
  /// One tick on the backend. False: the backend has ended. `now` reads a clock for the stage times (null: none read).
  bool pass(Backend& backend, std::int64_t tick, std::int64_t skipped, StageTimes* times,
            std::int64_t (*now)() noexcept) noexcept PNEUSERVO_NONBLOCKING final {
    const auto stamp = [&](std::int64_t StageTimes::* stage) {
      if (times != nullptr) times->*stage = now();
    };
    Loop& own = static_cast<Loop&>(*this);
    const double t_s = static_cast<double>(tick) * period_s_;
    stamp(&StageTimes::start);
    Measurement measured;
    if (!backend.read(tick, measured)) return false;
    const Truth truth = backend.truth();  // for the row alone, taken at the sampling instant
    stamp(&StageTimes::read);
    if (desk_.is_open()) {
      desk_.take_command(tick, supervisor_, [&own]() noexcept { own.rearm(); });
      supervisor_.allow_motion(own.may_start());
    }
    const JudgedInputs inputs = supervisor_.judge(measured, skipped);
    own.note_inputs(inputs, skipped);
    controller_.skip(skipped);
    const EstimatorOutput estimated = own.estimate(inputs, skipped);
    supervisor_.cross_check(inputs, estimated, skipped);
    own.watch(measured, inputs, estimated, skipped);
    stamp(&StageTimes::estimated);
    std::array<double, 2> command_V = supervisor_.safe_V();
    limited_ = false;
    const bool stepped = supervisor_.is_active();
    if (stepped) command_V = own.control(tick, inputs, estimated, skipped);
    if (!supervisor_.is_active()) command_V = supervisor_.safe_V();
    stamp(&StageTimes::controlled);
    const bool ended = supervisor_.faults() != 0;
    if (!backend.write(tick, {command_V[0], command_V[1], supervisor_.is_active(), ended})) {
      supervisor_.latch(fault_output_missed);
      command_V = supervisor_.safe_V();
      backend.write(tick, {command_V[0], command_V[1], false, true});
    }
    supervisor_.note_commands(command_V);
    if (!supervisor_.is_active()) limited_ = false;
    stamp(&StageTimes::written);
    own.fill_row(t_s, skipped, stepped, measured, truth, estimated);
    own.end_tick(tick, inputs);
    return true;
  }

  /// Safe output now and from now on (end of the run, stop request); the backend's write is tried at once.
  void stop(Backend& backend, std::int64_t tick) noexcept final {
    supervisor_.stop();
    const std::array<double, 2>& safe_V = supervisor_.safe_V();
    supervisor_.note_commands(safe_V);
    backend.write(tick, {safe_V[0], safe_V[1], false, true});
  }

  /// Time that the machine has been suspended so far [ns]; before the pass of a tick. HOT.
  void note_slept(std::int64_t slept_ns) noexcept final { supervisor_.note_slept(slept_ns); }

  void set_command_link(CommandLink* link) noexcept final {
    desk_.set_link(link);
    supervisor_.allow_motion(static_cast<Loop&>(*this).may_start());
  }

  /// The row of the last pass; `lateness_us` and `work_us` are the caller's to fill.
  const Row& row() const noexcept final { return row_; }
  Row& row() noexcept final { return row_; }
  std::uint64_t faults() const noexcept final { return supervisor_.faults(); }
  /// Bits of the tick in which the first fault came: the reason.
  std::uint64_t first_faults() const noexcept final { return supervisor_.first_faults(); }
  const Supervisor& supervisor() const noexcept final { return supervisor_; }
  const AxisController& controller() const noexcept final { return controller_; }
  /// Time at which the reference's own time 0 stands [s from tick 0].
  double reference_start_s() const noexcept final { return reference_start_s_; }
  double period_s() const noexcept { return period_s_; }
  std::size_t size() const noexcept final { return sizeof(Loop); }

 protected:
  static constexpr std::int64_t most_caught_up_periods = 10;  // a late tick must not grow long itself

  /// Those that the law acts on.
  std::array<double, 2> pressures(const JudgedInputs& inputs, const EstimatorOutput& estimate) const noexcept {
    const std::array<double, 2> estimated{estimate.chamber_pressure_Pa[0], estimate.chamber_pressure_Pa[1]};
    switch (source_) {
      case PressureSource::valve: return inputs.port_Pa;
      case PressureSource::chamber: return inputs.chamber_Pa;
      case PressureSource::differential: return inputs.port_less_loss_Pa(estimated);
      case PressureSource::estimated: break;
    }
    return estimated;
  }
  /// Of the last pass, for whoever commands the loop; the row has them as the sensors show them.
  PerSignal<double> told_readings() const noexcept {
    PerSignal<double> told = row_.measured;
    if (supervisor_.sensors().corrects()) supervisor_.sensors().correct(told);
    return told;
  }
  /// Flags of a row that mean the same in every loop.
  std::uint32_t row_flags(std::int64_t skipped) const noexcept {
    return (skipped > 0 ? row_overrun : 0u) | (limited_ ? row_command_limited : 0u) |
           (supervisor_.faults() != 0 ? row_fault : 0u) | (supervisor_.bridged() ? row_input_bridged : 0u);
  }

  double period_s_ = 0.001;
  PressureSource source_ = PressureSource::estimated;
  double command_max_V_ = 5.0;
  Supervisor supervisor_;
  CommandDesk desk_;
  PipelineEstimator estimator_;
  AxisController controller_;
  bool begins_ = true, limited_ = false;
  double reference_start_s_ = 0.0;
  Row row_;
};

}  // namespace pneuservo
