// Some rows of a column.
#pragma once
#include <cstddef>
#include <vector>

namespace pneuservo {

/// Leaves the rows of these numbers, which rise.
template <class T> void keep_only(std::vector<T>& values, const std::vector<std::size_t>& kept) {
  for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
  values.resize(kept.size());
}

}  // namespace pneuservo
