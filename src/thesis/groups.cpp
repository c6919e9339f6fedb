// All groups of rows in the thesis' order, and what they share.
#include "thesis/groups.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuservo {

std::vector<ThesisGroup> thesis_groups(const std::string& only) {
  std::vector<ThesisGroup> groups{
      thesis_table_group(),         thesis_valve_group(),   thesis_line_group(),       thesis_identify_group(),
      thesis_order_group(),         thesis_gain_group(),    thesis_model_group(),      thesis_feedforward_group(),
      thesis_table_sets_group(),    thesis_element_group(), thesis_flow_group(),       thesis_cylinder_group(),
      thesis_cylinder_sets_group(), thesis_index_group(),   thesis_difference_group(), thesis_wish_group()};
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
