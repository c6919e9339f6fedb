// Searches one set of numbers for a whole chapter, and lays what was found beside the print.
#include "thesis/one_set.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>
#include <thread>

#include <fmt/format.h>
#include <pneuservo/core/random.hpp>

#include "thesis/groups.hpp"

namespace pneuservo {
namespace {

/// From the unit interval to the number's range, and back for the one found.
double to_value(const FreeNumber& number, double share) {
  return number.is_logarithmic ? number.low * std::pow(number.high / number.low, share)
                               : number.low + share * (number.high - number.low);
}

double to_share(const FreeNumber& n, double value) {
  return n.is_logarithmic ? std::log(value / n.low) / std::log(n.high / n.low) : (value - n.low) / (n.high - n.low);
}

std::vector<double> to_values(const OneSet& set, const std::vector<double>& shares) {
  std::vector<double> out;
  for (std::size_t i = 0; i < shares.size(); ++i) out.push_back(to_value(set.numbers[i], shares[i]));
  return out;
}

struct Member {
  std::vector<double> shares, ours;
  double deviation = 0.0;
};

/// Every member on all cores, each with a bench of its own: what it computes is not kept.
void judge(const OneSet& set, const std::string& configs, std::vector<Member>& members) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < members.size(); i = next++) {
      Member& one = members[i];
      ThesisBench bench(configs);
      try {
        one.ours = figures_of(set, bench, to_values(set, one.shares));
      } catch (const std::exception&) {
        one.ours.clear();
      }  // no such machine: a gain that is not finite, a refused plan
      one.ours.resize(set.figures.size(), std::nan(""));
      one.deviation = total_deviation(set, one.ours, set.search_cap);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < std::max(1U, std::thread::hardware_concurrency()); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
}

/// Storn and Price's current-to-best/1/bin with a weight and a share of exchange drawn anew for every member.
Member offspring(const std::vector<Member>& all, std::size_t i, const Member& best, Random& random) {
  const auto any = [&] { return static_cast<std::size_t>(random.uniform() * static_cast<double>(all.size())); };
  const Member &a = all[any()], &b = all[any()];
  const double weight = 0.4 + 0.6 * random.uniform(), exchange = 0.3 + 0.7 * random.uniform();
  Member out = all[i];
  const std::size_t sure = static_cast<std::size_t>(random.uniform() * static_cast<double>(out.shares.size()));
  for (std::size_t k = 0; k < out.shares.size(); ++k) {
    if (k != sure && random.uniform() > exchange) continue;
    double& share = out.shares[k];
    share += weight * (best.shares[k] - share) + weight * (a.shares[k] - b.shares[k]);
    if (share < 0.0 || share > 1.0) share = random.uniform();
  }
  return out;
}

Member member_at(const OneSet& set, const std::vector<double>& values) {
  Member out;
  for (std::size_t i = 0; i < values.size(); ++i) out.shares.push_back(to_share(set.numbers[i], values[i]));
  return out;
}

/// Members all over the ranges.
std::vector<Member> drawn(const OneSet& set, std::size_t count, Random& random) {
  std::vector<Member> out(count);
  for (Member& one : out)
    for (std::size_t k = 0; k < set.numbers.size(); ++k) one.shares.push_back(random.uniform());
  return out;
}

// What the second stage covers about the best, as shares of the ranges.
constexpr double reaches[]{0.3, 0.1, 0.03, 0.01};
constexpr double few_moved = 0.15;

/// The best, and members within `reach` of it, with that share of their numbers moved.
std::vector<Member> drawn_about(const Member& best, double reach, double moved, std::size_t count, Random& random) {
  std::vector<Member> out(count, best);
  for (std::size_t i = 1; i < count; ++i)
    for (double& share : out[i].shares)
      if (moved >= 1.0 || random.uniform() < moved) share = std::clamp(share + random.uniform(-reach, reach), 0.0, 1.0);
  return out;
}

OneSetFound found_of(const OneSet& set, const Member& best, std::size_t evaluations) {
  return {to_values(set, best.shares), best.ours, total_deviation(set, best.ours), evaluations};
}

bool less_deviation(const Member& a, const Member& b) { return a.deviation < b.deviation; }

}  // namespace

