// The engine of the named steps before the first motion.
#include "loop/supervised_steps.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "loop/realtime_clock.hpp"
#include "loop/realtime_stop.hpp"
#include "loop/runner.hpp"

namespace pneuservo {
namespace {

/// Limits that mean something while the encoder's zero is unknown and the wiring unproven.
Rig rig_without_zero(Rig rig) {
  rig.limits.position_margin_m = rig.axis.cylinder.stroke_m;
  rig.limits.flow_mismatch_share = rig.limits.chamber_mismatch_Pa = 0.0;
  rig.sensor_effects = {};  // these steps judge the sensors themselves
  return rig;
}

}  // namespace

SupervisedSteps::SupervisedSteps(const Rig& rig, Backend& backend, std::string name, bool real_time,
                                 std::uint64_t passed_over)
    : rig_(rig), backend_(backend), name_(std::move(name)), real_time_(real_time), passed_over_(passed_over),
      last_resort_(backend, "", rig.period_s) {
  supervisor_.configure(rig_without_zero(rig), false);
  backend.activate();
}

SupervisedSteps::~SupervisedSteps() {
  Command last = safe();
  last.ended = true;
  backend_.write(tick_ + 1, last);
  backend_.deactivate();
}

Command SupervisedSteps::safe() const noexcept {
  const auto safe_V = safe_commands_V(rig_);
  return {safe_V[0], safe_V[1]};
}

Command SupervisedSteps::command(double volts) const noexcept {
  const double closed_V = rig_.safe_output.action == SafeAction::hold ? rig_.safe_output.command_V : 0.0;
  return {closed_V + volts, closed_V - volts, true};
}

void SupervisedSteps::refuse(const std::string& why) const { throw std::runtime_error(name_ + ": " + why); }

void SupervisedSteps::wait_for_slot() {
  if (!backend_.is_paced()) return MonotonicClock::sleep_until_ns(grid_->slot_ns());
  const Pace pace = backend_.await_sample();
  const std::int64_t more = grid_->follow(pace.at_ns, pace.samples);
  skipped_ += more;
  tick_ += more;
}

void SupervisedSteps::run(const std::function<StepAnswer(const StepSample&)>& step) {
  const std::int64_t period_ns = std::llround(rig_.period_s * 1e9);
  if (!grid_) grid_ = std::make_unique<TimeGrid>(MonotonicClock::now_ns() + period_ns, period_ns);
  const std::int64_t first = tick_;
  for (bool done = false; !done; tick_ += 1 + skipped_) {
    if (StopRequest::requested()) refuse("stopped by a signal before its end");
    if (real_time_) wait_for_slot();
    LastResort::note_tick(tick_);
    StepSample sample{.tick = tick_,
                      .skipped = skipped_,
                      .t_s = static_cast<double>(tick_ - first) * rig_.period_s,
                      .raw = {},
                      .in = {}};
    if (!backend_.read(tick_, sample.raw)) refuse("the backend ended");
    sample.in = supervisor_.judge(sample.raw, skipped_);
    const std::uint64_t faults = supervisor_.faults() & ~passed_over_;
    if (faults != 0) refuse(fault_words(faults, faults).front());
    const StepAnswer answer = step(sample);
    done = answer.done;
    supervisor_.note_commands({answer.command.valve_V, answer.command.valve_2_V});
    if (!backend_.write(tick_, answer.command)) refuse("the command could not be written");
    skipped_ = real_time_ && !backend_.is_paced() ? grid_->advance(MonotonicClock::now_ns()) : 0;
  }
}

}  // namespace pneuservo
