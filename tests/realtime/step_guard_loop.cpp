// The whole loop under system call trap, allocation count and fault count; status 1 if anything was caught. With the
// argument "planted" one tick in a thousand allocates: the watch over the whole loop is alive.
#include <cstdio>
#include <memory>
#include <string_view>

#include "loop/realtime.hpp"
#include "step_guard.hpp"
#include "whole_loop.hpp"

using namespace pneuservo;

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
    const std::string violations = report.violations();
    std::fprintf(stderr, "%s: %s\n", one.name.c_str(), violations.empty() ? "nothing caught" : violations.c_str());
    caught += violations.empty() && loop->loop().faults() == 0 ? 0 : 1;
  }
  return caught == 0 ? 0 : 1;
}
