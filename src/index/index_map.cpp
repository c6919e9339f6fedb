// Map of the necessity index: bands between iso-lines, which are exact because the index is proportional to the length.
#include "index/index_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

namespace pneuservo {

namespace {
constexpr double width = 760, height = 460, left = 70, right = 20, top = 16, bottom = 56;
/// Iso-lines, and the fill on their upper side of the index: cool below the limit, warm above.
constexpr std::array<double, 8> levels{0.1, 0.2, 0.5, 1, 2, 5, 10, 20};
constexpr std::array<const char*, 9> fills{"#d3e5f5", "#bcd8ef", "#9fc7e6", "#7fb3da", "#fde3bd", "#fbcf95", "#f6b26b", "#ee9350", "#e17339"};

struct Axes {
  double length_max_m, diameter_min_m, diameter_max_m;
  double x(double length_m) const { return left + (width - left - right) * length_m / length_max_m; }
  double y(double diameter_m) const {
    return height - bottom - (height - top - bottom) * (diameter_m - diameter_min_m) / (diameter_max_m - diameter_min_m);
  }
};

double step_of(double span) {
  const double power = std::pow(10.0, std::floor(std::log10(span / 6.0)));
  for (const double m : {1.0, 2.0, 5.0})
    if (span / (m * power) <= 8.0) return m * power;
  return 10.0 * power;
}

Axes axes_for(const std::vector<MapPoint>& points) {
  double length = 8.0, small = 0.004, large = 0.008;
  for (const MapPoint& p : points) {
    length = std::max(length, p.length_m);
    small = std::min(small, p.diameter_m);
    large = std::max(large, p.diameter_m);
  }
  return {1.25 * length, 0.7 * small, 1.25 * large};
}

/// Length at which the index has that value, for each of the diameters.
std::vector<std::pair<double, double>> iso_line(const Axes& axes, NecessitySide side, double speed_mps, double level) {
  std::vector<std::pair<double, double>> line;
  for (int i = 0; i <= 160; ++i) {
    side.diameter_m = axes.diameter_min_m + (axes.diameter_max_m - axes.diameter_min_m) * i / 160.0;
    line.emplace_back(level * limit_length_m(side, speed_mps), side.diameter_m);
  }
  return line;
}

std::string points_of(const Axes& axes, const std::vector<std::pair<double, double>>& line) {
  std::string out;
  for (const auto& [length, diameter] : line) out += fmt::format("{:.1f},{:.1f} ", axes.x(std::min(length, 1e3 * axes.length_max_m)), axes.y(diameter));
  return out;
}

std::string grid(const Axes& axes) {
  std::string out;
  const double length_step = step_of(axes.length_max_m);
  for (int i = 0; i * length_step <= axes.length_max_m * 1.0001; ++i) {
    const double x = axes.x(i * length_step);
    out += fmt::format("<path class='grid' d='M{0:.1f} {1}V{2}'/><text x='{0:.1f}' y='{3}' text-anchor='middle'>{4:g}</text>", x, top,
                       height - bottom, height - bottom + 18, i * length_step);
  }
  const double span_mm = 1e3 * (axes.diameter_max_m - axes.diameter_min_m), diameter_step = step_of(span_mm);
  for (double d = std::ceil(1e3 * axes.diameter_min_m / diameter_step) * diameter_step; d <= 1e3 * axes.diameter_max_m; d += diameter_step) {
    const double y = axes.y(1e-3 * d);
    out += fmt::format("<path class='grid' d='M{1} {0:.1f}H{2}'/><text x='{3}' y='{4:.1f}' text-anchor='end'>{5:g}</text>", y, left,
                       width - right, left - 8, y + 4, d);
  }
  out += fmt::format("<text x='{}' y='{}' text-anchor='middle'>line length, m</text>", 0.5 * (left + width - right), height - 14);
  out += fmt::format("<text transform='translate(20 {}) rotate(-90)' text-anchor='middle'>inner diameter, mm</text>", 0.5 * (top + height - bottom));
  return out;
}

/// Value of an iso-line, where the line leaves the map: at its right edge, else at its top.
std::string iso_label(const Axes& axes, const std::vector<std::pair<double, double>>& line, double level) {
  const char* kind = level == 1.0 ? " class='limit-label'" : "";
  const std::string text = level == 1.0 ? "index = 1" : fmt::format("{:g}", level);
  for (const auto& [length, diameter] : line)
    if (length >= axes.length_max_m && axes.y(diameter) < height - bottom - 14)
      return fmt::format("<text{} x='{:.1f}' y='{:.1f}' text-anchor='end'>{}</text>", kind, width - right - 4, axes.y(diameter) + (level == 1.0 ? 24 : 15), text);
  const auto& [length, diameter] = line.back();
  if (axes.x(length) < left + 12 || length >= axes.length_max_m) return "";
  return fmt::format("<text{} x='{:.1f}' y='{:.1f}' text-anchor='end'>{}</text>", kind, axes.x(length) - 14, axes.y(diameter) + 12, text);
}
}  // namespace

std::string index_map_svg(const NecessitySide& side, double peak_speed_mps, const std::vector<MapPoint>& points) {
  const Axes axes = axes_for(points);
  std::string out = fmt::format("<svg viewBox='0 0 {0} {1}' width='{0}' height='{1}' role='img' aria-label='necessity index over length and diameter'>"
                                "<clipPath id='map'><rect x='{2}' y='{3}' width='{4}' height='{5}'/></clipPath><g clip-path='url(#map)'>"
                                "<rect x='{2}' y='{3}' width='{4}' height='{5}' fill='{6}'/>",
                                width, height, left, top, width - left - right, height - top - bottom, fills[0]);
  std::string lines, labels;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto line = iso_line(axes, side, peak_speed_mps, levels[i]);
    const std::string path = points_of(axes, line);
    // Everything to the right of (longer than) the iso-line has a larger index.
    out += fmt::format("<polygon fill='{}' points='{}{:.1f},{} {:.1f},{}'/>", fills[i + 1], path, axes.x(1e3 * axes.length_max_m), top,
                       axes.x(1e3 * axes.length_max_m), height - bottom);
    lines += fmt::format("<polyline class='{}' points='{}'/>", levels[i] == 1.0 ? "limit" : "iso", path);
    labels += iso_label(axes, line, levels[i]);
  }
  out += lines + "</g>" + grid(axes) + labels;
  for (const MapPoint& p : points)
    out += fmt::format("<circle class='{}' cx='{:.1f}' cy='{:.1f}' r='5'/><text class='point' x='{:.1f}' y='{:.1f}'>{}</text>",
                       p.filled ? "filled" : "open", axes.x(p.length_m), axes.y(p.diameter_m), axes.x(p.length_m) + 8, axes.y(p.diameter_m) - 7, p.label);
  return out + "</svg>";
}

}  // namespace pneuservo
