// The whole loop under system call trap, allocation count and fault count; status 1 if anything was caught. With the
// argument "planted" one tick in a thousand allocates: the watch over the whole loop is alive.
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/loop/pressure_loop.hpp>

#include "config/read_rig.hpp"
#include "loop/realtime.hpp"
#include "sim/sim_backend.hpp"
#include "step_guard.hpp"
#include "whole_loop.hpp"

using namespace pneuservo;

namespace {

/// The loop of a pressure rig.
class PressurePasses {
 public:
  explicit PressurePasses(const LoopCase& one)
      : rig_(read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/" + one.config + ".yaml", one.sets)),
        backend_(rig_) {
    loop_.configure(rig_);
    backend_.configure();
    backend_.activate();
  }
  void tick() {
    const RtScope hot;
    loop_.pass(backend_, tick_++, 0, nullptr, nullptr);
  }
  std::uint64_t faults() const noexcept { return loop_.faults(); }

 private:
  Rig rig_;
  SimBackend backend_;
  PressureLoop loop_;
  std::int64_t tick_ = 0;
};

/// A valve whose edges false position inverts, and two on/off valves.
std::vector<LoopCase> pressure_cases() {
  return {{"pressure",
           "pressure-3m-4mm",
           {"effects={valve_dead_band: {width_V: 0.2}, valve_curve: {near_middle: -0.5, wide_open: 0.3}}"}},
          {"pressure by pulses", "pressure-on-off-3m-4mm", {}}};
}

/// Says what was caught; 1 if anything was.
int judge(const std::string& name, const StepGuardReport& report, std::uint64_t faults) {
  const std::string violations = report.violations();
  std::fprintf(stderr, "%s: %s\n", name.c_str(), violations.empty() ? "nothing caught" : violations.c_str());
  return violations.empty() && faults == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): a program that ends so has failed
  const bool planted = argc > 1 && std::string_view(argv[1]) == "planted";
  int caught = 0;
  for (const LoopCase& one : loop_cases()) {
    const auto loop = std::make_unique<WholeLoop>(one);
    const RealTimeSession session;
    int ticks = 0;
    const auto tick = [&] {
      loop->tick();
      if (planted && ++ticks % 1000 == 0) {
        const RtScope hot;
        delete new volatile double(1.0);
      }
    };
    const StepGuardReport report = guard_steps(tick, 200, 7500);
    caught += judge(one.name, report, loop->loop().faults());
  }
  for (const LoopCase& one : pressure_cases()) {
    const auto loop = std::make_unique<PressurePasses>(one);
    const RealTimeSession session;
    const StepGuardReport report = guard_steps([&] { loop->tick(); }, 200, 7500);
    caught += judge(one.name, report, loop->faults());
  }
  return caught == 0 ? 0 : 1;
}
