// Verb guard: a second process that closes the valve when the loop's sign of life stops.
#include <cerrno>
#include <cmath>
#include <csignal>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "guard/guard_link.hpp"
#include "guard/guard_outputs.hpp"
#include "guard/life_sign.hpp"
#include "loop/realtime.hpp"
#include "loop/realtime_clock.hpp"
#include "loop/realtime_stop.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"

namespace pneuservo {
namespace {

struct GuardOptions {
  std::string config;
  std::vector<std::string> sets;
  int priority = 85;  // above the loop's 80: one that spins must not keep its guard from acting
};

/// One line to standard error, without memory of its own.
template <class... Args> void say(fmt::format_string<Args...> format, Args&&... args) {
  char line[256];
  const auto end = fmt::format_to_n(line, sizeof line - 1, format, std::forward<Args>(args)...);
  line[std::min(end.size, sizeof line - 1)] = '\n';
  const ssize_t said = write(STDERR_FILENO, line, std::min(end.size, sizeof line - 1) + 1);
  (void)said;  // a log that is full must not keep the guard from its work
}

/// Looks at the loop's sign of life, and acts.
class Watch {
 public:
  Watch(LifeSign& sign, GuardOutputs& outputs, double timeout_s)
      : sign_(sign), outputs_(outputs), timeout_ns_(std::llround(timeout_s * 1e9)) {}

  void look(std::int64_t now_ns) {
    sign_.guard_beats.fetch_add(1, std::memory_order_relaxed);
    outputs_.drain();
    const auto order = static_cast<GuardOrder>(sign_.order.load(std::memory_order_acquire));
    if (order != before_) begin(order, now_ns);
    if (order != GuardOrder::watch && now_ns >= next_bus_ns_) {
      outputs_.open_bus();
      next_bus_ns_ = now_ns + 1'000'000'000;
    }
    if (order != GuardOrder::watch) return;
    const std::uint64_t beats = sign_.loop_beats.load(std::memory_order_relaxed);
    if (beats != beats_) alive(beats, now_ns);
    else if (now_ns - seen_ns_ > timeout_ns_) act(now_ns);
  }
  bool is_watching() const noexcept { return before_ == GuardOrder::watch; }

 private:
  void begin(GuardOrder order, std::int64_t now_ns) {
    before_ = order;
    seen_ns_ = now_ns;
    acted_ = false;
    if (order == GuardOrder::watch) {
      say("guard: watches process {}", sign_.loop_process.load());
      return;
    }
    outputs_.enable(false);
    if (order != GuardOrder::make_safe) return;
    // The bus is the loop's own while it lives: its heartbeat stopped, and it records what the axis does.
    const bool done = outputs_.make_board_safe();
    say("guard: process {} ended its motion{}", sign_.loop_process.load(),
        done ? "" : "; the safe output was refused by the board");
  }
  void alive(std::uint64_t beats, std::int64_t now_ns) {
    beats_ = beats;
    seen_ns_ = now_ns;
    if (!acted_) outputs_.enable(true);
  }
  // Again at each look while the loop stands: somebody else may command the output meanwhile.
  void act(std::int64_t now_ns) {
    outputs_.enable(false);
    const bool done = outputs_.make_safe();
    if (!acted_) {
      sign_.tripped = sign_.session.load();
      say("guard: no sign of life of process {} for {:.1f} ms; safe output {}, enable off", sign_.loop_process.load(),
          static_cast<double>(now_ns - seen_ns_) * 1e-6, done ? "sent" : "NOT sent");
    }
    acted_ = true;
    if (kill(sign_.loop_process, 0) == 0 || errno != ESRCH) return;
    say("guard: process {} is gone", sign_.loop_process.load());
    sign_.order = static_cast<std::uint32_t>(GuardOrder::idle);
    before_ = GuardOrder::idle;
  }

  LifeSign& sign_;
  GuardOutputs& outputs_;
  std::int64_t timeout_ns_, seen_ns_ = 0, next_bus_ns_ = 0;
  std::uint64_t beats_ = 0;
  GuardOrder before_ = GuardOrder::idle;
  bool acted_ = false;
};

int run_guard(const GuardOptions& options) {
  const Rig rig = read_rig(options.config, options.sets);
  if (!rig.hal || !rig.hal->guard)
    throw InputError(options.config + ": hal.guard: found nothing, expected the section of the guard (it may be {})");
  LifeSignPage page(rig, LifeSignPage::Side::guard);
  GuardOutputs outputs(rig);
  const double timeout_s = rig.hal->guard->timeout_s;
  Watch watch(page.sign(), outputs, timeout_s);
  const RealTimeSession session({.priority = options.priority, .cpu = std::nullopt});
  std::cerr << refusal_message(session.findings());
  StopRequest stop;
  page.sign().guard_process = getpid();
  for (const std::string& line : outputs.description()) std::cerr << "guard: " << line << "\n";
  if (!outputs.open_bus()) std::cerr << "guard: the bus is not there yet, tried again each second\n";
  std::cerr << fmt::format("guard '{}': acts after {:g} s without a sign of life; Ctrl-C ends\n", page.name(),
                           timeout_s);
  const std::int64_t look_ns = std::llround(timeout_s / GuardLink::looks_a_timeout * 1e9);
  for (std::int64_t next_ns = MonotonicClock::now_ns(); !StopRequest::requested();) {
    watch.look(MonotonicClock::now_ns());
    next_ns = std::max(next_ns + look_ns, MonotonicClock::now_ns());
    MonotonicClock::sleep_until_ns(next_ns);
  }
  if (watch.is_watching()) std::cerr << "guard: ended while a loop runs; it will fault\n";
  return 0;
}

}  // namespace

void add_guard(CommandLine& app, int& status) {
  auto o = std::make_shared<GuardOptions>();
  Verb verb = app.add_verb("guard", "closes the valve when a running loop dies or stops");
  verb.add_option("CONFIG", o->config, "rig with the section hal.guard, the one that run gets").required();
  add_set_option(verb, o->sets);
  verb.add_option("--priority", o->priority, "SCHED_FIFO priority, above the loop's").within(1, 99).shows_default();
  verb.footer("Start it before run; run refuses to start without it and faults when it vanishes.");
  verb.callback([o, &status] { status = run_guard(*o); });
}

}  // namespace pneuservo
