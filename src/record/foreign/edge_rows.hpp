// Lines above and below the rows of a table that look like rows and are none.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "record/table.hpp"

namespace pneuservo {

/// Rows whose every number is written with other decimals than nearly all rows: before the first row or behind the last
/// they are no rows but limits, averages, channel numbers or factors.
class EdgeRows {
 public:
  void add(std::size_t row);
  /// Takes them out of the table and tells of them; the number of rows taken at the front. Throws InputError where they
  /// look like factors.
  std::size_t leave_out(CsvTable& table) const;

 private:
  std::vector<std::size_t> rows_;  ///< in order
};

/// Throws InputError: nothing says whether values are before or behind the factors that the line states.
[[noreturn]] void refuse_factors(const std::string& path, std::size_t line);

}  // namespace pneuservo
