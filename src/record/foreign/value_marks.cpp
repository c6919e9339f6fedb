// Numbers that a logger writes where it has no value.
#include "record/foreign/value_marks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pneuservo/core/signal.hpp>

#include "record/column_values.hpp"
#include "record/foreign/channel_steps.hpp"

namespace pneuservo {

namespace {

constexpr double steps_apart = 10;  ///< of a mark from values beside it, in the largest step of the others; and of a
                                    ///< size from all usual ones
constexpr double chance_of_noise = 1e-3;   ///< that so many readings are exactly alike
constexpr std::size_t least_others = 30;   ///< values that tell what is usual
constexpr int most_rounds = 4;             ///< in which up to three numbers are found each
constexpr double beyond_a_command =
    1000;  ///< times the largest other: less than a thousandth of its range moves nothing

/// Neighbouring rows with one value; rows without one between them do not part them.
struct EqualRun {
  std::size_t begin = 0, end = 0;
  double value = 0;
  double before = no_value, behind = no_value;  ///< values beside it

  /// The smaller one of the steps into it and out of it.
  double jump() const { return std::fmin(std::abs(value - before), std::abs(behind - value)); }
};

/// Calls `take` with each, as if values that are absent were none.
void for_each_equal_run(const std::vector<double>& values, const auto& is_absent, const auto& take) {
  EqualRun run;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || is_absent(values[i])) continue;
    if (run.end > 0 && values[i] != run.value) {
      run.behind = values[i];
      take(std::as_const(run));
      run = {i, i, values[i], run.value, no_value};
    } else if (run.end == 0) {
      run = {i, i, values[i], no_value, no_value};
    }
    run.end = i + 1;
  }
  if (run.end > 0) take(std::as_const(run));
}

/// A number that may be a mark.
struct Mark {
  double value = 0;
  std::size_t samples = 0;
  std::vector<EqualRun> visits;
};

using Numbers = std::set<double>;

/// Numbers that may be marks.
struct Candidates {
  Numbers numbers;  ///< the least, the largest, and the one with the largest steps on both sides
  double jump = 0;  ///< the smaller one of these steps
};

Candidates candidates_in(const std::vector<double>& values) {
  double low = no_value, high = no_value, farthest = no_value, jump = 0;
  for_each_equal_run(
      values, [](double) { return false; },
      [&](const EqualRun& run) {
        low = std::fmin(low, run.value), high = std::fmax(high, run.value);
        if (run.jump() > jump) farthest = run.value, jump = run.jump();
      });
  return {jump > 0 ? Numbers{low, high, farthest} : Numbers{}, jump};
}

/// Whether other values step so far that nothing stands apart, as in nearly every channel.
bool steps_hide_marks(const std::vector<double>& values, const Candidates& candidates) {
  const double least_step = 2 * candidates.jump / steps_apart;  // a mark beside a mark makes a jump half as large
  for (std::size_t i = 1; i < values.size(); ++i)
    if (std::abs(values[i] - values[i - 1]) >= least_step && !candidates.numbers.contains(values[i]) &&
        !candidates.numbers.contains(values[i - 1]))
      return true;
  return false;
}

/// What the values are that are not the mark.
struct Others {
  double largest_step = 0, largest = 0;
  std::size_t count = 0;
  double chance_alike = 1;      ///< that two of them are equal
  double chance_unchanged = 1;  ///< that neighbours are; 1 where most are, as of a channel at rest
};

Others others_of(const std::vector<double>& values, const Numbers& marks) {
  Others out;
  std::vector<double> others;
  double adjacent_step = 0, any_step = 0;
  std::size_t adjacent = 0, unchanged = 0, last = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || marks.contains(values[i])) continue;
    if (!others.empty()) {
      const double step = std::abs(values[i] - others.back());
      any_step = std::max(any_step, step);
      if (last + 1 == i) adjacent_step = std::max(adjacent_step, step), ++adjacent, unchanged += step == 0;
    }
    others.push_back(values[i]);
    out.largest = std::max(out.largest, std::abs(values[i]));
    last = i;
  }
  out.count = others.size();
  // Where every value stands between marks there are no neighbours.
  out.largest_step = adjacent >= least_others ? adjacent_step : any_step;
  std::size_t alike = 0;
  const std::size_t half = others.size() / 2;
  for (std::size_t i = 0; i < half; ++i) alike += others[i] == others[i + half];
  out.chance_alike = static_cast<double>(alike + 1) / static_cast<double>(half + 1);
  if (2 * unchanged < adjacent)
    out.chance_unchanged = static_cast<double>(unchanged + 1) / static_cast<double>(adjacent + 1);
  return out;
}

/// Size that three quarters of a channel's values do not exceed.
double usual_size(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return quantile(std::move(values), 0.75);
}

/// Whether no physics comes there and leaves again: far beyond what any channel usually has, or for single rows in few
/// places. A valve that switches takes a pressure to one exact level and leaves it for longer.
bool is_unphysical(const Mark& mark, const Others& others, double usual_of_all) {
  constexpr std::size_t longest = 3, most_of = 5;  ///< rows of a visit; one sample of so many
  return std::abs(mark.value) > steps_apart * std::max(others.largest, usual_of_all) ||
         (mark.samples <= longest * mark.visits.size() && most_of * mark.samples <= others.count);
}

/// Whether noise rules out that so many samples are alike. A zero at an end alone may be one.
bool is_exact(const Mark& mark, const Others& others) {
  const auto visits = static_cast<double>(mark.visits.size()), samples = static_cast<double>(mark.samples);
  if (mark.samples < 2 || (mark.value == 0 && mark.visits.size() < 2)) return false;
  return std::pow(others.chance_alike, visits - 1) * std::pow(others.chance_unchanged, samples - visits) <
         chance_of_noise;
}

