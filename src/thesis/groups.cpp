// All groups of rows in the thesis' order, and what they share.
#include "thesis/groups.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace pneuservo {

std::vector<ThesisGroup> thesis_groups(const std::string& only, bool with_diagnoses) {
  std::vector<ThesisGroup> groups{thesis_table_group(),         thesis_valve_group(),       thesis_line_group(),
                                  thesis_identify_group(),      thesis_order_group(),       thesis_gain_group(),
                                  thesis_model_group(),         thesis_feedforward_group(), thesis_table_sets_group(),
                                  thesis_element_group(),       thesis_flow_group(),        thesis_cylinder_group(),
                                  thesis_cylinder_sets_group(), thesis_index_group(),       thesis_difference_group(),
                                  thesis_wish_group(),          thesis_misprint_group()};
  if (with_diagnoses) {
    const auto models =
        std::ranges::find_if(groups, [](const ThesisGroup& group) { return group.title.starts_with("2.4"); });
    groups.insert(models + 1, thesis_diagnosis_group());
  }
  for (ThesisGroup& group : groups)
    std::erase_if(group.rows, [&](const ThesisRow& row) { return row.place.find(only) == std::string::npos; });
  std::erase_if(groups, [](const ThesisGroup& group) { return group.rows.empty(); });
  return groups;
}

std::vector<std::string> gain_sets(const Ppd2Gains& gains) {
  return {fmt::format("controller.position_gain_V_per_m={:g}", gains.position_V_per_m),
          fmt::format("controller.velocity_gain_Vs_per_m={:g}", gains.velocity_Vs_per_m),
          fmt::format("controller.acceleration_gain_Vs2_per_m={:g}", gains.acceleration_Vs2_per_m)};
}

std::vector<std::string> linear_model_sets(int order) {
  const double valve_Hz = order == 7 ? 100.0 : 0.0;
  // The fifth order has one lag for valve and line that agrees with both up to s^2 (2.3.3).
  constexpr double turn = 2.0 * std::numbers::pi;
  const SecondOrderLag line = order == 7   ? SecondOrderLag{turn * 110.0, 0.068}
                              : order == 5 ? low_frequency_match({turn * 110.0, 0.068}, {turn * 100.0, 0.7})
                                           : SecondOrderLag{0.0, 0.05};
  // The loop's check of the gas has no linear flows.
  std::vector<std::string> out{"limits.flow_mismatch_share=0", "controller.feedforward=none",
                               "cylinder.linear_about_Pa=110000",
                               fmt::format("valve.natural_frequency_Hz={:g}", valve_Hz)};
  for (const char* side : {"line_1", "line_2"}) {
    out.push_back(fmt::format("{}.model=second_order_lag", side));
    out.push_back(fmt::format("{}.natural_frequency_Hz={:.9g}", side, line.natural_frequency_rad_per_s / turn));
    out.push_back(fmt::format("{}.damping_ratio={:.9g}", side, line.damping_ratio));
  }
  return out;
}

ThesisRow run_row(ThesisRow row, const ThesisRig& which, double (*figure)(const ThesisCourse&)) {
  row.plant = ThesisPlant::nonlinear;
  if (!row.held.empty() || row.within == 0.0) row.held_within = simulated_within;
  row.command = thesis_verb("run", which);
  row.ours = [which, figure](ThesisBench& bench) -> ThesisValue {
    const ThesisCourse& course = bench.run(which);
    return course.fault.empty() ? ThesisValue(figure(course)) : ThesisValue("fault: " + course.fault);
  };
  return row;
}

ThesisValue equation(double printed, double ours) { return equation(std::span(&printed, 1), std::span(&ours, 1)); }

ThesisValue equation(std::span<const double> printed, std::span<const double> ours) {
  // Coefficients of degree seven lose some digits on their way through products of polynomials.
  return nearly(printed, ours, 1e-9);
}

ThesisValue nearly(std::span<const double> printed, std::span<const double> ours, double within) {
  double worst = 0.0;
  for (std::size_t i = 0; i < printed.size(); ++i)
    worst = std::max(worst, std::fabs(printed[i] - ours[i]) / std::fabs(ours[i]));
  if (worst < within) return std::string(thesis_holds);
  return fmt::format("off by {:.3g} %", 100.0 * worst);
}

}  // namespace pneuservo
