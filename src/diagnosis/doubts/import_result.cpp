// What is understood of a foreign recording: by the map of a config, or by the names of its columns.
#include "diagnosis/doubts/import_result.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "diagnosis/doubts/recording_doubts.hpp"
#include "record/foreign/names_text.hpp"
#include "record/import.hpp"

namespace pneuservo {
namespace {

/// Columns by the config's own map, where it has one.
std::vector<ColumnGuess> mapped_columns(const CsvTable& table, const ImportParameters& map) {
  std::vector<ColumnGuess> out;
  for (const std::string& name : table.names) {
    out.push_back({name, "", "", 1, 0, "not in the config's section import", false, ""});
    for (const auto& [ours, source] : map.columns)
      if (source.column == name)
        out.back() = {name, ours, "", source.factor, source.offset, "import.columns of the config", false, ""};
    if (name == "t_s" && map.columns.count("t_s") == 0) out.back() = {name, "t_s", "", 1, 0, "its name", false, ""};
  }
  return out;
}

/// Columns that `diagnose` compares nothing without, of a rig that has no column in the file for them.
std::vector<std::string> missing_columns(const Rig& rig, const Recording& recording) {
  std::vector<std::string> wanted{"x_m"}, missing;
  if (rig.is_pneumatic()) {
    for (const std::string& command : command_columns(rig)) wanted.push_back(command);
    for (const Signal port : port_signals) wanted.emplace_back(info(port).column);
  } else if (!rig.has_controller()) {
    return {};  // a column of several serves there
  }
  std::ranges::copy_if(wanted, std::back_inserter(missing),
                       [&](const std::string& name) { return !recording.has(name); });
  return missing;
}

/// What the user has to state, with the columns of the file that nothing was taken from.
void tell_missing(const Rig& rig, ImportResult& result) {
  const std::vector<std::string> missing = missing_columns(rig, result.runs.front());
  if (missing.empty()) return;
  std::vector<std::string> untaken;
  for (const ColumnGuess& guess : result.columns)
    if (guess.ours.empty())
      untaken.push_back(guess.unit.empty() || guess.column.find(guess.unit) != std::string::npos
                            ? guess.column
                            : fmt::format("{} [{}]", guess.column, guess.unit));
  for (const std::string& name : missing)
    result.doubts.push_back(fmt::format("{0}: found no column for it, expected one: state it, "
                                        "import: {{columns: {{{0}: {{column: \"...\", factor: 1, offset: 0}}}}}}{1}",
                                        name, untaken.empty() ? "" : "; not taken are " + names_text(untaken)));
}

}  // namespace

ImportResult understand_recording(const std::string& path, std::optional<Rig> rig) {
  CsvTable table = read_table(path);
  ImportResult out;
  out.path = path;
  const double loop_period_s = rig ? rig->period_s : std::numeric_limits<double>::quiet_NaN();
  if (rig && rig->imported) {
    out.columns = mapped_columns(table, *rig->imported);
    out.runs = recordings_in(std::move(table), rig->imported, loop_period_s);
  } else {
    out.columns = guess_columns(table, rig ? rig->axis.air.atmosphere_Pa : 101325.0);
    const ImportParameters map = import_map(out.columns);
    if (map.columns.count("t_s") == 0)
      throw InputError(
          fmt::format("{}: found no column of times, expected one such as t_s, time_ms or a date, or one that "
                      "counts the rows, with their interval as its factor, or a line such as \"Sample rate: 1000 Hz\" "
                      "before the names; the file has {}",
                      path, names_text(table.names)));
    const bool is_own = is_own_format(table);
    out.runs = recordings_in(std::move(table), is_own ? std::nullopt : std::optional(map), loop_period_s);
  }
  ImportParameters map = rig && rig->imported ? *rig->imported : import_map(out.columns);
  if (const std::string axes = axis_words(out.columns); !axes.empty())
    out.understood.push_back(fmt::format("{}: {}", path, axes));
  for (const Recording& run : out.runs)
    for (const std::string& line : problem_lines(run)) out.understood.push_back(line);
  if (rig) {
    std::vector<Recording> judged = out.runs;
    try {
      doubt_recordings(*rig, judged, out.doubts);
    } catch (const InputError& asked) { out.doubts.emplace_back(asked.what()); }
    // What was certain stands in the section; the first run speaks for the file.
    for (auto& [name, source] : map.columns) {
      const bool tells_runs = source.tells_runs;
      if (judged.front().has(name) && !is_own_format(judged.front())) source = source_of(judged.front(), name);
      source.tells_runs = tells_runs;
    }
  }
  if (rig) tell_missing(*rig, out);
  out.section = import_section(map, out.columns);
  return out;
}

}  // namespace pneuservo
