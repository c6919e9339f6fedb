// Rows that repeat a sample, as a logger writes them that is faster than what it reads.
#include "record/foreign/held_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pneuservo/core/signal.hpp>

#include "record/kept_rows.hpp"

namespace pneuservo {

namespace {

constexpr double chance_of_hold = 1e-6;
constexpr std::size_t least_changes = 20;

/// Whether two neighbouring steps both change the value, which no held one does.
bool changes_twice(const std::vector<double>& values) {
  for (std::size_t i = 2; i < values.size(); ++i)
    if (std::abs(values[i] - values[i - 1]) > 0 && std::abs(values[i - 1] - values[i - 2]) > 0) return true;
  return false;
}

/// Rows at which a column changes, as numbers by their times; behind a missing row nothing is known.
struct Changes {
  std::vector<long long> numbers;
  bool have_sizes = false;  ///< steps are of many sizes
};

/// Whether many steps are several times a small one. A slow quantised channel changes by one quantum or two, which
/// the last written digit makes at most four times as large as each other.
bool are_of_many_sizes(std::vector<double> steps) {
  constexpr double most_of_quantum = 4 + 1e-6, least_share = 0.25;
  if (steps.empty()) return false;
  std::ranges::sort(steps);
  const double small = steps[steps.size() / 10];
  const auto large = std::ranges::count_if(steps, [&](double step) { return step > most_of_quantum * small; });
  return static_cast<double>(large) >= least_share * static_cast<double>(steps.size());
}

Changes changes_in(const std::vector<double>& values, const std::vector<long long>& number) {
  Changes out;
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = std::abs(values[i] - values[i - 1]);
    if (!(step > 0) || number[i] != number[i - 1] + 1) continue;
    out.numbers.push_back(number[i]);
    steps.push_back(step);
  }
  out.have_sizes = are_of_many_sizes(std::move(steps));
  return out;
}

/// How often a column is sampled: every `rows`-th from one on, or, with two and three rows between them, where it
/// changes.
struct Hold {
  long long rows = 1, phase = 0;
  bool is_uneven = false;
};

Hold hold_of(const std::vector<long long>& changes) {
  constexpr double even_odds = 0.5;  // at most, that a gap by chance is one of two
  if (changes.size() < least_changes) return {};
  std::vector<long long> gaps;
  for (std::size_t i = 1; i < changes.size(); ++i) gaps.push_back(changes[i] - changes[i - 1]);
  long long common = 0;
  for (const long long gap : gaps) common = std::gcd(common, gap);
  if (common > 1) {
    // A clock ticks always: most of its rows hold another sample.
    const long long ticks = (changes.back() - changes.front()) / common + 1;
    const bool is_clock = 2 * std::ssize(changes) > ticks;
    return is_clock && std::pow(static_cast<double>(common), 1 - static_cast<double>(gaps.size())) < chance_of_hold
               ? Hold{common, changes.front() % common, false}
               : Hold{};
  }
  // Of two samples that are equal by chance one does not show.
  const long long least = std::ranges::min(gaps);
  const auto single = std::ranges::count_if(gaps, [&](long long gap) { return gap <= least + 1; });
  const auto several = std::ranges::count_if(gaps, [&](long long gap) { return gap >= 2 * least && gap > least + 1; });
  const bool is_known = least == 2 && single + several == std::ssize(gaps) && single > 4 * several;
  return is_known && std::pow(even_odds, single) < chance_of_hold ? Hold{least, 0, true} : Hold{};
}

/// None where times do not go on.
std::vector<long long> row_numbers_by(const std::vector<double>& times) {
  const double interval = median_step_s(times);
  std::vector<long long> out{0};
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double step = std::round((times[i] - times[i - 1]) / interval);
    if (!(step >= 0 && std::isfinite(step))) return {};
    out.push_back(out.back() + std::llround(step));
  }
  return out;
}

/// How many repeats become none.
std::size_t empty_repeats(std::vector<double>& values, const std::vector<long long>& number, const Hold& hold) {
  std::size_t count = 0;
  double before = no_value;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double now = std::exchange(before, values[i]);
    const bool is_sample = hold.is_uneven ? values[i] != now : number[i] % hold.rows == hold.phase;
    if (is_sample || !std::isfinite(values[i])) continue;
    before = values[i];
    values[i] = no_value;
    ++count;
  }
  return count;
}

/// Leaves out rows of a table that changes in every n-th one alone.
void thin_rows(Recording& run, std::vector<long long>& number) {
  std::vector<long long> changes;
  bool have_sizes = false;
  for (std::size_t c = 0; c < run.names.size(); ++c) {
    if (run.names[c] == "t_s") continue;
    const Changes of_column = changes_in(run.values[c], number);
    have_sizes = have_sizes || (of_column.have_sizes && signal_of_column(run.names[c]));
    std::vector<long long> all;
    std::ranges::set_union(changes, of_column.numbers, std::back_inserter(all));
    changes = std::move(all);
  }
  const Hold hold = hold_of(changes);
  if (hold.rows == 1 || hold.is_uneven || !have_sizes) return;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < number.size(); ++i)
    if (number[i] % hold.rows == hold.phase) kept.push_back(i);
  run.report(0, ProblemKind::interval,
             fmt::format("all columns change in every {}. row alone: {} rows that repeat the one before are left out",
                         hold.rows, number.size() - kept.size()));
  for (std::vector<double>& values : run.values) keep_only(values, kept);
  keep_only(run.line_numbers, kept);
  number = row_numbers_by(run.t_s());
}

}  // namespace

void leave_out_repeats(Recording& run) {
  std::vector<std::size_t> held;
  bool are_all = true;
  for (std::size_t c = 0; c < run.names.size(); ++c) {
    if (run.names[c] == "t_s") continue;
    const bool is_held = !changes_twice(run.values[c]);
    are_all = are_all && is_held;
    if (is_held && signal_of_column(run.names[c])) held.push_back(c);
  }
  if (held.empty()) return;
  std::vector<long long> number = row_numbers_by(run.t_s());
  if (number.size() < run.rows()) return;
  if (are_all) thin_rows(run, number);
  std::map<std::pair<long long, bool>, std::vector<std::string>> told;
  for (const std::size_t c : held) {
    const Changes changes = changes_in(run.values[c], number);
    const Hold hold = hold_of(changes.numbers);
    if (hold.rows == 1 || !changes.have_sizes || empty_repeats(run.values[c], number, hold) == 0) continue;
    told[{hold.rows, hold.is_uneven}].push_back(source_of(run, run.names[c]).column);
  }
  for (const auto& [rows, names] : told)
    run.report(0, ProblemKind::interval,
               fmt::format("{} change{} in every {}{}. row alone: the repeats between are no samples",
                           fmt::join(names, ", "), names.size() == 1 ? "s" : "", rows.first,
                           rows.second ? fmt::format(". or {}", rows.first + 1) : ""));
}

}  // namespace pneuservo
