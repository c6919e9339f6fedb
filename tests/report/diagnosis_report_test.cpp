// The page of a diagnosis: the guilty element is marked on the rig's picture, and text, JSON and page carry the same
// numbers.
#include <catch2/catch.hpp>

#include <cmath>
#include <regex>

#include <fmt/format.h>
#include <report/binned_mean.hpp>
#include <report/diagnosis_report.hpp>
#include <report/diagnosis_tables.hpp>
#include <report/diagnosis_words.hpp>
#include <report/html_page.hpp>
#include <report/rig_picture.hpp>

#include "config/rig_parameters.hpp"
#include "diagnosis/diagnose.hpp"
#include "diagnosis/result_json.hpp"
#include "diagnosis/result_text.hpp"
#include "diagnosis/synthetic_axis.hpp"

using namespace pneuservo;
using namespace pneuservo::testing;

namespace {

const Diagnosis& friction_diagnosis() {
  static const Diagnosis diagnosis = [] {
    Rig machine = driven_axis_rig();
    set_parameter(machine, "effects.coulomb_friction.force_N", 6);
    Diagnosis found = diagnose(driven_axis_rig(), {axis_recording(machine, 7, no_extra)});
    found.recordings = {"folder/synthetic <1>.csv.gz"};
    return found;
  }();
  return diagnosis;
}

std::string cell(const Table& table, const std::string& title, std::size_t row) {
  for (const TableColumn& column : table.columns)
    if (column.title == title) return column.cells.at(row);
  FAIL("no column " << title);
  return "";
}

/// Agreement to half a unit of the last digit that is written.
void require_same(const std::string& written, double value) {
  CAPTURE(written, value);
  const std::string plain = written.ends_with(" %") ? written.substr(0, written.size() - 2) : written;
  const double scale = written.ends_with(" %") ? 100 : 1;
  const std::size_t exponent = plain.find('e'), mantissa_end = std::min(exponent, plain.size());
  const std::size_t point = plain.find('.');
  double last = point < mantissa_end ? std::pow(10.0, -static_cast<double>(mantissa_end - point - 1)) : 1.0;
  if (exponent != std::string::npos) last *= std::pow(10.0, std::stod(plain.substr(exponent + 1)));
  REQUIRE(std::abs(std::stod(plain) - scale * value) <= 0.500001 * last + 6e-5 * std::abs(scale * value));
}

}  // namespace

TEST_CASE("means over bins are those of the values in each bin, and far values do not widen the bins") {
  std::vector<double> x, y;
  for (int i = 0; i < 1000; ++i) {
    x.push_back(i % 10 + 0.5);
    y.push_back(3.0 * (i % 10) + (i / 10 % 2 == 0 ? 1 : -1));
  }
  x.push_back(1e6);
  y.push_back(1e9);
  x.push_back(5);
  y.push_back(std::nan(""));
  const BinnedMean binned = binned_mean(x, y, 10);
  REQUIRE(binned.center.size() == 10);
  for (std::size_t i = 0; i < 10; ++i) {
    REQUIRE(binned.mean[i] == Approx(3.0 * static_cast<double>(i)).margin(1e-9));
    REQUIRE(binned.deviation[i] == Approx(1.0));
    REQUIRE(binned.count[i] == 100);
  }
  REQUIRE(binned_mean({1, 1, 1}, {2, 2, 2}, 4, 4).center.empty());
  REQUIRE(binned_mean({}, {}, 4).center.empty());
}

TEST_CASE("the picture marks the guilty element with its share and draws the sensors that are there") {
  Rig rig = driven_axis_rig();
  rig.kind = RigKind::cylinder;
  const std::string svg = rig_picture(rig, {"x", "p1_port"}, {{"chamber_1", 0.91}, {"line_1", 0.03}, {"valve", 0.002}});
  REQUIRE(svg.find("data-element=\"chamber_1\" data-share=\"91\"") != std::string::npos);
  REQUIRE(svg.find(">91 %</text>") != std::string::npos);
  REQUIRE(svg.find("data-element=\"line_1\" data-share=\"3\"") != std::string::npos);
  REQUIRE(svg.find(">3 %</text>") == std::string::npos);  // tinted, no figure
  REQUIRE(svg.find("data-element=\"valve\">") != std::string::npos);
  REQUIRE(svg.find("data-element=\"sensor:p1_port\"") != std::string::npos);
  REQUIRE(svg.find("data-element=\"sensor:p2_port\"") == std::string::npos);
  for (const char* element : {"supply", "line_2", "chamber_2", "piston", "motion", "timing"})
    REQUIRE(svg.find(fmt::format("data-element=\"{}\"", element)) != std::string::npos);
  REQUIRE(svg.find("valve 2") == std::string::npos);
  rig.kind = RigKind::servo_table;
  REQUIRE(rig_picture(rig, {}, {{"valve", 0.5}}).find("valve 2") != std::string::npos);
}

