// What the time stamps of a table say.
#include "record/foreign/stamps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string_view>
#include <utility>

#include "record/column_values.hpp"
#include "record/reader.hpp"

namespace pneuservo {

namespace {

constexpr double least_epoch_s = 3e8, most_epoch_s = 3.3e9;  ///< 1979 to 2074
/// Rows nearer than this show nothing that gas or slider do, and rows further apart nothing of a motion.
constexpr double fastest_s = 1e-6, slowest_s = 100;
/// Where other programs begin to count, each from 2000 to about 2090; what lies between is since 1970.
struct Epoch {
  double factor, low, high;
  std::string_view words;
};
constexpr std::array<Epoch, 7> epochs{{{1e-7, 1.259e17, 1.55e17, "units of 100 ns since 1601"},
                                       {1e-7, 6.31e17, 6.6e17, "units of 100 ns since the year 1"},
                                       {1e-9, 7.5e17, 9.9e17, "nanoseconds since 2000"},
                                       {1, 3.3e9, 5e9, "seconds since 1904"},
                                       {86400, 36526, 69400, "days since 1899-12-30"},
                                       {86400, 730486, 763360, "days since the year 0"},
                                       {86400, 2451545, 2484420, "Julian days"}}};
/// Stamps a tenth of a millisecond apart that begin where a count of days does: days.
constexpr double least_step_of_seconds = 1e-4;
constexpr double slowest_periods = 200;  ///< rows further apart show a loop nothing: their unit is another
constexpr std::array<std::pair<double, std::string_view>, 7> time_units{{{1.0, "seconds"},
                                                                         {1e-3, "milliseconds"},
                                                                         {1e-6, "microseconds"},
                                                                         {1e-9, "nanoseconds"},
                                                                         {60.0, "minutes"},
                                                                         {3600.0, "hours"},
                                                                         {86400.0, "days"}}};
constexpr std::size_t rows_of_a_run = 3;  ///< that must go on behind a step back; fewer are rows out of order
constexpr double interval_agreement = 0.25;  ///< of the interval: rounding to half of it moves a step that far
constexpr double course_gain = 0.1;          ///< of a stamp's distance from the even course, which it moves by
constexpr double longest_at_wrap = 4;        ///< intervals: a run that ends so near to a counter's end is rare
constexpr double longest_counted = 20;       ///< intervals: behind a longer gap rows are counted anew

double first_finite(const std::vector<double>& values) {
  const auto at = std::find_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  return at == values.end() ? no_value : *at;
}

bool is_possible_step(double step_s, double period_s) {
  return !(step_s > slowest_periods * period_s) && step_s < slowest_s && step_s > 0.5 * fastest_s;
}

/// Whether rows i, i + 1, ... go on from row i upwards and stay behind `before`.
bool goes_on(const std::vector<double>& t, std::size_t i, double before) {
  double last = t[i];
  std::size_t count = 0;
  for (std::size_t k = i + 1; k < t.size() && count < rows_of_a_run; ++k) {
    if (!std::isfinite(t[k])) continue;
    if (t[k] < last || t[k] >= before) return false;
    last = t[k];
    ++count;
  }
  return count == rows_of_a_run;
}

/// Adds a turn wherever times go back by one less a step of at most `longest`; how often. Those of a clock are within a
/// turn, others must be, and each step must go on.
std::size_t go_on_behind(std::vector<double>& t, double turn, double longest, bool is_clock, double least = 0) {
  double before = no_value, added = 0;
  std::size_t count = 0;
  for (double& time : t) {
    if (!std::isfinite(time)) continue;
    const double now = time + added, step = now - before;
    const bool is_within = is_clock || (before - added <= least + turn && time >= least && step + turn > 0);
    if (step < 0 && step + turn < longest && is_within) added += turn, ++count;
    time += added;
    before = time;
  }
  return count;
}

/// First rows of groups of equal stamps.
std::vector<std::size_t> groups_of(const std::vector<double>& t) {
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (i == 0 || t[i] != t[i - 1]) first.push_back(i);
  return first;
}

/// Whether some time is earlier than the one before it.
bool goes_back(const std::vector<double>& t) {
  double before = no_value;
  for (const double time : t) {
    if (time < before) return true;
    if (std::isfinite(time)) before = time;
  }
  return false;
}

/// Rows of the whole groups from..to (numbers of groups) on the line nearest to their first rows: without that of the
/// first group, which may be cut off at its start.
void spread(std::vector<double>& t, const std::vector<std::size_t>& group, std::size_t from, std::size_t to,
            std::size_t end_row, double step_s) {
  const std::size_t first = to > from + 1 ? from + 1 : from;
  const double origin = t[group[first]], count = static_cast<double>(to - first + 1);
  const auto row_of = [&](std::size_t i) { return static_cast<double>(i) - static_cast<double>(group[first]); };
  double mean_row = 0, mean_s = 0, up = 0, down = 0;
  for (std::size_t g = first; g <= to; ++g)
    mean_row += row_of(group[g]) / count, mean_s += (t[group[g]] - origin) / count;
  for (std::size_t g = first; g <= to; ++g) {
    const double row = row_of(group[g]) - mean_row;
    up += row * (t[group[g]] - origin - mean_s), down += row * row;
  }
  const double h = down > 0 ? up / down : step_s;
  for (std::size_t i = group[from]; i < end_row; ++i) t[i] = origin + mean_s + h * (row_of(i) - mean_row);
}

/// Slope of times over row numbers, common to stretches that each have their own start.
class StampSlope {
 public:
  void add(double number, double time_s) {
    numbers_.push_back(number);
    times_s_.push_back(time_s);
  }
  void close() {
    const double count = static_cast<double>(numbers_.size());
    const double mean_n = std::accumulate(numbers_.begin(), numbers_.end(), 0.0) / count;
    const double mean_t = std::accumulate(times_s_.begin(), times_s_.end(), 0.0) / count;
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      up_ += (numbers_[i] - mean_n) * (times_s_[i] - mean_t);
      down_ += (numbers_[i] - mean_n) * (numbers_[i] - mean_n);
    }
    numbers_ = {0};
    times_s_ = {0};
  }
  double value(double otherwise) const { return down_ > 0 ? up_ / down_ : otherwise; }

