// A CSV table with comment header as it stands in a file, of our own format or foreign; nothing is hidden.
#include "record/table.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/input_error.hpp"
#include "record/foreign/names_text.hpp"

namespace pneuservo {

std::string_view name_of(ProblemKind kind) {
  static constexpr std::array<std::string_view, 12> names = {
      "header",  "dialect", "interval",      "field_count",     "not_a_number", "unreadable_field",
      "no_time", "gap",     "repeated_time", "decreasing_time", "truncated",    "damaged"};
  return names[static_cast<std::size_t>(kind)];
}

bool CsvTable::has(std::string_view name) const { return std::find(names.begin(), names.end(), name) != names.end(); }

const std::vector<double>& CsvTable::column(std::string_view name) const {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) require({std::string(name)});
  return values[static_cast<std::size_t>(at - names.begin())];
}

std::vector<double>& CsvTable::column(std::string_view name) {
  return const_cast<std::vector<double>&>(std::as_const(*this).column(name));
}

void CsvTable::keep_columns(const std::function<bool(const std::string&)>& is_kept) {
  const auto erase_at = [](auto& of, std::size_t at) {
    if (at < of.size()) of.erase(of.begin() + static_cast<std::ptrdiff_t>(at));
  };
  for (std::size_t c = names.size(); c-- > 0;) {
    if (is_kept(names[c])) continue;
    left_out.push_back(names[c]);
    erase_at(values, c);
    erase_at(units, c);
    erase_at(is_clock, c);
    erase_at(names, c);
  }
}

void CsvTable::require(const std::vector<std::string>& columns) const {
  std::vector<std::string> missing;
  for (const std::string& name : columns)
    if (!has(name)) missing.push_back(name);
  if (missing.empty()) return;
  missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
  std::vector<std::string> found = names;
  found.insert(found.end(), left_out.begin(), left_out.end());
  const char* remedy = header["format"] ? "" : "; `pneuservo import` proposes an import section for other names";
  throw InputError(fmt::format("{}: column{} {} {} missing; found {}{}", path, missing.size() > 1 ? "s" : "",
                               fmt::join(missing, ", "), missing.size() > 1 ? "are" : "is", names_text(found), remedy));
}

void CsvTable::report(std::size_t line, ProblemKind kind, std::string_view what) {
  problems.push_back(
      {line, kind, line > 0 ? fmt::format("{}, line {}: {}", path, line, what) : fmt::format("{}: {}", path, what)});
}

std::vector<std::string> problem_lines(const CsvTable& table, std::size_t each) {
  std::map<ProblemKind, std::size_t> counts;
  std::vector<std::string> result;
  for (const RecordingProblem& problem : table.problems)
    if (counts[problem.kind]++ < each) result.push_back(problem.sentence);
  for (const auto& [kind, count] : counts)
    if (count > each)
      result.push_back(fmt::format("{}: {} more of the kind {}", table.path, count - each, name_of(kind)));
  return result;
}

}  // namespace pneuservo
