// Guard program: runs one named step under system call trap, allocation count and fault count; status 1 if caught.
#include <cstdio>
#include <memory>

#include "guard_step.hpp"
#include "loop/realtime.hpp"
#include "step_guard.hpp"

using namespace pneuservo;

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): a program that ends so has failed
  const std::string_view name = argc > 1 ? argv[1] : "";
  prepare_step(name);
  // Fresh pages must stay fresh: with all memory locked the kernel would have filled them.
  const bool warm = name == "clean";
  const auto session = warm ? std::make_unique<RealTimeSession>() : nullptr;
  bool known = true;
  const StepGuardReport report = guard_steps([&] { known = guarded_step(name); }, warm ? 10 : 0, warm ? 5000 : 1);
  if (!known) {
    std::fprintf(stderr, "unknown or failed step\n");
    return 3;
  }
  const std::string violations = report.violations();
  std::fprintf(stderr, "%s\n", violations.empty() ? "nothing caught" : violations.c_str());
  return violations.empty() ? 0 : 1;
}
