// Rows as CSV lines, with the columns that a run has.
#include "record/row_text.hpp"

#include <algorithm>

#include "config/input_error.hpp"
#include "record/number_text.hpp"

namespace pneuservo {

std::vector<std::string> row_columns(std::span<const std::string_view> terms) {
  std::vector<std::string> names;
  Row::visit_all(terms, [&](std::string_view name) { names.emplace_back(name); });
  return names;
}

std::vector<std::string> columns_of_the_format() {
  std::vector<std::string> names = row_columns();
  names.emplace_back("F_N");
  return names;
}

RowText::RowText(const std::vector<std::string>& columns, std::span<const std::string_view> terms)
    : names_(row_columns(terms)), terms_(terms) {
  chosen_.fill(columns.empty());
  chosen_[0] = true;
  for (const std::string& name : columns) {
    const auto at = std::find(names_.begin(), names_.end(), name);
    if (at == names_.end()) throw InputError("recording: there is no column " + name + " to be written");
    chosen_[static_cast<std::size_t>(at - names_.begin())] = true;
  }
}

std::string RowText::header_line() const {
  std::string line;
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (chosen_[i]) line.append(i > 0 ? "," : "").append(names_[i]);
  return line += '\n';
}

char* RowText::line(char* text, const Row& row) const noexcept {
  std::size_t i = 0;
  Row::visit_all(
      terms_,
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
