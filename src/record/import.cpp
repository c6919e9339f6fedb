// Recordings of our own format and foreign ones by a column map.
#include "record/import.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pneuservo/core/signal.hpp>
#include <pneuservo/record/row.hpp>

#include "config/input_error.hpp"
#include "config/key_suggestion.hpp"
#include "record/foreign/channel_steps.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/foreign/held_rows.hpp"
#include "record/foreign/names_text.hpp"
#include "record/foreign/stamps.hpp"
#include "record/foreign/units.hpp"
#include "record/foreign/value_marks.hpp"
#include "record/kept_rows.hpp"
#include "record/row_text.hpp"

namespace pneuservo {

namespace {

/// Stamps of seven digits and a clock's drift agree with a stated period to this share.
constexpr double same_period = 2e-3;
/// In a random order nine of ten steps go back in one table of a hundred.
constexpr std::size_t rows_that_tell_order = 10;

/// Our columns of the file, those that it has.
struct MappedColumns {
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;
  std::vector<std::size_t> telling;  ///< which tell runs
  bool has_time_factor = false;
  bool is_clock = false;
  std::string time_name = "t_s";  ///< in the file

  std::size_t time() const {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), "t_s") - names.begin());
  }
};

/// "; did you mean Weg_mm? The file has ..."
std::string what_the_file_has(const CsvTable& table, const std::string& wanted) {
  std::vector<std::string> near;
  for (const std::string& name : table.names)
    if (name.starts_with(wanted) || wanted.starts_with(name)) near.push_back(name);
  if (near.empty()) near = near_names(wanted, table.names);
  return fmt::format("{}the file has {}", near.empty() ? "" : fmt::format("did you mean {}? ", fmt::join(near, ", ")),
                     names_text(table.names));
}

bool is_clock_column(const CsvTable& table, const std::string& name) {
  const auto at = std::find(table.names.begin(), table.names.end(), name) - table.names.begin();
  return table.is_clock[static_cast<std::size_t>(at)] != 0;
}

/// Columns are moved out of the table, those that several of ours take are copied.
MappedColumns mapped(CsvTable& table, const ImportParameters& imported) {
  MappedColumns out;
  std::vector<ImportedColumn> sources;
  std::map<std::string, ImportedColumn> columns = imported.columns;
  columns.try_emplace("t_s", ImportedColumn{"t_s"});
  const std::vector<std::string> known = columns_of_the_format();
  for (const std::string& name : table.names)
    if (std::find(known.begin(), known.end(), name) != known.end()) columns.try_emplace(name, ImportedColumn{name});
  for (const auto& [name, source] : columns) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError(fmt::format("import.columns: found {}, expected {}", name, expected_names(name, known)));
    if (!table.has(source.column)) {
      const std::string has = what_the_file_has(table, source.column);
      if (name == "t_s")
        throw InputError(
            fmt::format("{}: found no column {}, expected the times of the rows; {}", table.path, source.column, has));
      table.report(0, ProblemKind::header,
                   fmt::format("column {} is missing; {} of import.columns is left out; {}", source.column, name, has));
      continue;
    }
    if (source.tells_runs) out.telling.push_back(out.names.size());
    out.names.push_back(name);
    const auto takes_it = [&](const auto& entry) { return entry.second.column == source.column; };
    std::vector<double>& values = table.column(source.column);
    out.values.push_back(std::ranges::count_if(columns, takes_it) == 1 ? std::move(values) : values);
    sources.push_back(source);
    if (name == "t_s") {
      out.has_time_factor = source.factor != 1;
      out.is_clock = is_clock_column(table, source.column);
      out.time_name = source.column;
    }
  }
  std::vector<std::string> theirs;
  for (const ImportedColumn& source : sources) theirs.push_back(source.column);
  leave_out_marks(table, out.names, theirs, out.values);
  for (std::size_t c = 0; c < sources.size(); ++c)
    for (double& value : out.values[c]) value = sources[c].factor * value + sources[c].offset;
  return out;
}

/// Puts the columns that no map names among those left out.
void tell_untaken(CsvTable& table, const MappedColumns& taken, const ImportParameters& imported) {
  for (const std::string& name : table.names) {
    const bool is_mapped = std::any_of(imported.columns.begin(), imported.columns.end(),
                                       [&](const auto& entry) { return entry.second.column == name; });
    const bool is_ours = std::find(taken.names.begin(), taken.names.end(), name) != taken.names.end();
    if (!is_mapped && !is_ours) table.left_out.push_back(name);
  }
}

