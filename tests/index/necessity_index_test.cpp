// Necessity index: the thesis' tables, the verification case V14, the index of a config, the page.
#include <catch2/catch.hpp>

#include <yaml-cpp/yaml.h>

#include "index/index_map.hpp"
#include "index/index_report.hpp"

using namespace pneuservo;

namespace {
Rig nominal_rig() {
  Rig rig;
  rig.name = "cylinder <10 m>";
  rig.axis.line_1 = rig.axis.line_2 = {10.0, 0.00765};
  rig.axis.cylinder = {0.300, 1.257e-3, 1.056e-3, 2e-5, 2e-5, 50.0, 0.3};
  rig.reference.amplitude_m = 0.08;
  rig.reference.frequency_Hz = 1.0;
  rig.duration_s = 5.0;
  return rig;
}
}  // namespace

TEST_CASE("every printed digit of Tables 4.2 and 4.3 comes out, but the named one") {
  int differ = 0;
  for (const PrintedIndex& e : printed_indices()) {
    CAPTURE(e.table, e.diameter_m, e.length_m, e.frequency_Hz);
    if (e.remark[0] != 0) {
      ++differ;
      CHECK_FALSE(reproduces(e));
      CHECK(necessity_index(thesis_side(1, 2.0, 0.0061), thesis_peak_speed_mps(1.0)).index ==
            Approx(0.9431792340965).epsilon(1e-12));
    } else {
      CHECK(reproduces(e));
    }
  }
  REQUIRE(differ == 1);
  REQUIRE(printed_indices().size() == 17);
}

TEST_CASE("V14: every check of the necessity index") {
  YAML::Node checks;
  for (const YAML::Node& one : YAML::LoadFile(PNEUSERVO_SOURCE_DIR "/tests/data/verification/cases.yaml")["cases"])
    if (one["id"].as<std::string>() == "V14") checks = one["checks"];
  REQUIRE(checks.size() == 44);
  for (const YAML::Node& check : checks) {
    const YAML::Node at = check["at"];
    const int side = check["quantity"].as<std::string>() == "index_pipeline_2" ? 2 : 1;
    NecessitySide s = thesis_side(side, at["L_m"].as<double>(), 1e-3 * at["D_mm"].as<double>());
    s.viscosity_Pas = at["viscosity_Pas"].as<double>();
    const NecessityIndex got = necessity_index(s, thesis_peak_speed_mps(at["frequency_Hz"].as<double>()));
    const double expected = check["value"].as<double>(), tolerance = check["tol_10"].as<double>();
    INFO(check["id"].as<std::string>() << ": got " << got.index << ", expected " << expected << ", relative tolerance "
                                       << tolerance);
    CHECK(std::fabs(got.index - expected) <= tolerance * expected);
    if (at["Re"]) CHECK(got.reynolds == Approx(at["Re"].as<double>()).epsilon(1e-6));
    CHECK(got.turbulent == !at["Re"].IsDefined());
  }
}

TEST_CASE("a config is judged by its motion, the larger side decides") {
  Rig rig = nominal_rig();
  RigNecessity r = rig_necessity(rig);
  CHECK(r.peak_speed_mps == Approx(0.16 * M_PI));
  CHECK(r.index[0].index == Approx(1.624784377101).epsilon(1e-9));
  CHECK(r.side[1].pressure_Pa == Approx(540.2e3).epsilon(1e-3));
  CHECK((r.dominating == 0 && r.needed));
  CHECK((is_pipeline_model_needed(1.0) && !is_pipeline_model_needed(0.999)));
  rig.axis.line_2.diameter_m = 0.006;
  CHECK(rig_necessity(rig).dominating == 1);
  rig = nominal_rig();
  rig.axis.line_1.length_m = rig.axis.line_2.length_m = limit_length_m(r.side[0], r.peak_speed_mps) * 0.999;
  CHECK_FALSE(rig_necessity(rig).needed);
  rig.reference = ReferenceSpec{};
  rig.reference.kind = ReferenceKind::minimum_jerk;
  rig.reference.end_m = 0.12;
  rig.reference.duration_s = 0.8;
  CHECK(rig_necessity(rig).peak_speed_mps == Approx(1.875 * 0.12 / 0.8));
  rig.reference.end_m = 0.0;
  r = rig_necessity(rig);
  CHECK((r.index[0].index == 0.0 && !r.needed));
  CHECK(index_html("rest", r).find("<svg") == std::string::npos);
}

TEST_CASE("text, JSON and page carry the verdict, the page needs nothing from outside") {
  const RigNecessity r = rig_necessity(nominal_rig());
  CHECK(index_text("name", r).find("pipeline model is needed") != std::string::npos);
  const auto json = index_json("name", r);
  CHECK(json["pipeline_model_needed"] == true);
  CHECK(json["index"].get<double>() == r.index[0].index);
  CHECK(index_table_json()["entries"].size() == 17);
  for (const std::string& html : {index_html("cylinder <10 m>", r), index_table_html()}) {
    CHECK(html.find("http") == std::string::npos);
    CHECK(html.find("src=") == std::string::npos);
    CHECK(html.find("<10 m>") == std::string::npos);
    CHECK(html.find("index = 1") != std::string::npos);
    CHECK(html.find("nan") == std::string::npos);
  }
}
