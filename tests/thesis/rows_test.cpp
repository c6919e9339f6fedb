// Rows of the thesis: verdicts on planted rows, known values, what cannot be computed, the JSON.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "thesis/groups.hpp"
#include "thesis/report.hpp"

using namespace pneuservo;

namespace {

const std::string configs = PNEUSERVO_SOURCE_DIR "/config";

ThesisVerdict verdict_of(const ThesisRow& row, const ThesisValue& ours) { return judge_thesis_row(row, ours).verdict; }

/// The groups outlive what is found.
std::vector<ThesisResult> compute(const std::vector<ThesisGroup>& groups) {
  ThesisBench bench(configs);
  return compute_thesis(groups, bench, [](std::size_t, std::size_t) {});
}

/// Moved rows in words, none where all is well.
std::string moved(const std::vector<ThesisResult>& results) {
  std::string out;
  for (const ThesisResult& result : results)
    for (const ThesisFinding& finding : result.findings)
      if (finding.verdict == ThesisVerdict::moved)
        out += finding.row->place + ", " + finding.row->what + ": " + thesis_value_text(finding) + "\n";
  return out;
}

}  // namespace

TEST_CASE("a figure as text knows its last digit") {
  CHECK(thesis_tolerance("1.60", 0.0) == Approx(0.005));
  CHECK(thesis_tolerance("45", 0.0) == Approx(0.5));
  CHECK(thesis_tolerance("1.8e5", 0.0) == Approx(5e3));
  CHECK(thesis_tolerance("200", 0.02) == Approx(4.0));
  CHECK(std::isnan(thesis_number("formula")));
  CHECK(std::isnan(thesis_number("")));
}

TEST_CASE("verdicts on planted rows") {
  using V = ThesisVerdict;
  const ThesisRow print{.printed = "1.60"};
  CHECK(verdict_of(print, 1.604) == V::agrees);
  CHECK(verdict_of(print, 1.606) == V::moved);
  const ThesisRow misprint{.printed = "0.005", .meant = "0.05"};
  CHECK(verdict_of(misprint, 0.048) == V::corrected);
  CHECK(verdict_of(misprint, 0.005) == V::moved);
  const ThesisRow differs{.printed = "1.60", .held = "121.1", .held_within = 0.02};
  CHECK(verdict_of(differs, 122.0) == V::differs);
  CHECK(verdict_of(differs, 125.0) == V::moved);
  // That the print is met at last is a change, too.
  CHECK(verdict_of(differs, 1.60) == V::moved);
  const ThesisRow words{.printed = "well", .held = "0.40"};
  CHECK(verdict_of(words, 0.401) == V::no_figure);
  CHECK(verdict_of(words, 0.41) == V::moved);
  const ThesisRow equation{.printed = "formula", .held = "holds"};
  CHECK(verdict_of(equation, "holds") == V::agrees);
  CHECK(verdict_of(equation, "off by 3 %") == V::moved);
  CHECK(verdict_of(print, std::numeric_limits<double>::quiet_NaN()) == V::moved);
}

TEST_CASE("limits in the print are kept or not") {
  const ThesisRow limit{.printed = "above 7.5", .held = "8.0", .held_within = 0.1};
  CHECK(verdict_of(limit, 8.1) == ThesisVerdict::agrees);
  CHECK(verdict_of(limit, 7.4) == ThesisVerdict::differs);
  CHECK(verdict_of(limit, 9.0) == ThesisVerdict::moved);
  const ThesisRow alone{.printed = "below 1"};
  CHECK(verdict_of(alone, 0.5) == ThesisVerdict::agrees);
  CHECK(verdict_of(alone, 1.5) == ThesisVerdict::moved);
}

TEST_CASE("a row that throws has moved, the others stand") {
  const std::vector<ThesisGroup> groups{
      {"planted",
       {{.place = "a", .printed = "1", .ours = [](ThesisBench&) -> ThesisValue { throw std::invalid_argument("no"); }},
        {.place = "b", .printed = "1", .ours = [](ThesisBench&) { return 1.0; }},
        {.place = "c", .printed = "wished", .plant = ThesisPlant::none}}}};
  const auto results = compute(groups);
  CHECK(results[0].findings[0].verdict == ThesisVerdict::moved);
  CHECK(results[0].findings[0].ours.words == "no");
  CHECK(results[0].findings[1].verdict == ThesisVerdict::agrees);
  CHECK(results[0].findings[2].verdict == ThesisVerdict::not_there);
}

