// Poles in the complex plane as a drawing for a report page.
#pragma once
#include <complex>
#include <string>
#include <vector>

#include <report/html_page.hpp>

namespace pneuservo {

/// How one set of poles is drawn.
enum class PoleMark { dot, cross, circle };

/// Poles of one name; those below the real axis are not drawn, for they come in pairs.
struct PoleSet {
  std::string name;
  Tone tone = Tone::neutral;
  PoleMark mark = PoleMark::dot;
  std::vector<std::complex<double>> poles;
};

/// Upper half of the s plane between real_min and real_max, up to imag_max; rays of equal damping behind the poles.
struct PolePlot {
  std::string title, unit = "rad/s";
  double real_min = -1.0, real_max = 1.0, imag_max = 1.0;
  std::vector<PoleSet> sets;
};

/// One SVG element with a legend below; colours follow the page.
std::string pole_svg(const PolePlot& plot);

}  // namespace pneuservo