 private:
  std::vector<double> numbers_{0}, times_s_{0};
  double up_ = 0, down_ = 0;
};

/// Of stamps that are all rounded to one resolution.
bool spread_alike(std::vector<double>& t) {
  const std::vector<std::size_t> group = groups_of(t);
  if (group.size() < 4 || t.size() < 3 * group.size() / 2) return false;
  // The first and the last group may be cut off.
  const double usual = static_cast<double>(group.back() - group[1]) / static_cast<double>(group.size() - 2);
  std::size_t regular = 0;
  std::vector<double> steps;
  for (std::size_t g = 0; g + 1 < group.size(); ++g) {
    regular += std::abs(static_cast<double>(group[g + 1] - group[g]) - usual) <= 1.0;
    steps.push_back(t[group[g + 1]] - t[group[g]]);
  }
  if (static_cast<double>(regular) < 0.9 * static_cast<double>(group.size() - 1)) return false;
  const double usual_step = median_of(steps);
  std::size_t from = 0;
  for (std::size_t g = 0; g < group.size(); ++g) {
    const bool ends = g + 1 == group.size() || steps[g] > 1.5 * usual_step || steps[g] <= 0;
    if (!ends) continue;
    spread(t, group, from, g, g + 1 < group.size() ? group[g + 1] : t.size(), usual_step / usual);
    from = g + 1;
  }
  return true;
}

/// Where the number of digits before the decimal sign changes and equal stamps become at least so much more or less
/// frequent: of numbers with a fixed count of digits the resolution changes there.
std::vector<std::size_t> resolution_changes(const std::vector<double>& t) {
  constexpr double other_size = 2;
  const auto digits = [](double time) { return time == 0 ? 0.0 : std::floor(std::log10(std::abs(time))); };
  std::vector<std::size_t> candidates{0};
  for (std::size_t i = 1; i < t.size(); ++i)
    if (digits(t[i]) != digits(t[i - 1]) && std::isfinite(t[i])) candidates.push_back(i);
  candidates.push_back(t.size());
  const auto rows_a_stamp = [&](std::size_t from, std::size_t end) {
    std::size_t groups = 1;
    for (std::size_t i = from + 1; i < end; ++i) groups += t[i] != t[i - 1];
    return static_cast<double>(end - from) / static_cast<double>(groups);
  };
  std::vector<std::size_t> out{0};
  for (std::size_t c = 1; c + 1 < candidates.size(); ++c) {
    const double before = rows_a_stamp(out.back(), candidates[c]),
                 behind = rows_a_stamp(candidates[c], candidates[c + 1]);
    if (before >= other_size * behind || behind >= other_size * before) out.push_back(candidates[c]);
  }
  out.push_back(t.size());
  return out;
}

/// Moves rows that were spread evenly, but rounded to the nearest stamp, so far that they go on behind the row before.
void join_to(double before, std::vector<double>& part, double resolution) {
  const double shift = before + (part.back() - part.front()) / static_cast<double>(part.size() - 1) - part.front();
  if (!(std::abs(shift) <= resolution)) return;
  for (double& time : part) time += shift;
}

}  // namespace

