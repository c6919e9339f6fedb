// Channels with stamps of their own, brought to the rows of one table.
#include "record/foreign/timed_groups.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "record/drawn_value.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/foreign/stamps.hpp"
#include "record/kept_rows.hpp"

namespace pneuservo {

namespace {

/// Timers of loggers agree to a per cent; who samples so much slower has a rate of his own.
constexpr double same_rate = 0.01;
/// Of an interval: stamps this close are one.
constexpr double same_stamp = 1e-3;
/// Of a channel's interval: a step that lacks one sample, with half an interval of jitter. Nothing is drawn through
/// longer ones.
constexpr double longest_step = 2.5;

/// What join_groups told of its rows in the end.
struct JoinTold {
  double shift = 0;  ///< largest, in intervals of the rows
  std::size_t repeated = 0;
  bool is_apart = false;  ///< not all groups have the same stamps
};

void keep_rows(TimedGroup& group, const std::vector<std::size_t>& kept) {
  keep_only(group.times, kept);
  keep_only(group.lines, kept);
  for (auto& values : group.values) keep_only(values, kept);
}

/// JoinedRows in the order of `rows`.
template <class T> void reorder(std::vector<T>& values, const std::vector<std::size_t>& rows) {
  std::vector<T> out;
  out.reserve(rows.size());
  for (const std::size_t row : rows) out.push_back(values[row]);
  values = std::move(out);
}

/// The mean of what stands at one stamp takes its place.
std::size_t join_repeats(TimedGroup& group) {
  std::vector<std::size_t> kept;
  const std::size_t all = group.times.size();
  for (std::size_t first = 0, end = 0; first < all; first = end) {
    while (end < all && group.times[end] == group.times[first]) ++end;
    kept.push_back(first);
    if (end == first + 1) continue;
    for (auto& values : group.values) {
      double sum = 0, count = 0;
      for (std::size_t i = first; i < end; ++i)
        if (std::isfinite(values[i])) sum += values[i], ++count;
      values[first] = count > 0 ? sum / count : no_value;
    }
  }
  if (kept.size() < all) keep_rows(group, kept);
  return all - kept.size();
}

/// JoinedRows that rise in time, each stamp once; rounded stamps are spread evenly first.
std::size_t order_group(TimedGroup& group) {
  sort_by_time(group);
  if (std::adjacent_find(group.times.begin(), group.times.end()) == group.times.end()) return 0;
  return spread_rounded(group.times) ? 0 : join_repeats(group);
}

void leave_out_untimed(TimedGroup& group) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < group.times.size(); ++i)
    if (std::isfinite(group.times[i])) kept.push_back(i);
  if (kept.size() < group.times.size()) keep_rows(group, kept);
}

/// Each run of a group as one of its own.
std::vector<TimedGroup> runs_of_group(const TimedGroup& group) {
  std::vector<std::size_t> starts = run_starts(group.times);
  starts.push_back(group.times.size());
  std::vector<TimedGroup> out;
  for (std::size_t r = 0; r + 1 < starts.size(); ++r) {
    const auto part = [&](const auto& of) {
      using Part = std::decay_t<decltype(of)>;
      return Part(of.begin() + static_cast<std::ptrdiff_t>(starts[r]),
                  of.begin() + static_cast<std::ptrdiff_t>(starts[r + 1]));
    };
    out.push_back({part(group.times), part(group.lines), group.names, group.units, {}});
    for (const auto& values : group.values) out.back().values.push_back(part(values));
  }
  return out;
}

double interval_in(const TimedGroup& group) { return group.times.size() < 3 ? no_value : interval_of(group.times); }

/// Number of the stamp that is nearest; `stamps` rise.
std::size_t nearest_stamp(const std::vector<double>& stamps, double time) {
  const auto at = std::lower_bound(stamps.begin(), stamps.end(), time);
  if (at == stamps.begin()) return 0;
  const auto i = static_cast<std::size_t>(at - stamps.begin());
  return at == stamps.end() || time - stamps[i - 1] <= stamps[i] - time ? i - 1 : i;
}

/// The times of all rows with the line that each is from.
struct JoinedRows {
  std::vector<double> times;
  std::vector<std::size_t> lines;
  double interval = no_value;  ///< of an even grid; NaN: every stamp is a row

  void add(const std::vector<std::pair<double, std::size_t>>& more) {
    std::vector<std::pair<double, std::size_t>> all(more);
    for (std::size_t i = 0; i < times.size(); ++i) all.emplace_back(times[i], lines[i]);
    std::sort(all.begin(), all.end());
    times.clear(), lines.clear();
    for (const auto& [time, line] : all) {
      const double same = std::isfinite(interval) ? 0.5 * interval : 0;
      if (!times.empty() && time - times.back() <= same) continue;
      times.push_back(time);
      lines.push_back(line);
    }
  }
};

