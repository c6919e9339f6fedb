// Runs the loop on a backend in simulated or real time.
#include "loop/runner.hpp"

#include <bit>
#include <chrono>
#include <cmath>
#include <iostream>
#include <thread>

#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/loop/grid.hpp>
#include <pneuservo/loop/pressure_loop.hpp>
#include <pneuservo/record/ring.hpp>

#include "loop/fault_watch.hpp"
#include "loop/last_resort.hpp"
#include "loop/realtime_clock.hpp"
#include "loop/realtime_stop.hpp"
#include "record/ordinary_thread.hpp"
#include "record/writer.hpp"

namespace pneuservo {
namespace {

/// Ticks left out of timing and fault counters: the first pass touches code and data for the first time.
constexpr std::int64_t warm_up_ticks = 200;

std::int64_t injected_sleep_ns(const RunSettings& settings, std::int64_t tick) noexcept {
  std::int64_t slept_ns = 0;
  for (const Suspend& suspend : settings.suspends) slept_ns += suspend.tick <= tick ? suspend.slept_ns : 0;
  return slept_ns;
}

/// HOT. After the course has seen the tick.
void note_fault(const RunSettings& settings, const Course& course, const ControlLoop& loop,
                std::int64_t tick) noexcept {
  if (settings.fault_watch != nullptr && course.fault_tick() == tick)
    settings.fault_watch->note(loop.first_faults(), loop.row().t_s);
}

void say_why(const RunSettings& settings, const std::string& why) {
  if (!why.empty() && settings.say) settings.say(why);
}

void run_simulated(const Rig& rig, ControlLoop& loop, Backend& backend, const RunSettings& settings, Course& course,
                   RunOutcome& out) {
  const auto pass = [&](std::int64_t tick, std::int64_t skipped) noexcept {
    const RtScope hot;
    LastResort::note_tick(tick);
    return loop.pass(backend, tick, skipped, nullptr, nullptr);
  };
  std::int64_t tick = 0;
  auto late = settings.late.begin();
  for (; !StopRequest::requested(); ++tick) {
    std::int64_t skipped = 0;
    for (; late != settings.late.end() && late->tick <= tick; ++late) skipped += late->slots;
    tick += skipped;
    out.overruns += skipped;
    loop.note_slept(injected_sleep_ns(settings, tick));
    // Not sooner: commands that come meanwhile replace each other.
    if (loop.pass_due() && tick >= loop.pass_needed_tick()) say_why(settings, loop.make_pass());
    if (!pass(tick, skipped)) {
      out.ended_by_backend = true;
      break;
    }
    ++out.ticks;
    if (settings.writer != nullptr) settings.writer->write(loop.row());
    if (settings.progress && tick % 2048 == 0) settings.progress(course.fraction(tick));
    const bool goes_on = course.after(tick, loop);
    note_fault(settings, course, loop, tick);
    if (!goes_on) break;
    if (loop.learning_due()) loop.learn(rig.axis);
  }
  out.stopped_by_signal = StopRequest::requested();
  loop.stop(backend, tick + 1);
}

// Books one tick's stages; `loop` is what is neither estimator, controller nor backend.
void account(LoopTiming& timing, const StageTimes& stages, std::int64_t lateness_ns, std::int64_t tick) noexcept {
  const std::int64_t backend = (stages.read - stages.start) + (stages.written - stages.controlled);
  const std::int64_t estimator = stages.estimated - stages.read, controller = stages.controlled - stages.estimated;
  const std::int64_t work = stages.end - stages.start;
  timing.lateness.add(lateness_ns);
  timing.work.add(work);
  timing.backend.add(backend);
  timing.estimator.add(estimator);
  timing.controller.add(controller);
  timing.tick.add(work - backend);
  timing.loop.add(work - backend - estimator - controller);
  timing.keep_worst({tick, lateness_ns, work});
  ++timing.ticks;
}

/// By the devices' own clock. Returns how many slots were skipped.
std::int64_t wait_for_sample(Backend& backend, TimeGrid& grid, const ControlLoop& loop, const RecordingRing* ring,
                             const Course& course) noexcept {
  const Pace pace = backend.await_sample();
  warm(&loop, loop.size());
  course.prefetch();
  if (ring != nullptr) ring->prefetch();
  return grid.follow(pace.at_ns, pace.samples);
}

// Waits for the slot; what the tick will touch comes into the cache meanwhile, and the processor is awake.
void wait_for_slot(std::int64_t slot_ns, std::int64_t early_ns, const ControlLoop& loop, const RecordingRing* ring,
                   const Course& course) noexcept {
  MonotonicClock::sleep_until_ns(slot_ns - early_ns);
  warm(&loop, loop.size());
  course.prefetch();
  if (ring != nullptr) ring->prefetch();
  MonotonicClock::spin_until_ns(slot_ns);
}

// One tick of real time: the pass, its row into the ring, the course. False: the run is over.
bool real_tick(ControlLoop& loop, Backend& backend, const RunSettings& settings, Course& course, std::int64_t tick,
               std::int64_t skipped, std::int64_t lateness_ns, std::int64_t last_work_ns, StageTimes& stages) noexcept {
  const RtScope hot;
  LastResort::note_tick(tick);
  if (!loop.pass(backend, tick, skipped, &stages, &MonotonicClock::now_ns)) return false;
  loop.row().lateness_us = static_cast<double>(lateness_ns) * 1e-3;
  loop.row().work_us = static_cast<double>(last_work_ns) * 1e-3;  // of the tick before: this one is not done yet
  if (settings.ring != nullptr) settings.ring->push(loop.row());
  const bool goes_on = course.after(tick, loop);
  note_fault(settings, course, loop, tick);
  stages.end = MonotonicClock::now_ns();
  return goes_on;
}

/// Learns from finished moves, and makes the passes of commanded ones, beside the loop: that is too long for a tick.
/// The reference, or the move, waits for it.
class Learner {
 public:
  Learner(const Rig& rig, ControlLoop& loop, const RunSettings& settings) {
    if (!loop.controller().learns() && !loop.makes_passes()) return;
    thread_ = std::jthread([&rig, &loop, &settings](const std::stop_token& ends) {
      become_ordinary_thread("learning");
      while (!ends.stop_requested()) {
        if (loop.learning_due()) loop.learn(rig.axis);
        if (loop.pass_due()) say_why(settings, loop.make_pass());
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    });
  }

 private:
  std::jthread thread_;
};

/// Devices let go of the loop with each fault: the command `reset` takes them up again.
bool was_reset(const RunSettings& settings, const Backend& backend, const ControlLoop& loop) {
  return settings.commands != nullptr && backend.name() == "configured" &&
         loop.row().command_kind == static_cast<std::uint32_t>(CommandKind::reset);
}

/// Cold, in the middle of a run: the valves have the safe output. What does not come back is missing in the next tick.
void wake_devices(Backend& backend) {
  backend.deactivate();
  try {
    backend.activate();
  } catch (const std::exception& error) { std::cerr << "reset: " << error.what() << "\n"; }
}

/// Slots skipped on the way to the next one; those that devices take to come back do not count.
std::int64_t next_slot(const RunSettings& settings, Backend& backend, const ControlLoop& loop, TimeGrid& grid) {
  const bool is_reset = was_reset(settings, backend, loop);
  if (!is_reset && !backend.is_paced()) return grid.advance(MonotonicClock::now_ns());
  if (is_reset) wake_devices(backend);
  grid.restart(MonotonicClock::now_ns());
  return 0;
}

/// Until the devices showed the safe output. A device that does not show it in so many cycles does not have it.
void await_readback(ControlLoop& loop, Backend& backend, std::int64_t tick, std::int64_t period_ns) {
  constexpr int most_cycles = 5;  // an answer comes a cycle later, or two
  for (int i = 1; i <= most_cycles; ++i) {
    const SafeOutput safe = backend.safe_output();
    if (!safe.is_read_back || safe.is_simulated || safe.confirmed_tick >= 0) return;
    MonotonicClock::sleep_until_ns(MonotonicClock::now_ns() + period_ns);
    Measurement answer;
    backend.read(tick + i, answer);
    loop.stop(backend, tick + i);
  }
}

void run_real(const Rig& rig, ControlLoop& loop, Backend& backend, const RunSettings& settings, Course& course,
              RunOutcome& out) {
  const Learner learner(rig, loop, settings);
  const double period_s = rig.period_s;
  out.timing = std::make_unique<LoopTiming>();
  LoopTiming& timing = *out.timing;
  prefault(&timing, sizeof timing);
  const std::int64_t period_ns = std::llround(period_s * 1e9);
  const double early_s =
      settings.early_wake_s < 0.0 ? RunSettings::usual_early_wake_s(period_s) : settings.early_wake_s;
  const std::int64_t early_ns = std::llround(early_s * 1e9);
  TimeGrid grid(MonotonicClock::now_ns() + period_ns, period_ns);
  ThreadCounters before = ThreadCounters::now();
  std::int64_t skipped = 0, last_work_ns = 0;
  std::int64_t unserved = 0;
  SuspendWatch suspends;
  suspends.slept_ns(MonotonicClock::now_ns());
  auto late = settings.late.begin();
  while (!StopRequest::requested()) {
    for (; late != settings.late.end() && late->tick <= grid.slot(); ++late) {
      MonotonicClock::sleep_until_ns(grid.slot_ns() + (late->slots - 1) * period_ns);
      skipped += 1 + grid.advance(MonotonicClock::now_ns());
      ++unserved;
    }
    if (backend.is_paced()) skipped += wait_for_sample(backend, grid, loop, settings.ring, course);
    else wait_for_slot(grid.slot_ns(), early_ns, loop, settings.ring, course);
    if (out.ticks > warm_up_ticks) timing.overruns += skipped;
    const std::int64_t woken_ns = MonotonicClock::now_ns();
    const std::int64_t tick = grid.slot(), lateness_ns = grid.lateness_ns(woken_ns);
    loop.note_slept(suspends.slept_ns(woken_ns) + injected_sleep_ns(settings, tick));
    StageTimes stages;
    const bool goes_on = real_tick(loop, backend, settings, course, tick, skipped, lateness_ns, last_work_ns, stages);
    out.ended_by_backend = stages.end == 0;
    if (out.ended_by_backend) break;
    last_work_ns = stages.end - stages.start;
    ++out.ticks;
    if (out.ticks > warm_up_ticks) account(timing, stages, lateness_ns, tick);
    if (out.ticks == warm_up_ticks) before = ThreadCounters::now();
    if (!goes_on) break;
    skipped = next_slot(settings, backend, loop, grid);
  }
  const ThreadCounters counted = ThreadCounters::now() - before;
  loop.stop(backend, grid.slot() + 1);
  await_readback(loop, backend, grid.slot() + 1, period_ns);
  timing.page_faults = counted.page_faults;
  timing.context_switches_involuntary = counted.context_switches_involuntary;
  out.stopped_by_signal = StopRequest::requested();
  out.overruns = grid.missed() + unserved;
}

}  // namespace

std::vector<std::string> fault_words(std::uint64_t first, std::uint64_t all) {
  std::vector<std::string> words;
  for (const bool first_round : {true, false})
    for (const FaultText& text : fault_texts)
      if ((all & text.bit) != 0 && ((first & text.bit) != 0) == first_round)
        words.push_back(std::string(text.name) + ": " + std::string(text.meaning));
  return words;
}

std::unique_ptr<ControlLoop> make_control_loop(const Rig& rig, const LoadPositions& load, GainMailbox* gains,
                                               CommandLink* commands) {
  if (rig.controls_pressure()) {
    auto loop = std::make_unique<PressureLoop>();
    loop->configure(rig);
    loop->set_command_link(commands);
    return loop;
  }
  auto loop = std::make_unique<AxisLoop>();
  loop->configure(rig, load);
  loop->set_gain_mailbox(gains);
  loop->set_command_link(commands);
  return loop;
}

RunOutcome run_loop(const Rig& rig, Backend& backend, const RunSettings& settings) {
  RunOutcome out;
  const std::unique_ptr<ControlLoop> made = make_control_loop(rig, settings.load, settings.gains, settings.commands);
  ControlLoop& loop = *made;
  if (settings.learned) loop.begin_with_learned(settings.learned);
  Course course(rig, settings.moves);
  const LastResort last_resort(backend, settings.recording, rig.period_s);
  backend.activate();
  const auto begin = std::chrono::steady_clock::now();
  try {
    if (settings.real_time) run_real(rig, loop, backend, settings, course, out);
    else run_simulated(rig, loop, backend, settings, course, out);
  } catch (...) {  // e.g. no memory for the recording: never without the safe output
    loop.stop(backend, 0);
    backend.deactivate();
    throw;
  }
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  backend.deactivate();
  course.close();
  out.faults = fault_words(loop.first_faults(), loop.faults());
  out.first_faults = static_cast<std::size_t>(std::popcount(loop.first_faults()));
  if (course.fault_tick() >= 0) out.fault_s = static_cast<double>(course.fault_tick()) * rig.period_s;
  out.moves = course.moves();
  out.moves_begun = course.moves_begun();
  // The last move teaches, too, where it came to its end.
  if (const RepeatedMove* move = loop.controller().repeated_move()) {
    if (out.faults.empty() && !out.stopped_by_signal && !out.ended_by_backend) loop.learn(rig.axis);
    out.repeated_move = *move;
  }
  out.moves_not_learned = loop.controller().moves_not_learned();
  out.rows = course.take_rows();
  out.motion_limits = loop.supervisor().motion().limits();
  return out;
}

}  // namespace pneuservo
