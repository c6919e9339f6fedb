// Rows of tables 2.7 and 2.8: the printed gains beside the rules.
#include <fmt/format.h>

#include "design/axis_design.hpp"
#include "design/gain_rules.hpp"
#include "design/itae.hpp"
#include "thesis/groups.hpp"

namespace pneuservo {
namespace {

using Rule = std::function<Ppd2Gains(const LinearAxis&)>;

/// Both gains of one row of a table, per mm as they stand there.
struct PrintedGains {
  const char *place, *name, *config;
  double position_V_per_m;
  const char *velocity, *acceleration;            ///< printed, V s/m per mm
  const char *velocity_meant, *acceleration_meant;
  const char *velocity_held, *acceleration_held;  ///< of the rule; empty: within the tolerance of the print
  const char *method, *why;
  double within;
  Rule rule;
};

Rule alpha_beta(double Kp) {
  return [Kp](const LinearAxis& axis) { return alpha_beta_gains(axis, Kp, 2.0, 2.0); };
}
Rule two_coefficients(double Kp, double c_6, double c_5) {
  return [=](const LinearAxis& axis) { return coefficient_gains(axis, Kp, c_6, c_5); };
}
Rule least(double Kp) {
  return [Kp](const LinearAxis& axis) { return least_itae_gains(axis, Kp); };
}

constexpr const char* per_mm = "0.4 to 0.6 % off its own formula in every row; printed per mm, called per m";
constexpr const char* no_rule = "follows none of the thesis' rules; the least ITAE of the full order stands beside it";
const char* const c4 = table_4mm.config;
const char* const c8 = table_8mm.config;

const std::vector<PrintedGains>& printed_gains() {
  static const std::vector<PrintedGains> all{
      {"Table 2.7", "3rd, 4 mm, K_p 1.0", c4, 1000, "5.49e-2", "1.57e-3", "", "", "", "", "--method alpha_beta", per_mm,
       0.007, alpha_beta(1000)},
      {"Table 2.7", "\"5th\" (7th by 2.4.2), C_5 45, C_6 11", c4, 1000, "6.48e-2", "1.50e-3", "", "", "5.683e-2",
       "1.257e-3", "--method itae_7", "the printed pair does not give the printed gains", 0,
       two_coefficients(1000, 11, 45)},
      {"Table 2.7", "\"5th\" (7th by 2.4.2), C_5 53.7, C_6 12.5", c4, 1000, "6.48e-2", "1.50e-3", "", "", "", "",
       "--method itae_7 --c5 53.7 --c6 12.5", "rows of Table 2.7 are swapped; this pair gives the printed gains", 0.002,
       two_coefficients(1000, 12.5, 53.7)},
      {"Table 2.7", "\"7th\" (5th by 2.4.3), K_p 1.1", c4, 1100, "4.96e-2", "1.10e-3", "", "", "6.27e-2", "1.467e-3",
       "--method itae_min", no_rule, 0, least(1100)},
      {"Table 2.8", "4 mm, 3rd, K_p 1.2", c4, 1200, "6.21e-2", "1.67e-3", "", "", "", "", "--method alpha_beta", per_mm,
       0.007, alpha_beta(1200)},
      {"Table 2.8", "8 mm, 3rd, K_p 1.5", c8, 1500, "7.23e-2", "1.79e-3", "", "", "", "", "--method alpha_beta", per_mm,
       0.007, alpha_beta(1500)},
      {"Table 2.8", "4 mm, 5th, K_p 1.2", c4, 1200, "5.40e-2", "1.30e-3", "", "", "6.654e-2", "1.511e-3",
       "--method itae_min", no_rule, 0, least(1200)},
      {"Table 2.8", "8 mm, 5th, K_p 1.5", c8, 1500, "1.80e-3", "6.00e-2", "6.00e-2", "1.80e-3", "7.735e-2", "1.627e-3",
       "--method itae_min", "K_v and K_a are swapped in the print, as 2.6.2 shows; they follow no rule", 0,
       least(1500)},
  };
  return all;
}

void add(std::vector<ThesisRow>& rows, const PrintedGains& p, bool velocity) {
  const bool searched = std::string_view(p.method) == "--method itae_min";
  rows.push_back(
      {.place = p.place,
       .what = fmt::format("{}: {} by {}", p.name, velocity ? "K_v" : "K_a", std::string_view(p.method).substr(9)),
       .unit = velocity ? "V s/mm" : "V s2/mm",
       .printed = velocity ? p.velocity : p.acceleration,
       .meant = velocity ? p.velocity_meant : p.acceleration_meant,
       .ours =
           [p, velocity](ThesisBench& bench) {
             const Ppd2Gains g = p.rule(bench.design({p.config}).linear.axis);
             return 1e-3 * (velocity ? g.velocity_Vs_per_m : g.acceleration_Vs2_per_m);
           },
       .within = p.within,
       .held = velocity ? p.velocity_held : p.acceleration_held,
       .held_within = searched ? searched_within : 0.0,
       .why = p.why,
       .command =
           fmt::format("{} {} --position-gain {:g}", thesis_verb("design", {p.config}), p.method, p.position_V_per_m)});
}

/// The lag of a line as the config has it.
ThesisRow lag_row(const char* what, const char* unit, const char* printed, const char* meant, const char* config,
                  bool frequency) {
  return {.place = "Table 2.8",
          .what = what,
          .unit = unit,
          .printed = printed,
          .meant = meant,
          .plant = ThesisPlant::config,
          .ours =
              [config, frequency](ThesisBench& bench) {
                const auto line = bench.rig({config}).axis.line_1;
                return frequency ? line.natural_frequency_Hz : line.damping_ratio;
              },
          .why = "tables 2.5 and 2.6 have it the other way round"};
}

}  // namespace

ThesisGroup thesis_gain_group() {
  std::vector<ThesisRow> rows;
  for (const PrintedGains& p : printed_gains())
    for (const bool velocity : {true, false}) add(rows, p, velocity);
  rows.push_back(lag_row("D 4 mm, L 0.5 m: w_t", "Hz", "102", "110", c4, true));
  rows.push_back(lag_row("D 4 mm, L 0.5 m: zeta_t", "", "0.048", "0.068", c4, false));
  rows.push_back(lag_row("D 8 mm, L 1 m: w_t", "Hz", "110", "102", c8, true));
  rows.push_back(lag_row("D 8 mm, L 1 m: zeta_t", "", "0.068", "0.048", c8, false));
  rows.push_back({.place = "2.3.2",
                  .what = "ITAE of the least coefficients, 7th",
                  .printed = "pattern in words",
                  .ours = [](ThesisBench&) { return itae_of_coefficients(least_itae_coefficients(7)); },
                  .held = "10.63",
                  .held_within = searched_within,
                  .why = "the classic coefficients have 15.00",
                  .command = thesis_verb("design", {c4}) + " --coefficients"});
  return {"Tables 2.7, 2.8 Gains", rows};
}

}  // namespace pneuservo