/// Units of the columns that a map takes as they stand.
std::map<std::string, std::string> units_of(const CsvTable& table, const ImportParameters& imported) {
  std::map<std::string, std::string> out;
  for (const auto& [ours, source] : imported.columns) {
    const auto at = std::find(table.names.begin(), table.names.end(), source.column);
    if (at == table.names.end() || source.offset != 0) continue;
    const std::string stated = stated_unit(table, static_cast<std::size_t>(at - table.names.begin()));
    const std::optional<Unit> unit = unit_in(stated);
    // Thousandths are in per cent by their factor.
    const bool is_share = unit && unit->quantity == Quantity::raw && unit->factor != 1 && unit->factor == source.factor;
    if (!stated.empty() && (is_share || source.factor == 1)) out[ours] = is_share ? "%" : stated;
  }
  return out;
}

/// The columns as they are named.
MappedColumns unmapped(CsvTable& table) {
  table.require({"t_s"});
  return {table.names, std::move(table.values), {}, false, is_clock_column(table, "t_s"), "t_s"};
}

/// Rows between stamps get their times; how many got one, and how many rows with values have none, is told.
void fill_times(CsvTable& table, MappedColumns& columns) {
  std::vector<double>& times = columns.values[columns.time()];
  if (const std::size_t filled = fill_between(times); filled > 0)
    table.report(0, ProblemKind::interval,
                 fmt::format("{} of {} rows have no time of their own: they lie evenly between those that have one",
                             filled, times.size()));
  std::size_t lost = 0;
  for (std::size_t row = 0; row < times.size(); ++row)
    lost += !std::isfinite(times[row]) && std::any_of(columns.values.begin(), columns.values.end(),
                                                      [&](const auto& of) { return std::isfinite(of[row]); });
  if (lost > 0 && lost < times.size())
    table.report(0, ProblemKind::no_time,
                 fmt::format("{} of {} rows have no time, nor does one follow from the rows beside them: they are not "
                             "used",
                             lost, times.size()));
}

/// Times within a second, a minute or an hour go on behind it where the sensors go on; a command may step anywhere.
/// Runs that begin and end at one place go on, too: so the column is named as such a part (`ms`), or begins within one.
void take_turns(CsvTable& table, MappedColumns& columns, double period_s) {
  std::vector<double>& times = columns.values[columns.time()];
  const bool is_stated = columns.has_time_factor || columns.is_clock;
  const Turns turns = turns_of(times, is_stated ? 1 : unit_of_times(times, period_s, false).factor);
  if (turns.rows.empty()) return;
  const std::optional<Unit> part = unit_in(columns.time_name);
  const auto first = std::ranges::find_if(times, [](double t) { return std::isfinite(t); });
  if (!(part && part->quantity == Quantity::time) && *first <= median_step_s(times)) return;
  for (std::size_t c = 0; c < columns.names.size(); ++c)
    if (signal_of_column(columns.names[c]) && jumps_into(turns.rows, columns.values[c], columns.values[c])) return;
  pass_turns(times, turns);
  table.report(0, ProblemKind::interval,
               fmt::format("t_s begins again where the {} ends, {}, and the sensors go on: the time goes on behind it",
                           turns.words, turns.rows.size() == 1 ? "once" : fmt::format("{} times", turns.rows.size())));
}

/// Brings the times to seconds, and tells it.
void take_seconds(CsvTable& table, MappedColumns& columns, double period_s) {
  std::vector<double>& times = columns.values[columns.time()];
  if (const std::size_t nights = pass_midnights(times, columns.is_clock); nights > 0)
    table.report(0, ProblemKind::interval,
                 fmt::format("t_s passes midnight {}: the time goes on behind it",
                             nights == 1 ? "once" : fmt::format("{} times", nights)));
  if (const int bits = columns.is_clock ? 0 : pass_wraps(times); bits > 0)
    table.report(0, ProblemKind::interval,
                 fmt::format("t_s is a counter of {} bits that begins again: the time goes on behind it", bits));
  if (columns.telling.empty()) take_turns(table, columns, period_s);
  fill_times(table, columns);
  TimeUnit unit = unit_of_times(times, period_s, columns.is_clock);
  if (columns.has_time_factor && unit.start == 0) return;
  if (columns.has_time_factor) unit.factor = 1;  // stated
  if (unit.words.empty()) return;
  for (double& t : times) t = unit.factor * (t - unit.start);
  const double step = median_step_s(times);
  table.report(0, ProblemKind::interval,
               fmt::format("t_s holds {}{}{}; taken in seconds{}", unit.words,
                           std::isfinite(step) ? fmt::format(": rows are {:.4g} s apart", step) : "",
                           std::isfinite(period_s) ? fmt::format(", the loop's period is {:g} s", period_s) : "",
                           unit.start != 0 ? " from the first row on" : ""));
}