TEST_CASE("formulas, lines and loops of the thesis stand where they are held") {
  const auto results =
      compute({thesis_line_group(), thesis_order_group(), thesis_element_group(), thesis_index_group()});
  INFO(moved(results));
  CHECK(moved(results).empty());
  const auto counts = thesis_counts(results);
  CHECK(counts[static_cast<std::size_t>(ThesisVerdict::agrees)] > 40);
}

TEST_CASE("the printed moves on the linear plant") {
  std::vector<ThesisGroup> groups{thesis_feedforward_group()};
  std::erase_if(groups[0].rows, [](const ThesisRow& row) { return row.plant != ThesisPlant::linear; });
  REQUIRE(groups[0].rows.size() == 20);
  const auto results = compute(groups);
  INFO(moved(results));
  CHECK(moved(results).empty());
}

TEST_CASE("every row names its place and a reason where it is not the print") {
  for (const ThesisGroup& group : thesis_groups())
    for (const ThesisRow& row : group.rows) {
      INFO(group.title << ": " << row.place << ", " << row.what);
      CHECK_FALSE(row.place.empty());
      CHECK_FALSE(row.what.empty());
      CHECK_FALSE(row.printed.empty());
      const double held = thesis_number(row.held);
      const ThesisValue value = std::isfinite(held) ? ThesisValue(held) : ThesisValue(row.held);
      const bool is_known_to_differ =
          !row.held.empty() && judge_thesis_row(row, value).verdict == ThesisVerdict::differs;
      if (!row.meant.empty() || is_known_to_differ) CHECK_FALSE(row.why.empty());
      CHECK_FALSE(thesis_command(row).empty());
    }
}

TEST_CASE("each reason stands once below its table, with the number that its rows have") {
  const auto two = [](ThesisBench&) { return 2.0; };
  const std::vector<ThesisGroup> groups{
      {"planted",
       {{.place = "a", .printed = "1", .ours = two, .held = "2.0", .why = "the valve"},
        {.place = "a", .printed = "2.0", .ours = two},
        {.place = "a", .printed = "1", .ours = two, .held = "2.0", .why = "the line"},
        {.place = "b", .printed = "3", .ours = two, .held = "2.0", .why = "the valve"}}}};
  const auto results = compute(groups);
  CHECK(thesis_reasons(results[0]) == std::vector<std::string>{"[1] the valve", "[2] the line"});
  const TableColumn numbers = thesis_table(results[0]).columns.back();
  CHECK(numbers.cells == std::vector<std::string>{"[1]", "", "[2]", "[1]"});
}

TEST_CASE("the text names the command of what is left out, where it is of that section") {
  const auto text = [](const char* title) { return thesis_text({{title, {}}}); };
  CHECK(text("2.4 Linear models against the experiment").find("pneuservo thesis --only 'Fig 2.2' --diagnose") !=
        std::string::npos);
  CHECK(text("2.6 Feedforward").find("--diagnose") == std::string::npos);
  CHECK(thesis_left_out(
            {{"2.4 Linear models against the experiment", {}}, {"2.4 What diagnose says that each order lacks", {}}})
            .empty());
}

TEST_CASE("JSON has every key of every row") {
  const std::vector<ThesisGroup> groups = thesis_groups("Table 2.1");
  const auto results = compute(groups);
  const auto json = thesis_json(results);
  CHECK(json["verdicts"]["agrees"] == 5);
  CHECK(json["verdicts"]["MOVED"] == 0);
  REQUIRE(json["groups"].size() == 1);
  const auto& row = json["groups"][0]["rows"][0];
  std::set<std::string> keys;
  for (const auto& [key, value] : row.items()) keys.insert(key);
  CHECK(keys == std::set<std::string>{"place", "what", "unit", "printed", "corrected", "plant", "ours", "held",
                                      "verdict", "reason", "command"});
  CHECK(row["ours"] == Approx(70.0));
  CHECK(thesis_text(results).find("5 rows: 5 agrees") != std::string::npos);
}
