// Rows as CSV lines, with the columns that a run has.
#include "record/row_text.hpp"

#include <algorithm>

#include "config/input_error.hpp"
#include "record/number_text.hpp"

namespace pneuservo {

const std::vector<std::string>& row_columns() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    const Row row;
    Row::visit([&](std::string_view name, const auto&) { result.emplace_back(name); }, row);
    return result;
  }();
  return names;
}

RowText::RowText(const std::vector<std::string>& columns) {
  const auto& known = row_columns();
  chosen_.fill(columns.empty());
  chosen_[0] = true;
  for (const std::string& name : columns) {
    const auto at = std::find(known.begin(), known.end(), name);
    if (at == known.end()) throw InputError("recording: there is no column " + name + " to be written");
    chosen_[static_cast<std::size_t>(at - known.begin())] = true;
  }
}

std::string RowText::header_line() const {
  std::string line;
  for (std::size_t i = 0; i < row_column_count; ++i)
    if (chosen_[i]) line.append(i > 0 ? "," : "").append(row_columns()[i]);
  return line += '\n';
}

char* RowText::line(char* text, const Row& row) const noexcept {
  std::size_t i = 0;
  Row::visit(
      [&](std::string_view, const auto& value) {
        if (!chosen_[i++]) return;
        text = number_text(text, value);
        *text++ = ',';
      },
      row);
  text[-1] = '\n';
  return text;
}

}  // namespace pneuservo
