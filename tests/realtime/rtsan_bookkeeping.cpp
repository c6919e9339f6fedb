// The bookkeeping of a tick, many times under RealtimeSanitizer: any report or status is a failure.
#include "guard_step.hpp"

int main() {
  for (int i = 0; i < 100'000; ++i)
    if (!guarded_step("clean")) return 3;
  return 0;
}