TEST_CASE("words and sizes are those of the workshop") {
  REQUIRE(effect_words("chamber_leak_2") == "a leak from chamber 2 to the room");
  REQUIRE(effect_words("sensor_offset:p1_port") == "an offset of the sensor of p1_port");
  REQUIRE(effect_words("parameter:slider.mass_kg") == "slider.mass_kg is not what the config says");
  REQUIRE(effect_words("something_new_3") == "something_new_3");
  REQUIRE(size_words("time_constant_s", 0.006) == "6 ms");
  REQUIRE(size_words("area_m2", 0.6e-6 * M_PI / 4) == "0.4712 mm², about a hole of 1 mm");
  REQUIRE(size_words("force_N", 3).empty());
  REQUIRE(size_words("force_per_pressure_N_per_Pa", 1e-6).empty());
}

TEST_CASE("the page says what of long recordings is compared and how it was chosen, and nothing where all is") {
  Diagnosis diagnosis = friction_diagnosis();
  diagnosis.coverage = {};
  REQUIRE(diagnosis_report_html(diagnosis).find("What is compared") == std::string::npos);
  diagnosis.coverage = {1234.5, {{"slow.csv", 6, 12}, {"fast.csv", 100.25, 106.25}}, "pieces of 6 s that tell most"};
  const Table spans = coverage_table(diagnosis.coverage);
  REQUIRE(cell(spans, "recording", 1) == "fast.csv");
  REQUIRE(cell(spans, "from", 0) == "6");
  REQUIRE(cell(spans, "to", 1) == "106.25");
  const std::string page = diagnosis_report_html(diagnosis);
  const std::size_t section = page.find("What is compared");
  REQUIRE(section != std::string::npos);
  REQUIRE(page.find("Of 1234 s recorded: pieces of 6 s that tell most.", section) != std::string::npos);
  for (const std::string text : {"slow.csv", "fast.csv", ">100.25<", ">106.25<"})
    REQUIRE(page.find(text, section) != std::string::npos);
}

TEST_CASE("text, JSON and page of a diagnosis carry the same numbers") {
  const Diagnosis& diagnosis = friction_diagnosis();
  const auto json = diagnosis_json(diagnosis);
  const std::string page = diagnosis_report_html(diagnosis), text = diagnosis_text(diagnosis);
  REQUIRE(json["answers"][0]["effect"] == "coulomb_friction");
  REQUIRE(text.find(json["sentence"].get<std::string>()) != std::string::npos);
  REQUIRE(page.find(html_escape(json["sentence"].get<std::string>())) != std::string::npos);
  REQUIRE(page.find("synthetic &lt;1&gt;.csv.gz") != std::string::npos);
  REQUIRE(page.find("synthetic <1>") == std::string::npos);

  const auto& answer = json["answers"][0];
  require_same(cell(answers_table(diagnosis), "probability", 0), answer["probability"]);
  require_same(cell(estimates_table(diagnosis), "value", 0), answer["parameters"]["force_N"]["value"]);
  require_same(cell(estimates_table(diagnosis), "standard error", 0),
               answer["parameters"]["force_N"]["standard_error"]);
  const Table fit = fit_table(diagnosis.channels);
  for (const auto& [title, key] : {std::pair{"noise floor", "noise"},
                                   {"before", "before"},
                                   {"after", "after"},
                                   {"held out, before", "held_out_before"},
                                   {"held out, after", "held_out_after"}}) {
    const double value = json["fit"]["channels"]["F_N"][key];
    require_same(cell(fit, title, 0), value);
    REQUIRE(text.find(cell(fit, title, 0)) != std::string::npos);
    REQUIRE(page.find(">" + cell(fit, title, 0) + "<") != std::string::npos);
  }
  const Table candidates = candidates_table(diagnosis);
  for (std::size_t i = 0; i < json["candidates"].size(); ++i) {
    require_same(cell(candidates, "probability", i), json["candidates"][i]["probability"]);
    REQUIRE(text.find(cell(candidates, "probability", i)) != std::string::npos);
    REQUIRE(page.find(">" + cell(candidates, "explanation", i) + "<") != std::string::npos);
  }
  for (std::size_t i = 0; i < json["parameters_moved"].size(); ++i)
    require_same(cell(moved_table(diagnosis), "best value", i), json["parameters_moved"][i]["fitted"]);
  const std::smatch share = [&] {
    std::smatch found;
    REQUIRE(std::regex_search(page, found, std::regex("data-element=\"motion\" data-share=\"(\\d+)\"")));
    return found;
  }();
  require_same(share[1].str() + " %", json["elements"][0]["share"]);
}

TEST_CASE("a page of a diagnosis that found nothing marks nothing and says what would have been seen") {
  const Diagnosis diagnosis = diagnose(driven_axis_rig(), {axis_recording(driven_axis_rig(), 11, no_extra)});
  REQUIRE(diagnosis.verdict == Verdict::consistent);
  const std::string page = diagnosis_report_html(diagnosis);
  REQUIRE(page.find("data-share") == std::string::npos);
  REQUIRE(page.find("coulomb_friction.force_N") != std::string::npos);
  REQUIRE(page.find("What it is") == std::string::npos);
}
