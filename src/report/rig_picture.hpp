// The picture of a rig with the elements that a diagnosis holds guilty marked, as SVG.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One element of the vocabulary (`chamber_1`, `sensor:x`) and its share of the mismatch, 0 to 1.
struct PictureMark {
  std::string element;
  double share = 0.0;
};

/// Inline SVG in the page's colours: supply, valve, lines, chambers, piston and slider of a pneumatic rig, drive and
/// slider of a driven axis, and those sensors that `sensors` names (names of signals). Elements with at least 1 % are
/// tinted by their share, those with at least 5 % bear it as a figure. Every element is a group with `data-element`, a
/// marked one with `data-share` in per cent.
std::string rig_picture(const Rig& rig, const std::vector<std::string>& sensors, const std::vector<PictureMark>& marks);

}  // namespace pneuservo
