// Rows of chapter 3: elements of the cylinder's model, loops on three pressures, the estimate.
#include <cmath>

#include <fmt/format.h>

#include <pneuservo/elements/air.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/pipe_friction.hpp>

#include "thesis/groups.hpp"

namespace pneuservo {
namespace {

using Sets = std::vector<std::string>;
const ThesisRig cylinder{"cylinder-10m-7.65mm"};
constexpr const char* picture = "thesis/picture-10m-7.65mm";
constexpr const char* rule = "thesis/rule-10m-7.65mm";
double error_mm(const ThesisCourse& course) { return 1e3 * course.max_error_m; }
double estimation_kPa(const ThesisCourse& course) { return 1e-3 * course.max_estimation_error_Pa; }

Sets source_set(const char* source) { return {fmt::format("controller.pressure_source={}", source)}; }

ThesisRow cylinder_row(ThesisRow row, double (*value)(const Rig&)) {
  row.place = "Table 3.1";
  row.plant = ThesisPlant::config;
  row.command = thesis_verb("run", cylinder) + " --dump-config";
  row.ours = [value](ThesisBench& bench) { return value(bench.rig(cylinder)); };
  return row;
}

std::vector<ThesisRow> cylinder_parameters() {
  return {cylinder_row({.what = "area A_L", .unit = "mm2", .printed = "1257"},
                       [](const Rig& r) { return 1e6 * r.axis.cylinder.area_1_m2; }),
          cylinder_row({.what = "area A_R", .unit = "mm2", .printed = "1056"},
                       [](const Rig& r) { return 1e6 * r.axis.cylinder.area_2_m2; }),
          cylinder_row({.what = "full stroke l", .unit = "mm", .printed = "300"},
                       [](const Rig& r) { return 1e3 * r.axis.cylinder.stroke_m; }),
          cylinder_row({.what = "supply pressure P_s", .unit = "MPa", .printed = "0.7"},
                       [](const Rig& r) { return 1e-6 * r.axis.supply.pressure_Pa; }),
          cylinder_row({.what = "length L", .unit = "m", .printed = "10.0"},
                       [](const Rig& r) { return r.axis.line_1.length_m; }),
          cylinder_row({.what = "diameter D", .unit = "mm", .printed = "7.65"},
                       [](const Rig& r) { return 1e3 * r.axis.line_1.diameter_m; }),
          cylinder_row({.what = "critical pressure ratio b (3.3.2.1)", .printed = "0.35"},
                       [](const Rig& r) { return r.axis.valve.critical_pressure_ratio; }),
          cylinder_row({.what = "grid of the estimator (3.3.2.3)", .unit = "m", .printed = "1.0"},
                       [](const Rig& r) { return 1.0 / r.estimator.cells_per_m; }),
          cylinder_row({.what = "period of converters and estimator (3.1, 3.2)", .unit = "ms", .printed = "1"},
                       [](const Rig& r) { return 1e3 * r.period_s; }),
          cylinder_row({.what = "largest valve area (Fig 3.7)",
                        .unit = "mm2",
                        .printed = "curve without figures",
                        .held = "13.0",
                        .why = "linear to 5 V; a measured curve enters as effects.valve_curve"},
                       [](const Rig& r) { return 1e6 * r.axis.valve.area_max_m2; })};
}

/// lambda of the element at some Reynolds numbers against the print.
ThesisValue friction(std::array<double, 2> reynolds, double (*printed)(double)) {
  LineParameters<double> line;
  line.turbulent_reynolds = line.laminar_reynolds;  // the print jumps at 2300
  const PipeFriction<double> friction(line, Air<double>{});
  std::array<double, 2> wanted{}, ours{};
  for (std::size_t i = 0; i < 2; ++i) {
    wanted[i] = printed(reynolds[i]);
    ours[i] = friction(reynolds[i]).lambda_reynolds / reynolds[i];
  }
  return nearly(wanted, ours, 1e-6);
}

std::vector<ThesisRow> line_equations() {
  return {
      {.place = "(3.6)",
       .what = "lambda = 64/Re",
       .printed = "formula",
       .ours = [](ThesisBench&) { return friction({200.0, 2200.0}, [](double Re) { return 64.0 / Re; }); },
       .held = "holds"},
      {.place = "(3.7)",
       .what = "lambda = 0.3164 Re^-0.25",
       .printed = "formula",
       .ours =
           [](ThesisBench&) { return friction({3e3, 4e4}, [](double Re) { return 0.3164 * std::pow(Re, -0.25); }); },
       .held = "holds",
       .why = "with the print's jump at 2300; the configs go over from 2300 to 4000"},
      {.place = "(3.9)",
       .what = "Nu = 0.046 Re^0.8 Pr^0.4",
       .printed = "formula",
       .ours =
           [](ThesisBench&) {
             const AirParameters<double> air;
             const PipeFriction<double> friction(LineParameters<double>{}, Air<double>(air));
             const double Re = 3e4;
             return nearly(std::array{0.046 * std::pow(Re, 0.8) * std::pow(air.prandtl, 0.4)},
                           std::array{friction(Re).nusselt}, 2.1e-3);
           },
       .held = "holds",
       .why = "Re^0.2 by a cubic within 0.21 %; never below the laminar 3.66"},
  };
}

std::vector<ThesisRow> flow_equations() {
  return {
      {.place = "(3.10)",
       .what = "k = 7.95e-5 T + 2.0465e-3",
       .printed = "formula",
       .ours = [](ThesisBench&) { return equation(7.95e-5 * 293.0 + 2.0465e-3, Air<double>::conductivity(293.0)); },
       .held = "holds"},
      {.place = "(3.11) to (3.14)",
       .what = "flow of an edge, choked and not",
       .printed = "volume flow, K_f not given",
       .meant = "mass flow, K_f of (2.7)",
       .ours =
           [](ThesisBench&) {
             const Air<double> air;
             const double b = 0.35, choked = air.flow_constant * 7e5 / std::sqrt(air.R * 293.0);
             const double ellipse = std::sqrt(1.0 - std::pow((0.8 - b) / (1.0 - b), 2));
             return equation(
                 std::array{choked, choked * ellipse},
                 std::array{orifice_flux(air, 7e5, 293.0, 0.3 * 7e5, b), orifice_flux(air, 7e5, 293.0, 0.8 * 7e5, b)});
           },
       .held = "holds",
       .why = "mass is what the line conserves"},
      {.place = "(3.21)",
       .what = "c dt over the estimator's cell",
       .printed = "below 1",
       .ours =
           [](ThesisBench& bench) {
             const Rig r = bench.rig(cylinder);
             return Air<double>(r.axis.air).sound_speed() * r.period_s * r.estimator.cells_per_m;
           },
       .held = "0.343"},
  };
}

/// The pictures' axis with payload; its loops swing.
ThesisRig loaded_picture(const char* source) {
  ThesisRig which{picture, unguarded};
  which.sets.insert(which.sets.end(), {"slider.payload_kg=1.25", source_set(source).front()});
  return which;
}

std::vector<ThesisRow> pictures() {
  const auto on = [](const char* source) { return ThesisRig{picture, source_set(source)}; };
  constexpr const char* fitted =
      "gains, mass and friction of this config are fitted to 56.6 and 13.0 mm: no prediction";
  std::vector<ThesisRow> rows{run_row({.place = "Fig 3.13",
                                       .what = "position error on port pressures",
                                       .unit = "mm",
                                       .printed = "56.6",
                                       .within = 0.03,
                                       .why = fitted},
                                      on("valve"), error_mm),
                              run_row({.place = "Fig 3.14",
                                       .what = "position error on chamber pressures",
                                       .unit = "mm",
                                       .printed = "13.0",
                                       .within = 0.03,
                                       .why = fitted},
                                      on("chamber"), error_mm),
                              run_row({.place = "Fig 3.20",
                                       .what = "position error on estimated pressures, free",
                                       .unit = "mm",
                                       .printed = "almost the same as 13.0",
                                       .held = "13.23"},
                                      on("estimated"), error_mm)};
  rows.insert(rows.begin() + 2, {.place = "3.5.1",
                                 .what = "improvement by chamber pressures",
                                 .unit = "mm",
                                 .printed = "43.6",
                                 .plant = ThesisPlant::nonlinear,
                                 .ours =
                                     [on](ThesisBench& bench) {
                                       return error_mm(bench.run(on("valve"))) - error_mm(bench.run(on("chamber")));
                                     },
                                 .within = 0.03,
                                 .why = fitted});
  return rows;
}

/// Figs 3.18, 3.19, 3.21: the estimate, free and with payload.
std::vector<ThesisRow> estimates() {
  std::vector<ThesisRow> rows;
  rows.push_back(run_row(
      {.place = "Fig 3.18", .what = "estimate less truth, free", .unit = "kPa", .printed = "well", .held = "0.396"},
      cylinder, estimation_kPa));
  rows.push_back(run_row({.place = "Fig 3.19",
                          .what = "estimate less truth, payload 1.25 kg",
                          .unit = "kPa",
                          .printed = "well",
                          .held = "0.40"},
                         {cylinder.config, {"slider.payload_kg=1.25"}}, estimation_kPa));
  rows.push_back(
      {.place = "Fig 3.21",
       .what = "the pictures' own axis, payload: estimated over sensed error",
       .printed = "below 1",
       .plant = ThesisPlant::nonlinear,
       .ours =
           [](ThesisBench& bench) {
             return error_mm(bench.run(loaded_picture("estimated"))) / error_mm(bench.run(loaded_picture("chamber")));
           },
       .held = "1.003",
       .held_within = simulated_within,
       .why = "both swing by 90 mm: the set once fitted to 56.6 and 13.0 mm cannot be the thesis' machine; one that "
              "meets them and carries 1.25 kg stands below",
       .command = thesis_verb("run", loaded_picture("estimated"))});
  return rows;
}

/// Mean largest error over four seeds, chamber sensors with 10 kPa of noise, payload.
double noisy_payload_mm(ThesisBench& bench, const char* source) {
  double sum = 0.0;
  for (const int seed : {1, 2, 3, 4}) {
    Sets sets = source_set(source);
    sets.insert(sets.end(),
                {"slider.payload_kg=1.25", fmt::format("seed={}", seed), "sensors.chamber_pressure.noise_Pa=10000"});
    sum += error_mm(bench.run(ThesisRig{rule, sets}));
  }
  return sum / 4.0;
}

/// 3.5.2: the model of 1 m cells under the command of an "experiment" of 10 cells a metre.
ThesisRow simulated_row(const char* place, const std::string& what, const char* unit, const char* held,
                        double (*difference)(const ThesisCourse& model, const ThesisCourse& experiment),
                        const ThesisRig& case_of = cylinder) {
  ThesisRig model = case_of, experiment = case_of;
  model.sets.push_back("simulation.cells_per_m=1");
  experiment.sets.insert(experiment.sets.end(), noise_free.begin(), noise_free.end());
  experiment.sets.insert(experiment.sets.end(), {"controller.pressure_source=chamber", "simulation.cells_per_m=10"});
  return {
      .place = place,
      .what = what,
      .unit = unit,
      .printed = "agrees (picture)",
      .plant = ThesisPlant::nonlinear,
      .ours = [=](ThesisBench& bench) { return difference(bench.simulate(model, experiment), bench.run(experiment)); },
      .held = held,
      .held_within = simulated_within,
      .why = "no recording of the thesis exists: a plant of ten times as fine a grid stands for its experiment",
      .command = thesis_verb("run", experiment) + " --record fine.csv.gz && " + thesis_verb("simulate", model) +
                 " --command fine.csv.gz"};
}

double largest_kPa(const std::array<std::vector<double>, 2>& a, const std::array<std::vector<double>, 2>& b) {
  double largest = 0.0;
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t i = 0; i < a[side].size(); ++i)
      largest = std::max(largest, 1e-3 * std::fabs(a[side][i] - b[side][i]));
  return largest;
}

double apart_mm(const ThesisCourse& a, const ThesisCourse& b) { return 1e3 * largest_apart_m(a, b); }
double chambers_apart_kPa(const ThesisCourse& a, const ThesisCourse& b) {
  return largest_kPa(a.chamber_Pa, b.chamber_Pa);
}

/// 3.5.2 beyond the pictures: payload, other frequencies and lines.
struct OtherCase {
  const char* name;
  ThesisRig rig;
  const char *position_mm, *chamber_kPa;
};
const OtherCase other_cases[] = {
    {"payload 1.25 kg", {"cylinder-10m-7.65mm", {"slider.payload_kg=1.25"}}, "0.04127", "0.09074"},
    {"0.5 Hz", {"cylinder-10m-7.65mm", {"reference.frequency_Hz=0.5"}}, "0.008997", "0.02057"},
    {"2 Hz", {"cylinder-10m-7.65mm", {"reference.frequency_Hz=2"}}, "0.1464", "0.7396"},
    {"6.10 mm x 5 m", {"cylinder-5m-6.10mm"}, "0.03633", "0.08888"},
    {"4.15 mm x 2 m", {"cylinder-2m-4.15mm"}, "0.4629", "0.4199"},
};

std::vector<ThesisRow> simulations() {
  std::vector<ThesisRow> rows{
      simulated_row("Fig 3.15", "position, simulated less experiment", "mm", "0.03938", apart_mm),
      simulated_row("Fig 3.16", "port pressures, the same", "kPa", "0.1826",
                    [](const ThesisCourse& a, const ThesisCourse& b) { return largest_kPa(a.port_Pa, b.port_Pa); }),
      simulated_row("Fig 3.17", "chamber pressures, the same", "kPa", "0.07967", chambers_apart_kPa)};
  for (const OtherCase& one : other_cases) {
    rows.push_back(simulated_row("3.5.2", fmt::format("{}: position, simulated less experiment", one.name), "mm",
                                 one.position_mm, apart_mm, one.rig));
    rows.push_back(simulated_row("3.5.2", fmt::format("{}: chamber pressures, the same", one.name), "kPa",
                                 one.chamber_kPa, chambers_apart_kPa, one.rig));
  }
  return rows;
}

/// 3.5.4 on every line: the largest error on estimated pressures over that on chamber pressures.
ThesisRow agreement(const char* diameter, int length_m, const char* held) {
  const std::string config = fmt::format("cylinder-{}m-{}mm", length_m, diameter);
  const auto on = [config](const char* source) { return ThesisRig{config, source_set(source)}; };
  return {.place = "3.5.4",
          .what = fmt::format("{} mm x {} m: error on estimated over error on chamber pressures", diameter, length_m),
          .printed = "almost the same",
          .plant = ThesisPlant::nonlinear,
          .ours =
              [on](ThesisBench& bench) {
                return error_mm(bench.run(on("estimated"))) / error_mm(bench.run(on("chamber")));
              },
          .held = held,
          .held_within = searched_within,
          .command = thesis_verb("run", ThesisRig{config}) + " --pressure-source all"};
}

/// 3.1, 3.5.3: every line, free at three frequencies and with payload.
struct NineLines {
  const char* diameter;
  int length_m;
  std::array<const char*, 4> kPa;
  const char* ratio;  ///< error on estimated over error on chamber pressures
};
constexpr NineLines nine[] = {
    {"7.65", 2, {"0.5902", "0.5913", "0.478", "0.5157"}, "1.0005"},
    {"7.65", 5, {"0.5051", "0.4769", "0.4159", "0.4844"}, "1.0006"},
    {"7.65", 10, {"0.3985", "0.3962", "0.9643", "0.4031"}, "0.9998"},
    {"6.10", 2, {"0.4233", "0.4437", "0.4536", "0.4236"}, "1.0007"},
    {"6.10", 5, {"0.3402", "0.3391", "0.6345", "0.347"}, "1.0001"},
    {"6.10", 10, {"0.3188", "0.3106", "1.412", "0.3192"}, "0.9996"},
    {"4.15", 2, {"0.2616", "0.3286", "3.24", "0.3379"}, "0.9993"},
    {"4.15", 5, {"0.2149", "0.3922", "2.195", "0.3949"}, "0.9990"},
    {"4.15", 10, {"0.1395", "0.1964", "0.3736", "0.1951"}, "0.9999"},
};

std::vector<ThesisRow> nine_lines() {
  struct Case {
    const char* name;
    Sets sets;
  };
  const std::array<Case, 4> cases{{{"0.5 Hz", {"reference.frequency_Hz=0.5"}},
                                   {"1 Hz", {}},
                                   {"2 Hz", {"reference.frequency_Hz=2"}},
                                   {"1 Hz, payload", {"slider.payload_kg=1.25"}}}};
  std::vector<ThesisRow> rows;
  for (const NineLines& line : nine) rows.push_back(agreement(line.diameter, line.length_m, line.ratio));
  for (const NineLines& line : nine)
    for (std::size_t i = 0; i < cases.size(); ++i)
      rows.push_back(run_row(
          {.place = "3.5.3",
           .what = fmt::format("{} mm x {} m, {}: estimate less truth", line.diameter, line.length_m, cases[i].name),
           .unit = "kPa",
           .printed = "well",
           .held = line.kPa[i]},
          {fmt::format("cylinder-{}m-{}mm", line.length_m, line.diameter), cases[i].sets}, estimation_kPa));
  return rows;
}

}  // namespace

ThesisGroup thesis_element_group() {
  ThesisGroup group{"3.1 to 3.3 The cylinder and its model", cylinder_parameters()};
  for (auto part : {line_equations(), flow_equations()}) group.rows.insert(group.rows.end(), part.begin(), part.end());
  return group;
}

ThesisGroup thesis_cylinder_group() {
  ThesisGroup group{"3.5 Experiments and simulations of the cylinder", pictures()};
  group.rows.push_back(
      {.place = "Fig 3.21",
       .what = "set of chapter 4, payload, noisy sensors: estimated over sensed error",
       .printed = "below 1",
       .plant = ThesisPlant::nonlinear,
       .ours =
           [](ThesisBench& bench) { return noisy_payload_mm(bench, "estimated") / noisy_payload_mm(bench, "chamber"); },
       .held = "0.976",
       .held_within = searched_within,
       .why = "the largest error; in rms the sensors are ahead by 0.1 %",
       .command = "tools/figures payload"});
  for (auto part : {estimates(), simulations(), nine_lines()})
    group.rows.insert(group.rows.end(), part.begin(), part.end());
  return group;
}

}  // namespace pneuservo
