// Reading configs: every file of config/ and every cylinder rig of the shared data reads, values land where they
// belong.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "config/test_rigs.hpp"

using namespace pneuservo;
namespace fs = std::filesystem;

TEST_CASE("every config of the project reads and is named as its file") {
  const std::vector<fs::path> files = test::config_files();
  int of_the_thesis = 0;
  for (const fs::path& file : files) {
    INFO(file);
    const Rig rig = read_rig(file);
    REQUIRE(rig.name == file.stem().string());
    if (rig.kind != RigKind::cylinder || rig.hal || rig.reference.kind == ReferenceKind::live) continue;
    ++of_the_thesis;
    const std::string lines =
        fmt::format("{:g}m-{:.2f}mm", rig.axis.line_1.length_m, 1000 * rig.axis.line_1.diameter_m);
    REQUIRE(rig.name.ends_with(lines));
    REQUIRE(rig.axis.line_1.length_m == rig.axis.line_2.length_m);
    REQUIRE(rig.axis.line_1.diameter_m == rig.axis.line_2.diameter_m);
    REQUIRE(rig.axis.valve.area_max_m2 == Approx(5.0 * rig.axis.valve.area_per_volt_m2_per_V).epsilon(1e-12));
    REQUIRE(rig.controller.of<PdForce>().pressure_source == PressureSource::estimated);
    REQUIRE(rig.reference.amplitude_m == 0.08);
    REQUIRE(rig.tolerances.size() == 12);
  }
  REQUIRE(of_the_thesis == 19);
}

TEST_CASE("every rig of the shared data reads") {
  const std::vector<fs::path> files = test::shared_rig_files();
  if (files.empty()) {
    WARN("SKIPPED: no shared data folder");
    return;
  }
  for (const fs::path& file : files) {
    INFO(file);
    REQUIRE_NOTHROW(read_rig(file));
  }
}
