// A CSV table with comment header as it stands in a file, of our own format or foreign; nothing is hidden.
#include "record/table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "record/text_input.hpp"

namespace pneuservo {

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

/// False if the whole field is no number.
bool parse(std::string_view field, double& value) {
  if (field.starts_with('+')) field.remove_prefix(1);
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc() && end == field.data() + field.size();
}

/// None where it is no YAML, or no map.
std::optional<YAML::Node> map_in(const std::string& text) {
  try {
    YAML::Node node = YAML::Load(text);
    return node.IsMap() ? std::optional(std::move(node)) : std::nullopt;
  } catch (const YAML::Exception&) { return std::nullopt; }
}

/// The keys of one stretch of text; nothing where it is no YAML, or no map.
void add_keys(const std::string& text, YAML::Node& header) {
  const auto entry = map_in(text);
  if (!entry) return;
  for (const auto& pair : *entry)
    if (pair.first.IsScalar()) header[pair.first.Scalar()] = pair.second;
}

/// A foreign file may mix keys with free text: then each key is read by itself, with the indented lines below it.
YAML::Node parse_header(const std::string& comments) {
  if (const auto whole = map_in(comments)) return *whole;
  YAML::Node header(YAML::NodeType::Map);
  for (std::size_t start = 0; start < comments.size();) {
    std::size_t end = comments.find('\n', start) + 1;
    while (end < comments.size() && comments[end] == ' ') end = comments.find('\n', end) + 1;
    add_keys(comments.substr(start, end - start), header);
    start = end;
  }
  return header;
}

class TableReader {
 public:
  explicit TableReader(const std::string& path) : input_(path) { table_.path = path; }

  CsvTable read() {
    read_head();
    std::string_view line;
    while (input_.next_line(line)) read_row(line);
    report_end();
    if (table_.rows() == 0)
      throw InputError(
          fmt::format("{}, line {}: there is no row that can be used{}; expected at least one line of {} numbers",
                      table_.path, input_.line_number() + 1, end_words(), table_.names.size()));
    return std::move(table_);
  }

 private:
  void read_head() {
    std::string_view line;
    while (input_.next_line(line)) {
      if (input_.line_number() == 1 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);  // byte order mark
      if (line.starts_with('#')) {
        line.remove_prefix(line.starts_with("# ") ? 2 : 1);
        table_.comments.append(line) += '\n';
      } else if (!trimmed(line).empty()) {
        table_.header = parse_header(table_.comments);
        read_names(line);
        return;
      }
    }
    throw InputError(
        fmt::format("{}, line {}: the file ends before the line of column names{}; expected one line such as "
                    "t_s,x_m,u_V after the comment lines",
                    table_.path, input_.line_number() + 1, end_words()));
  }

  std::string_view end_words() const {
    return input_.end() == TextInput::End::whole ? "" : " (the file is cut off or damaged)";
  }

  void read_names(std::string_view line) {
    for (const std::string_view name : split(line)) {
      double number;
      if (name.empty() || parse(name, number))
        throw InputError(
            fmt::format("{}, line {}: found \"{}\" where a column name is expected; the first line after the "
                        "comment lines names the columns",
                        table_.path, input_.line_number(), name));
      if (table_.has(name))
        throw InputError(fmt::format("{}, line {}: column {} is there twice", table_.path, input_.line_number(), name));
      table_.names.emplace_back(name);
    }
    table_.values.resize(table_.names.size());
    row_.resize(table_.names.size());
  }

  void read_row(std::string_view line) {
    const auto expected = table_.names.size();
    const auto count = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
    if (count != expected || line.starts_with('#') || (trimmed(line).empty() && expected > 1)) {
      table_.report(input_.line_number(), ProblemKind::field_count,
                    line.starts_with('#') ? "a comment line among the rows is not used"
                                          : fmt::format("{} fields where {} are expected; the row is not used",
                                                        trimmed(line).empty() ? 0 : count, expected));
      return;
    }
    for (std::size_t i = 0; i < expected; ++i) {
      const std::size_t comma = std::min(line.find(','), line.size());
      row_[i] = read_field(trimmed(line.substr(0, comma)), table_.names[i]);
      line.remove_prefix(std::min(comma + 1, line.size()));
    }
    for (std::size_t i = 0; i < expected; ++i) table_.values[i].push_back(row_[i]);
    table_.line_numbers.push_back(input_.line_number());
  }

  double read_field(std::string_view field, const std::string& name) {
    if (field.empty()) return no_value;
    double value;
    if (!parse(field, value)) {
      table_.report(input_.line_number(), ProblemKind::unreadable_field,
                    fmt::format("{} is \"{}\", which is no number; it is read as no value", name, field));
      return no_value;
    }
    if (!std::isfinite(value))
      table_.report(input_.line_number(), ProblemKind::not_a_number, fmt::format("{} is {}", name, field));
    return value;
  }

  void report_end() {
    const std::size_t line = input_.line_number() + 1;
    if (input_.end() == TextInput::End::truncated)
      table_.report(line, ProblemKind::truncated, "the file is cut off here; the whole rows before are used");
    else if (input_.end() == TextInput::End::damaged)
      table_.report(
          line, ProblemKind::damaged,
          "the compressed data are damaged near here; the rows before are used, the last of them may be wrong");
  }

  TextInput input_;
  CsvTable table_;
  std::vector<double> row_;
};

}  // namespace

std::string_view name_of(ProblemKind kind) {
  static constexpr std::array<std::string_view, 10> names = {
      "header", "field_count",   "not_a_number",    "unreadable_field", "no_time",
      "gap",    "repeated_time", "decreasing_time", "truncated",        "damaged"};
  return names[static_cast<std::size_t>(kind)];
}

bool CsvTable::has(std::string_view name) const { return std::find(names.begin(), names.end(), name) != names.end(); }

const std::vector<double>& CsvTable::column(std::string_view name) const {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) require({std::string(name)});
  return values[static_cast<std::size_t>(at - names.begin())];
}

void CsvTable::require(const std::vector<std::string>& columns) const {
  std::vector<std::string> missing;
  for (const std::string& name : columns)
    if (!has(name)) missing.push_back(name);
  if (missing.empty()) return;
  throw InputError(fmt::format("{}: column{} {} {} missing; found {}", path, missing.size() > 1 ? "s" : "",
                               fmt::join(missing, ", "), missing.size() > 1 ? "are" : "is", fmt::join(names, ", ")));
}

void CsvTable::report(std::size_t line, ProblemKind kind, std::string_view what) {
  problems.push_back(
      {line, kind, line > 0 ? fmt::format("{}, line {}: {}", path, line, what) : fmt::format("{}: {}", path, what)});
}

CsvTable read_table(const std::string& path) { return TableReader(path).read(); }

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
