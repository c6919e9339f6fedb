// Real-time session, stop request, fault counters: what is granted is undone, what is refused has a remedy.
#include <csignal>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "loop/realtime.hpp"
#include "loop/realtime_clock.hpp"
#include "loop/realtime_latency.hpp"
#include "loop/realtime_stop.hpp"

using namespace pneuservo;

namespace {

// Sanitizers turn mlockall into nothing and fault on memory of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

void on_other_signal(int) {}

std::size_t processors_allowed() {
  cpu_set_t cpus;
  sched_getaffinity(0, sizeof cpus, &cpus);
  return static_cast<std::size_t>(CPU_COUNT(&cpus));
}

int first_processor_allowed() {
  cpu_set_t cpus;
  sched_getaffinity(0, sizeof cpus, &cpus);
  int cpu = 0;
  while (!CPU_ISSET(cpu, &cpus)) ++cpu;
  return cpu;
}

/// Size of the locked memory of this process [KiB].
long locked_KiB() {
  std::FILE* file = std::fopen("/proc/self/status", "r");
  char line[256];
  long size = -1;
  while (std::fgets(line, sizeof line, file) != nullptr) std::sscanf(line, "VmLck: %ld", &size);
  std::fclose(file);
  return size;
}

}  // namespace

TEST_CASE("a session puts the scheduler, the affinity and the memory back") {
  std::thread([] {
    const std::size_t before = processors_allowed();
    RealTimeSettings settings;
    settings.priority = 12;
    settings.cpu = first_processor_allowed();
    {
      const RealTimeSession session(settings);
      REQUIRE(session.state().cpu == settings.cpu);
      REQUIRE(processors_allowed() == 1);
      if (!sanitized) REQUIRE(session.state().memory_locked == (locked_KiB() > 0));
      if (session.state().priority == 0) WARN("SKIPPED: SCHED_FIFO is not permitted here");
      else {
        sched_param parameters{};
        sched_getparam(0, &parameters);
        REQUIRE((sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO);
        REQUIRE(parameters.sched_priority == 12);
        int policy_of_new_thread = -1;
        std::thread([&] { policy_of_new_thread = sched_getscheduler(0); }).join();
        REQUIRE(policy_of_new_thread == SCHED_OTHER);
      }
    }
    REQUIRE((sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_OTHER);
    REQUIRE(processors_allowed() == before);
    REQUIRE(locked_KiB() == 0);
  }).join();
}

TEST_CASE("what is refused is a finding with a remedy, said once") {
  std::thread([] {
    RealTimeSettings settings;
    settings.priority = 1000;
    settings.cpu = 100'000;
    const RealTimeSession session(settings);
    REQUIRE(session.state().policy == "SCHED_OTHER");
    REQUIRE_FALSE(session.state().cpu);
    REQUIRE(session.findings().size() >= 2);
    for (const Finding& finding : session.findings()) {
      REQUIRE(finding.level != FindingLevel::good);
      REQUIRE_FALSE(finding.what.empty());
      REQUIRE_FALSE(finding.remedy.empty());
    }
    const std::string message = refusal_message(session.findings());
    REQUIRE(message.find("NOT REAL TIME (processor)") != std::string::npos);
    REQUIRE(message.find("remedy: choose a priority from 1 to 99") != std::string::npos);
  }).join();
  REQUIRE(refusal_message({}).empty());
}

TEST_CASE("signals become a flag while a stop request lives") {
  struct sigaction other{}, found{};
  other.sa_handler = on_other_signal;
  sigaction(SIGTERM, &other, nullptr);
  {
    const StopRequest stop(StopSignals::every);
    REQUIRE_FALSE(StopRequest::requested());
    { const StopRequest inner; }  // the outermost one counts
    raise(SIGTERM);
    REQUIRE(StopRequest::requested());
    raise(SIGINT);
    REQUIRE(StopRequest::signal_number() == SIGTERM);
    REQUIRE(StopRequest::signal_name() == "SIGTERM");
    for (const int other_number : {SIGQUIT, SIGTSTP, SIGUSR1, SIGUSR2, SIGALRM, SIGXFSZ, SIGRTMIN + 3})
      raise(other_number);
    REQUIRE(StopRequest::signals() == 8);  // a file that is too large is no wish
  }
  sigaction(SIGTERM, nullptr, &found);
  REQUIRE(found.sa_handler == on_other_signal);
  signal(SIGTERM, SIG_DFL);
  {
    const StopRequest stop;
    REQUIRE_FALSE(StopRequest::requested());
    StopRequest::stop();
    REQUIRE(StopRequest::requested());
    REQUIRE(StopRequest::signal_number() == 0);
  }
}

TEST_CASE("sleeping to an absolute time does not end early, nor by a signal") {
  struct sigaction handler{};
  handler.sa_handler = on_other_signal;
  sigaction(SIGALRM, &handler, nullptr);
  alarm(1);
  const std::int64_t until_ns = MonotonicClock::now_ns() + 1'100'000'000;
  MonotonicClock::sleep_until_ns(until_ns);
  REQUIRE(MonotonicClock::now_ns() >= until_ns);
  signal(SIGALRM, SIG_DFL);
}

TEST_CASE("touched memory faults no more") {
  constexpr std::size_t bytes = std::size_t{256} * 4096;
  auto* memory = static_cast<char*>(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  madvise(memory, bytes, MADV_NOHUGEPAGE);
  memory[5] = 42;
  const ThreadCounters before = ThreadCounters::now();
  prefault(memory, bytes);
  const ThreadCounters between = ThreadCounters::now();
  for (std::size_t i = 0; i < bytes; i += 512) static_cast<volatile char*>(memory)[i + 1] = 1;
  const ThreadCounters after = ThreadCounters::now();
  REQUIRE((between - before).page_faults >= 255);
  if (!sanitized) REQUIRE((after - between).page_faults == 0);
  REQUIRE(memory[5] == 42);
  munmap(memory, bytes);
}

TEST_CASE("the latency measurement serves or skips every slot and stops when asked") {
  LatencySettings settings;
  settings.duration_s = 0.2;
  settings.session.priority = 1;
  const auto result = measure_latency(settings);
  REQUIRE(result->timing.lateness.count() == result->timing.ticks);
  REQUIRE(result->timing.ticks + result->timing.overruns >= 200);
  REQUIRE(result->timing.ticks <= 200);
  if (result->state.memory_locked && !sanitized) REQUIRE(result->timing.page_faults <= 1);
  const StopRequest stop;
  StopRequest::stop();
  REQUIRE(measure_latency(settings)->timing.ticks == 0);
}
