// Grading the settings of kernel and processors below /proc and /sys.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "loop/machine_check.hpp"

namespace pneuservo {
namespace {

namespace fs = std::filesystem;
using Level = FindingLevel;
using OptionalFinding = std::optional<Finding>;
constexpr const char* processors = "/sys/devices/system/cpu";

/// The first line of a file without its line feed; none if the file cannot be read.
std::optional<std::string> first_line(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  return line;
}

/// The number that a file begins with; none if it cannot be read or begins with something else.
std::optional<double> first_number(const fs::path& path) {
  std::ifstream file(path);
  double number = 0.0;
  if (!(file >> number)) return std::nullopt;
  return number;
}

/// Folders cpu0, cpu1, ... below `root`.
std::vector<fs::path> processor_folders(const std::string& root) {
  std::vector<fs::path> folders;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(root + processors, ignored)) {
    const std::string name = entry.path().filename();
    if (name.size() > 3 && name.rfind("cpu", 0) == 0 && name.find_first_not_of("0123456789", 3) == std::string::npos)
      folders.push_back(entry.path());
  }
  return folders;
}

OptionalFinding check_kernel(const std::string& root, const std::string& version) {
  const bool real_time =
      first_line(root + "/sys/kernel/realtime") == "1" || version.find("PREEMPT_RT") != std::string::npos;
  if (real_time) return Finding{Level::good, "kernel", fmt::format("PREEMPT_RT ({})", version), ""};
  const bool preemptible = version.find("PREEMPT") != std::string::npos;
  return Finding{preemptible ? Level::acceptable : Level::bad, "kernel",
                 fmt::format("not PREEMPT_RT ({}): lateness has no bound", version),
                 "apt-get install linux-image-rt-amd64, then boot that kernel"};
}

OptionalFinding check_governor(const std::string& root) {
  std::set<std::string> governors;
  for (const fs::path& folder : processor_folders(root))
    if (const auto governor = first_line(folder / "cpufreq/scaling_governor")) governors.insert(*governor);
  if (governors.empty())
    return Finding{Level::good, "frequency governor", "none: the frequency is fixed or not ours to set", ""};
  const bool fixed = governors == std::set<std::string>{"performance"};
  return Finding{fixed ? Level::good : Level::acceptable, "frequency governor",
                 fmt::format("{}", fmt::join(governors, ", ")), fixed ? "" : "cpupower frequency-set -g performance"};
}

OptionalFinding check_isolation(const std::string& root) {
  const auto isolated = first_line(root + processors + "/isolated");
  const auto tickless = first_line(root + processors + "/nohz_full");
  const bool has = isolated && isolated->find_first_of("0123456789") != std::string::npos;
  if (has)
    return Finding{Level::good, "processor isolation",
                   fmt::format("isolated {}, without timer tick {}", *isolated, tickless.value_or("none")), ""};
  return Finding{
      Level::acceptable, "processor isolation", "no processor is kept free for the loop",
      "boot with 'isolcpus=managed_irq,domain,N nohz_full=N rcu_nocbs=N irqaffinity=0' and give the loop --cpu N"};
}

OptionalFinding check_throttling(const std::string& root) {
  const auto runtime = first_number(root + "/proc/sys/kernel/sched_rt_runtime_us");
  if (!runtime) return std::nullopt;
  constexpr const char* remedy =
      "echo -1 > /proc/sys/kernel/sched_rt_runtime_us (sysctl kernel.sched_rt_runtime_us=-1)";
  const double period_us = first_number(root + "/proc/sys/kernel/sched_rt_period_us").value_or(1e6);
  const double share = *runtime / period_us;
  if (share < 0) return Finding{Level::good, "real-time throttling", "off", ""};
  return Finding{share < 0.5 ? Level::bad : Level::acceptable, "real-time throttling",
                 fmt::format("a real-time thread that uses more than {:.0f} % of a processor is stopped", 100 * share),
                 remedy};
}

/// "6.12" and later of a text that begins with the release.
bool is_at_least(const std::string& release, int major, int minor) {
  int found_major = 0, found_minor = 0;
  char dot = 0;
  std::istringstream(release) >> found_major >> dot >> found_minor;
  return found_major > major || (found_major == major && found_minor >= minor);
}

// Since 6.12 a server of the scheduler gives ordinary threads 50 ms of a second, whatever sched_rt_runtime_us says.
OptionalFinding check_fair_server(const std::string& root, const std::string& version) {
  const std::string servers = root + "/sys/kernel/debug/sched/fair_server";
  constexpr const char* remedy =
      "as root: for f in /sys/kernel/debug/sched/fair_server/cpu*/runtime; do echo 0 > $f; done";
  double longest_ns = -1;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(servers, ignored))
    if (const auto runtime = first_number(entry.path() / "runtime")) longest_ns = std::max(longest_ns, *runtime);
  if (longest_ns == 0) return Finding{Level::good, "fair server", "off", ""};
  if (longest_ns > 0)
    return Finding{Level::acceptable, "fair server",
                   fmt::format("stops a real-time thread for {:g} ms where ordinary ones wait for its processor",
                               longest_ns * 1e-6),
                   remedy};
  if (!is_at_least(version, 6, 12)) return std::nullopt;
  return Finding{Level::acceptable, "fair server",
                 "cannot be read (root alone may): this kernel stops a real-time thread for 50 ms where ordinary ones "
                 "wait for its processor",
                 remedy};
}

