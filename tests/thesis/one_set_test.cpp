// One set of numbers for a chapter: deviations, a search on a planted family, the sets that the page holds.
#include <catch2/catch.hpp>

#include <cmath>

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

}  // namespace

TEST_CASE("deviations count twice as much and half as much alike, and end where a figure is not there") {
  const PrintedFigure figure{"Fig 1", "", "", "2.0"};
  CHECK(one_set_deviation(2.0, figure) == Approx(0.0).margin(1e-12));
  CHECK(one_set_deviation(4.0, figure) == Approx(one_set_deviation(1.0, figure)));
  CHECK(one_set_deviation(std::nan(""), figure) == one_set_deviation(1e9, figure));
  CHECK(one_set_deviation(-1.0, figure) == one_set_deviation(0.0, figure));
  const PrintedFigure limit{"Fig 1", "", "", "below 2.0"};
  CHECK(one_set_deviation(1.0, limit) == 0.0);
  CHECK(one_set_deviation(4.0, limit) == Approx(std::log(2.0)));
  CHECK(one_set_deviation(std::nan(""), limit) == one_set_deviation(1e9, limit));
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
  const double held = total_deviation(figures_of(set, bench, found_numbers(set)), set.figures);
  const OneSetFound found = search_one_set(set, one_set_configs, {.evaluations = 20, .seed = 5, .from_found = true},
                                           [](const OneSetFound&) {});
  CHECK(found.deviation <= held + 1e-12);
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
    CHECK(std::string(set.searched).find("--seed") != std::string::npos);
    for (const FreeNumber& number : set.numbers) {
      INFO(set.name << ": " << number.name);
      CHECK(number.found >= number.low);
      CHECK(number.found <= number.high);
      if (number.is_logarithmic) CHECK(number.low > 0.0);
    }
  }
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
