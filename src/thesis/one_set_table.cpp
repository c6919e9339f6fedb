// The family of servo tables: one set of pressures, valve, gas, lines and input curve against Figs 2.21 to 2.33.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "thesis/groups.hpp"
#include "thesis/one_set.hpp"

namespace pneuservo {
namespace {

using Sets = std::vector<std::string>;
struct TableKey {
  enum Number : std::size_t {
    mean_pressure,
    model_pressure,
    supply,
    area_per_volt,
    area_share,
    wall,
    area_2,
    mass,
    volume,
    critical_ratio,
    dead_band,
    near_middle,
    wide_open,
    losses,
    is_lag,
    delay,
    lead,
    speed,
    ramp_3,
    ramp_5,
    degree_3,
    degree_5,
    way
  };
};

std::vector<FreeNumber> table_numbers(const std::array<double, 23>& found) {
  return {{"mean pressure at the start", "Pa", 1.05e5, 2.4e5, false, found[0]},
          {"P_0 of the thesis' model", "Pa", 1.05e5, 2.4e5, false, found[1]},
          {"supply pressure", "Pa", 2.45e5, 3.6e5, false, found[2]},
          {"K_sv of the thesis' model", "m2/V", 1e-6, 8e-6, true, found[3]},
          {"K_sv of the table over it", "", 0.7, 1.4, false, found[4]},
          {"wall heat of a chamber", "W/(m2 K)", 1.0, 1e5, true, found[5]},
          {"piston area 2 over 1", "", 0.95, 1.05, false, found[6]},
          {"mass over the printed one", "", 0.97, 1.03, false, found[7]},
          {"dead volume over the printed one", "", 0.8, 1.25, false, found[8]},
          {"critical pressure ratio", "", 0.2, 0.55, false, found[9]},
          {"overlap of the spool", "V", -0.5, 0.05, false, found[10]},
          {"slope of the valve about its middle", "", -0.5, 1.0, false, found[11]},
          {"slope of the valve wide open", "", -0.5, 1.0, false, found[12]},
          {"frequency-dependent losses", "", 0.0, 2.0, false, found[13]},
          {"line: below 1 distributed, above the printed lag", "", 0.0, 2.0, false, found[14]},
          {"delay of the command", "s", 0.0, 4e-4, false, found[15]},
          {"delay that the feedforward makes up for", "s", 0.0, 4e-4, false, found[16]},
          {"speed of the move", "m/s", 0.03, 0.2, true, found[17]},
          {"time of the ramps, curve for the third order", "s", 0.08, 1.0, true, found[18]},
          {"time of the ramps, curve for the fifth order", "s", 0.08, 1.0, true, found[19]},
          {"degree of the curve for the third order: 5, 7, 9, 11", "", 0.0, 4.0, false, found[20]},
          {"degree of the curve for the fifth order: 5, 7, 9, 11", "", 0.0, 4.0, false, found[21]},
          {"way of 2.6: 100, 70, 50, 20 mm", "", 0.0, 4.0, false, found[22]}};
}

template <std::size_t n> double one_of(const std::array<double, n>& choices, double number) {
  return choices[static_cast<std::size_t>(std::clamp(number, 0.0, static_cast<double>(n) - 1e-9))];
}

constexpr std::array<double, 4> curve_degrees{5, 7, 9, 11}, move_ways{0.1, 0.07, 0.05, 0.02};

/// Keys of that member of the family: the controller knows the print, the plant has what the member says.
Sets table_member(const std::vector<double>& at, double way_m, int order) {
  const double degree = one_of(curve_degrees, at[order == 5 ? TableKey::degree_5 : TableKey::degree_3]);
  const double start_m = -0.5 * way_m, ramp_s = at[order == 5 ? TableKey::ramp_5 : TableKey::ramp_3],
               speed_mps = std::min(at[TableKey::speed], way_m / ramp_s);
  const double area = at[TableKey::area_per_volt];
  Sets sets = noise_free;
  sets.insert(sets.end(), unguarded.begin(), unguarded.end());
  const std::string line = at[TableKey::is_lag] < 1.0 ? "distributed" : "second_order_lag";
  sets.insert(
      sets.end(),
      {"simulation.cells_per_m=8", "estimator.cells_per_m=1",
       fmt::format("supply.pressure_Pa={:.9g}", at[TableKey::supply]),
       fmt::format("valve.area_per_volt_m2_per_V={:.9g}", area), fmt::format("valve.area_max_m2={:.9g}", 1.6 * area),
       fmt::format("controller.equilibrium_pressure_Pa={:.9g}", at[TableKey::model_pressure]),
       fmt::format("controller.command_delay_s={:.9g}", at[TableKey::lead]),
       fmt::format("cylinder.wall_heat_W_per_m2K={:.9g}", at[TableKey::wall]),
       fmt::format("initial={{position_m: {:.9g}, pressure_1_Pa: {:.9g}}}", start_m, at[TableKey::mean_pressure]),
       "line_1.model=" + line, "line_2.model=" + line,
       fmt::format("deviations={{valve.area_per_volt_m2_per_V: {:.9g}, cylinder.area_2_m2: {:.9g}, slider.mass_kg: "
                   "{:.9g}, cylinder.dead_volume_1_m3: {:.9g}, cylinder.dead_volume_2_m3: {:.9g}, "
                   "valve.critical_pressure_ratio: {:.9g}}}",
                   at[TableKey::area_share] - 1.0, at[TableKey::area_2] - 1.0, at[TableKey::mass] - 1.0,
                   at[TableKey::volume] - 1.0, at[TableKey::volume] - 1.0, at[TableKey::critical_ratio] / 0.4 - 1.0),
       fmt::format("concealed={{valve_dead_band: {{width_V: {:.9g}}}, valve_curve: {{near_middle: {:.9g}, wide_open: "
                   "{:.9g}}}, frequency_dependent_losses: {{share: {:.9g}}}, command_delay: {{delay_s: {:.9g}}}}}",
                   at[TableKey::dead_band], at[TableKey::near_middle], at[TableKey::wide_open],
                   at[TableKey::is_lag] < 1.0 ? at[TableKey::losses] : 0.0, at[TableKey::delay]),
       fmt::format("reference={{kind: cruise, start_m: {:.9g}, end_m: {:.9g}, speed_mps: {:.9g}, ramp_s: {:.9g}, "
                   "start_s: 0.2, smoothness: {:g}}}",
                   start_m, -start_m, speed_mps, ramp_s, degree),
       fmt::format("duration_s={:.4f}", 0.9 + way_m / speed_mps + ramp_s)});
  return sets;
}

/// Figs 2.27 to 2.33: the largest error of the printed law on that table.
double feedforward_um(ThesisBench& bench, const std::vector<double>& at, const ThesisTable& table, int order) {
  Sets sets = table_member(at, one_of(move_ways, at[TableKey::way]), order);
  for (const std::string& set : gain_sets(order == 5 ? table.fifth : table.third)) sets.push_back(set);
  sets.push_back(fmt::format("controller.feedforward={}", order == 0 ? "none" : std::to_string(order)));
  const ThesisCourse& course = bench.run(ThesisRig{table.config, sets});
  return course.fault.empty() ? 1e6 * course.max_error_m : std::nan("");
}

/// Figs 2.21 to 2.25: a linear model of that order against that table.
double model_um(ThesisBench& bench, const std::vector<double>& at, int order, const Ppd2Gains& gains) {
  Sets sets = table_member(at, 0.1, 3);
  for (const std::string& set : gain_sets(gains)) sets.push_back(set);
  sets.push_back("controller.feedforward=none");
  const ThesisRig table{table_4mm.config, sets};
  const ThesisCourse& experiment = bench.run(table);
  if (!experiment.fault.empty()) return std::nan("");
  return 1e6 * largest_apart_m(bench.run(LinearRun{table, gains, 0, order, LinearRun::Law::config}), experiment);
}

std::vector<double> move_figures(ThesisBench& bench, const std::vector<double>& at) {
  std::vector<double> out{model_um(bench, at, 3, {1000, 54.9, 1.57}), model_um(bench, at, 7, {1000, 64.8, 1.50}),
                          model_um(bench, at, 5, {1100, 49.6, 1.10})};
  for (const ThesisTable* table : {&table_4mm, &table_8mm})
    for (const int order : {0, 3, 5}) out.push_back(feedforward_um(bench, at, *table, order));
  return out;
}

}  // namespace

OneSet table_set() {
  return {"table",
          "Figs 2.21 to 2.33 on one servo table",
          "540 um is of no table that a linear inverse leaves at 22.67 um; 0.30 um needs chambers, valves and gas more "
          "linear than any member was",
          table_numbers({1.95e5, 1.95e5, 251.3e3, 2.14e-6, 1.144, 1e5,    1,    1,   1,   0.4, 0,  0,
                         0,      0,      1.5,     1e-4,    1e-4,  0.0597, 0.15, 0.6, 2.5, 2.5, 2.5}),
          {{"Fig 2.21", "3rd order model against the table", "um", "540", "21.09"},
           {"Fig 2.23", "7th order model against the table", "um", "14"},
           {"Fig 2.25", "5th order model against the table", "um", "22", "42.63"},
           {"Fig 2.27", "4 mm, without feedforward", "um", "3270"},
           {"Fig 2.28", "4 mm, feedforward of order 3", "um", "22.67", "17.76"},
           {"Fig 2.32", "4 mm, feedforward of order 5", "um", "1.60"},
           {"Fig 2.29", "8 mm, without feedforward", "um", "3036"},
           {"Fig 2.30", "8 mm, feedforward of order 3", "um", "21.50", "15.60"},
           {"Fig 2.33", "8 mm, feedforward of order 5", "um", "0.30", "1.376"}},
          move_figures,
          "4 of 9",
          "5.8047",
          "--evaluations 4000 --seed 2"};
}

}  // namespace pneuservo