TimeUnit unit_of_times(const std::vector<double>& stamps, double period_s, bool is_clock) {
  TimeUnit out;
  const double first = first_finite(stamps);
  if (is_clock) return {1, first, "dates or times of day"};
  const double step = median_step_s(stamps);
  for (const Epoch& epoch : epochs)
    if (first >= epoch.low && first < epoch.high && is_possible_step(step * epoch.factor, period_s) &&
        (epoch.factor < 2 || step < least_step_of_seconds))
      return {epoch.factor, first, std::string(epoch.words)};
  for (const auto& [factor, name] : time_units)
    if (factor <= 1 && first * factor > least_epoch_s && first * factor < most_epoch_s &&
        is_possible_step(step * factor, period_s))
      return {factor, first, std::string(name) + " since 1970"};
  // A counter that no date begins: the unit whose rows are nearest to the loop's, or to a millisecond.
  const double usual_s = std::isfinite(period_s) ? period_s : 1e-3;
  if (!(step > slowest_periods * period_s) && !(step > slowest_s) && !(step < fastest_s)) return out;
  const auto distance = [&](double factor) { return std::abs(std::log(step * factor / usual_s)); };
  for (const auto& [factor, name] : time_units)
    if (distance(factor) < distance(out.factor)) out = {factor, 0, std::string(name)};
  return out;
}

std::size_t pass_midnights(std::vector<double>& t, bool is_clock) {
  constexpr double day_s = 86400;
  if (!goes_back(t)) return 0;
  return go_on_behind(t, day_s, is_clock ? 0.5 * day_s : longest_counted * median_step_s(t), is_clock);
}

int pass_wraps(std::vector<double>& t) {
  if (!goes_back(t)) return 0;
  const double longest = longest_at_wrap * median_step_s(t);
  for (const int bits : {16, 24, 32})
    for (const double unit : {1.0, 1e-3, 1e-6})
      for (const double share : {0.0, -0.5}) {  // of the turn, that lies below zero: with a sign half of it
        const double turn = std::ldexp(unit, bits);
        if (turn > 1 && go_on_behind(t, turn, longest, false, share * turn) > 0) return bits;
      }
  return 0;
}

Turns turns_of(const std::vector<double>& t, double unit_s) {
  constexpr std::array<std::pair<double, std::string_view>, 3> turns{
      {{1.0, "second"}, {60.0, "minute"}, {3600.0, "hour"}}};
  if (!goes_back(t)) return {};
  const double longest = longest_at_wrap * median_step_s(t);
  for (const auto& [turn_s, words] : turns) {
    Turns out{{}, turn_s / unit_s, std::string(words)};
    double before = no_value;
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (!std::isfinite(t[i])) continue;
      const double step = t[i] + out.turn - before;
      if (t[i] < before && t[i] >= 0 && before <= out.turn && step > 0 && step <= longest) out.rows.push_back(i);
      before = t[i];
    }
    if (!out.rows.empty()) return out;
  }
  return {};
}

void pass_turns(std::vector<double>& t, const Turns& turns) {
  auto next = turns.rows.begin();
  double added = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (next != turns.rows.end() && *next == i) added += turns.turn, ++next;
    t[i] += added;
  }
}

