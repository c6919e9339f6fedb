// A thread in real time: memory, scheduler, affinity and sleep states, each granted or refused with a remedy.
#include "loop/realtime.hpp"

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "loop/realtime_clock.hpp"

namespace pneuservo {
namespace {

constexpr const char* login_remedy =
    "add to /etc/security/limits.d/pneuservo.conf: '@realtime - rtprio 98' and '@realtime - memlock unlimited', then "
    "'groupadd -f realtime; usermod -aG realtime USER' and log in again; or 'setcap cap_sys_nice,cap_ipc_lock+ep' on "
    "the program";
constexpr const char* container_remedy =
    "in a container: docker run --cap-add SYS_NICE --cap-add IPC_LOCK --ulimit rtprio=98 --ulimit memlock=-1 (podman "
    "has the same options)";
constexpr const char* service_remedy =
    "in a service of systemd: LimitRTPRIO=98 and LimitMEMLOCK=infinity below [Service], then 'systemctl daemon-reload'";
constexpr const char* group_remedy =
    "the right is there, but this control group has no real-time share (CONFIG_RT_GROUP_SCHED): echo 950000 > "
    "/sys/fs/cgroup/cpu/GROUP/cpu.rt_runtime_us in it and in those above it, or boot with 'rt_group_sched=0' or a "
    "kernel without that option";
constexpr int capability_ipc_lock = 14, capability_sys_nice = 23;  // linux/capability.h

bool has_capability(int number) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("CapEff:", 0) == 0) return (std::stoull(line.substr(7), nullptr, 16) >> number & 1U) != 0;
  return false;
}

/// Limits of a login are read by no container and no service: each has its own way to the right.
std::string rights_remedy() {
  const auto is_there = [](const char* path) { return access(path, F_OK) == 0; };
  if (is_there("/.dockerenv") || is_there("/run/.containerenv") || getenv("container") != nullptr)
    return container_remedy;
  return getenv("INVOCATION_ID") != nullptr ? fmt::format("{}; at a login: {}", service_remedy, login_remedy)
                                            : login_remedy;
}

// With MCL_FUTURE and a finite limit a later mmap (a thread's stack) would fail in the middle of the run.
bool may_lock_future_memory() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  return limit.rlim_cur == RLIM_INFINITY || has_capability(capability_ipc_lock);
}

}  // namespace

bool kernel_is_preempt_rt() {
  int flag = 0;
  if (std::ifstream("/sys/kernel/realtime") >> flag) return flag == 1;
  utsname name{};
  uname(&name);
  return std::strstr(name.version, "PREEMPT_RT") != nullptr;
}

RealTimeSession::RealTimeSession(const RealTimeSettings& settings) {
  utsname name{};
  uname(&name);
  state_.kernel = name.release;
  state_.preempt_rt = kernel_is_preempt_rt();
  previous_policy_ = sched_getscheduler(0);
  sched_getparam(0, &previous_parameters_);
  sched_getaffinity(0, sizeof previous_cpus_, &previous_cpus_);
  previous_timer_slack_ns_ = static_cast<unsigned long>(prctl(PR_GET_TIMERSLACK));
  keep_heap();
  lock_memory();
  prefault_stack(settings.stack_bytes);
  hold_cpu_latency();
  if (settings.cpu) pin(*settings.cpu);
  raise_priority(settings.priority);
}

RealTimeSession::~RealTimeSession() {
  if (state_.policy == "SCHED_FIFO" && sched_setscheduler(0, previous_policy_, &previous_parameters_) != 0)
    sched_setscheduler(0, previous_policy_ | SCHED_RESET_ON_FORK, &previous_parameters_);  // without CAP_SYS_NICE
  prctl(PR_SET_TIMERSLACK, previous_timer_slack_ns_);
  if (state_.cpu) sched_setaffinity(0, sizeof previous_cpus_, &previous_cpus_);
  if (latency_file_ >= 0) close(latency_file_);
  if (state_.memory_locked) munlockall();
  mallopt(M_TRIM_THRESHOLD, 128 * 1024);  // glibc's defaults: what was set before cannot be read
  mallopt(M_MMAP_MAX, 65536);
}

void RealTimeSession::refuse(FindingLevel level, std::string topic, std::string what, std::string remedy) {
  findings_.push_back({level, std::move(topic), std::move(what), std::move(remedy)});
}

void RealTimeSession::keep_heap() {
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
}

void RealTimeSession::lock_memory() {
  if (!may_lock_future_memory()) {
    rlimit limit{};
    getrlimit(RLIMIT_MEMLOCK, &limit);
    refuse(
        FindingLevel::bad, "memory lock",
        fmt::format("memory is not locked: the limit memlock is {} KiB, a page fault may stop a tick for milliseconds",
                    limit.rlim_cur / 1024),
        rights_remedy());
    return;
  }
  state_.memory_locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!state_.memory_locked)
    refuse(FindingLevel::bad, "memory lock", fmt::format("memory is not locked: mlockall: {}", std::strerror(errno)),
           rights_remedy());
}

void RealTimeSession::hold_cpu_latency() {
  constexpr const char* path = "/dev/cpu_dma_latency";
  const std::int32_t latency_us = 0;
  latency_file_ = open(path, O_WRONLY | O_CLOEXEC);
  state_.cpu_latency_held =
      latency_file_ >= 0 && write(latency_file_, &latency_us, sizeof latency_us) == sizeof latency_us;
  if (!state_.cpu_latency_held)
    refuse(FindingLevel::acceptable, "sleep states",
           fmt::format("processor sleep states stay on: {}: {}", path, std::strerror(errno)),
           "echo 'KERNEL==\"cpu_dma_latency\", GROUP=\"realtime\", MODE=\"0660\"' > "
           "/etc/udev/rules.d/99-cpu-dma-latency.rules; udevadm trigger");
}

void RealTimeSession::pin(int cpu) {
  cpu_set_t one;
  CPU_ZERO(&one);
  if (cpu >= 0 && cpu < CPU_SETSIZE) CPU_SET(static_cast<std::size_t>(cpu), &one);
  if (sched_setaffinity(0, sizeof one, &one) == 0) state_.cpu = cpu;
  else
    refuse(FindingLevel::bad, "processor",
           fmt::format("the loop is not pinned to processor {}: {}", cpu, std::strerror(errno)),
           fmt::format("choose one of the processors that 'taskset -cp $$' lists (this machine has 0..{})",
                       sysconf(_SC_NPROCESSORS_ONLN) - 1));
}

// Threads that the program starts later do not inherit the policy (SCHED_RESET_ON_FORK). Where FIFO is refused the
// timer slack of 50 us at least goes.
void RealTimeSession::raise_priority(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const bool granted = sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) == 0;
  const int error = errno;
  state_.policy = granted ? "SCHED_FIFO" : "SCHED_OTHER";
  state_.priority = granted ? priority : 0;
  prctl(PR_SET_TIMERSLACK, 1UL);
  if (!granted)
    refuse(FindingLevel::bad, "scheduling policy",
           fmt::format("SCHED_FIFO priority {} was refused: {}; any other program may delay the loop", priority,
                       std::strerror(error)),
           error == EINVAL                       ? "choose a priority from 1 to 99"
           : has_capability(capability_sys_nice) ? group_remedy
                                                 : rights_remedy());
}

std::string refusal_message(const std::vector<Finding>& findings) {
  std::string message;
  for (const Finding& finding : findings)
    message += fmt::format("pneuservo: NOT REAL TIME ({}): {}\n           remedy: {}\n", finding.topic, finding.what,
                           finding.remedy);
  return message;
}

}  // namespace pneuservo
