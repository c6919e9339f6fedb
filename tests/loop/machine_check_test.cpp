// Grades of machine and config: planted settings get the expected level, and whatever is not good has a remedy.
#include <filesystem>
#include <fstream>

#include <catch2/catch.hpp>
#include <unistd.h>

#include "can/bus_interface.hpp"
#include "loop/bus_check.hpp"
#include "loop/machine_check.hpp"
#include "loop/rig_grade.hpp"

using namespace pneuservo;
namespace fs = std::filesystem;

namespace {

/// A folder that stands for / with planted files, removed at the end.
struct PlantedRoot {
  fs::path folder = fs::temp_directory_path() / ("pneuservo-root-" + std::to_string(getpid()));
  PlantedRoot() { fs::create_directories(folder); }
  ~PlantedRoot() { fs::remove_all(folder); }
  void plant(const std::string& path, const std::string& text) const {
    fs::create_directories((folder / path).parent_path());
    std::ofstream(folder / path) << text << '\n';
  }
};

const Finding* find(const std::vector<Finding>& findings, const std::string& topic) {
  for (const Finding& finding : findings)
    if (finding.topic == topic) return &finding;
  return nullptr;
}

void require_remedies(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    CAPTURE(finding.topic, finding.what);
    REQUIRE_FALSE(finding.what.empty());
    REQUIRE(finding.remedy.empty() == (finding.level == FindingLevel::good));
  }
}

Rig sound_rig() {
  Rig rig;
  rig.axis.supply.pressure_Pa = 700000;
  rig.axis.valve = {5.0, 2.6e-6, 1.3e-5, 0.35};
  rig.axis.cylinder.stroke_m = 0.3;
  rig.axis.cylinder.area_1_m2 = 1.257e-3;
  rig.axis.cylinder.area_2_m2 = 1.056e-3;
  rig.sensors.position = {5e-6, 0.0};
  rig.sensors.port_pressure = {100.0, 300.0};
  rig.controller.of<PdForce>().position_gain_N_per_m = 8000;
  rig.controller.of<PdForce>().velocity_gain_Ns_per_m = 120;
  rig.controller.of<PdForce>().velocity_filter_s = 0.003;
  rig.controller.of<PdForce>().force_gain_V_per_N = 0.005;
  rig.duration_s = 5;
  return rig;
}

}  // namespace

TEST_CASE("a machine set up for real time is good throughout") {
  const PlantedRoot root;
  root.plant("sys/kernel/realtime", "1");
  root.plant("proc/cpuinfo", "flags : fpu tsc");
  root.plant("proc/swaps", "Filename Type Size Used Priority");
  root.plant("proc/sys/kernel/sched_rt_runtime_us", "-1");
  for (const char* cpu : {"cpu0", "cpu1"}) {
    const std::string folder = std::string("sys/devices/system/cpu/") + cpu;
    root.plant(folder + "/cpufreq/scaling_governor", "performance");
    root.plant(folder + "/cpuidle/state0/latency", "2");
  }
  root.plant("sys/devices/system/cpu/isolated", "1");
  root.plant("sys/devices/system/cpu/smt/active", "0");
  root.plant("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc");
  root.plant("sys/kernel/mm/transparent_hugepage/enabled", "always [madvise] never");
  root.plant("sys/kernel/debug/sched/fair_server/cpu0/runtime", "0");
  const auto findings = check_settings(root.folder, "6.12.0-rt #1 SMP PREEMPT_RT");
  CAPTURE(finding_table(findings));
  REQUIRE(findings.size() == 12);
  REQUIRE(worst_level(findings) == FindingLevel::good);
  require_remedies(findings);
}

