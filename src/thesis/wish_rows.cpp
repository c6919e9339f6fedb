// Rows of 5.2 and of the nomenclature: what the thesis wishes for, and what is not there.
#include <cmath>

#include <fmt/format.h>

#include "thesis/groups.hpp"

namespace pneuservo {
namespace {

using Sets = std::vector<std::string>;

/// 1 Hz with estimated pressures, without and with the flow feedforward.
std::vector<ThesisRow> feedforward() {
  struct Line {
    const char *name, *config, *off, *on;
  };
  const Line lines[] = {{"7.65 mm x 10 m", "cylinder-10m-7.65mm", "33.1", "1.936"},
                        {"4.15 mm x 10 m", "cylinder-10m-4.15mm", "67.6", "14.94"}};
  std::vector<ThesisRow> rows;
  for (const Line& line : lines)
    for (const bool on : {false, true})
      rows.push_back(
          run_row({.place = "5.2",
                   .what = fmt::format("{}, {} flow feedforward: position error", line.name, on ? "with" : "without"),
                   .unit = "mm",
                   .printed = "wished: feedforward for long lines",
                   .held = on ? line.on : line.off},
                  {line.config, {fmt::format("controller.flow_feedforward={}", on)}},
                  [](const ThesisCourse& course) { return 1e3 * course.max_error_m; }));
  return rows;
}

ThesisRow missing(const char* what, const char* why) {
  return {.place = "5.2", .what = what, .printed = "wished", .plant = ThesisPlant::none, .why = why};
}

}  // namespace

ThesisGroup thesis_wish_group() {
  const Sets leak{"effects.chamber_leak_1.area_m2=1e-8", "duration_s=6", "evaluation={from_s: 0.2, to_s: 6}",
                  "controller.integral_gain_V_per_m_s=1e4"};
  const Sets unlike{"deviations={valve.area_per_volt_m2_per_V: -0.0291425}", "controller.learning=flow"};
  ThesisGroup group{
      "5.2 Future work, nomenclature",
      {run_row({.place = "5.2",
                .what = "4 mm, leak of 0.01 mm2 with integral: error at rest",
                .unit = "um",
                .printed = "wished: joint leaks compensated",
                .held = "9.386e-4",
                .why = "by integral action; the leak is not estimated"},
               {table_4mm.config, leak},
               [](const ThesisCourse& course) { return 1e6 * std::fabs(course.end_error_m); }),
       run_row({.place = "5.2",
                .what = "4 mm, valve 3 % off, flow learned: error of move 4",
                .unit = "um",
                .printed = "wished: unlike chambers compensated",
                .held = "6.712e-3"},
               {table_4mm.config, unlike, 4}, [](const ThesisCourse& course) { return 1e6 * course.max_error_m; })}};
  const auto more = feedforward();
  group.rows.insert(group.rows.end(), more.begin(), more.end());
  group.rows.push_back(missing("loss by differential pressure sensors", "no channel, sensor or use of it"));
  group.rows.push_back(missing("cylinder without a position sensor", "estimator and laws need the position"));
  group.rows.push_back({.place = "Nomenclature",
                        .what = "unit of K_ap",
                        .printed = "N/V",
                        .meant = "V/N",
                        .why = "the gain makes a voltage of a force: controller.force_gain_V_per_N"});
  return group;
}

}  // namespace pneuservo
