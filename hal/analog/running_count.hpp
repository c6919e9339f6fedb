// The count of an incremental encoder since the start, from a counter that runs past its end.
#pragma once
#include <cstdint>

namespace pneuservo {

/// What passed between two readings is taken as the shorter way round: right while it is less than half of all counts.
class RunningCount {
 public:
  /// `last`: largest reading, after which 0 comes. The first reading gives 0.
  std::int64_t advance(std::uint32_t reading, std::uint32_t last) noexcept {
    const std::int64_t whole = std::int64_t{last} + 1;
    std::int64_t step = has_begun_ ? std::int64_t{reading} - std::int64_t{previous_} : 0;
    if (step > whole / 2) step -= whole;
    else if (step < -whole / 2) step += whole;
    has_begun_ = true;
    previous_ = reading;
    return total_ += step;
  }

 private:
  bool has_begun_ = false;
  std::uint32_t previous_ = 0;
  std::int64_t total_ = 0;
};

}  // namespace pneuservo