/// Whether these times, in their order, are each once there and nine of ten steps within half of the usual one.
bool are_spread_evenly(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  const double usual = median_step_s(times);
  std::size_t alike = 0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double step = times[i] - times[i - 1];
    if (!(step > 0)) return false;
    alike += step > 0.5 * usual && step < 1.5 * usual;
  }
  return 10 * alike >= 9 * (times.size() - 1);
}

/// A table that is written from its last row to its first is turned round, one in no order is put in that of its
/// times, and that is told. By chance half of all steps go back; of runs of more than four rows, one behind the other,
/// less than a quarter do, and their times come again.
void take_order(CsvTable& table, MappedColumns& columns) {
  const std::vector<double>& times = columns.values[columns.time()];
  std::size_t back = 0, steps = 0;
  for (std::size_t i = 1; i < times.size(); ++i) back += times[i] < times[i - 1], steps += times[i] != times[i - 1];
  if (steps < rows_that_tell_order) return;
  std::vector<std::size_t> rows(times.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  if (10 * back >= 9 * steps) {
    std::reverse(rows.begin(), rows.end());
    table.report(0, ProblemKind::interval, "t_s goes back from row to row: the rows are taken in the other order");
  } else if (4 * back >= steps && std::ranges::all_of(times, [](double t) { return std::isfinite(t); }) &&
             are_spread_evenly(times)) {
    std::ranges::sort(rows, {}, [&](std::size_t row) { return times[row]; });
    table.report(0, ProblemKind::interval, "the rows are in no order of t_s: they are put in order");
  } else {
    return;
  }
  const auto in_order = [&](auto& values) {
    const auto before = values;
    std::ranges::transform(rows, values.begin(), [&](std::size_t row) { return before[row]; });
  };
  std::ranges::for_each(columns.values, in_order);
  in_order(table.line_numbers);
}

/// Rows put in order of time, repeats averaged; a value that a row lacks does not count. NaN times are left out.
void put_in_order(Recording& run) {
  const std::vector<double> t_s = run.t_s();
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < t_s.size(); ++i)
    if (std::isfinite(t_s[i])) rows.push_back(i);
  const auto is_earlier = [&](std::size_t a, std::size_t b) { return t_s[a] < t_s[b]; };
  if (rows.size() == t_s.size() && std::adjacent_find(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
                                     return t_s[a] >= t_s[b];
                                   }) == rows.end())
    return;
  std::stable_sort(rows.begin(), rows.end(), is_earlier);
  const std::vector<std::vector<double>> values = std::exchange(run.values, {run.names.size(), std::vector<double>{}});
  const std::vector<std::size_t> lines = std::exchange(run.line_numbers, {});
  std::size_t repeats = 0;
  for (std::size_t first = 0, end = 0; first < rows.size(); first = end) {
    while (end < rows.size() && t_s[rows[end]] == t_s[rows[first]]) ++end;
    for (std::size_t c = 0; c < values.size(); ++c) {
      double sum = 0, count = 0;
      for (std::size_t i = first; i < end; ++i)
        if (std::isfinite(values[c][rows[i]])) sum += values[c][rows[i]], ++count;
      run.values[c].push_back(count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN());
    }
    run.line_numbers.push_back(lines[rows[first]]);
    repeats += end - first - 1;
  }
  if (repeats > 0)
    run.report(0, ProblemKind::repeated_time,
               fmt::format("{} rows have the time of another: their mean is used", repeats));
}

/// The columns are moved out where the run is all there is.
Recording as_they_stand(MappedColumns& columns, const std::vector<std::size_t>& rows) {
  Recording run;
  run.names = columns.names;
  run.line_numbers = rows;
  if (rows.size() == columns.values[columns.time()].size()) {
    run.values = std::move(columns.values);
    return run;
  }
  run.values.resize(columns.names.size());
  for (std::size_t c = 0; c < columns.values.size(); ++c)
    for (const std::size_t row : rows) run.values[c].push_back(columns.values[c][row]);
  return run;
}

