// Names that recordings cannot show are not tried.
#include "diagnosis/shown_candidates.hpp"

#include <algorithm>
#include <cmath>

namespace pneuservo {

namespace {

/// Whether the speeds tell how friction depends on them: the tenth highest is twice the tenth lowest.
bool tells_speeds(const std::vector<ResidualRow>& rows) {
  constexpr double least_spread = 2.0;
  std::vector<double> speeds;
  speeds.reserve(rows.size());
  for (const ResidualRow& row : rows) speeds.push_back(std::abs(row.velocity_mps));
  if (speeds.empty()) return true;
  std::sort(speeds.begin(), speeds.end());
  const double low = speeds[speeds.size() / 10], high = speeds[speeds.size() - 1 - speeds.size() / 10];
  return low == 0 || high > least_spread * low;
}

/// Whether the motion goes both ways: the slower one reaches a twentieth of the top speed.
bool goes_both_ways(const std::vector<ResidualRow>& rows) {
  constexpr double least_share = 0.05;
  double forward = 0, backward = 0;
  for (const ResidualRow& row : rows) {
    forward = std::max(forward, row.velocity_mps);
    backward = std::max(backward, -row.velocity_mps);
  }
  return std::min(forward, backward) >= least_share * std::max(forward, backward);
}

/// Whether places are passed more than once: else place and speed go together, and a tight spot looks like a speed.
bool passes_again(const std::vector<ResidualRow>& rows) {
  constexpr double least_passes = 1.5;
  const MotionRange range = motion_range(rows);
  double way_m = 0;
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (rows[i].recording == rows[i - 1].recording && rows[i].channel == rows[i - 1].channel)
      way_m += std::abs(rows[i].position_m - rows[i - 1].position_m);
  return way_m >= least_passes * (range.highest_m - range.lowest_m);
}

/// Whether a vessel's recording begins with more than a twentieth above the atmosphere in it: gas that nothing has
/// charged is as warm as its wall.
bool begins_charged(const Rig& rig, ResidualModel& model) {
  constexpr double least_ratio = 1.05;
  if (rig.kind != RigKind::vessel) return false;
  const std::vector<ResidualCourse> courses = model.courses({rig, {}});
  return std::any_of(courses.begin(), courses.end(), [&](const ResidualCourse& course) {
    return !course.measured.empty() && course.measured.front() > least_ratio * rig.axis.air.atmosphere_Pa;
  });
}

}  // namespace

std::vector<Candidate> shown_candidates(std::vector<Candidate> candidates, const Rig& rig, ResidualModel& model) {
  const std::vector<ResidualRow>& rows = model.rows();
  const bool one_speed = !tells_speeds(rows), one_way = !goes_both_ways(rows), one_pass = !passes_again(rows);
  std::erase_if(candidates, [&](const Candidate& c) {
    const bool by_turn = c.name.starts_with("direction_dependent_") || c.name == "elastic_friction";
    const bool by_speed = c.name == "stribeck_friction" || c.name == "quadratic_drag" || c.name == "viscous_friction" ||
                          c.name == "direction_dependent_viscous_friction";
    return (one_speed && by_speed) || (one_way && by_turn) || (one_pass && c.name == "friction_zone");
  });
  if (!begins_charged(rig, model))
    std::erase_if(candidates, [](const Candidate& c) { return c.name == "charging_heat"; });
  return candidates;
}

}  // namespace pneuservo
