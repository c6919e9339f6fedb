// Rows of 2.3: the closed loops of third, fifth and seventh order, equation by equation, and their poles.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "design/axis_design.hpp"
#include "design/gain_rules.hpp"
#include "thesis/groups.hpp"

namespace pneuservo {
namespace {

constexpr Ppd2Gains fifth_gains = table_4mm.fifth;

/// Symbols of the thesis, from the model of the 4 mm table and its printed gains.
struct Symbols {
  double K = 0.0, wn2 = 0.0, wt = 0.0, zt = 0.0, wv = 0.0, zv = 0.0, w0 = 0.0, z0 = 0.0;
  LinearAxis axis;
};

Symbols symbols_of(ThesisBench& bench) {
  Symbols s;
  s.axis = bench.design({table_4mm.config}).linear.axis;
  s.K = s.axis.gain_per_V;
  s.wn2 = s.axis.natural_frequency_squared();
  s.wt = s.axis.lines[0].natural_frequency_rad_per_s;
  s.zt = s.axis.lines[0].damping_ratio;
  s.wv = s.axis.valve.natural_frequency_rad_per_s;
  s.zv = s.axis.valve.damping_ratio;
  const SecondOrderLag both = low_frequency_match(s.axis.lines[0], s.axis.valve);
  s.w0 = both.natural_frequency_rad_per_s;
  s.z0 = both.damping_ratio;
  return s;
}

enum class Order { third, fifth, seventh };
Polynomial loop_of(const Symbols& s, Order order) {
  if (order == Order::third) return closed_loop(without_lags(s.axis), fifth_gains);
  return closed_loop(order == Order::fifth ? matched_at_low_frequency(s.axis) : s.axis, fifth_gains);
}

/// One coefficient of a loop by the printed, or the corrected, formula, against that of the polynomial.
struct Formula {
  const char *place, *what, *meant, *why;
  Order order;
  std::size_t power;
  double (*value)(const Symbols&);
};
const double Ka = fifth_gains.acceleration_Vs2_per_m, Kv = fifth_gains.velocity_Vs_per_m,
             Kp = fifth_gains.position_V_per_m;

const Formula formulas[] = {
    {"(2.20)", "A_1", "", "", Order::third, 2, [](const Symbols& s) { return Ka * s.K; }},
    {"(2.21)", "A_2", "", "", Order::third, 1, [](const Symbols& s) { return Kv * s.K + s.wn2; }},
    {"(2.22)", "A_3", "", "", Order::third, 0, [](const Symbols& s) { return Kp * s.K; }},
    {"(2.27)", "C_1 w", "", "", Order::seventh, 6, [](const Symbols& s) { return 2 * (s.zt * s.wt + s.zv * s.wv); }},
    {"(2.28)", "C_2 w^2", "", "", Order::seventh, 5,
     [](const Symbols& s) { return s.wt * s.wt + s.wn2 + s.wv * s.wv + 4 * s.zt * s.zv * s.wt * s.wv; }},
    {"(2.29)", "C_3 w^3", "", "", Order::seventh, 4,
     [](const Symbols& s) {
       return 2 * ((s.zt * s.wt + s.zv * s.wv) * s.wn2 + s.wt * s.wv * (s.zt * s.wv + s.zv * s.wt));
     }},
    {"(2.30)", "C_4 w^4", "", "", Order::seventh, 3,
     [](const Symbols& s) {
       return s.wt * s.wt * s.wv * s.wv + s.wn2 * (s.wt * s.wt + s.wv * s.wv + 4 * s.zt * s.zv * s.wt * s.wv);
     }},
    {"(2.31)", "C_5 w^5", "bracket closes before + K_a K_n K_sv (w_t w_v w_n)^2",
     "as printed the K_a term is multiplied by 2 w_t w_v w_n^2 once more", Order::seventh, 2,
     [](const Symbols& s) {
       return 2 * s.wt * s.wv * s.wn2 * (s.zt * s.wv + s.zv * s.wt) + Ka * s.K * s.wt * s.wt * s.wv * s.wv;
     }},
    {"(2.32)", "C_6 w^6", "", "", Order::seventh, 1,
     [](const Symbols& s) { return s.wt * s.wt * s.wv * s.wv * (s.wn2 + Kv * s.K); }},
    {"(2.33)", "w^7", "", "", Order::seventh, 0, [](const Symbols& s) { return s.wt * s.wt * s.wv * s.wv * Kp * s.K; }},
    {"(2.37)", "B_1 w", "", "", Order::fifth, 4, [](const Symbols& s) { return 2 * s.w0 * s.z0; }},
    {"(2.38)", "B_2 w^2, of s^3 in (2.36)", "s^3", "(2.36) and (2.43) print s^2 for it", Order::fifth, 3,
     [](const Symbols& s) { return s.w0 * s.w0 + s.wn2; }},
    {"(2.39)", "B_3 w^3", "", "", Order::fifth, 2,
     [](const Symbols& s) { return 2 * s.wn2 * s.z0 * s.w0 + Ka * s.K * s.w0 * s.w0; }},
    {"(2.40)", "B_4 w^4", "", "", Order::fifth, 1, [](const Symbols& s) { return s.w0 * s.w0 * (s.wn2 + Kv * s.K); }},
    {"(2.41)", "w^5", "", "", Order::fifth, 0, [](const Symbols& s) { return s.w0 * s.w0 * Kp * s.K; }},
};

std::vector<ThesisRow> order_equations() {
  std::vector<ThesisRow> rows;
  for (const Formula& f : formulas)
    rows.push_back({.place = f.place,
                    .what = f.what,
                    .printed = "formula",
                    .meant = f.meant,
                    .ours =
                        [f](ThesisBench& bench) {
                          const Symbols s = symbols_of(bench);
                          return equation(f.value(s), loop_of(s, f.order)[f.power]);
                        },
                    .held = std::string(thesis_holds),
                    .why = f.why});
  return rows;
}

/// (2.34), (2.35): gains from two coefficients, put back into the loop.
ThesisValue gains_from_coefficients(ThesisBench& bench) {
  const LinearAxis axis = symbols_of(bench).axis;
  const Ppd2Gains found = coefficient_gains(axis, 1000.0, 11.0, 45.0);
  const std::vector<double> c = normalised_coefficients(closed_loop(axis, found));
  return equation(std::array{11.0, 45.0}, std::array{c[0], c[1]});
}

/// c_i of the feedforward against the coefficients of the loop over the last one.
ThesisValue inverse_of(ThesisBench& bench, Order order) {
  const Symbols s = symbols_of(bench);
  const Polynomial loop = loop_of(s, order);
  const auto axis = order == Order::third ? without_lags(s.axis) : matched_at_low_frequency(s.axis);
  std::vector<double> wanted;
  for (std::size_t i = 1; i < loop.size(); ++i) wanted.push_back(loop[i] / loop[0]);
  return equation(wanted, inverse_of_closed_loop(axis, fifth_gains));
}

/// Where the real parts of the poles leave their largest gap: so many far, so many near.
ThesisValue poles_in_words(ThesisBench& bench) {
  std::vector<double> real;
  for (const auto& pole : roots(loop_of(symbols_of(bench), Order::seventh))) real.push_back(-pole.real());
  std::sort(real.begin(), real.end());
  std::size_t near = 1;
  for (std::size_t i = 1; i < real.size(); ++i)
    if (real[i] / real[i - 1] > real[near] / real[near - 1]) near = i;
  return fmt::format("{} far, {} near", real.size() - near, near);
}

}  // namespace

ThesisGroup thesis_order_group() {
  std::vector<ThesisRow> rows = order_equations();
  rows.push_back({.place = "(2.34), (2.35)",
                  .what = "K_a, K_v from C_5, C_6",
                  .printed = "w^(5/7), w^(6/7)",
                  .meant = "w^5, w^6",
                  .ours = gains_from_coefficients,
                  .held = std::string(thesis_holds),
                  .why = "2.31 and 2.32 have w^5 and w^6"});
  rows.push_back({.place = "Fig 2.18",
                  .what = "poles of the seventh order",
                  .printed = "2 far, 5 near",
                  .ours = poles_in_words,
                  .command = thesis_verb("design", {table_4mm.config}) + " --report design.html"});
  rows.push_back({.place = "2.3.3",
                  .what = "w_0/2 pi of the fifth order",
                  .unit = "Hz",
                  .printed = "not given",
                  .ours = [](ThesisBench& bench) { return symbols_of(bench).w0 / 6.283185307179586; },
                  .held = "70.72",
                  .why =
                      "matched at low frequency; leaving out the two far poles would keep the line (106 Hz, 0.08) and "
                      "lose the valve's phase"});
  rows.push_back({.place = "2.3.3",
                  .what = "zeta_0 of the fifth order",
                  .printed = "not given",
                  .ours = [](ThesisBench& bench) { return symbols_of(bench).z0; },
                  .held = "0.539"});
  rows.push_back({.place = "(2.42)",
                  .what = "inverse of the third order",
                  .printed = "formula",
                  .ours = [](ThesisBench& bench) { return inverse_of(bench, Order::third); },
                  .held = std::string(thesis_holds)});
  rows.push_back({.place = "(2.43)",
                  .what = "inverse of the fifth order",
                  .printed = "B_2 w^2 s^2",
                  .meant = "B_2 w^2 s^3",
                  .ours = [](ThesisBench& bench) { return inverse_of(bench, Order::fifth); },
                  .held = std::string(thesis_holds),
                  .why = "s^2 stands there twice"});
  return {"2.3, 2.5 Linear models and their inverse", rows};
}

}  // namespace pneuservo
