// A CSV table with comment header as it stands in a file, of our own format or foreign; nothing is hidden.
#pragma once
#include <cstddef>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace pneuservo {

/// What stands where a row has no number.
inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// What can be wrong with a recording that is still of use.
enum class ProblemKind {
  header,           ///< a key is missing or impossible
  dialect,          ///< how the file is written, where that is not this program's way
  interval,         ///< what the stamps say of the rows' times, where the header or the config says otherwise
  field_count,      ///< a line with more or fewer fields than columns; not used
  not_a_number,     ///< a field says nan or inf
  unreadable_field, ///< a field is no number; read as "no value"
  no_time,          ///< a row without t_s; not used
  gap,              ///< rows are missing
  repeated_time,    ///< a row at the time of the one before; not used
  decreasing_time,  ///< a row out of order; not used
  truncated,        ///< the file stops early; what is whole is used
  damaged,          ///< the gzip data are wrong from here on
};
/// E.g. "repeated_time".
std::string_view name_of(ProblemKind kind);

struct RecordingProblem {
  std::size_t line = 0;  ///< from 1; 0 = the file as a whole
  ProblemKind kind = ProblemKind::header;
  std::string sentence;  ///< begins with file and line
};

/// Columns by name, all kept, known or not. NaN = no value.
struct CsvTable {  // NOLINT(bugprone-exception-escape): of a YAML node that is moved, whose only failure is no memory
  std::string path;
  YAML::Node header;  ///< the keys of the comment header; a map, possibly empty
  std::string comments;  ///< the comment header with the `# ` taken off
  std::vector<std::string> names;
  std::vector<std::string> left_out;  ///< names of columns that are there but were not wanted
  std::vector<std::vector<double>> values;  ///< as long as names; each as long as rows()
  std::vector<std::string> units;  ///< as the file states them below the names; empty text: not stated
  std::vector<char> is_clock;  ///< columns of dates or times of day, here in seconds
  std::vector<std::size_t> line_numbers;  ///< of each row
  std::vector<RecordingProblem> problems;  ///< by line

  std::size_t rows() const { return line_numbers.size(); }
  bool has(std::string_view name) const;
  /// Throws InputError naming the missing column and those that are there.
  const std::vector<double>& column(std::string_view name) const;
  std::vector<double>& column(std::string_view name);
  /// Throws InputError naming all that are missing.
  void require(const std::vector<std::string>& columns) const;
  /// Leaves out every column whose name is not kept.
  void keep_columns(const std::function<bool(const std::string&)>& is_kept);
  /// Notes a problem; the sentence is put behind file and line.
  void report(std::size_t line, ProblemKind kind, std::string_view what);
};

/// Reads a .csv.gz or plain .csv. Throws InputError: no such file, not gzip, no line of column names, a column twice,
/// no row that can be used, more than most_bytes of values (0: a quarter of the memory). wanted: of this program's own
/// format, the columns that are kept; empty: all.
CsvTable read_table(const std::string& path, const std::set<std::string>& wanted = {}, std::size_t most_bytes = 0);

/// The problems for a reader's eye: the first `each` of every kind, then how many more.
std::vector<std::string> problem_lines(const CsvTable& table, std::size_t each = 3);

}  // namespace pneuservo
