// Foreign recordings by a column map.
#include "record/import.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "config/input_error.hpp"

namespace pneuservo {

namespace {

/// Our columns of the file, those that it has.
struct MappedColumns {
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;
  std::vector<std::size_t> telling;  ///< which tell runs
};

MappedColumns mapped(CsvTable& table, const ImportParameters& imported) {
  MappedColumns out;
  std::map<std::string, ImportedColumn> columns = imported.columns;
  columns.try_emplace("t_s", ImportedColumn{"t_s"});
  for (const auto& [name, source] : columns) {
    if (!table.has(source.column)) {
      if (name == "t_s")
        throw InputError(
            fmt::format("{}: found no column {}, expected the times of the rows", table.path, source.column));
      table.report(0, ProblemKind::header,
                   fmt::format("column {} is missing; {} of import.columns is left out", source.column, name));
      continue;
    }
    if (source.tells_runs) out.telling.push_back(out.names.size());
    out.names.push_back(name);
    out.values.push_back(table.column(source.column));
    for (double& value : out.values.back()) value = source.factor * value + source.offset;
  }
  return out;
}

/// Rows of one run put in order, repeats averaged; a value that a row lacks does not count.
Recording ordered(const MappedColumns& columns, std::size_t time, std::vector<std::size_t> rows) {
  const std::vector<double>& t_s = columns.values[time];
  std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return t_s[a] < t_s[b]; });
  Recording run;
  run.names = columns.names;
  run.values.resize(columns.names.size());
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t end = first;
    while (end < rows.size() && t_s[rows[end]] == t_s[rows[first]]) ++end;
    for (std::size_t c = 0; c < columns.values.size(); ++c) {
      double sum = 0, count = 0;
      for (std::size_t i = first; i < end; ++i)
        if (std::isfinite(columns.values[c][rows[i]])) sum += columns.values[c][rows[i]], ++count;
      run.values[c].push_back(count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN());
    }
    run.line_numbers.push_back(rows[first]);
    first = end;
  }
  return run;
}

}  // namespace

std::vector<Recording> read_recordings(const std::string& path, const std::optional<ImportParameters>& imported,
                                       double period_s) {
  if (!imported) return {read_recording(path)};
  CsvTable table = read_table(path);
  const MappedColumns columns = mapped(table, *imported);
  const auto time =
      static_cast<std::size_t>(std::find(columns.names.begin(), columns.names.end(), "t_s") - columns.names.begin());
  std::map<std::vector<double>, std::vector<std::size_t>> runs;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double t = columns.values[time][row];
    if (!std::isfinite(t) || t < imported->from_s || t > imported->to_s) continue;
    std::vector<double> key;
    key.reserve(columns.telling.size());
    for (const std::size_t c : columns.telling) key.push_back(columns.values[c][row]);
    runs[key].push_back(row);
  }
  if (runs.empty())
    throw InputError(fmt::format("{}: found no row between import.from_s and import.to_s, expected some", path));
  std::vector<Recording> out;
  for (const auto& [key, rows] : runs) {
    out.push_back(ordered(columns, time, rows));
    Recording& run = out.back();
    for (std::size_t& line : run.line_numbers) line = table.line_numbers[line];
    run.path = path;
    run.header = table.header;
    run.comments = table.comments;
    run.period_s = period_s;
  }
  out.front().problems = table.problems;
  return out;
}

}  // namespace pneuservo
