// What Fig 2.21 can be beside Fig 2.28 on any table that is linear: a bound over every input curve.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "design/axis_design.hpp"
#include "design/polynomial.hpp"
#include "thesis/groups.hpp"

namespace pneuservo {
namespace {

constexpr Ppd2Gains model_gains{1000, 54.9, 1.57};  // of Fig 2.21

Polynomial slope_of(const Polynomial& a) {
  Polynomial out;
  for (std::size_t i = 1; i < a.size(); ++i) out.push_back(static_cast<double>(i) * a[i]);
  return out;
}

/// With u = G^-1 x needed and what the third order says of it, both figures come of one missing voltage: the error e
/// behind its inverse is T_A v/K_pA, the distance d of its model T_3 T_B v/K_pB. So d = T_3 (D_A/D_B) e, D the closed
/// loops' polynomials, and |d| <= the integral of that filter's |impulse response| times |e|, whatever the input curve.
/// NaN: a loop swings, or rings for longer than `least_damping` lets it.
double largest_ratio(const LinearAxis& model, const LinearAxis& axis, double least_damping) {
  const Polynomial third = closed_loop(without_lags(model), model_gains), b = closed_loop(axis, model_gains),
                   numerator = scaled(closed_loop(axis, table_4mm.third), third[0]), denominator = product(third, b),
                   slope = slope_of(denominator);
  const auto poles = roots(denominator);
  double slowest = 1e9, fastest = 0.0;
  for (const auto& pole : poles) {
    if (-pole.real() < least_damping * std::abs(pole)) return std::nan("");
    slowest = std::min(slowest, -pole.real());
    fastest = std::max(fastest, std::abs(pole));
  }
  const double step_s = 0.05 / fastest, end_s = 20.0 / slowest;
  std::vector<std::complex<double>> terms, turns;
  for (const auto& pole : poles) {
    terms.push_back(value_at(numerator, pole) / value_at(slope, pole));
    turns.push_back(std::exp(pole * step_s));
  }
  double sum = 0.0;
  for (double t = 0.0; t < end_s; t += step_s) {
    std::complex<double> now = 0.0;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      now += terms[i];
      terms[i] *= turns[i];
    }
    sum += step_s * std::fabs(now.real());
  }
  return sum;
}

/// The largest of tables with other gains, air springs, line lags and valves whose loops do not ring.
double largest_ratio_of_all(const LinearAxis& printed) {
  double largest = 0.0;
  for (const double gain : {0.5, 0.7, 1.0, 1.4, 2.0})
    for (const double spring : {0.5, 1.0, 2.0, 4.0})
      for (const double line_Hz : {30.0, 50.0, 80.0, 110.0, 160.0, 250.0})
        for (const double line_damping : {0.02, 0.07, 0.2, 0.5})
          for (const double valve_Hz : {60.0, 100.0, 200.0}) {
            LinearAxis axis = printed;
            axis.gain_per_V *= gain;
            for (double& stiffness : axis.stiffness_per_s2) stiffness *= spring;
            for (SecondOrderLag& line : axis.lines) line = {6.283185307179586 * line_Hz, line_damping};
            axis.valve.natural_frequency_rad_per_s = 6.283185307179586 * valve_Hz;
            const double ratio = largest_ratio(printed, axis, 0.02);
            if (std::isfinite(ratio)) largest = std::max(largest, ratio);
          }
  return largest;
}

}  // namespace

std::vector<ThesisRow> order_bound_rows() {
  const std::string why =
      "the inverse of a model leaves what the model lacks: on a linear table both figures come of one missing voltage, "
      "so 540 and 22.67 um cannot be of one table whatever the input curve";
  const auto row = [&](const char* what, const char* held, double (*ratio)(const LinearAxis&)) {
    return ThesisRow{
        .place = "Fig 2.21 over Fig 2.28, one set",
        .what = what,
        .printed = "23.8",
        .plant = ThesisPlant::linear,
        .ours = [ratio](ThesisBench& bench) { return ratio(bench.design({table_4mm.config}).linear.axis); },
        .held = held,
        .held_within = simulated_within,
        .why = why,
        .command = "pneuservo thesis --only 'over Fig 2.28'"};
  };
  return {row("most that any input curve gives, 7th order as printed", "1.433",
              [](const LinearAxis& axis) { return largest_ratio(axis, axis, 0.0); }),
          row("most of 1440 linear tables whose loops damp every swing by 0.02", "1.815",
              [](const LinearAxis& axis) { return largest_ratio_of_all(axis); })};
}

}  // namespace pneuservo
