// Names that recordings cannot show are not tried.
#include "diagnosis/search/shown_candidates.hpp"

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

/// What the recordings have of Excitation.
unsigned excitation(const std::vector<ResidualRow>& rows) {
  const MotionRange range = motion_range(rows);
  unsigned has = 0;
  if (tells_speeds(rows)) has |= many_speeds;
  if (goes_both_ways(rows)) has |= both_ways;
  if (passes_again(rows)) has |= places_again;
  if (range.highest_m - range.lowest_m > 1.0) has |= a_radian;
  return has;
}

}  // namespace

std::vector<Candidate> shown_candidates(std::vector<Candidate> candidates, const std::vector<ResidualRow>& rows) {
  const unsigned has = excitation(rows);
  std::erase_if(candidates, [&](const Candidate& c) { return (c.shown_by & ~has) != 0; });
  return candidates;
}

}  // namespace pneuservo