TEST_CASE("each unfit setting is named with its remedy") {
  const PlantedRoot root;
  const auto [path, text, topic, level] = GENERATE(table<std::string, std::string, std::string, FindingLevel>({
      {"sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave", "frequency governor",
       FindingLevel::acceptable},
      {"sys/devices/system/cpu/cpu0/cpuidle/state3/latency", "133", "deepest sleep state", FindingLevel::acceptable},
      {"sys/devices/system/cpu/cpu0/online", "1", "processors", FindingLevel::acceptable},
      {"sys/devices/system/cpu/isolated", "", "processor isolation", FindingLevel::acceptable},
      {"sys/devices/system/cpu/smt/active", "1", "hyper-threading", FindingLevel::acceptable},
      {"sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet", "clock source", FindingLevel::bad},
      {"sys/kernel/mm/transparent_hugepage/enabled", "[always] madvise never", "transparent huge pages",
       FindingLevel::acceptable},
      {"proc/sys/kernel/sched_rt_runtime_us", "950000", "real-time throttling", FindingLevel::acceptable},
      {"proc/sys/kernel/sched_rt_runtime_us", "100000", "real-time throttling", FindingLevel::bad},
      {"sys/kernel/debug/sched/fair_server/cpu1/runtime", "50000000", "fair server", FindingLevel::acceptable},
      {"proc/sys/kernel/numa_balancing", "1", "memory balancing", FindingLevel::acceptable},
      {"proc/swaps", "Filename\n/dev/sda2 partition 8 0 -2", "swap", FindingLevel::acceptable},
      {"proc/cpuinfo", "flags : fpu hypervisor", "hardware", FindingLevel::acceptable},
  }));
  root.plant(path, text);
  const auto findings = check_settings(root.folder, "5.0 #1 SMP");
  const Finding* finding = find(findings, topic);
  CAPTURE(topic, finding_table(findings));
  REQUIRE(finding != nullptr);
  REQUIRE(finding->level == level);
  REQUIRE(find(findings, "kernel")->level == FindingLevel::bad);
  require_remedies(findings);
}

TEST_CASE("a fair server that cannot be read is told on kernels that have one") {
  const PlantedRoot root;
  CHECK(find(check_settings(root.folder, "6.11.5 #1 SMP"), "fair server") == nullptr);
  for (const char* release : {"6.12.0", "6.18.44+deb13", "7.0.1"}) {
    const auto findings = check_settings(root.folder, std::string(release) + " #1 SMP");
    CAPTURE(release);
    REQUIRE(find(findings, "fair server") != nullptr);
    require_remedies(findings);
  }
}

TEST_CASE("a number of the kernel that is missing or odd is not known, and the check goes on") {
  const PlantedRoot root;
  const std::string text = GENERATE(as<std::string>{}, "", "<unsupported>", "1e999999");
  const std::string processor = "sys/devices/system/cpu/cpu0";
  for (const std::string& path :
       {std::string("sys/kernel/debug/sched/fair_server/cpu0/runtime"),
        std::string("proc/sys/kernel/sched_rt_runtime_us"), processor + "/cpuidle/state1/latency"})
    root.plant(path, text);
  const auto findings = check_settings(root.folder, "6.12.0 #1 SMP");
  CAPTURE(text, finding_table(findings));
  CHECK(find(findings, "real-time throttling") == nullptr);
  REQUIRE(find(findings, "fair server") != nullptr);
  CHECK_THAT(find(findings, "fair server")->what, Catch::Contains("cannot be read"));
  CHECK(find(findings, "deepest sleep state")->level == FindingLevel::good);
  require_remedies(findings);
}

TEST_CASE("rights are tried, not read: every right has exactly one finding") {
  RealTimeSettings settings;
  settings.cpu = 100'000;
  const auto findings = check_rights(settings);
  REQUIRE(findings.size() == 4);
  REQUIRE(find(findings, "processor")->level == FindingLevel::bad);
  for (const char* topic : {"scheduling policy", "memory lock", "sleep states"})
    REQUIRE(find(findings, topic) != nullptr);
  require_remedies(findings);
}

