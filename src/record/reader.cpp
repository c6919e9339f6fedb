// Reads recordings of docs/recording.md's format: a table whose times are checked.
#include "record/reader.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <pneuservo/record/row.hpp>

#include "config/input_error.hpp"
#include "record/column_values.hpp"
#include "record/header.hpp"
#include "record/kept_rows.hpp"

namespace pneuservo {

namespace {

constexpr double gap_periods = 1.5;  // a step in time that is longer misses at least one row
constexpr double spike_periods =
    10;  // a time that is ahead by more and then back is wrong itself; by less, the later row is

std::string quoted(const std::string& text) { return text.empty() ? "missing" : fmt::format("\"{}\"", text); }

void read_header(Recording& recording) {
  const YAML::Node& header = recording.header;
  const auto text = [&](const char* key) {
    const YAML::Node node = header[key];
    return node && node.IsScalar() ? node.Scalar() : std::string();
  };
  if (const std::string format = text("format"); format != RecordingHeader::format)
    recording.report(0, ProblemKind::header,
                     fmt::format("format is {}; expected {}", quoted(format), RecordingHeader::format));
  recording.rig = text("rig");
  if (recording.rig.empty())
    recording.report(0, ProblemKind::header, "rig is missing; expected the name of the config");
  double period_s = 0.0;
  const std::string period = text("period_s");
  if (!period.empty() && YAML::convert<double>::decode(header["period_s"], period_s) && period_s > 0 &&
      std::isfinite(period_s))
    recording.period_s = period_s;
  else
    recording.report(0, ProblemKind::header,
                     fmt::format("period_s is {}; expected a number above 0; gaps are not sought", quoted(period)));
}

/// Decides row by row which ones are in order; keeps their indices.
class TimeCheck {
 public:
  explicit TimeCheck(Recording& recording)
      : recording_(recording), t_s_(recording.t_s()),
        flags_(recording.has("flags") ? &recording.column("flags") : nullptr) {}

  std::vector<std::size_t> run() {
    for (std::size_t i = 0; i < t_s_.size(); ++i) take(i);
    for (const auto& gap : gaps_) report_gap(gap.before, gap.after);
    return std::move(kept_);
  }

 private:
  struct Gap {
    std::size_t before, after;
  };

  void report(std::size_t row, ProblemKind kind, std::string_view what) {
    recording_.report(recording_.line_numbers[row], kind, what);
  }

  void take(std::size_t i) {
    const double t = t_s_[i];
    if (!std::isfinite(t)) return report(i, ProblemKind::no_time, "t_s has no value; the row is not used");
    if (kept_.empty()) return kept_.push_back(i);
    const double before = t_s_[kept_.back()];
    if (t > before) {
      if (t - before > gap_periods * recording_.period_s) gaps_.push_back({kept_.back(), i});
      kept_.push_back(i);
    } else if (t == before) {
      report(i, ProblemKind::repeated_time,
             fmt::format("t_s {} is that of line {} again; the row is not used", t,
                         recording_.line_numbers[kept_.back()]));
    } else if (follows_a_spike(t)) {
      report(kept_.back(), ProblemKind::decreasing_time,
             fmt::format("t_s {} is ahead of line {} with {}; the row is not used", before, recording_.line_numbers[i],
                         t));
      kept_.back() = i;
      gaps_.pop_back();
    } else {
      report(i, ProblemKind::decreasing_time,
             fmt::format("t_s {} is behind line {} with {}; the row is not used", t,
                         recording_.line_numbers[kept_.back()], before));
    }
  }

  /// One time that jumped ahead must not cost all rows after it: this one continues where the jump began.
  bool follows_a_spike(double t) const {
    if (gaps_.empty() || gaps_.back().after != kept_.back()) return false;
    const double step = t - t_s_[gaps_.back().before], ahead = t_s_[kept_.back()] - t;
    return ahead > spike_periods * recording_.period_s && step > 0 && step <= 2.0 * gap_periods * recording_.period_s;
  }

  void report_gap(std::size_t before, std::size_t after) {
    const double step = t_s_[after] - t_s_[before];
    const auto missing = static_cast<std::size_t>(std::llround(step / recording_.period_s)) - 1;
    const bool dropped = flags_ != nullptr && (static_cast<std::uint32_t>(flag_value(after)) & row_dropped_before) != 0;
    recording_.missing_rows += missing;
    if (dropped) recording_.dropped_rows += missing;
    report(after, ProblemKind::gap,
           fmt::format("t_s goes from {} to {}, a step of {:.6g} s where period_s is {}: {} row{} missing{}",
                       t_s_[before], t_s_[after], step, recording_.period_s, missing, missing == 1 ? " is" : "s are",
                       dropped ? ", which the recorder dropped (flags bit 2)" : ""));
  }

  double flag_value(std::size_t row) const {
    const double value = (*flags_)[row];
    return value >= 0 && value <= 4294967295.0 ? value : 0.0;
  }

  Recording& recording_;
  const std::vector<double>& t_s_;
  const std::vector<double>* flags_;
  std::vector<std::size_t> kept_;
  std::vector<Gap> gaps_;
};

}  // namespace

ImportedColumn source_of(const Recording& recording, const std::string& column) {
  const auto found = recording.sources.find(column);
  if (found != recording.sources.end()) return found->second;
  ImportedColumn own;
  own.column = column;
  return own;
}

double median_step_s(const std::vector<double>& time_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i)
    if (time_s[i] > time_s[i - 1]) steps.push_back(time_s[i] - time_s[i - 1]);
  if (steps.empty()) return std::numeric_limits<double>::quiet_NaN();
  return median_of(std::move(steps));
}

double row_interval_s(const Recording& recording) {
  return std::isfinite(recording.period_s) ? recording.period_s : median_step_s(recording.t_s());
}

void check_times(Recording& recording) {
  const std::vector<std::size_t> kept = TimeCheck(recording).run();
  if (kept.empty()) throw InputError(recording.path + ": no row has a time; expected numbers in column t_s");
  if (kept.size() < recording.rows()) {
    for (auto& values : recording.values) keep_only(values, kept);
    keep_only(recording.line_numbers, kept);
  }
  std::stable_sort(recording.problems.begin(), recording.problems.end(),
                   [](const auto& a, const auto& b) { return a.line < b.line; });
}

bool is_own_format(const CsvTable& table) {
  const YAML::Node format = table.header["format"];
  return format && format.IsScalar() && format.Scalar() == RecordingHeader::format;
}

void read_keys(Recording& recording) { read_header(recording); }

Recording read_recording(const std::string& path) {
  Recording recording;
  static_cast<CsvTable&>(recording) = read_table(path);
  recording.require({"t_s"});
  read_keys(recording);
  check_times(recording);
  return recording;
}

}  // namespace pneuservo