/// Rows of each run, by what tells runs, else by where the time goes back.
std::vector<std::vector<std::size_t>> rows_of_runs(CsvTable& table, const MappedColumns& columns, double from_s,
                                                   double to_s) {
  const std::vector<double>& t = columns.values[columns.time()];
  const auto is_wanted = [&](std::size_t row) { return !(t[row] < from_s) && !(t[row] > to_s); };
  std::vector<std::vector<std::size_t>> runs;
  if (columns.telling.empty()) {
    std::vector<std::size_t> starts = run_starts(t);
    for (std::size_t i = 1; i < starts.size(); ++i)
      table.report(table.line_numbers[starts[i]], ProblemKind::interval,
                   fmt::format("t_s goes back to {:.6g} and on from there: the rows from here on are a recording of "
                               "their own",
                               t[starts[i]]));
    starts.push_back(t.size());
    for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
      runs.emplace_back();
      for (std::size_t row = starts[i]; row < starts[i + 1]; ++row)
        if (is_wanted(row)) runs.back().push_back(row);
    }
  } else {
    std::map<std::vector<double>, std::vector<std::size_t>> by_key;
    for (std::size_t row = 0; row < t.size(); ++row) {
      if (!std::isfinite(t[row]) || !is_wanted(row)) continue;
      std::vector<double> key;
      for (const std::size_t c : columns.telling) key.push_back(columns.values[c][row]);
      by_key[key].push_back(row);
    }
    for (auto& [key, rows] : by_key) runs.push_back(std::move(rows));
  }
  std::erase_if(runs, [](const auto& rows) { return rows.empty(); });
  return runs;
}

/// The interval of the rows by their stamps; the stated period where it is the same.
void take_interval(Recording& run, double loop_period_s) {
  const double stated_s = run.period_s, seen_s = interval_of(run.t_s());
  if (!std::isfinite(seen_s)) return;  // rows of any spacing
  for (const double period_s : {stated_s, loop_period_s})
    if (std::abs(seen_s / period_s - 1) < same_period) {
      run.period_s = period_s;
      return;
    }
  run.period_s = seen_s;
  if (std::isfinite(stated_s))
    run.report(0, ProblemKind::interval,
               fmt::format("rows are {:.6g} s apart by their stamps, the header's period_s is {:g}: the stamps are "
                           "believed",
                           seen_s, stated_s));
  else if (std::isfinite(loop_period_s))
    run.report(0, ProblemKind::interval,
               fmt::format("rows are {:.6g} s apart, the loop's period_s is {:g}: compared at the rows' own interval",
                           seen_s, loop_period_s));
}

/// Rows written twice: each that shares its time with the one before is its copy, which no sensor's noise makes.
void leave_out_copies(Recording& run) {
  const std::vector<double>& t = run.t_s();
  if (run.names.size() < 2) return;
  const auto is_copy = [&](std::size_t row) {
    return std::all_of(run.values.begin(), run.values.end(), [row](const std::vector<double>& values) {
      return values[row] == values[row - 1] || (std::isnan(values[row]) && std::isnan(values[row - 1]));
    });
  };
  std::vector<std::size_t> kept;
  for (std::size_t row = 0; row < t.size(); ++row) {
    if (row == 0 || t[row] != t[row - 1]) kept.push_back(row);
    else if (!is_copy(row)) return;
  }
  const std::size_t copies = t.size() - kept.size();
  if (copies == 0) return;
  for (std::vector<double>& values : run.values) keep_only(values, kept);
  keep_only(run.line_numbers, kept);
  run.report(0, ProblemKind::repeated_time,
             fmt::format("{} row{} written twice: each is used once", copies, copies > 1 ? "s are" : " is"));
}

/// Rows that share their time with several others cannot be told apart.
void refuse_few_stamps(const std::string& path, const std::vector<double>& times) {
  std::size_t rows = 0, different = 0;
  double before = std::numeric_limits<double>::quiet_NaN();
  for (const double t : times)
    if (std::isfinite(t)) ++rows, different += t != before, before = t;
  if (rows < 4 || 2 * different > rows) return;
  throw InputError(fmt::format("{}: {} rows have {} different times, expected a time for each row: write t_s with more "
                               "digits, or give a column that counts the rows, with their interval as its factor",
                               path, rows, different));
}