/// The rows of one group, and further ones in step with them where others have samples beyond its ends or in its gaps.
JoinedRows even_rows(const std::vector<TimedGroup>& groups, std::size_t grid, double interval) {
  JoinedRows out{groups[grid].times, groups[grid].lines, interval};
  std::vector<std::pair<double, std::size_t>> more;
  for (const TimedGroup& group : groups)
    for (std::size_t i = 0; i < group.times.size(); ++i) {
      const double row = groups[grid].times[nearest_stamp(groups[grid].times, group.times[i])];
      const double steps = std::round((group.times[i] - row) / interval);
      if (std::abs(group.times[i] - row) > interval) more.emplace_back(row + steps * interval, group.lines[i]);
    }
  if (!more.empty()) out.add(more);
  return out;
}

JoinedRows all_rows(const std::vector<TimedGroup>& groups) {
  JoinedRows out;
  std::vector<std::pair<double, std::size_t>> all;
  for (const TimedGroup& group : groups)
    for (std::size_t i = 0; i < group.times.size(); ++i) all.emplace_back(group.times[i], group.lines[i]);
  out.add(all);
  return out;
}

/// Places a group's channels into rows.
class Placement {
 public:
  Placement(const JoinedRows& rows, const TimedGroup& group, double interval)
      : rows_(rows), group_(group), is_even_(std::isfinite(interval)) {
    if (!std::isfinite(rows.interval) || group.times.empty()) return;  // every stamp has its row
    const bool is_as_fast = interval <= (1 + same_rate) * rows.interval;
    longest_ = longest_step * (is_even_ ? interval : rows.interval);
    std::size_t last = rows.times.size();
    for (std::size_t i = 0; i < group.times.size(); ++i) {
      const std::size_t row = nearest_stamp(rows.times, group.times[i]);
      if (row != last && !is_as_fast) wanted_.push_back({row, i});
      last = row;
    }
    for (std::size_t row = 0; is_as_fast && row < rows.times.size(); ++row) {
      const std::size_t i = nearest_stamp(group.times, rows.times[row]);
      if (std::abs(group.times[i] - rows.times[row]) <= (0.5 + same_stamp) * rows.interval) wanted_.push_back({row, i});
    }
  }

  double largest_shift() const {
    double out = 0;
    for (const auto& [row, sample] : wanted_)
      out = std::max(out, std::abs(group_.times[sample] - rows_.times[row]) / rows_.interval);
    return out;
  }

  std::vector<double> place(const std::vector<double>& values, bool is_held) const {
    std::vector<double> out(rows_.times.size(), no_value);
    if (!std::isfinite(rows_.interval))
      for (std::size_t i = 0; i < group_.times.size(); ++i)
        out[nearest_stamp(rows_.times, group_.times[i])] = values[i];
    for (const auto& [row, sample] : wanted_) out[row] = is_held ? values[sample] : drawn(values, row, sample);
    if (is_held && !is_even_) hold(out);
    return out;
  }

 private:
  struct Wanted {
    std::size_t row, sample;
  };

  double drawn(const std::vector<double>& values, std::size_t row, std::size_t sample) const {
    const std::vector<double>& t = group_.times;
    const double at = rows_.times[row];
    if (std::abs(at - t[sample]) <= same_stamp * rows_.interval) return values[sample];
    const std::size_t from = at < t[sample] ? sample - 1 : sample;  // of sample 0: beyond every index
    if (from + 1 >= t.size() || from > sample || t[from + 1] - t[from] > longest_)
      return is_even_ ? no_value : values[sample];
    const double cubic = drawn_value(t, values, from, at, longest_);
    return std::isfinite(cubic) ? cubic : drawn_value(t, values, from, at, 0);
  }

  /// Up to the next value, and no longer than a value stood before.
  void hold(std::vector<double>& out) const {
    double longest = 0, since = no_value, value = no_value;
    for (std::size_t i = 1; i < group_.times.size(); ++i)
      longest = std::max(longest, group_.times[i] - group_.times[i - 1]);
    for (std::size_t row = 0; row < out.size(); ++row) {
      if (std::isfinite(out[row])) value = out[row], since = rows_.times[row];
      else if (rows_.times[row] - since <= longest) out[row] = value;
    }
  }

  const JoinedRows& rows_;
  const TimedGroup& group_;
  bool is_even_;
  double longest_ = 0;
  std::vector<Wanted> wanted_;
};

/// Columns that a guess takes for a command or a reference, which stand until they are written anew.
std::vector<char> held_columns(const CsvTable& table) {
  std::vector<char> out;
  for (const ColumnGuess& guess : guess_columns(table)) out.push_back(guess.ours == "u_V" || guess.ours == "x_ref_m");
  return out;
}

