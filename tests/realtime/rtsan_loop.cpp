// The whole loop under RealtimeSanitizer: six moves with late ticks, each pressure source, with and without
// feedforward.
#include <cstdio>

#include "whole_loop.hpp"

int main() {
  for (const char* source : {"valve", "chamber", "estimated"})
    for (const bool feedforward : {false, true}) {
      pneuservo::WholeLoop loop(source, feedforward);
      int ticks = 1;
      while (loop.tick()) {
        if (++ticks % 1000 == 0) loop.drain();
      }
      loop.stop();
      std::fprintf(stderr, "%s%s: %d ticks, faults %u\n", source, feedforward ? " with feedforward" : "", ticks,
                   loop.loop().faults());
      if (ticks < 8000 || loop.loop().faults() != 0) return 3;
    }
  return 0;
}
