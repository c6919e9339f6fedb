// Channels of several axes in one table, told apart by their names.
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace pneuservo {

/// What a column's name says of its axis.
struct AxisOfColumn {
  bool is_of_axis = false;
  std::string axis;  ///< the word or number by which its name differs from those of other axes; may be empty
  std::string name;  ///< its name without that
};

/// Names that are equal but for one word or number are the same channel of several axes, where positions or commands
/// and another signal differ so by the same words. Set points, models and names of the recording format tell no axes;
/// whether the words are sides of one is asked of loses_by_sides(). meaning: the column of the recording format that a
/// column would be under another name; empty: none. One a column; none is of an axis where there is one axis alone.
std::vector<AxisOfColumn> axes_in(const std::vector<std::string>& names,
                                  const std::function<std::string(std::size_t, const std::string&)>& meaning);

}  // namespace pneuservo
