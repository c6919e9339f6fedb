// Rows of a run as a recording in memory.
#include "record/row_recording.hpp"

#include <string>
#include <string_view>

#include "record/import.hpp"
#include "record/row_text.hpp"

namespace pneuservo {

namespace {

bool is_recorded(std::string_view column, std::size_t valves) {
  if (column == "u1_V" || column == "u2_V") return valves == 2;
  if (column == "u_V") return valves == 1;
  return column == "t_s" || signal_of_column(column).has_value();
}

}  // namespace

Recording recording_of(const std::vector<Row>& rows, const std::string& rig, double period_s, std::size_t valves) {
  Recording out;
  out.path = "virtual run";
  out.rig = rig;
  out.period_s = period_s;
  for (const std::string& name : row_columns()) {
    if (!is_recorded(name, valves)) continue;
    out.names.push_back(name);
    std::vector<double> column;
    column.reserve(rows.size());
    for (const Row& row : rows)
      Row::visit(
          [&](std::string_view key, const auto& value) {
            if (key == name) column.push_back(static_cast<double>(value));
          },
          row);
    out.values.push_back(std::move(column));
  }
  for (std::size_t i = 0; i < rows.size(); ++i) out.line_numbers.push_back(i + 1);
  return out;
}

}  // namespace pneuservo
