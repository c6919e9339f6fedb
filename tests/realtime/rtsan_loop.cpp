// The whole loop under RealtimeSanitizer: six moves with late ticks of each case.
#include <cstdio>

#include "whole_loop.hpp"

int main() {
  for (const pneuservo::LoopCase& one : pneuservo::loop_cases()) {
    pneuservo::WholeLoop loop(one);
    int ticks = 1;
    while (loop.tick()) {
      if (++ticks % 1000 == 0) loop.drain();
    }
    loop.stop();
    std::fprintf(stderr, "%s: %d ticks, faults %#llx\n", one.name.c_str(), ticks,
                 static_cast<unsigned long long>(loop.loop().faults()));
    if (ticks < 8000 || loop.loop().faults() != 0) return 3;
  }
  return 0;
}
