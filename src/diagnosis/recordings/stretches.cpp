// Recordings cut where their inputs are missing.
#include "diagnosis/recordings/stretches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/recordings/even_samples.hpp"

namespace pneuservo {

namespace {

using Span = TimeSpan;

constexpr double least_axis_s = 0.3;           ///< the balance's kernels reach 0.15 s beyond what is judged
constexpr double least_axis_intervals = 60;    ///< and 24 intervals to both sides of slowly sampled rows
constexpr double least_cylinder_s = first_compared_s + 1.0;
constexpr std::size_t told_gaps = 3;

/// Columns that nothing can be compared without.
std::vector<std::string> input_columns(const Rig& rig, const Recording& recording) {
  if (rig.kind == RigKind::driven_axis && !recording.has("F_N") && !recording.has("u_V")) return {"x_m"};
  if (rig.kind == RigKind::driven_axis) return {"x_m", recording.has("F_N") ? "F_N" : "u_V"};
  std::vector<std::string> columns = command_columns(rig);
  columns.emplace_back("x_m");
  return columns;
}

/// Where one of the columns has no value for longer than can be drawn through.
std::vector<Span> gaps_of(const Recording& recording, const std::vector<std::string>& columns) {
  const std::vector<double>& t = recording.t_s();
  std::vector<Span> gaps;
  for (const std::string& name : columns) {
    if (!recording.has(name)) continue;
    std::vector<double> known;
    for (std::size_t i = 0; i < t.size(); ++i)
      if (std::isfinite(recording.column(name)[i])) known.push_back(t[i]);
    if (known.empty()) continue;
    const double longest = longest_drawn_s(std::max(row_interval_s(recording), median_step_s(known)));
    if (known.front() - t.front() > longest) gaps.emplace_back(t.front(), known.front());
    for (std::size_t i = 1; i < known.size(); ++i)
      if (known[i] - known[i - 1] > longest) gaps.emplace_back(known[i - 1], known[i]);
    if (t.back() - known.back() > longest) gaps.emplace_back(known.back(), t.back());
  }
  std::sort(gaps.begin(), gaps.end());
  gaps.erase(std::unique(gaps.begin(), gaps.end()), gaps.end());  // rows that are missing lack every column
  return gaps;
}

/// What lies between the gaps.
std::vector<Span> spans_between(const std::vector<Span>& gaps, double from, double to) {
  std::vector<Span> spans;
  for (const Span& gap : gaps) {
    if (gap.first > from) spans.emplace_back(from, gap.first);
    from = std::max(from, gap.second);
  }
  if (to > from) spans.emplace_back(from, to);
  return spans;
}

void tell_gaps(const Recording& recording, const std::vector<Span>& gaps, std::vector<std::string>& notes) {
  std::string text;
  for (std::size_t i = 0; i < std::min(gaps.size(), told_gaps); ++i)
    text += fmt::format("{}{:.6g} to {:.6g} s", i > 0 ? ", " : "", gaps[i].first, gaps[i].second);
  if (gaps.size() > told_gaps) text += fmt::format(" and {} more", gaps.size() - told_gaps);
  notes.push_back(
      fmt::format("{}: position or drive are missing from {}; what follows a gap is compared as a recording "
                  "of its own",
                  recording.path, text));
}

/// Rows further apart show a loop nothing, and nearer ones nothing that gas or slider do.
constexpr double slowest_periods = 200, fastest_s = 1e-6;

void refuse_interval(const Rig& rig, const Recording& recording) {
  const double interval_s = row_interval_s(recording);
  if (recording.rows() < 2) throw InputError(fmt::format("{}: found one row, expected a recording", recording.path));
  if (interval_s >= fastest_s && interval_s <= slowest_periods * rig.period_s) return;
  throw InputError(fmt::format("{}: rows are {:.4g} s apart, expected {:g} to {:g} s: in which unit is t_s? State it: "
                               "import: {{columns: {{t_s: {{column: t_s, factor: ...}}}}}}",
                               recording.path, interval_s, fastest_s, slowest_periods * rig.period_s));
}

/// A grid that has next to no rows is none.
void refuse_sparse(const Recording& recording) {
  try {
    const EvenSamples even(recording.t_s(), row_interval_s(recording));
  } catch (const InputError& error) { throw InputError(fmt::format("{}: {}", recording.path, error.what())); }
}

}  // namespace

void refuse_intervals(const Rig& rig, const std::vector<Recording>& recordings) {
  if (!rig.has_controller()) return;
  for (const Recording& recording : recordings) refuse_interval(rig, recording);
}

Recording part_of(const Recording& recording, const TimeSpan& span) {
  const std::vector<double>& t = recording.t_s();
  const auto first = std::lower_bound(t.begin(), t.end(), span.first) - t.begin();
  const auto end = std::upper_bound(t.begin(), t.end(), span.second) - t.begin();
  Recording part;
  part.header = recording.header;
  part.names = recording.names;
  part.rig = recording.rig;
  part.period_s = recording.period_s;
  part.is_held_out = recording.is_held_out;
  part.sources = recording.sources;
  part.stated_units = recording.stated_units;
  part.changed = recording.changed;
  part.path = fmt::format("{} ({:.6g} to {:.6g} s)", recording.path, span.first, span.second);
  for (const auto& values : recording.values) part.values.emplace_back(values.begin() + first, values.begin() + end);
  part.line_numbers = {recording.line_numbers.begin() + first, recording.line_numbers.begin() + end};
  return part;
}

double way_of(const Recording& recording, const std::string& column, const TimeSpan& span) {
  const std::vector<double>&t = recording.t_s(), &y = recording.column(column);
  const auto first = static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), span.first) - t.begin());
  double way = 0, last = y[first];
  // Every 20 ms: noise of single rows is no way.
  double next_s = span.first;
  for (std::size_t i = first; i < t.size() && t[i] <= span.second; ++i) {
    if (t[i] < next_s || !std::isfinite(y[i])) continue;
    if (std::isfinite(last)) way += std::abs(y[i] - last);
    last = y[i];
    next_s = t[i] + 0.02;
  }
  return way;
}

