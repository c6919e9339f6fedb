// Pages: text is escaped wherever it stands, curves keep their peaks, and nothing outside the file is needed.
#include <catch2/catch.hpp>

#include <algorithm>
#include <regex>

#include <config/input_error.hpp>
#include <nlohmann/json.hpp>
#include <report/evaluation.hpp>
#include <report/html_page.hpp>
#include <report/plot_json.hpp>
#include <report/run_plots.hpp>
#include <report/run_report.hpp>

#include "synthetic_rows.hpp"

using namespace pneuservo;
using test::wave;

namespace {

const std::string evil = "</script><script>alert('1')</script>&\"";

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

RunReport long_report(std::size_t moves) {
  RunReport report;
  report.config = "many moves";
  for (const char* source : {"valve", "chamber", "estimated"})
    for (std::size_t move = 1; move <= moves; ++move) {
      RunResult run;
      run.pressure_source = source;
      run.move = static_cast<int>(move);
      run.rows = test::make_rows(60.0, 1e-3, [](Row& row) {
        const double noise = wave(317.7, row.t_s) + wave(101.3, row.t_s);
        Row::visit([&](std::string_view name, auto& value) {
          if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>)
            if (name != "t_s") value = 4.7e5 + 12345.678 * noise;
        }, row);
      });
      report.runs.push_back(std::move(run));
    }
  return report;
}

}  // namespace

TEST_CASE("text is escaped in headlines, tables, bars, panels, details and plots") {
  REQUIRE(html_escape("a<b>&\"'") == "a&lt;b&gt;&amp;&quot;&#39;");
  HtmlPage page(evil, evil, evil);
  page.section(evil, evil);
  page.alert(evil);
  page.table({evil, {text_column(evil, {evil})}, -1});
  page.bars({{evil, evil, {{evil, Tone::valve, 1.0}}}});
  page.panels_begin({evil}, 0);
  page.panel(0);
  Plot plot;
  plot.title = plot.unit = plot.group = evil;
  plot.curves = {{evil, Tone::valve, {0.0, 1.0}, {1.0, 2.0}}};
  plot.marks = {{0.5, evil}};
  page.plot(plot);
  page.panels_end();
  page.details(evil, evil);
  page.details(evil, {{evil, evil}});
  const std::string html = page.html();
  REQUIRE(html.find("<script>alert") == std::string::npos);
  REQUIRE(occurrences(html, "</script>") == 3);
  REQUIRE(occurrences(html, "<script") == 3);
}

TEST_CASE("a plot's data is JSON that reads back, with times as steps of the period and gaps as null") {
  Plot plot;
  plot.x_step = 1e-3;
  plot.curves = {{"caf\xe9 <", Tone::estimated, {0.005, 0.006, 0.009}, {1.5, Row::none, -2.25}, true}};
  plot.bands = {{"bound", Tone::neutral, {0.0, 0.001}, {-1.0, -2.0}, {1.0, 2.0}}};
  const auto json = nlohmann::json::parse(plot_json(plot, "plot-1"));
  const auto& curve = json["curves"][0];
  REQUIRE(curve["x"]["from"] == 5);
  REQUIRE(curve["x"]["by"] == nlohmann::json({0, 1, 3}));
  REQUIRE(curve["y"] == nlohmann::json({1.5, nullptr, -2.25}));
  REQUIRE(json["bands"][0]["low"] == nlohmann::json({-1.0, -2.0}));
  plot.curves[0].x = {0.0051, 0.0062, 0.009};
  REQUIRE(nlohmann::json::parse(plot_json(plot, "plot-1"))["curves"][0]["x"] == nlohmann::json({0.0051, 0.0062, 0.009}));
}

TEST_CASE("thinning keeps ends, single peaks and gaps within the number of points") {
  std::vector<double> y(100000);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = wave(1.0, 1e-4 * static_cast<double>(i));
  y[12345] = 50.0, y[67890] = -60.0, y[40000] = Row::none;
  const auto kept = keep_peaks(y, 4000);
  REQUIRE(kept.size() <= 4000);
  REQUIRE(kept.front() == 0);
  REQUIRE(kept.back() == y.size() - 1);
  REQUIRE(std::is_sorted(kept.begin(), kept.end()));
  REQUIRE(std::adjacent_find(kept.begin(), kept.end()) == kept.end());
  for (std::size_t wanted : {12345, 67890, 40000}) REQUIRE(std::binary_search(kept.begin(), kept.end(), wanted));
  REQUIRE(keep_peaks({1.0, 2.0, 3.0}, 4000).size() == 3);
}

TEST_CASE("a page of three sources with many long moves stays below 3 MB and needs no other file") {
  const RunReport report = long_report(4);
  REQUIRE(shown_runs(report).size() == 6);
  Rig rig;
  const std::string html = run_report_html(report, rig);
  REQUIRE(html.size() < 3000000);
  const std::regex outside("(src|href)\\s*=|url\\(|@import|sourceMappingURL");
  const std::string own = html.substr(0, html.find("<script>"));
  REQUIRE_FALSE(std::regex_search(own, outside));
  REQUIRE(html.find("sourceMappingURL") == std::string::npos);
}

TEST_CASE("runs with nothing in them make a page all the same") {
  RunReport report;
  report.config = "empty";
  Rig rig;
  REQUIRE(run_report_html(report, rig).find("No run was made.") != std::string::npos);
  report.runs.resize(2);
  REQUIRE(run_report_html(report, rig).find("too short to be judged") != std::string::npos);
}

TEST_CASE("a page that cannot be written is unusable input, named by its path") {
  HtmlPage page("t", "e", "h");
  REQUIRE_THROWS_AS(page.write("/no-such-folder/report.html"), InputError);
  REQUIRE_THROWS_WITH(page.write("/no-such-folder/report.html"), Catch::Contains("/no-such-folder/report.html"));
}