/// Joins groups run by run.
class GroupJoin {
 public:
  GroupJoin(CsvTable& table, const std::vector<TimedGroup>& groups) : table_(table) {
    table.values.assign(1, {});
    table.line_numbers.clear();
    for (auto* of : {&table.names, &table.units}) of->resize(1);
    for (const TimedGroup& group : groups)
      for (std::size_t c = 0; c < group.names.size(); ++c) {
        table.names.push_back(group.names[c]);
        table.units.push_back(group.units[c]);
        table.values.emplace_back();
      }
    table.is_clock.resize(1);
    table.is_clock.resize(table.names.size(), 0);
    is_held_ = held_columns(table);
  }

  void add_run(std::vector<TimedGroup> groups) {
    for (TimedGroup& group : groups) told_.repeated += order_group(group);
    std::vector<double> intervals;
    for (const TimedGroup& group : groups) intervals.push_back(interval_in(group));
    const std::size_t grid = grid_of(groups, intervals);
    for (const TimedGroup& group : groups) told_.is_apart = told_.is_apart || group.times != groups.front().times;
    const JoinedRows rows = grid < groups.size() ? even_rows(groups, grid, intervals[grid]) : all_rows(groups);
    grid_name_ = grid < groups.size() ? groups[grid].names.front() : "";
    table_.values[0].insert(table_.values[0].end(), rows.times.begin(), rows.times.end());
    table_.line_numbers.insert(table_.line_numbers.end(), rows.lines.begin(), rows.lines.end());
    std::size_t column = 1;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const Placement placement(rows, groups[g], intervals[g]);
      told_.shift = std::max(told_.shift, placement.largest_shift());
      for (const auto& values : groups[g].values) {
        const std::vector<double> placed = placement.place(values, is_held_[column] != 0);
        table_.values[column].insert(table_.values[column].end(), placed.begin(), placed.end());
        ++column;
      }
    }
  }

  void tell() const {
    const std::string where =
        grid_name_.empty() ? "brought to one table by them"
                           : fmt::format("brought to those of {}{}", grid_name_,
                                         told_.shift > same_stamp ? fmt::format(", the furthest by {:.2g} of a row: "
                                                                                "commands as they stood, others drawn",
                                                                                told_.shift)
                                                                  : "");
    if (told_.is_apart) table_.report(0, ProblemKind::dialect, "each column has times of its own: " + where);
    if (told_.repeated > 0)
      table_.report(
          0, ProblemKind::repeated_time,
          fmt::format("{} values have the time of another of their column: their mean is used", told_.repeated));
  }

 private:
  /// The fastest even group, of several the one with a command: what is held cannot be drawn. Else no group.
  std::size_t grid_of(const std::vector<TimedGroup>& groups, const std::vector<double>& intervals) const {
    double fastest = no_value;
    for (const double interval : intervals) fastest = std::fmin(fastest, interval);
    std::size_t out = groups.size(), column = 1;
    bool has_command = false;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const auto begin = is_held_.begin() + static_cast<std::ptrdiff_t>(column);
      column += groups[g].names.size();
      const bool is_held = std::any_of(begin, is_held_.begin() + static_cast<std::ptrdiff_t>(column),
                                       [](char held) { return held != 0; });
      if (!(intervals[g] <= (1 + same_rate) * fastest) || (out < groups.size() && (has_command || !is_held))) continue;
      out = g;
      has_command = is_held;
    }
    return out;
  }

  CsvTable& table_;
  std::vector<char> is_held_;
  std::string grid_name_;
  JoinTold told_;
};

}  // namespace

void sort_by_time(TimedGroup& group) {
  if (std::is_sorted(group.times.begin(), group.times.end())) return;
  std::vector<std::size_t> rows(group.times.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return group.times[a] < group.times[b]; });
  reorder(group.lines, rows);
  for (auto& values : group.values) reorder(values, rows);
  reorder(group.times, rows);
}

void join_groups(CsvTable& table, std::vector<TimedGroup> groups) {
  GroupJoin join(table, groups);
  std::vector<std::vector<TimedGroup>> runs;  // of each group
  for (TimedGroup& group : groups) {
    leave_out_untimed(group);
    if (table.is_clock[0] != 0) pass_midnights(group.times, true);
    runs.push_back(group.times.empty() ? std::vector{group} : runs_of_group(group));
  }
  const std::size_t count = runs.front().size();
  const bool are_alike = std::all_of(runs.begin(), runs.end(), [&](const auto& of) { return of.size() == count; });
  if (!are_alike) join.add_run(std::move(groups));
  for (std::size_t r = 0; are_alike && r < count; ++r) {
    std::vector<TimedGroup> run;
    for (auto& of : runs) run.push_back(std::move(of[r]));
    join.add_run(std::move(run));
  }
  join.tell();
}

}  // namespace pneuservo