std::vector<std::size_t> run_starts(const std::vector<double>& t) {
  std::vector<std::size_t> starts{0};
  double before = no_value, last_but_one = no_value;
  const double step = median_step_s(t);
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(t[i])) continue;
    if (t[i] < before) {
      const bool was_spike = t[i] > last_but_one && t[i] - last_but_one < 3 * step;
      if (!was_spike && goes_on(t, i, before)) starts.push_back(i);
      else if (!was_spike) continue;  // a row out of order
    }
    last_but_one = before;
    before = t[i];
  }
  return starts;
}

bool spread_rounded(std::vector<double>& t) {
  const std::vector<std::size_t> ends = resolution_changes(t);
  if (ends.size() == 2) return spread_alike(t);
  bool is_any = false;
  for (std::size_t p = 0; p + 1 < ends.size(); ++p) {
    const auto begin = t.begin() + static_cast<std::ptrdiff_t>(ends[p]);
    std::vector<double> part(begin, t.begin() + static_cast<std::ptrdiff_t>(ends[p + 1]));
    const double resolution = median_step_s(part);
    if (!spread_alike(part)) continue;
    if (p > 0) join_to(t[ends[p] - 1], part, resolution);
    std::copy(part.begin(), part.end(), begin);
    is_any = true;
  }
  return is_any;
}

std::size_t fill_between(std::vector<double>& t) {
  std::vector<std::size_t> at;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::isfinite(t[i])) at.push_back(i);
  if (at.size() < 3 || at.size() == t.size()) return 0;
  const auto rows_to = [&](std::size_t k) { return static_cast<double>(at[k] - at[k - 1]); };
  std::vector<double> steps, counts;
  for (std::size_t k = 1; k < at.size(); ++k)
    if (t[at[k]] > t[at[k - 1]]) steps.push_back((t[at[k]] - t[at[k - 1]]) / rows_to(k)), counts.push_back(rows_to(k));
  if (steps.empty()) return 0;
  const double usual = median_of(steps), block = median_of(counts);
  std::size_t filled = 0;
  const auto fill = [&](std::size_t from, std::size_t end, std::size_t origin, double step) {
    const double start = t[origin];
    for (std::size_t i = from; i < end; ++i, ++filled)
      t[i] = start + step * (static_cast<double>(i) - static_cast<double>(origin));
  };
  for (std::size_t k = 1; k < at.size(); ++k) {
    const double step = (t[at[k]] - t[at[k - 1]]) / rows_to(k);
    if (std::abs(step - usual) <= interval_agreement * usual) fill(at[k - 1] + 1, at[k], at[k - 1], step);
  }
  // Blocks at both ends may be cut off.
  if (static_cast<double>(at.front()) < block) fill(0, at.front(), at.front(), usual);
  if (static_cast<double>(t.size() - at.back() - 1) < block) fill(at.back() + 1, t.size(), at.back(), usual);
  return filled;
}

double interval_of(const std::vector<double>& t) {
  double h = median_step_s(t);
  // The mean of the steps of one row: where stamps are rounded their median is one of two values.
  for (int round = 0; round < 3 && std::isfinite(h); ++round) {
    double sum = 0, count = 0;
    for (std::size_t i = 1; i < t.size(); ++i) {
      const double step = t[i] - t[i - 1];
      if (step > 0 && step < 1.6 * h) sum += step, ++count;
    }
    if (count > 0) h = sum / count;
  }
  StampSlope slope;
  std::size_t agree = 0, steps = 0;
  // Rows are counted against their own even course, which follows the stamps slowly: jitter of one does not count.
  double start = t.front(), course = t.front(), rows = 0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (!std::isfinite(t[i])) continue;
    const double count = std::round((t[i] - course) / h);
    ++steps;
    if (count < 1 && count >= 0) continue;  // a row again
    if (!(count >= 1 && count <= longest_counted)) {
      slope.close();
      start = course = t[i];
      rows = 0;
      continue;
    }
    rows += count;
    course += count * h;
    agree += std::abs(t[i] - course) < interval_agreement * h && count < 4;
    course += course_gain * (t[i] - course);
    slope.add(rows, t[i] - start);
  }
  slope.close();
  if (2 * agree < steps) return no_value;
  return slope.value(h);
}

}  // namespace pneuservo
