// The nominal cylinder of the verification cases, lines on a chosen grid, and small helpers to read signals.
#pragma once
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <vector>

#include <pneuservo/elements/line_with_chamber.hpp>

#include "verification.hpp"

namespace verification {

using namespace pneuservo;
using Complex = std::complex<double>;

inline constexpr double p_start = 470000.0, T_start = 293.0, half_stroke = 0.15;

inline AirParameters<double> nominal_air() { return {}; }
inline ChamberGeometry<double> chamber_1(double wall_heat) { return {1.257e-3, 2.0e-5, wall_heat}; }
inline ChamberGeometry<double> chamber_2(double wall_heat) { return {1.056e-3, 2.0e-5, wall_heat}; }
inline LineParameters<double> line_of(double length_m, double diameter_mm) {
  LineParameters<double> line;
  line.length_m = length_m;
  line.diameter_m = diameter_mm * 1e-3;
  return line;
}
/// Sub-steps a period for a line alone, by the product's own rule (Courant number 0.9 of sound at 1.2 T plus flow).
inline int substeps_of(const Line<double>& line, double period_s, double speed_mps) {
  const double c = std::sqrt(1.4 * 287.0 * 1.2 * T_start);
  return std::max(1, static_cast<int>(std::ceil((c + speed_mps) * period_s / (0.9 * line.cell_length()))));
}
/// The chamber end as a rigid wall: with its own pressure on the face the last velocity stays exactly 0.
inline ChamberEnd<double> closed_end(const Line<double>& line) {
  const int last = line.cells() - 1;
  return {line.cell_pressure(last), line.cell_temperature(last)};
}
/// Where a sampled signal first reaches `level`, linear between samples; NaN if never.
inline double time_of_level(const std::vector<double>& t, const std::vector<double>& y, double level) {
  for (std::size_t i = 1; i < y.size(); ++i)
    if ((y[i - 1] - level) * (y[i] - level) <= 0.0 && y[i] != y[i - 1])
      return t[i - 1] + (t[i] - t[i - 1]) * (level - y[i - 1]) / (y[i] - y[i - 1]);
  return NAN;
}
/// Value at time `at`, linear between samples.
inline double value_at(const std::vector<double>& t, const std::vector<double>& y, double at) {
  std::size_t i = 1;
  while (i + 1 < t.size() && t[i] < at) ++i;
  return y[i - 1] + (y[i] - y[i - 1]) * (at - t[i - 1]) / (t[i] - t[i - 1]);
}

}  // namespace verification
