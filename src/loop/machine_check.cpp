// Grading the machine: the rights that a thread gets, and the kernel's limits.
#include "loop/machine_check.hpp"

#include <thread>

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/utsname.h>

namespace pneuservo {
namespace {

std::string limit_text(rlim_t limit, rlim_t unit) {
  return limit == RLIM_INFINITY ? "unlimited" : fmt::format("{}", limit / unit);
}

std::string limits_text() {
  rlimit priority{}, memory{};
  getrlimit(RLIMIT_RTPRIO, &priority);
  getrlimit(RLIMIT_MEMLOCK, &memory);
  return fmt::format("limits rtprio {}, memlock {} KiB", limit_text(priority.rlim_cur, 1), limit_text(memory.rlim_cur, 1024));
}

}  // namespace

std::vector<Finding> check_rights(const RealTimeSettings& settings) {
  std::vector<Finding> findings;
  std::thread([&] {
    const RealTimeSession session(settings);
    const RealTimeState& state = session.state();
    const auto granted = [&](std::string topic, std::string what) {
      findings.push_back({FindingLevel::good, std::move(topic), std::move(what), ""});
    };
    if (state.priority > 0)
      granted("scheduling policy", fmt::format("{} priority {} is granted ({})", state.policy, state.priority, limits_text()));
    if (state.memory_locked) granted("memory lock", "present and future memory can be locked");
    if (state.cpu_latency_held) granted("sleep states", "can be held off (/dev/cpu_dma_latency at 0 us)");
    if (state.cpu) granted("processor", fmt::format("can be pinned to processor {}", *state.cpu));
    findings.insert(findings.end(), session.findings().begin(), session.findings().end());
  }).join();
  return findings;
}

std::vector<Finding> check_machine(const RealTimeSettings& settings) {
  utsname kernel{};
  uname(&kernel);
  std::vector<Finding> findings = check_rights(settings);
  const std::vector<Finding> of_settings = check_settings("", fmt::format("{} {}", kernel.release, kernel.version));
  findings.insert(findings.end(), of_settings.begin(), of_settings.end());
  return findings;
}

}  // namespace pneuservo
