// One set of numbers for a chapter: deviations, a search on a planted family, the sets that the page holds.
#include <catch2/catch.hpp>

#include <cmath>
#include <sstream>

#include "thesis/groups.hpp"
#include "thesis/one_set.hpp"

using namespace pneuservo;

namespace {

const std::string one_set_configs = PNEUSERVO_SOURCE_DIR "/config";

/// Two figures of three numbers, met by one member; the third number does nothing, and above 1 nothing is computed.
OneSet planted() {
  OneSet set;
  set.name = "planted";
  set.numbers = {{"a", "", 0.01, 100.0, true, 50.0}, {"b", "", -1.0, 1.0, false, 0.9}, {"c", "", 0.0, 2.0, false, 0.5}};
  set.figures = {{"Fig 1", "a", "", "2.0",
                  [](ThesisBench&, const std::vector<double>& at) {
                    if (at[2] > 1.0) throw std::invalid_argument("no such machine");
                    return at[0];
                  }},
                 {"Fig 2", "a and b", "", "0.50",
                  [](ThesisBench&, const std::vector<double>& at) { return 0.25 * at[0] + std::fabs(at[1]); }}};
  return set;
}

/// The options that the page names for a set.
OneSetSearch search_of(const OneSet& set) {
  OneSetSearch out;
  std::istringstream words(set.searched);
  for (std::string word; words >> word;) {
    if (word == "--evaluations") words >> out.evaluations;
    else if (word == "--seed") words >> out.seed;
    else if (word == "--from-begun") out.from_begun = true;
    else FAIL("no option of a search: " << word);
  }
  return out;
}

}  // namespace

TEST_CASE("deviations count twice as much and half as much alike, and are infinite where a figure is not there") {
  const PrintedFigure figure{"Fig 1", "", "", "2.0"};
  CHECK(one_set_deviation(2.0, figure) == Approx(0.0).margin(1e-12));
  CHECK(one_set_deviation(4.0, figure) == Approx(one_set_deviation(1.0, figure)));
  CHECK(one_set_deviation(2e9, figure) == Approx(std::log(1e9)));
  for (const double none : {std::nan(""), 0.0, -1.0}) CHECK(std::isinf(one_set_deviation(none, figure)));
  const PrintedFigure limit{"Fig 1", "", "", "below 2.0"};
  CHECK(one_set_deviation(1.0, limit) == 0.0);
  CHECK(one_set_deviation(4.0, limit) == Approx(std::log(2.0)));
  CHECK(std::isinf(one_set_deviation(std::nan(""), limit)));
}

TEST_CASE("the sum counts every figure in full, a search no figure beyond its cap") {
  OneSet set = planted();
  CHECK(total_deviation(set, {2.0, 50.0}) == Approx(std::log(100.0)));
  CHECK(total_deviation(set, {2.0, 50.0}, set.search_cap) == Approx(3.0));
  CHECK(total_deviation(set, {4.0, std::nan("")}, set.search_cap) == Approx(std::log(2.0) + 3.0));
  CHECK(std::isinf(total_deviation(set, {4.0, std::nan("")})));
  set.measure = SetMeasure::largest;
  CHECK(total_deviation(set, {2.2, 0.4}) == Approx(0.2));
  CHECK(total_deviation(set, {std::nan(""), 0.4}, set.search_cap) == Approx(3.0));
}

TEST_CASE("the search finds the one member that meets the print") {
  const OneSet set = planted();
  std::size_t told = 0;
  const OneSetFound found =
      search_one_set(set, one_set_configs, {.evaluations = 1500, .seed = 3}, [&](const OneSetFound& now) {
        CHECK(now.deviation >= 0.0);
        ++told;
      });
  CHECK(told > 10);
  CHECK(found.evaluations >= 1500);
  CHECK(found.deviation < 0.02);
  CHECK(found.at[0] == Approx(2.0).epsilon(0.02));
  CHECK(std::fabs(found.at[1]) < 0.02);
  CHECK(found.at[2] <= 1.0);
  // The same seed finds the same set, whatever the number of cores.
  CHECK(search_one_set(set, one_set_configs, {.evaluations = 200, .seed = 3}, [](const OneSetFound&) {}).at ==
        search_one_set(set, one_set_configs, {.evaluations = 200, .seed = 3}, [](const OneSetFound&) {}).at);
}

TEST_CASE("a search that begins with the set found is never worse than it") {
  const OneSet set = planted();
  ThesisBench bench(one_set_configs);
  const double held = total_deviation(set, figures_of(set, bench, found_numbers(set)));
  const OneSetFound found = search_one_set(set, one_set_configs, {.evaluations = 20, .seed = 5, .from_found = true},
                                           [](const OneSetFound&) {});
  CHECK(found.deviation <= held + 1e-12);
}

TEST_CASE("a search can begin about a member that was set by hand") {
  OneSet set = planted();
  const OneSetSearch about{.evaluations = 20, .seed = 5, .from_begun = true};
  const auto nothing = [](const OneSetFound&) {};
  CHECK_THROWS_WITH(search_one_set(set, one_set_configs, about, nothing), Catch::Contains("planted"));
  set.begun = {2.0, 0.0, 0.5};
  CHECK(search_one_set(set, one_set_configs, about, nothing).deviation < 1e-9);
}

