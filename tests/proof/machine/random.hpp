// Random numbers of the machine: PCG32 (O'Neill 2014), normal ones by the polar method.
#pragma once

#include <cmath>
#include <cstdint>

namespace proof {

class Random {
 public:
  explicit Random(std::uint64_t seed) {
    bits();
    state_ += seed;
    bits();
  }

  std::uint32_t bits() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + 1442695040888963407ULL;
    const auto word = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto turn = static_cast<std::uint32_t>(old >> 59U);
    return (word >> turn) | (word << ((32U - turn) & 31U));
  }

  double uniform() { return (bits() + 0.5) / 4294967296.0; }

  double normal() {
    if (kept_) {
      kept_ = false;
      return spare_;
    }
    double a = 0, b = 0, s = 0;
    do {
      a = 2.0 * uniform() - 1.0;
      b = 2.0 * uniform() - 1.0;
      s = a * a + b * b;
    } while (s >= 1.0 || s == 0.0);
    const double f = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = b * f;
    kept_ = true;
    return a * f;
  }

 private:
  std::uint64_t state_ = 0;
  double spare_ = 0;
  bool kept_ = false;
};

}  // namespace proof
