// Poles in the complex plane as a drawing for a report page.
#include <report/pole_plot.hpp>

#include <cmath>

#include <fmt/format.h>

namespace pneuservo {
namespace {

constexpr double drawing_width = 540, drawing_height = 380, left = 58, right = 14, top = 12, bottom = 40;

/// From the s plane to the drawing.
struct Frame {
  const PolePlot& plot;
  double x(double real) const {
    return left + (real - plot.real_min) / (plot.real_max - plot.real_min) * (drawing_width - left - right);
  }
  double y(double imag) const {
    return drawing_height - bottom - imag / plot.imag_max * (drawing_height - top - bottom);
  }
  bool holds(std::complex<double> s) const {
    return s.real() >= plot.real_min && s.real() <= plot.real_max && s.imag() >= 0.0 && s.imag() <= plot.imag_max;
  }
};

/// 1, 2 or 5 times a power of ten, some five steps over the span.
double grid_step(double span) {
  const double rough = span / 5.0, decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * decade >= rough) return factor * decade;
  return 10.0 * decade;
}

std::string line(double x1, double y1, double x2, double y2, const char* style) {
  return fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' class='{}'/>", x1, y1, x2, y2, style);
}
std::string label(double x, double y, const char* anchor, const std::string& words) {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>", x, y, anchor, html_escape(words));
}

std::string grid(const Frame& frame) {
  const PolePlot& plot = frame.plot;
  std::string out;
  const double real_step = grid_step(plot.real_max - plot.real_min), imag_step = grid_step(plot.imag_max);
  for (double r = std::ceil(plot.real_min / real_step) * real_step; r <= plot.real_max; r += real_step) {
    out += line(frame.x(r), frame.y(0), frame.x(r), frame.y(plot.imag_max), "grid");
    out += label(frame.x(r), drawing_height - bottom + 16, "middle", figure(std::fabs(r) < 1e-9 * real_step ? 0.0 : r));
  }
  for (double i = 0.0; i <= plot.imag_max; i += imag_step) {
    out += line(frame.x(plot.real_min), frame.y(i), frame.x(plot.real_max), frame.y(i), "grid");
    out += label(left - 6, frame.y(i) + 4, "end", figure(i));
  }
  for (const double damping : {0.1, 0.3, 0.5, 0.7, 0.9}) {  // until the ray leaves the frame
    const double slope = std::sqrt(1.0 - damping * damping) / damping;
    const double real = std::max(plot.real_min, -plot.imag_max / slope);
    out += line(frame.x(0), frame.y(0), frame.x(real), frame.y(-real * slope), "ray");
    out += label(frame.x(real) + (real > plot.real_min ? 2 : 3), frame.y(-real * slope) + 11, "start",
                 fmt::format("{:g}", damping));
  }
  out += line(frame.x(0), frame.y(0), frame.x(0), frame.y(plot.imag_max), "axis");
  return out +
         label(drawing_width - right, drawing_height - 6, "end", "real part [" + plot.unit + "]; rays: damping ratio");
}

std::string mark(double x, double y, PoleMark kind, const char* tone) {
  if (kind == PoleMark::dot)
    return fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='1.5' fill='var(--{})'/>", x, y, tone);
  if (kind == PoleMark::circle)
    return fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4.5' fill='none' stroke='var(--{})' stroke-width='1.6'/>", x,
                       y, tone);
  return fmt::format("<path d='M{:.1f} {:.1f}l9 9m0 -9l-9 9' stroke='var(--{})' stroke-width='2.2' fill='none'/>",
                     x - 4.5, y - 4.5, tone);
}

}  // namespace

std::string pole_svg(const PolePlot& plot) {
  const Frame frame{plot};
  std::string out = fmt::format("<svg class='poles' viewBox='0 0 {} {}' role='img' aria-label='{}'>", drawing_width,
                                drawing_height, html_escape(plot.title));
  out += grid(frame);
  std::string legend;
  for (const PoleSet& set : plot.sets) {
    const char* tone = tone_name(set.tone);
    for (const auto& pole : set.poles)
      if (frame.holds(pole)) out += mark(frame.x(pole.real()), frame.y(pole.imag()), set.mark, tone);
    legend += fmt::format("<span><svg class='key' viewBox='0 0 12 12'>{}</svg>{}</span>", mark(6, 6, set.mark, tone),
                          html_escape(set.name));
  }
  return out + "</svg><p class='pole-legend'>" + legend + "</p>";
}

}  // namespace pneuservo