/// Where a number stands apart from all that may be no marks.
Mark mark_at(const std::vector<double>& values, const Numbers& candidates, double number, double least_jump) {
  Mark out{number, 0, {}};
  const auto is_other_mark = [&](double value) { return value != number && candidates.contains(value); };
  for_each_equal_run(values, is_other_mark, [&](const EqualRun& run) {
    if (run.value != number || !(run.jump() > least_jump)) return;
    out.visits.push_back(run);
    for (std::size_t i = run.begin; i < run.end; ++i) out.samples += values[i] == number;
  });
  return out;
}

/// Of one channel. calm: its values without them and without single values that stand as far apart; empty: there are
/// none. is_taken: a further condition.
std::vector<Mark> marks_in(const std::vector<double>& all, std::vector<double>& calm, double usual_of_all,
                           const auto& is_taken) {
  std::vector<Mark> out;
  for (int round = 0; round < most_rounds; ++round) {
    const Candidates found = candidates_in(calm.empty() ? all : calm);
    if (found.numbers.empty() || steps_hide_marks(calm.empty() ? all : calm, found)) break;
    if (calm.empty()) calm = all;
    std::vector<double>& values = calm;
    const Numbers& candidates = found.numbers;
    const Others others = others_of(values, candidates);
    if (others.count < least_others) break;
    bool is_any = false;
    for (const double number : candidates) {
      Mark mark = mark_at(values, candidates, number, steps_apart * others.largest_step);
      const bool is_mark =
          is_exact(mark, others) && is_unphysical(mark, others, usual_of_all) && is_taken(mark, others);
      if (!is_mark && mark.samples != 1) continue;
      is_any = true;
      for (const EqualRun& run : mark.visits)
        for (std::size_t i = run.begin; i < run.end; ++i)
          if (values[i] == number) values[i] = no_value;
      if (is_mark) out.push_back(std::move(mark));
    }
    if (!is_any) break;
  }
  return out;
}

/// Where a channel stands among others, its values without marks, and the marks.
struct MarkedChannel {
  std::size_t place = 0;
  std::vector<double> calm;
  std::vector<Mark> marks;
};

/// Whether another channel steps where this one comes to the mark or leaves it: then it was there. Where the other has
/// a mark of its own in the same row, neither was.
bool is_seen_by(const Mark& mark, const std::vector<double>& values, const MarkedChannel& other) {
  std::vector<std::size_t> borders;
  const auto has_own = [&](std::size_t row) {
    return std::ranges::any_of(other.marks, [&](const Mark& own) { return values[row] == own.value; });
  };
  for (const EqualRun& visit : mark.visits) {
    if (visit.begin > 0 && !has_own(visit.begin)) borders.push_back(visit.begin);
    if (visit.end < values.size() && !has_own(visit.end - 1)) borders.push_back(visit.end);
  }
  std::erase_if(borders,
                [&, last = std::size_t{0}](std::size_t row) mutable { return std::exchange(last, row) == row; });
  return jumps_into(borders, values, other.calm.empty() ? values : other.calm);
}

}  // namespace

void leave_out_marks(CsvTable& table, const std::vector<std::string>& ours, const std::vector<std::string>& theirs,
                     std::vector<std::vector<double>>& values) {
  std::vector<MarkedChannel> channels;
  double usual_of_all = 0;
  for (std::size_t c = 0; c < ours.size(); ++c)
    if (signal_of_column(ours[c])) usual_of_all = std::fmax(usual_of_all, usual_size(values[c]));
  const auto add = [&](std::size_t c, const auto& is_taken) {
    MarkedChannel channel{c, {}, {}};
    channel.marks = marks_in(values[c], channel.calm, usual_of_all, is_taken);
    channels.push_back(std::move(channel));
  };
  for (std::size_t c = 0; c < ours.size(); ++c)
    if (signal_of_column(ours[c])) add(c, [](const Mark&, const Others&) { return true; });
  std::set<double> of_sensors;
  for (const MarkedChannel& channel : channels)
    for (const Mark& mark : channel.marks) of_sensors.insert(mark.value);
  of_sensors.erase(0);
  for (std::size_t c = 0; c < ours.size(); ++c)
    if (ours[c] == "u_V" || ours[c] == "x_ref_m")
      add(c, [&](const Mark& mark, const Others& others) {
        const double share = of_sensors.contains(mark.value) ? 1 : beyond_a_command;
        return others.largest > 0 && std::abs(mark.value) > share * others.largest;
      });
  std::vector<std::vector<Mark>> sure;
  for (const MarkedChannel& channel : channels) {
    sure.push_back(channel.marks);
    std::erase_if(sure.back(), [&](const Mark& mark) {
      return std::ranges::any_of(channels, [&](const MarkedChannel& other) {
        return &other != &channel && is_seen_by(mark, values[other.place], other);
      });
    });
  }
  std::map<std::string, std::vector<std::string>> told;
  for (std::size_t k = 0; k < channels.size(); ++k)
    for (const Mark& mark : sure[k]) {
      const std::size_t c = channels[k].place;
      for (const EqualRun& run : mark.visits)
        for (std::size_t i = run.begin; i < run.end; ++i)
          if (values[c][i] == mark.value) values[c][i] = no_value;
      told[fmt::format("{:.10g}", mark.value)].push_back(fmt::format("{} samples of {}", mark.samples, theirs[c]));
    }
  for (const auto& [mark, where] : told)
    table.report(
        0, ProblemKind::dialect,
        fmt::format("{} stands in {}, entered and left in one row: taken for no value", mark, fmt::join(where, ", ")));
}

}  // namespace pneuservo
