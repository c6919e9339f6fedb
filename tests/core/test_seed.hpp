// The seed of a randomised test: PNEUSERVO_TEST_SEED repeats one that failed.
#pragma once
#include <cstdlib>
#include <optional>
#include <random>

namespace pneuservo::test {

inline std::optional<unsigned> stated_seed() {
  const char* stated = std::getenv("PNEUSERVO_TEST_SEED");
  if (stated == nullptr) return std::nullopt;
  return static_cast<unsigned>(std::strtoul(stated, nullptr, 10));
}

/// Another each run; the test shows it with a failure (INFO).
inline unsigned new_seed() {
  const std::optional<unsigned> stated = stated_seed();
  return stated ? *stated : std::random_device{}();
}

}  // namespace pneuservo::test
