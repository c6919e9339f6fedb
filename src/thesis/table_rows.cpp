// Rows of 2.1 and 2.2.1: parameters of the servo table, its linear model.
#include <cmath>

#include <pneuservo/control/ppd2.hpp>
#include <pneuservo/elements/air.hpp>
#include <pneuservo/elements/spool_mass.hpp>

#include "design/axis_design.hpp"
#include "thesis/groups.hpp"

namespace pneuservo {
namespace {

using Bench = ThesisBench;
constexpr auto config = ThesisPlant::config;
const ThesisRig table{table_4mm.config};

/// A key of the config, in the print's unit.
ThesisRow table_row(ThesisRow row, double (*value)(const Rig&)) {
  row.plant = config;
  row.command = thesis_verb("run", table) + " --dump-config";
  row.ours = [value](Bench& bench) { return value(bench.rig(table)); };
  return row;
}

/// A constant of the linear model.
ThesisRow model_row(ThesisRow row, double (*value)(const AxisLinearisation&)) {
  row.command = thesis_verb("design", table);
  row.ours = [value](Bench& bench) { return value(bench.design(table).linear); };
  return row;
}

std::vector<ThesisRow> table_parameters() {
  return {
      table_row({.place = "Table 2.1", .what = "half stroke l", .unit = "mm", .printed = "70"},
                [](const Rig& r) { return 500.0 * r.axis.cylinder.stroke_m; }),
      table_row({.place = "Table 2.1", .what = "mass m", .unit = "kg", .printed = "26"},
                [](const Rig& r) { return r.axis.slider.mass_kg; }),
      table_row({.place = "Table 2.1", .what = "piston area A", .unit = "m2", .printed = "1.2e-3"},
                [](const Rig& r) { return r.axis.cylinder.area_1_m2; }),
      table_row({.place = "Table 2.1", .what = "chamber volume V_0", .unit = "m3", .printed = "1.92e-4"},
                [](const Rig& r) {
                  const auto& c = r.axis.cylinder;
                  return c.dead_volume_1_m3 + 0.5 * c.stroke_m * c.area_1_m2;
                }),
      table_row({.place = "Table 2.1", .what = "period", .unit = "us", .printed = "200"},
                [](const Rig& r) { return 1e6 * r.period_s; }),
      table_row({.place = "2.1.1", .what = "resolution of the scale", .unit = "pm", .printed = "62.5"},
                [](const Rig& r) { return 1e12 * r.sensors.position.quantum_m; }),
      table_row({.place = "2.1.1", .what = "friction of the air bearing at 0.1 m/s", .unit = "N", .printed = "below 2"},
                [](const Rig& r) {
                  return 0.1 * r.axis.slider.viscous_friction_Ns_per_m + r.axis.effects.motion.coulomb_friction.force_N;
                }),
      table_row({.place = "2.1.1",
                 .what = "mean pressure",
                 .unit = "kPa",
                 .printed = "118",
                 .meant = "110",
                 .why = "2.2.1 computes with 110 kPa; the linear models take that"},
                [](const Rig& r) { return 1e-3 * r.controller.of<Ppd2>().equilibrium_pressure_Pa; }),
      table_row({.place = "2.1.2", .what = "largest effective area", .unit = "mm2", .printed = "5.0"},
                [](const Rig& r) { return 1e6 * r.axis.valve.area_max_m2; }),
  };
}

/// Of the valve, and of what 2.2.1 takes.
std::vector<ThesisRow> valve_parameters() {
  return {
      {.place = "2.1.2",
       .what = "sonic conductance, as area",
       .unit = "mm2",
       .printed = "9.0e-9 m4 s/kg",
       .meant = "4.5",
       .ours =
           [](Bench& bench) {
             // C rho_0 = K_f S/sqrt(R T): 9.0e-9 m3/(s Pa) at 1.185 kg/m3 (ISO 6358).
             const Air<double> air(bench.rig(table).axis.air);
             return 1e6 * 9.0e-9 * 1.185 * std::sqrt(air.R * air.temperature_K) / air.flow_constant;
           },
       .why = "the printed 9.0e-9 m4 s/kg is a smaller area than the printed 5 mm2; the gains fit 5 mm2"},
      {.place = "2.1.2",
       .what = "mass of the spool",
       .unit = "g",
       .printed = "10",
       .meant = "61",
       .ours = [](Bench&) { return 1e3 * SpoolMassParameters<double>{}.mass_kg; },
       .why = "Table 2.3 has 61 g with the coil, and the loop's gains need it"},
      table_row({.place = "2.2.1", .what = "critical pressure ratio b", .printed = "0.4"},
                [](const Rig& r) { return r.axis.valve.critical_pressure_ratio; }),
      table_row({.place = "2.2.1",
                 .what = "supply pressure P_s",
                 .unit = "MPa",
                 .printed = "0.25",
                 .why = "Table 2.7 has 251.3 kPa"},
                [](const Rig& r) { return 1e-6 * r.axis.supply.pressure_Pa; }),
  };
}

/// Six lines, printed gains or half of them, under the flatness feedforward.
std::vector<ThesisRow> lines() {
  struct Line {
    const char *what, *held, *why;
    ThesisRig rig;
  };
  const std::string lag_1m_4mm = "natural_frequency_Hz: 67, damping_ratio: 0.068}",
                    lag_half_m_8mm = "natural_frequency_Hz: 146, damping_ratio: 0.06}";
  const auto both = [](const std::string& line) {
    return std::vector<std::string>{"line_1=" + line, "line_2=" + line, "simulation.cells_per_m=32"};
  };
  const Line all[] = {
      {"D 4 mm, L 0.5 m: error of the printed move", "", "", {table_4mm.config}},
      {"D 4 mm, L 1 m", "", "", {table_4mm.config, both("{length_m: 1, diameter_m: 0.004, " + lag_1m_4mm)}},
      {"D 4 mm, L 2 m", "", "gains halved, ramps of 0.5 s", {"servo-table-2m-4mm"}},
      {"D 8 mm, L 0.5 m", "", "", {table_8mm.config, both("{length_m: 0.5, diameter_m: 0.008, " + lag_half_m_8mm)}},
      {"D 8 mm, L 1 m", "", "", {table_8mm.config}},
      {"D 8 mm, L 2 m", "", "gains halved, ramps of 0.3 s", {"servo-table-2m-8mm"}}};
  std::vector<ThesisRow> rows;
  for (const Line& line : all)
    rows.push_back(run_row({.place = "Table 2.2",
                            .what = line.what,
                            .unit = "um",
                            .printed = "below 1",
                            .held = line.held,
                            .why = line.why},
                           line.rig, [](const ThesisCourse& course) { return 1e6 * course.max_error_m; }));
  return rows;
}

std::vector<ThesisRow> model() {
  return {
      {.place = "(2.7)",
       .what = "flow constant K_f",
       .printed = "formula",
       .ours =
           [](Bench& bench) {
             const double k = bench.rig(table).axis.air.heat_capacity_ratio;
             return equation(std::sqrt(k * std::pow(2.0 / (k + 1.0), (k + 1.0) / (k - 1.0))),
                             Air<double>::choked_flow_constant(k));
           },
       .held = "holds"},
      model_row({.place = "(2.8)",
                 .what = "delta, discharge over charge",
                 .printed = "P_0/P_s inside the root",
                 .meant = "P_0/P_s outside",
                 .held = "0.21693",
                 .why = "as printed it gives 0.818; a discharging edge passes P_0/P_s of a charging one"},
                [](const AxisLinearisation& l) { return l.discharge_ratio; }),
      model_row({.place = "(2.10)",
                 .what = "K = K_n K_sv w_n^2",
                 .unit = "m/(s3 V)",
                 .printed = "K_sv in (kg/s)/V",
                 .meant = "K_sv in m2/V",
                 .held = "45.58",
                 .why = "2.9 makes an area of a voltage"},
                [](const AxisLinearisation& l) { return l.axis.gain_per_V; }),
      model_row({.place = "(2.11)", .what = "K_n", .unit = "1/(m s)", .printed = "formula", .held = "2.3001e5"},
                [](const AxisLinearisation& l) { return l.speed_per_area_per_ms; }),
      {.place = "(2.12)",
       .what = "w_n = sqrt(2 A^2 P_0/(m V_0))",
       .printed = "formula",
       .ours =
           [](Bench& bench) {
             const Rig r = bench.rig(table);
             const auto& c = r.axis.cylinder;
             const double volume = c.dead_volume_1_m3 + 0.5 * c.stroke_m * c.area_1_m2;
             return equation(2.0 * c.area_1_m2 * c.area_1_m2 * r.controller.of<Ppd2>().equilibrium_pressure_Pa /
                                 (r.axis.slider.mass_kg * volume),
                             bench.design(table).linear.axis.natural_frequency_squared());
           },
       .held = "holds"},
  };
}

}  // namespace

ThesisGroup thesis_table_group() {
  ThesisGroup group{"2.1, 2.2.1 The servo table", table_parameters()};
  for (auto part : {valve_parameters(), lines(), model()})
    group.rows.insert(group.rows.end(), part.begin(), part.end());
  return group;
}

}  // namespace pneuservo
