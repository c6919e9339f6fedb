// Whatever a fit may try of a candidate is a number that the config takes.
#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "config/read_rig.hpp"
#include "diagnosis/search/candidates.hpp"

using namespace pneuservo;

TEST_CASE("every number between the bounds of a candidate is one that its key can have, whatever the rig") {
  using Channels = std::vector<ResidualChannel>;
  const Channels pressures{
      {"p1_port", "Pa", 0, 1}, {"p2_port", "Pa", 0, 1}, {"p1_chamber", "Pa", 0, 1}, {"x", "m", 0, 1}},
      force{{"F", "N", 0, 1}}, vessel{{"p1_chamber", "Pa", 0, 1}};
  const MotionRange range{.lowest_m = -0.1, .highest_m = 0.1, .top_speed_mps = 0.5, .duration_s = 8, .first_Pa = 4e5};
  int tried = 0;
  for (const auto& [name, channels] : {std::pair("cylinder-2m-4.15mm", pressures),
                                       {"cylinder-10m-7.65mm", pressures},
                                       {"servo-table-0.5m-4mm", pressures},
                                       {"machines/emps", force},
                                       {"machines/arm-joint", force},
                                       {"machines/tank-discharge", vessel},
                                       {"machines/pump-tank", vessel}}) {
    const Rig rig = read_rig(std::string(PNEUSERVO_SOURCE_DIR "/config/") + name + ".yaml");
    for (const Candidate& candidate : all_candidates(rig, channels, range))
      for (std::size_t p = 0; p < candidate.parameters.size(); ++p) {
        FreeParameter parameter = candidate.parameters[p];
        if (parameter.start_factor >= 0 || !(parameter.lower < parameter.upper)) continue;
        const double width = parameter.upper - parameter.lower;
        std::vector<double> places{parameter.lower, parameter.upper};
        for (double share = 1e-16; share < 1; share *= 3) places.push_back(parameter.lower + share * width);
        for (const double z : places) {
          INFO(name << ": " << parameter.path << " at z = " << z << ": " << parameter.value(z));
          Rig changed = rig;
          CHECK_NOTHROW(parameter.number.value().set(changed, parameter.value(z)));
          ++tried;
        }
      }
  }
  CHECK(tried > 5000);
}

TEST_CASE("small physics stays what its keys can have, and a fitting is granted by the line that it ends") {
  const std::vector<ResidualChannel> channels{{"p1_port", "Pa", 0, 1}, {"p2_port", "Pa", 0, 1}};
  for (const char* name : {"cylinder-2m-4.15mm", "servo-table-0.5m-4mm"}) {
    const Rig rig =
        read_rig(std::string(PNEUSERVO_SOURCE_DIR "/config/") + name + ".yaml", {"line_2.diameter_m=0.006"});
    int fittings = 0;
    for (const FreeParameter& granted : small_physics(rig, channels)) {
      INFO(name << ": " << granted.path);
      CHECK(granted.lower < granted.upper);
      for (const double z : {granted.lower, 0.0, granted.step, 1.0, granted.upper}) {
        Rig changed = rig;
        CHECK_NOTHROW(granted.number.value().set(changed, granted.value(z)));
      }
      const bool is_first = granted.path == "effects.line_restriction_1.area_m2";
      if (!is_first && granted.path != "effects.line_restriction_2.area_m2") continue;
      ++fittings;
      CHECK(granted.value(0) == 0);  // none
      // An orifice of area a in a bore A takes (A/a)^2 dynamic heads of the gas in the bore.
      const LineParameters<double>& line = is_first ? rig.axis.line_1 : rig.axis.line_2;
      const double ratio = line.section_m2() / granted.value(1);
      CHECK(ratio * ratio == Approx(1.5));
    }
    CHECK(fittings == 2);
  }
}