/// Rows at one time that were rounded to it stand evenly again; otherwise they are told and left out.
void mend_times(Recording& run) {
  leave_out_copies(run);
  auto& times = run.column("t_s");
  if (!spread_rounded(times)) return refuse_few_stamps(run.path, times);
  const double interval_s = interval_of(times);
  run.report(0, ProblemKind::interval,
             fmt::format("t_s is rounded so far that neighbours are equal: the rows are spread evenly{}",
                         std::isfinite(interval_s) ? fmt::format(", {:.6g} s apart", interval_s) : ""));
}

}  // namespace

std::vector<Recording> read_recordings(const std::string& path, const std::optional<ImportParameters>& imported,
                                       double period_s, const std::set<std::string>& wanted) {
  return recordings_in(read_table(path, wanted), imported, period_s);
}

namespace {

/// Names the column of the times and a field of it.
std::string no_time_words(const CsvTable& table, const std::optional<ImportParameters>& imported) {
  const bool is_mapped = imported && imported->columns.contains("t_s");
  const std::string column = is_mapped ? imported->columns.at("t_s").column : "t_s";
  const std::string text = fmt::format("column {} holds text such as ", column);
  std::string found;
  for (const RecordingProblem& problem : table.problems) {
    const std::size_t at = problem.sentence.find(text), end = problem.sentence.rfind(", read as no value");
    if (at != std::string::npos && end != std::string::npos)
      found = ", found " + problem.sentence.substr(at + text.size(), end - at - text.size());
  }
  return fmt::format("{}: no row has a time; expected numbers, dates or times of day in column {}{}", table.path,
                     column, found);
}

}  // namespace

std::vector<Recording> recordings_in(CsvTable table, const std::optional<ImportParameters>& imported, double period_s) {
  const bool is_own = !imported && is_own_format(table);
  const auto stated_units = imported ? units_of(table, *imported) : std::map<std::string, std::string>();
  MappedColumns columns = imported ? mapped(table, *imported) : unmapped(table);
  if (!imported && !is_own) leave_out_marks(table, columns.names, columns.names, columns.values);
  if (imported) tell_untaken(table, columns, *imported);
  if (!is_own && columns.telling.empty()) take_order(table, columns);
  if (!is_own) take_seconds(table, columns, period_s);
  const double from_s = imported ? imported->from_s : -infinite, to_s = imported ? imported->to_s : infinite;
  const auto runs = rows_of_runs(table, columns, from_s, to_s);
  if (runs.empty())
    throw InputError(fmt::format("{}: found no row between import.from_s and import.to_s, expected some", table.path));
  std::vector<Recording> out;
  for (const auto& rows : runs) {
    out.push_back(as_they_stand(columns, rows));
    Recording& run = out.back();
    for (std::size_t& line : run.line_numbers) line = table.line_numbers[line];
    run.path = table.path;
    run.header = table.header;
    run.comments = table.comments;
    run.left_out = table.left_out;
    if (out.size() == 1) run.problems = table.problems;
    if (is_own) read_keys(run);
    else if (columns.telling.empty()) mend_times(run);
    if (imported) {
      put_in_order(run);
      run.sources = imported->columns;
      run.stated_units = stated_units;
    }
    if (std::none_of(run.t_s().begin(), run.t_s().end(), [](double t) { return std::isfinite(t); }))
      throw InputError(no_time_words(table, imported));
    if (!is_own) leave_out_repeats(run);
    take_interval(run, period_s);
    check_times(run);
  }
  return out;
}

Recording read_first_recording(const std::string& path, const std::optional<ImportParameters>& imported,
                               double period_s) {
  std::vector<Recording> runs = read_recordings(path, imported, period_s);
  if (runs.size() > 1)
    runs.front().report(0, ProblemKind::header, fmt::format("the file holds {} runs; the first is used", runs.size()));
  return std::move(runs.front());
}

std::pair<std::vector<double>, std::vector<double>> load_reference_positions(const std::string& path) {
  const Recording recording = read_first_recording(path, std::nullopt, std::numeric_limits<double>::quiet_NaN());
  return {recording.t_s(), recording.column("x_ref_m")};
}

}  // namespace pneuservo
