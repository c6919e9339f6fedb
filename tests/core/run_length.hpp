// What a test tagged [long] takes by day, and what under PNEUSERVO_LONG=1.
#pragma once
#include <cstdlib>
#include <initializer_list>
#include <vector>

namespace pneuservo::test {

inline bool is_long_run() { return std::getenv("PNEUSERVO_LONG") != nullptr; }

/// The values of the short form, and in the long run the further ones as well.
template <class T>
std::vector<T> and_in_the_long_run(std::initializer_list<T> values, std::initializer_list<T> further) {
  std::vector<T> out(values);
  if (is_long_run()) out.insert(out.end(), further);
  return out;
}

}  // namespace pneuservo::test