Recording most_moving_part(const Recording& recording, double seconds) {
  const double from = recording.t_s().front(), to = recording.t_s().back();
  TimeSpan best{from, from + seconds};
  double most = -1;
  const double step = std::max(0.5 * seconds, (to - from) / 200);
  for (double start = from; start == from || start + seconds <= to; start += step) {
    const double way = way_of(recording, "x_m", {start, start + seconds});
    if (way > most) most = way, best = {start, start + seconds};
  }
  return part_of(recording, best);
}

std::vector<Recording> compared_stretches(const Rig& rig, std::vector<Recording> recordings,
                                          std::vector<std::string>& notes) {
  if (!rig.has_controller()) return recordings;
  std::vector<Recording> out;
  double longest_s = 0, least_s = 0;
  std::string first_path = recordings.front().path;
  for (Recording& recording : recordings) {
    const std::vector<double>& t = recording.t_s();
    const std::vector<Span> gaps = gaps_of(recording, input_columns(rig, recording));
    least_s = rig.is_pneumatic() ? least_cylinder_s
                                 : std::max(least_axis_s, least_axis_intervals * row_interval_s(recording));
    if (gaps.empty()) {
      out.push_back(std::move(recording));
      continue;
    }
    tell_gaps(recording, gaps, notes);
    for (const Span& span : spans_between(gaps, t.front(), t.back())) {
      longest_s = std::max(longest_s, span.second - span.first);
      if (span.second - span.first >= least_s) out.push_back(part_of(recording, span));
      else
        notes.push_back(fmt::format("{}: {:.6g} to {:.6g} s is left out: a stretch needs {:.3g} s", recording.path,
                                    span.first, span.second, least_s));
    }
  }
  if (out.empty())
    throw InputError(fmt::format("{}: found no stretch without a gap longer than {:.3g} s, expected one of at least "
                                 "{:.3g} s",
                                 first_path, longest_s, least_s));
  for (const Recording& stretch : out) refuse_sparse(stretch);
  return out;
}

}  // namespace pneuservo