TEST_CASE("a search for some figures alone computes and counts no other") {
  OneSet whole = planted();
  whole.figures[0].ours = [](ThesisBench&, const std::vector<double>&) -> double {
    FAIL("computed a figure that is not asked");
    return 0.0;
  };
  const OneSet one = with_figures(whole, {"2"});
  REQUIRE(one.figures.size() == 1);
  CHECK(one.figures[0].place == std::string("Fig 2"));
  CHECK(search_one_set(one, one_set_configs, {.evaluations = 300, .seed = 3}, [](const OneSetFound&) {}).deviation <
        0.02);
  CHECK(with_figures(planted(), {"Fig 2", "Fig 1"}).figures.size() == 2);
  CHECK_THROWS_WITH(with_figures(planted(), {"3.7"}), Catch::Contains("3.7") && Catch::Contains("Fig 1"));
}

TEST_CASE("the sets on the page lie in the ranges that their searches cover") {
  for (const OneSet& set : all_one_sets()) {
    CHECK(std::string(set.met_held).ends_with(std::to_string(set.figures.size())));
    const OneSetSearch search = search_of(set);
    CHECK(search.evaluations >= 1000);
    CHECK((!search.from_begun || !set.begun.empty()));
    for (const FreeNumber& number : set.numbers) {
      INFO(set.name << ": " << number.name);
      CHECK(number.found >= number.low);
      CHECK(number.found <= number.high);
      if (number.is_logarithmic) CHECK(number.low > 0.0);
    }
  }
}

TEST_CASE("the command beside a set finds what the page holds") {
  for (const OneSet& set : line_length_sets()) {
    INFO(set.name);
    ThesisBench bench(one_set_configs);
    const double held = total_deviation(set, figures_of(set, bench, found_numbers(set)));
    CHECK(search_one_set(set, one_set_configs, search_of(set), [](const OneSetFound&) {}).deviation ==
          Approx(held).epsilon(1e-4));
    // No rig found comes within 10 %, from another seed neither.
    CHECK(search_one_set(set, one_set_configs, {.evaluations = 800, .seed = 7}, [](const OneSetFound&) {}).deviation >
          0.995 * held);
    CHECK(held > 0.12);
  }
}

TEST_CASE("three runs of one curve leave little of 540 um on any table") {
  ThesisBench bench(one_set_configs);
  const auto rows = three_runs_rows();
  REQUIRE(rows.size() == 8);
  std::vector<double> ours;
  for (const ThesisRow& row : rows) {
    ours.push_back(row.ours(bench).value);
    INFO(row.what << ": " << ours.back());
    CHECK(judge_thesis_row(row, ours.back()).verdict != ThesisVerdict::moved);
  }
  // All three figures within 10 %: not on the printed model nor on 0.7 to 2.5 of its gain; with half of it they may be.
  CHECK(ours[1] == Approx(1.1 * ours[0]));
  CHECK(1.1 * ours[2] < 0.9 * 540.0);
  CHECK(1.1 * ours[3] > 0.9 * 540.0);
  CHECK(1.1 * ours[4] < 0.9 * 540.0);
  CHECK(ours[2] > ours[0]);
  CHECK(ours[7] == Approx(std::log(540.0 / ours[0])));
}

TEST_CASE("one rig for lines meets all frequencies and every damping but those of 8 mm") {
  ThesisBench bench(one_set_configs);
  const auto rows = most_met_rows();
  REQUIRE(rows.size() == 3);
  CHECK(rows[0].ours(bench).words == "11 of 14");
  for (const ThesisRow& row : rows) CHECK(judge_thesis_row(row, row.ours(bench)).verdict != ThesisVerdict::moved);
}

TEST_CASE("printed figures that exclude each other lie above what any machine of the kind gives") {
  ThesisBench bench(one_set_configs);
  for (auto rows : {order_bound_rows(), damping_bound_rows()})
    for (const ThesisRow& row : rows) {
      INFO(row.place << ": " << row.what);
      // Both figures within 10 % change their ratio by 1.1/0.9 at most.
      CHECK(row.ours(bench).value * 1.1 / 0.9 < thesis_number(row.printed));
    }
}

TEST_CASE("the printed table keeps the bounds of all linear tables, and the found set the least sum") {
  ThesisBench bench(one_set_configs);
  const auto rows = order_bound_rows();
  REQUIRE(rows.size() == 13);
  for (std::size_t i = 0; i < 12; i += 4) {
    INFO(rows[i].place);
    CHECK(rows[i].ours(bench).value < rows[i + 2].ours(bench).value);
  }
  const auto sums = least_sum_rows();
  REQUIRE(sums.size() == 4);
  for (std::size_t i = 0; i < 3; ++i) CHECK(sums[i].ours(bench).value > 5.0);
  CHECK(sums[3].ours(bench).value < thesis_number(table_set().deviation_held));
}
