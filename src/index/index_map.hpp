// Map of the necessity index over line length and diameter as inline SVG.
#pragma once
#include <string>
#include <vector>

#include "index/necessity_index.hpp"

namespace pneuservo {

/// A line drawn on the map.
struct MapPoint {
  double length_m, diameter_m;
  std::string label;
  bool filled = true;
};

/// SVG element: bands of the index of lines on the side `side` (its own length and diameter do not matter) at that
/// peak speed > 0, iso-lines with their values, the limit index = 1 in bold, and the points.
std::string index_map_svg(const NecessitySide& side, double peak_speed_mps, const std::vector<MapPoint>& points);

}  // namespace pneuservo