double one_set_deviation(double ours, const PrintedFigure& figure) {
  constexpr std::string_view below = "below ";
  const std::string_view printed = figure.printed;
  const bool is_limit = printed.starts_with(below);
  const double over = std::log(ours / thesis_number(std::string(is_limit ? printed.substr(below.size()) : printed)));
  if (is_limit && over < 0.0 && ours >= 0.0) return 0.0;
  return std::isfinite(over) ? std::fabs(over) : std::numeric_limits<double>::infinity();
}

double total_deviation(const OneSet& set, const std::vector<double>& ours, double cap) {
  double sum = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < set.figures.size(); ++i) {
    const double apart = std::min(one_set_deviation(ours[i], set.figures[i]), cap);
    const double share = std::fabs(ours[i] / thesis_number(set.figures[i].printed) - 1.0);
    sum += apart;
    largest = std::max(largest, std::isfinite(share) ? share : cap);
  }
  return set.measure == SetMeasure::sum ? sum : largest;
}

std::vector<double> figures_of(const OneSet& set, ThesisBench& bench, const std::vector<double>& at) {
  std::vector<double> out;
  for (const PrintedFigure& figure : set.figures) out.push_back(figure.ours(bench, at));
  return out;
}

OneSet with_figures(OneSet set, const std::vector<std::string>& places) {
  std::vector<PrintedFigure> kept;
  for (const std::string& place : places) {
    const auto is_it = [&](const PrintedFigure& figure) {
      return figure.place == place || std::string_view(figure.place).ends_with(" " + place);
    };
    if (std::ranges::any_of(kept, is_it)) continue;
    std::ranges::copy_if(set.figures, std::back_inserter(kept), is_it);
    if (std::ranges::none_of(kept, is_it))
      throw std::invalid_argument(
          fmt::format("no figure '{}' in '{}', such as '{}'", place, set.name, set.figures.front().place));
  }
  set.figures = std::move(kept);
  return set;
}

std::vector<double> found_numbers(const OneSet& set) {
  std::vector<double> out;
  for (const FreeNumber& number : set.numbers) out.push_back(number.found);
  return out;
}

OneSetFound search_one_set(const OneSet& set, const std::string& configs, const OneSetSearch& search,
                           const std::function<void(const OneSetFound&)>& progress) {
  Random random(search.seed);
  std::size_t evaluations = 0;
  // Three members a number, or a twentieth of the trials: the others are for what comes of them.
  const std::size_t count =
      std::clamp<std::size_t>(3 * set.numbers.size(), 8, std::max<std::size_t>(search.evaluations / 20, 8));
  Member best;
  best.deviation = std::numeric_limits<double>::infinity();
  const auto evolve = [&](std::vector<Member> all, std::size_t until) {
    judge(set, configs, all);
    evaluations += count;
    for (;;) {
      const Member& nearest = *std::ranges::min_element(all, less_deviation);
      if (nearest.deviation < best.deviation) best = nearest;
      progress(found_of(set, best, evaluations));
      if (evaluations >= until) return;
      std::vector<Member> next;
      for (std::size_t i = 0; i < count; ++i) next.push_back(offspring(all, i, best, random));
      judge(set, configs, next);
      evaluations += count;
      for (std::size_t i = 0; i < count; ++i)
        if (next[i].deviation <= all[i].deviation) all[i] = next[i];
    }
  };
  if (search.from_begun && set.begun.empty())
    throw std::invalid_argument(fmt::format("'{}' has no member set by hand", set.name));
  if (search.from_found || search.from_begun) {
    std::vector<Member> one{member_at(set, search.from_begun ? set.begun : found_numbers(set))};
    judge(set, configs, one);
    best = one[0];
    evaluations = 1;
  } else {
    evolve(drawn(set, count, random), search.evaluations / 2);
  }
  // About a good member most moves of all its numbers are bad ones.
  const double moved = search.from_found || search.from_begun ? few_moved : 1.0;
  const std::size_t rounds = std::size(reaches), first = evaluations, all = std::max(search.evaluations, evaluations);
  for (std::size_t k = 0; k < rounds; ++k)
    evolve(drawn_about(best, reaches[k], moved, count, random), first + (k + 1) * (all - first) / rounds);
  return found_of(set, best, evaluations);
}