TEST_CASE("a sound config has no finding that is worse than good") {
  const auto findings = grade_rig(sound_rig());
  CAPTURE(finding_table(findings));
  REQUIRE(worst_level(findings) == FindingLevel::good);
}

TEST_CASE("values of a config that will work badly are named") {
  Rig rig = sound_rig();
  std::string topic;
  FindingLevel level = FindingLevel::bad;
  SECTION("safe output that moves") {
    rig.safe_output.command_V = 1;
    topic = "safe_output.command_V";
    level = FindingLevel::acceptable;
  }
  SECTION("no position gain") {
    rig.controller.of<PdForce>().position_gain_N_per_m = 0;
    topic = "controller.position_gain_N_per_m";
  }
  SECTION("no force gain") {
    rig.controller.of<PdForce>().force_gain_V_per_N = 0;
    topic = "controller.force_gain_V_per_N";
  }
  SECTION("period of 20 us") {
    rig.period_s = 20e-6;
    topic = "period_s";
  }
  SECTION("many estimator steps") {
    rig.estimator.cells_per_m = 100;
    topic = "period_s";
    level = FindingLevel::acceptable;
  }
  SECTION("noise") {
    rig.controller.of<PdForce>().force_gain_V_per_N = 5;
    topic = "sensor noise";
    level = FindingLevel::acceptable;
  }
  const auto findings = grade_rig(rig);
  CAPTURE(finding_table(findings));
  REQUIRE(find(findings, topic) != nullptr);
  REQUIRE(find(findings, topic)->level == level);
  require_remedies(findings);
}

TEST_CASE("the kernel's CAN interface: each planted setting gets its level and a remedy") {
  const BusInterface sound{.is_can = true,
                           .is_up = true,
                           .queue_length = 16,
                           .queue_discipline = "pfifo_fast",
                           .bit_rate_bps = 1'000'000,
                           .restart_ms = 0,
                           .state = 0};
  const auto graded = [](const std::optional<BusInterface>& found) {
    std::vector<Finding> findings = grade_bus_interface("can0", found, 1e6);
    require_remedies(findings);
    return findings;
  };
  CHECK(graded(sound).size() == 5);
  CHECK(worst_level(graded(sound)) == FindingLevel::good);
  CHECK(worst_level(graded(std::nullopt)) == FindingLevel::bad);
  const auto level_with = [&](const auto& change, const std::string& topic) {
    BusInterface changed = sound;
    change(changed);
    const std::vector<Finding> findings = graded(changed);
    const Finding* found = find(findings, topic);
    REQUIRE(found != nullptr);
    return found->level;
  };
  using Level = FindingLevel;
  CHECK(level_with([](BusInterface& b) { b.is_can = false; }, "CAN interface") == Level::bad);
  CHECK(level_with([](BusInterface& b) { b.is_up = false; }, "CAN interface") == Level::bad);
  CHECK(level_with([](BusInterface& b) { b.queue_length = 1000; }, "CAN queue") == Level::acceptable);
  CHECK(level_with([](BusInterface& b) { b.queue_discipline = "tbf"; }, "CAN queue") == Level::acceptable);
  CHECK(level_with([](BusInterface& b) { b.bit_rate_bps = 500'000; }, "CAN bit rate") == Level::bad);
  CHECK(level_with([](BusInterface& b) { b.restart_ms = 100; }, "CAN bus-off") == Level::acceptable);
  CHECK(level_with([](BusInterface& b) { b.state = 2; }, "CAN controller") == Level::acceptable);
  CHECK(level_with([](BusInterface& b) { b.state = 3; }, "CAN controller") == Level::bad);
}

TEST_CASE("the kernel is asked: the loopback interface is there and is no CAN interface") {
  const auto loopback = read_bus_interface("lo");
  REQUIRE(loopback);
  CHECK_FALSE(loopback->is_can);
  CHECK_FALSE(loopback->queue_discipline.empty());
  CHECK_FALSE(read_bus_interface("pneuservo-none"));
}
