// Whether a channel goes on across some rows as it does elsewhere.
#pragma once
#include <cstddef>
#include <vector>

namespace pneuservo {

/// Whether the steps into these rows are larger than elsewhere: their median is above twice what 99 of 100 other steps
/// stay below. calm: the same values without those that no step elsewhere is taken from or to.
bool jumps_into(const std::vector<std::size_t>& rows, const std::vector<double>& values,
                const std::vector<double>& calm);

}  // namespace pneuservo