std::vector<OneSet> all_one_sets() {
  std::vector<OneSet> sets{line_set(), table_set(), cylinder_set()};
  for (OneSet& set : line_length_sets()) sets.push_back(std::move(set));
  return sets;
}

namespace {

std::vector<double> found_figures(ThesisBench& bench, const OneSet& set) {
  return figures_of(set, bench, found_numbers(set));
}

ThesisRow figure_row(const OneSet& set, std::size_t i) {
  const PrintedFigure& figure = set.figures[i];
  return {.place = fmt::format("{}, one set", figure.place),
          .what = fmt::format("{} ({})", figure.what, set.name),
          .unit = figure.unit,
          .printed = figure.printed,
          .plant = set.plant,
          .ours = [set, i](ThesisBench& bench) { return found_figures(bench, set)[i]; },
          .within = one_set_within,
          .held = figure.held,
          .held_within = simulated_within,
          .why = *figure.held == '\0' ? "" : set.why,
          .command = fmt::format("pneuservo thesis --only 'one set'")};
}

/// How many figures the set found meets, and the sum of all deviations.
std::vector<ThesisRow> sum_rows(const OneSet& set) {
  const std::string command = fmt::format("pneuservo thesis --search {} {}", set.name, set.searched);
  return {{.place = "One set",
           .what = fmt::format("{}: figures within 10 %", set.name),
           .printed = fmt::format("{} of {}", set.figures.size(), set.figures.size()),
           .plant = set.plant,
           .ours =
               [set](ThesisBench& bench) {
                 const std::vector<double> ours = found_figures(bench, set);
                 std::size_t met = 0;
                 for (std::size_t i = 0; i < ours.size(); ++i)
                   met += judge_thesis_row(figure_row(set, i), ours[i]).verdict == ThesisVerdict::agrees ? 1U : 0U;
                 return ThesisValue(fmt::format("{} of {}", met, ours.size()));
               },
           .held = set.met_held,
           .why = set.why,
           .command = command},
          {.place = "One set",
           .what = fmt::format("{}: sum of |ln(ours/printed)|", set.name),
           .printed = "not given",
           .plant = set.plant,
           .ours = [set](ThesisBench& bench) { return total_deviation(set, found_figures(bench, set)); },
           .held = set.deviation_held,
           .held_within = simulated_within,
           .why = "the nearest that is known, found as docs/thesis.md says: a bound from above",
           .command = command}};
}

ThesisGroup sets_group(const char* title, const std::vector<OneSet>& sets) {
  ThesisGroup group{title, {}};
  for (const OneSet& set : sets) {
    for (std::size_t i = 0; i < set.figures.size(); ++i) group.rows.push_back(figure_row(set, i));
    for (ThesisRow& row : sum_rows(set)) group.rows.push_back(std::move(row));
  }
  return group;
}

}  // namespace

ThesisGroup thesis_table_sets_group() {
  ThesisGroup group = sets_group("One set for chapter 2", {line_set(), table_set()});
  for (auto rows : {most_met_rows(), line_length_rows(), damping_bound_rows(), order_bound_rows(), three_runs_rows(),
                    least_sum_rows(), table_together_rows()})
    for (ThesisRow& row : rows) group.rows.push_back(std::move(row));
  return group;
}

ThesisGroup thesis_cylinder_sets_group() { return sets_group("One axis for chapter 3", {cylinder_set()}); }

}  // namespace pneuservo
