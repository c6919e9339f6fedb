// Printed figures of chapter 2 that exclude each other on linear tables: bounds over every input curve.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "design/axis_design.hpp"
#include "design/polynomial.hpp"
#include "thesis/groups.hpp"

namespace pneuservo {
namespace {

Polynomial slope_of(const Polynomial& a) {
  Polynomial out;
  for (std::size_t i = 1; i < a.size(); ++i) out.push_back(static_cast<double>(i) * a[i]);
  return out;
}

/// Integral of |impulse response| of numerator/denominator: the most that the filter makes of a largest value. NaN: it
/// swings, or rings for longer than `least_damping` lets it.
double largest_gain(const Polynomial& numerator, const Polynomial& denominator, double least_damping) {
  const Polynomial slope = slope_of(denominator);
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
  // Of equal degrees: a part of the value passes at once.
  double sum = numerator.size() == denominator.size() ? std::fabs(numerator.back() / denominator.back()) : 0.0;
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

/// With u = G^-1 x needed and what a model says of it, two figures come of one missing voltage v: the error e behind
/// its inverse is T_A v/K_pA, the distance d of the model T_model T_B v/K_pB. So d = T_model (D_A/D_B) e, D the loops'
/// polynomials, and |d| <= the filter's largest gain times |e|, whatever the input curve.
double distance_over_error(const LinearAxis& model, const LinearAxis& axis, const Ppd2Gains& of_distance,
                           const Ppd2Gains& of_error, double least_damping) {
  const Polynomial loop = closed_loop(model, of_distance);
  return largest_gain(scaled(closed_loop(axis, of_error), loop[0]), product(loop, closed_loop(axis, of_distance)),
                      least_damping);
}

/// A figure of 2.4 over one of 2.6: the model of that order, whose inverse the latter has, and the gains of both.
struct FigurePair {
  LinearAxis (*model)(const LinearAxis& printed);
  Ppd2Gains of_distance, of_error;
};
constexpr FigurePair third_order{
    [](const LinearAxis& axis) { return without_lags(axis); }, {1000, 54.9, 1.57}, table_4mm.third};
constexpr FigurePair fifth_order{
    [](const LinearAxis& axis) { return matched_at_low_frequency(axis); }, {1100, 49.6, 1.10}, table_4mm.fifth};
/// Here the inverse is that of the fifth order, which lacks 0.12 um more than the model.
constexpr FigurePair seventh_order{[](const LinearAxis& axis) { return axis; }, {1000, 64.8, 1.50}, table_4mm.fifth};

double ratio_on(const FigurePair& pair, const LinearAxis& printed, const LinearAxis& axis, double least_damping) {
  return distance_over_error(pair.model(printed), axis, pair.of_distance, pair.of_error, least_damping);
}

/// On the printed table itself, its gain moved: poles that lie on each other have no partial fractions.
double ratio_on_printed(const FigurePair& pair, const LinearAxis& printed) {
  LinearAxis axis = printed;
  axis.gain_per_V *= 1.01;
  return ratio_on(pair, printed, axis, 0.0);
}

/// The largest of tables with other gains, air springs, line lags and valves whose loops do not ring.
double largest_ratio_of_all(const FigurePair& pair, const LinearAxis& printed, double least_damping) {
  double largest = 0.0;
  for (const double gain : {0.5, 0.7, 1.01, 1.4, 2.0})
    for (const double spring : {0.5, 1.0, 2.0, 4.0})
      for (const double line_Hz : {30.0, 50.0, 80.0, 110.0, 160.0, 250.0})
        for (const double line_damping : {0.02, 0.07, 0.2, 0.5})
          for (const double valve_Hz : {60.0, 100.0, 200.0}) {
            LinearAxis axis = printed;
            axis.gain_per_V *= gain;
            for (double& stiffness : axis.stiffness_per_s2) stiffness *= spring;
            for (SecondOrderLag& line : axis.lines) line = {6.283185307179586 * line_Hz, line_damping};
            axis.valve.natural_frequency_rad_per_s = 6.283185307179586 * valve_Hz;
            const double ratio = ratio_on(pair, printed, axis, least_damping);
            if (std::isfinite(ratio)) largest = std::max(largest, ratio);
          }
  return largest;
}

constexpr const char* third_why =
    "the inverse of a model leaves what the model lacks: on a linear table both figures come of one missing voltage, "
    "so 540 and 22.67 um cannot be of one table whatever the input curve";
constexpr const char* fifth_why = "the same for 22 and 1.60 um, on one input curve; 2.6.2 has a curve of its own "
                                  "(Fig 2.31), which leaves a way out";
constexpr const char* seventh_why =
    "14 and 1.60 um cannot be of one input curve on a linear table: the fifth order's own lack, 0.12 um on "
    "the curve here, would have to be most of 14 um";
struct Bound {
  const char *place, *printed;
  FigurePair pair;
  const char *printed_held, *all_held, *why;
};
const Bound bounds[] = {{"Fig 2.21 over Fig 2.28, one set", "23.8", third_order, "1.433", "1.815", third_why},
                        {"Fig 2.23 over Fig 2.32, one set", "8.75", seventh_order, "1.200", "1.889", seventh_why},
                        {"Fig 2.25 over Fig 2.32, one set", "13.8", fifth_order, "2.366", "5.952", fifth_why}};

}  // namespace

std::vector<ThesisRow> order_bound_rows() {
  const auto axis_of = [](ThesisBench& bench, const ThesisTable& table) {
    return bench.design({table.config}).linear.axis;
  };
  const auto row = [](const char* place, const char* what, const char* printed, const char* held, const char* why,
                      std::function<ThesisValue(ThesisBench&)> ours) {
    return ThesisRow{.place = place,
                     .what = what,
                     .printed = printed,
                     .plant = ThesisPlant::linear,
                     .ours = std::move(ours),
                     .held = held,
                     .held_within = simulated_within,
                     .why = why,
                     .command = fmt::format("pneuservo thesis --only '{}'", place)};
  };
  std::vector<ThesisRow> rows;
  for (const Bound& bound : bounds) {
    rows.push_back(row(bound.place, "most that any input curve gives, 7th order as printed", bound.printed,
                       bound.printed_held, bound.why,
                       [=](ThesisBench& bench) { return ratio_on_printed(bound.pair, axis_of(bench, table_4mm)); }));
    rows.push_back(row(bound.place, "most of 1440 linear tables whose loops damp every swing by 0.02", bound.printed,
                       bound.all_held, bound.why, [=](ThesisBench& bench) {
                         return largest_ratio_of_all(bound.pair, axis_of(bench, table_4mm), 0.02);
                       }));
  }
  rows.push_back(
      row("Fig 2.32 over Fig 2.33, one set", "most that one missing voltage gives behind both lines", "5.33", "3.143",
          "a delay or a bent valve makes one missing voltage behind both lines, which cannot give 1.60 beside 0.30 um: "
          "the lines' own models would have to differ",
          [=](ThesisBench& bench) {
            // e = v D(0)/(K_p D) behind either line.
            const auto loop = [&](const ThesisTable& table) {
              const Polynomial d = closed_loop(axis_of(bench, table), table.fifth);
              return scaled(d, table.fifth.position_V_per_m / d[0]);
            };
            return largest_gain(loop(table_8mm), loop(table_4mm), 0.0);
          }));
  return rows;
}

}  // namespace pneuservo