OptionalFinding check_clock(const std::string& root) {
  const auto source = first_line(root + "/sys/devices/system/clocksource/clocksource0/current_clocksource");
  if (!source) return std::nullopt;
  static const std::set<std::string> fast{"tsc", "kvm-clock", "arch_sys_counter"},
      paravirtual{"hyperv_clocksource_tsc_page"};
  if (fast.contains(*source)) return Finding{Level::good, "clock source", *source, ""};
  const bool acceptable = paravirtual.contains(*source);
  return Finding{
      acceptable ? Level::acceptable : Level::bad, "clock source",
      fmt::format("{}: reading the time {}", *source, acceptable ? "is slower than with tsc" : "is a system call"),
      "echo tsc > /sys/devices/system/clocksource/clocksource0/current_clocksource, or boot with 'tsc=reliable'"};
}

OptionalFinding check_hyper_threading(const std::string& root) {
  const auto active = first_line(root + processors + "/smt/active");
  if (!active) return std::nullopt;
  if (*active == "0") return Finding{Level::good, "hyper-threading", "off", ""};
  return Finding{Level::acceptable, "hyper-threading", "on: the sibling thread takes turns with the loop's",
                 "echo off > /sys/devices/system/cpu/smt/control, or switch it off in the firmware"};
}

OptionalFinding check_swap(const std::string& root) {
  std::ifstream file(root + "/proc/swaps");
  if (!file) return std::nullopt;
  std::string line, areas;
  std::getline(file, line);
  while (std::getline(file, line)) areas += (areas.empty() ? "" : ", ") + line.substr(0, line.find_first_of(" \t"));
  if (areas.empty()) return Finding{Level::good, "swap", "none", ""};
  return Finding{Level::acceptable, "swap", fmt::format("{}: harmless only while the memory is locked", areas),
                 "swapoff -a"};
}

/// The longest exit latency of the sleep states that are not disabled on the first processor that has any.
OptionalFinding check_sleep_states(const std::string& root) {
  double longest_us = -1;
  std::string name;
  std::error_code ignored;
  for (const fs::path& folder : processor_folders(root))
    for (const auto& state : fs::directory_iterator(folder / "cpuidle", ignored)) {
      const auto latency_us = first_number(state.path() / "latency");
      if (!latency_us || first_line(state.path() / "disable").value_or("0") != "0") continue;
      if (*latency_us <= longest_us) continue;
      longest_us = *latency_us;
      name = first_line(state.path() / "name").value_or(state.path().filename());
    }
  if (longest_us < 0) return Finding{Level::good, "deepest sleep state", "none that the kernel manages", ""};
  if (longest_us <= 10)
    return Finding{Level::good, "deepest sleep state", fmt::format("{}, {} us to wake", name, longest_us), ""};
  return Finding{Level::acceptable, "deepest sleep state",
                 fmt::format("{}, {} us to wake, unless /dev/cpu_dma_latency holds it off", name, longest_us),
                 "cpupower idle-set -D 10"};
}

OptionalFinding check_huge_pages(const std::string& root) {
  const auto enabled = first_line(root + "/sys/kernel/mm/transparent_hugepage/enabled");
  if (!enabled) return std::nullopt;
  if (enabled->find("[always]") == std::string::npos)
    return Finding{Level::good, "transparent huge pages", "only on request", ""};
  return Finding{Level::acceptable, "transparent huge pages", "always: the kernel moves pages while the loop runs",
                 "echo madvise > /sys/kernel/mm/transparent_hugepage/enabled"};
}

OptionalFinding check_numa_balancing(const std::string& root) {
  const auto balancing = first_line(root + "/proc/sys/kernel/numa_balancing");
  if (!balancing || *balancing == "0") return std::nullopt;
  return Finding{Level::acceptable, "memory balancing", "on: the kernel unmaps pages to see who uses them",
                 "echo 0 > /proc/sys/kernel/numa_balancing"};
}

OptionalFinding check_virtual_machine(const std::string& root) {
  std::ifstream file(root + "/proc/cpuinfo");
  std::ostringstream text;
  text << file.rdbuf();
  if (text.str().find(" hypervisor") == std::string::npos)
    return Finding{Level::good, "hardware", "no virtual machine", ""};
  return Finding{Level::acceptable, "hardware", "a virtual machine: its host may take the processor away at any time",
                 "run the controller on a machine of its own, or pin the virtual processors on the host"};
}

OptionalFinding check_processors(const std::string& root) {
  const std::size_t count = processor_folders(root).size();
  if (count == 0) return std::nullopt;
  if (count > 1) return Finding{Level::good, "processors", fmt::format("{}", count), ""};
  return Finding{Level::acceptable, "processors", "one: the loop shares it with everything else",
                 "use a machine with two processors or more"};
}

}  // namespace

std::vector<Finding> check_settings(const std::string& root, const std::string& kernel_version) {
  std::vector<Finding> findings;
  for (const OptionalFinding& finding :
       {check_kernel(root, kernel_version), check_virtual_machine(root), check_processors(root), check_isolation(root),
        check_governor(root), check_sleep_states(root), check_hyper_threading(root), check_throttling(root),
        check_fair_server(root, kernel_version), check_clock(root), check_swap(root), check_huge_pages(root),
        check_numa_balancing(root)})
    if (finding) findings.push_back(*finding);
  return findings;
}

}  // namespace pneuservo
