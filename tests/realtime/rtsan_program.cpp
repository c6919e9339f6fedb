// Guard program under RealtimeSanitizer: one named step; the runtime ends the process with a report if it is unsafe.
#include <cstdio>

#include "guard_step.hpp"

int main(int argc, char** argv) {
  const char* const name = argc > 1 ? argv[1] : "";
  prepare_step(name);
  if (!guarded_step(name)) return 3;
  std::fprintf(stderr, "nothing caught\n");
  return 0;
}
