// The page of the verb thesis: the tables, and pictures where the thesis has pictures.
#include "thesis/pictures.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <pneuservo/control/reference.hpp>

#include "design/axis_design.hpp"
#include "report/pole_plot.hpp"
#include "thesis/groups.hpp"
#include "thesis/one_set.hpp"
#include "thesis/report.hpp"

namespace pneuservo {
namespace {

using Complex = std::complex<double>;
using Sets = std::vector<std::string>;
constexpr double mm = 1e3, um = 1e6, kPa = 1e-3;
constexpr Tone tones[] = {Tone::chamber, Tone::valve, Tone::estimated, Tone::fourth, Tone::fifth, Tone::sixth};

Plot time_plot(std::string title, std::string unit, std::string group) {
  Plot plot;
  plot.title = std::move(title);
  plot.unit = std::move(unit);
  plot.group = std::move(group);
  plot.points_max = 1500;
  return plot;
}

Curve curve(std::string name, Tone tone, const std::vector<double>& x, std::vector<double> y, double factor,
            bool dashed = false) {
  for (double& value : y) value *= factor;
  return {std::move(name), tone, x, std::move(y), dashed, false};
}

/// x_ref - x.
Curve error_curve(std::string name, Tone tone, const ThesisCourse& course, double factor) {
  std::vector<double> error(course.x_m.size());
  for (std::size_t i = 0; i < error.size(); ++i) error[i] = course.x_ref_m[i] - course.x_m[i];
  return curve(std::move(name), tone, course.t_s, error, factor);
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out(std::min(a.size(), b.size()));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

// --- Bode ------------------------------------------------------------------------------------------------------------

struct Bode {
  Plot magnitude, phase;
  Bode(const std::string& title, const std::string& group) {
    for (Plot* plot : {&magnitude, &phase}) {
      *plot = time_plot(title, plot == &magnitude ? "dB" : "deg", group);
      plot->x_title = "frequency";
      plot->x_unit = "Hz";
      plot->log_x = true;
      plot->height_px = 280;
    }
  }
  template <class Transfer> void add(const std::string& name, Tone tone, double low, double high, int points,
                                     bool dashed, const Transfer& transfer) {
    std::vector<double> Hz, size, angle;
    double turns = 0.0;
    for (int i = 0; i < points; ++i) {
      Hz.push_back(low * std::pow(high / low, i / (points - 1.0)));
      const Complex value = transfer(Hz.back());
      size.push_back(20.0 * std::log10(std::abs(value)));
      double degrees = std::arg(value) * 180.0 / std::numbers::pi + turns;
      if (!angle.empty() && degrees > angle.back() + 180.0) degrees -= 360.0, turns -= 360.0;
      angle.push_back(degrees);
    }
    magnitude.curves.push_back({name, tone, Hz, size, dashed, false});
    phase.curves.push_back({name, tone, Hz, angle, dashed, false});
  }
};

Complex at_Hz(double f) { return {0.0, 2.0 * std::numbers::pi * f}; }

void valve_pictures(HtmlPage& page, ThesisBench&) {
  Bode bode("Fig 2.7: spool over command, moved by 10 % of its stroke", "valve");
  std::size_t i = 0;
  for (const double set_Hz : {50.0, 100.0, 300.0}) {
    bode.add(fmt::format("set to {:g} Hz", set_Hz), tones[i], 10.0, 1000.0, 40, false,
             [&](double f) { return spool_response(set_Hz, f); });
    bode.add(fmt::format("lag of {:g} Hz, 0.7", set_Hz), tones[i++], 10.0, 1000.0, 200, true, [&](double f) {
      const Complex s = at_Hz(f) / (2.0 * std::numbers::pi * set_Hz);
      return 1.0 / (s * s + 1.4 * s + 1.0);
    });
  }
  page.plots({bode.magnitude, bode.phase});
}

void line_pictures(HtmlPage& page, ThesisBench& bench) {
  page.paragraph(
      "Flow out of the line over flow into it, exact theory with losses that depend on frequency, between the "
      "small volumes of a test rig. Dashed: the printed lag.");
  Bode by_length("Fig 2.12: D 5 mm", "lines"), by_diameter("Fig 2.13: L 1 m", "lines"),
      printed("Fig 2.11: L 1 m, D 5 mm", "lines");
  const auto line = [](Bode& bode, const std::string& name, Tone tone, double L, double D) {
    const LineAcoustics theory = thesis_line(L, D, LineLoss::frequency_dependent);
    bode.add(name, tone, 2.0, 250.0, 300, false,
             [&](double f) { return flow_transfer(theory, line_rig_ends, at_Hz(f)); });
  };
  std::size_t i = 0;
  for (const double L : {0.5, 1.0, 2.0}) line(by_length, fmt::format("L {:g} m", L), tones[i++], L, 5e-3);
  i = 0;
  for (const double D : {4e-3, 5e-3, 6.5e-3, 8e-3})
    line(by_diameter, fmt::format("D {:g} mm", D * mm), tones[i++], 1.0, D);
  line(printed, "exact theory", Tone::chamber, 1.0, 5e-3);
  i = 1;
  for (const double damping : {0.005, 0.05})
    printed.add(fmt::format("80 Hz, {:g}", damping), tones[i++], 2.0, 250.0, 300, true, [&](double f) {
      const Complex s(0.0, f / 80.0);
      return 1.0 / (s * s + 2.0 * damping * s + 1.0);
    });
  page.plots({by_length.magnitude, by_diameter.magnitude});
  page.plots({printed.magnitude, printed.phase});
  const ThesisCourse& moved = bench.run(ThesisRig{"servo-table-1m-8mm", noise_free});
  Plot ends = time_plot("Fig 2.10: the line's ends in the printed move, L 1 m, D 8 mm", "kPa", "line"),
       loss = time_plot("port less chamber", "kPa", "line");
  ends.curves = {curve("port", Tone::valve, moved.t_s, moved.port_Pa[0], kPa),
                 curve("chamber", Tone::chamber, moved.t_s, moved.chamber_Pa[0], kPa)};
  loss.curves = {
      curve("difference", Tone::estimated, moved.t_s, difference(moved.port_Pa[0], moved.chamber_Pa[0]), kPa)};
  page.plots({ends, loss});
}

// --- poles -----------------------------------------------------------------------------------------------------------

void pole_pictures(HtmlPage& page, ThesisBench& bench) {
  const LinearAxis& axis = bench.design({table_4mm.config}).linear.axis;
  const auto poles_at = [&](double share) {
    const Ppd2Gains& g = table_4mm.fifth;
    return roots(
        closed_loop(axis, {share * g.position_V_per_m, share * g.velocity_Vs_per_m, share * g.acceleration_Vs2_per_m}));
  };
  PoleSet less{"gain below the printed", Tone::estimated, PoleMark::dot, {}},
      more{"above", Tone::valve, PoleMark::dot, {}},
      printed{"printed gains", Tone::chamber, PoleMark::cross, poles_at(1.0)};
  for (int i = 0; i <= 120; ++i) {
    const double share = 0.1 * std::pow(40.0, i / 120.0);
    for (const Complex& pole : poles_at(share)) (share < 1.0 ? less : more).poles.push_back(pole);
  }
  PolePlot all{"Fig 2.18: seventh order, L 0.5 m, D 4 mm", "rad/s", -900.0, 250.0, 900.0, {less, more, printed}},
      slow = all;
  slow.title = "The slow ones";
  slow.real_min = -100.0;
  slow.real_max = 30.0;
  slow.imag_max = 100.0;
  page.poles({all, slow});
}

// --- the servo table -------------------------------------------------------------------------------------------------

void model_pictures(HtmlPage& page, ThesisBench& bench) {
  struct Model {
    const char* title;
    int order;
    Ppd2Gains gains;
  };
  const Model models[] = {{"Fig 2.21: 3rd order", 3, {1000, 54.9, 1.57}},
                          {"Figs 2.22, 2.23: 7th order", 7, {1000, 64.8, 1.50}},
                          {"Figs 2.24, 2.25: 5th order", 5, {1100, 49.6, 1.10}}};
  for (const Model& model : models) {
    Sets sets{"controller.feedforward=none"};
    for (const std::string& set : gain_sets(model.gains)) sets.push_back(set);
    const ThesisRig table{table_4mm.config, sets};
    const ThesisCourse& linear = bench.run(LinearRun{table, model.gains, 0, model.order, LinearRun::Law::config});
    const ThesisCourse& nonlinear = bench.run(table);
    Plot errors = time_plot(std::string(model.title) + ": x_ref - x", "um", "models"),
         apart = time_plot("model less table", "um", "models");
    errors.curves = {error_curve("linear model", Tone::valve, linear, um),
                     error_curve("nonlinear table", Tone::chamber, nonlinear, um)};
    apart.curves = {curve("difference", Tone::estimated, linear.t_s, difference(linear.x_m, nonlinear.x_m), um)};
    page.plots({errors, apart});
    Sets keys = linear_model_sets(model.order);
    for (const Sets& more : {gain_sets(model.gains), noise_free}) keys.insert(keys.end(), more.begin(), more.end());
    const ThesisCourse& chambers = bench.run(ThesisRig{table_4mm.config, keys});
    std::vector<Plot> sides;
    for (const std::size_t side : {0U, 1U}) {
      sides.push_back(time_plot(fmt::format("Chamber {} of (2.3), (2.4) and of the table", side + 1), "kPa", "models"));
      sides.back().curves = {curve("linear model", Tone::valve, chambers.t_s, chambers.chamber_Pa[side], kPa),
                             curve("nonlinear table", Tone::chamber, nonlinear.t_s, nonlinear.chamber_Pa[side], kPa)};
    }
    page.plots(sides);
  }
}

/// The curve of both orders, whose five derivatives the fifth order's feedforward takes.
void derivative_pictures(HtmlPage& page, ThesisBench& bench, const ThesisCourse& motion) {
  const Reference reference(bench.rig({table_4mm.config}).reference);
  std::vector<Plot> plots;
  for (std::size_t order = 1; order <= 5; ++order) {
    std::vector<double> values;
    for (const double t_s : motion.t_s) values.push_back(reference.at(t_s).d[order]);
    plots.push_back(time_plot(fmt::format("Figs 2.20, 2.31: derivative {}", order),
                              order == 1 ? "m/s" : fmt::format("m/s{}", order), "feedforward"));
    plots.back().curves = {curve("x_ref", Tone::neutral, motion.t_s, values, 1.0)};
  }
  page.plots(plots);
}

void feedforward_pictures(HtmlPage& page, ThesisBench& bench) {
  const ThesisCourse& motion = bench.run(LinearRun{{table_4mm.config}, table_4mm.fifth, 5});
  Plot input = time_plot("Figs 2.20, 2.31: input curve", "mm", "feedforward"), without = input;
  input.curves = {curve("x_ref", Tone::neutral, motion.t_s, motion.x_ref_m, mm)};
  without.title = "Figs 2.27, 2.29: without feedforward, x_ref - x";
  without.unit = "um";
  for (const ThesisTable* table : {&table_4mm, &table_8mm})
    without.curves.push_back(error_curve(std::string(table->name) + ", linear",
                                         table == &table_4mm ? Tone::chamber : Tone::valve,
                                         bench.run(LinearRun{{table->config}, table->third, 0}), um));
  page.plots({input, without});
  derivative_pictures(page, bench, motion);
  for (const ThesisTable* table : {&table_4mm, &table_8mm}) {
    Plot linear = time_plot(
             fmt::format("Figs {}: {}, linear plant", table == &table_4mm ? "2.28, 2.32" : "2.30, 2.33", table->name),
             "um", "feedforward"),
         nonlinear = time_plot(std::string(table->name) + ", nonlinear table", "um", "feedforward");
    std::size_t i = 0;
    for (const int order : {3, 5}) {
      const Ppd2Gains& gains = order == 3 ? table->third : table->fifth;
      Sets sets = gain_sets(gains);
      sets.push_back(fmt::format("controller.feedforward={}", order));
      const std::string name = fmt::format("order {}", order);
      linear.curves.push_back(error_curve(name, tones[i], bench.run(LinearRun{{table->config}, gains, order}), um));
      nonlinear.curves.push_back(error_curve(name, tones[i++], bench.run(ThesisRig{table->config, sets}), um));
    }
    nonlinear.curves.push_back(error_curve("flatness", tones[i], bench.run(ThesisRig{table->config}), um));
    page.plots({linear, nonlinear});
  }
}

void flow_pictures(HtmlPage& page, ThesisBench& bench) {
  const MeasuredValve valve = thesis_measured_valve(bench);
  Plot area = time_plot("Fig 3.7: area over voltage, measured as in Fig 3.6", "mm2", "flow");
  area.x_title = "voltage";
  area.x_unit = "V";
  area.curves = {curve("config: straight", Tone::neutral, valve.command_V, valve.straight_m2, 1e6, true),
                 curve("simulated valve", Tone::chamber, valve.command_V, valve.true_m2, 1e6),
                 curve("measured flows", Tone::valve, valve.command_V, valve.measured_m2, 1e6)};
  page.plot(area);
}

// --- the cylinder ----------------------------------------------------------------------------------------------------

Plot pressures(std::string title, const ThesisCourse& course, std::size_t side, std::string group) {
  Plot plot = time_plot(std::move(title), "kPa", std::move(group));
  plot.curves = {curve("port", Tone::valve, course.t_s, course.port_Pa[side], kPa),
                 curve("chamber", Tone::chamber, course.t_s, course.chamber_Pa[side], kPa),
                 curve("estimated", Tone::estimated, course.t_s, course.estimated_Pa[side], kPa, true)};
  return plot;
}

/// Figs 3.15 to 3.17, 3.21: the plant of 1 m cells under the command of one of 10 cells a metre; payload.
void simulation_pictures(HtmlPage& page, ThesisBench& bench) {
  const char* const config = "cylinder-10m-7.65mm";
  Sets fine = noise_free;
  fine.insert(fine.end(), {"controller.pressure_source=chamber", "simulation.cells_per_m=10"});
  const ThesisRig experiment{config, fine};
  const ThesisCourse &real = bench.run(experiment),
                     &model = bench.simulate({config, {"simulation.cells_per_m=1"}}, experiment);
  Plot position = time_plot("Fig 3.15: 10 cells a metre (\"experiment\") and 1 (model)", "mm", "simulation");
  position.curves = {curve("experiment", Tone::chamber, real.t_s, real.x_m, mm),
                     curve("model", Tone::valve, model.t_s, model.x_m, mm, true)};
  Plot pressure = time_plot("Figs 3.16, 3.17: line 1", "kPa", "simulation");
  pressure.curves = {curve("port, experiment", Tone::chamber, real.t_s, real.port_Pa[0], kPa),
                     curve("port, model", Tone::valve, model.t_s, model.port_Pa[0], kPa, true),
                     curve("chamber, experiment", Tone::fourth, real.t_s, real.chamber_Pa[0], kPa),
                     curve("chamber, model", Tone::estimated, model.t_s, model.chamber_Pa[0], kPa, true)};
  page.plots({position, pressure});
  Plot loaded =
      time_plot("Fig 3.21: x_ref - x, chapter 4's set, payload 1.25 kg, sensors with 10 kPa of noise", "mm", "loaded");
  for (const auto& [source, tone] : {std::pair{"chamber", Tone::chamber}, std::pair{"estimated", Tone::estimated}})
    loaded.curves.push_back(
        error_curve(source, tone,
                    bench.run(ThesisRig{"thesis/rule-10m-7.65mm",
                                        {fmt::format("controller.pressure_source={}", source), "slider.payload_kg=1.25",
                                         "seed=1", "sensors.chamber_pressure.noise_Pa=10000"}}),
                    mm));
  page.plot(loaded);
}

void cylinder_pictures(HtmlPage& page, ThesisBench& bench) {
  Plot position = time_plot("Figs 3.13, 3.14, 3.20: position", "mm", "cylinder"),
       error = time_plot("x_ref - x", "mm", "cylinder");
  const auto on = [&](const char* source) -> const ThesisCourse& {
    return bench.run(ThesisRig{"thesis/picture-10m-7.65mm", {fmt::format("controller.pressure_source={}", source)}});
  };
  const ThesisCourse& first = on("valve");
  position.curves.push_back(curve("reference", Tone::neutral, first.t_s, first.x_ref_m, mm, true));
  const std::pair<const char*, Tone> sources[] = {
      {"valve", Tone::valve}, {"chamber", Tone::chamber}, {"estimated", Tone::estimated}};
  for (const auto& [source, tone] : sources) {
    position.curves.push_back(curve(source, tone, on(source).t_s, on(source).x_m, mm));
    error.curves.push_back(error_curve(source, tone, on(source), mm));
  }
  page.plots({position, error});
  const ThesisCourse &free = bench.run(ThesisRig{"cylinder-10m-7.65mm"}),
                     &loaded = bench.run(ThesisRig{"cylinder-10m-7.65mm", {"slider.payload_kg=1.25"}});
  page.plots(
      {pressures("Fig 3.18: pipeline 1, free", free, 0, "estimate"), pressures("pipeline 2", free, 1, "estimate")});
  page.plots({pressures("Fig 3.19: pipeline 1, payload 1.25 kg", loaded, 0, "estimate"),
              pressures("pipeline 2", loaded, 1, "estimate")});
  simulation_pictures(page, bench);
}

/// Pressures of both lines with their difference, and positions with theirs, of one line of chapter 4.
void difference_pictures(HtmlPage& page, ThesisBench& bench, const char* config, const char* pressure_place,
                         const char* position_place) {
  const auto on = [&](const char* source) -> const ThesisCourse& {
    ThesisRig which{config, noise_free};
    which.sets.push_back(fmt::format("controller.pressure_source={}", source));
    which.sets.insert(which.sets.end(), unguarded.begin(), unguarded.end());
    return bench.run(which);
  };
  const ThesisCourse &valve = on("valve"), &chamber = on("chamber");
  std::vector<Plot> losses;
  for (const std::size_t side : {0U, 1U}) {
    losses.push_back(time_plot(fmt::format("{}: line {}, port less chamber", pressure_place, side + 1), "kPa", config));
    losses.back().curves = {
        curve("loss", Tone::estimated, chamber.t_s, difference(chamber.port_Pa[side], chamber.chamber_Pa[side]), kPa)};
  }
  page.plots(losses);
  Plot position = time_plot(fmt::format("{}: position", position_place), "mm", config),
       apart = time_plot("x_valve - x_chamber over the amplitude", "%", config);
  position.curves = {curve("on port pressures", Tone::valve, valve.t_s, valve.x_m, mm),
                     curve("on chamber pressures", Tone::chamber, chamber.t_s, chamber.x_m, mm)};
  apart.curves = {curve("difference", Tone::estimated, valve.t_s, difference(valve.x_m, chamber.x_m), 100.0 / 0.08)};
  page.plots({position, apart});
}

void all_difference_pictures(HtmlPage& page, ThesisBench& bench) {
  difference_pictures(page, bench, "thesis/rule-5m-7.65mm", "Fig 4.2", "Fig 4.3");
  difference_pictures(page, bench, "thesis/rule-10m-7.65mm", "Fig 4.4", "Fig 4.5");
  difference_pictures(page, bench, "thesis/rule-2m-6.10mm", "Fig 4.6", "Fig 4.7");
}

// --- one set ---------------------------------------------------------------------------------------------------------

/// What the search found, beside the range that it covered.
void add_set_table(HtmlPage& page, const OneSet& set) {
  std::vector<std::string> names, found, low, high;
  for (const FreeNumber& number : set.numbers) {
    names.push_back(*number.unit == '\0' ? number.name : fmt::format("{}, {}", number.name, number.unit));
    found.push_back(fmt::format("{:.5g}", number.found));
    low.push_back(fmt::format("{:g}", number.low));
    high.push_back(fmt::format("{:g}", number.high));
  }
  page.table({.title = fmt::format("{}: found by --search {} {}", set.title, set.name, set.searched),
              .columns = {text_column("number", names), text_column("found", found), text_column("from", low),
                          text_column("to", high)}});
}

void table_set_pictures(HtmlPage& page, ThesisBench&) {
  add_set_table(page, line_set());
  add_set_table(page, table_set());
}

void cylinder_set_pictures(HtmlPage& page, ThesisBench& bench) {
  add_set_table(page, cylinder_set());
  std::vector<Plot> plots;
  for (const double payload_kg : {0.0, 1.25}) {
    plots.push_back(time_plot(fmt::format("The axis found, payload {:g} kg: x_ref - x", payload_kg), "mm", "found"));
    for (const auto& [source, tone] : {std::pair{"valve", Tone::valve}, std::pair{"chamber", Tone::chamber},
                                       std::pair{"estimated", Tone::estimated}})
      plots.back().curves.push_back(error_curve(source, tone, bench.run(found_cylinder(source, payload_kg)), mm));
  }
  page.plots(plots);
}

/// Pictures by the beginning of their group's title.
struct Pictures {
  const char* title;
  void (*add)(HtmlPage&, ThesisBench&);
};
constexpr Pictures all_pictures[] = {{"2.2.2", valve_pictures},       {"2.2.3 The lines", line_pictures},
                                     {"2.3", pole_pictures},          {"2.4", model_pictures},
                                     {"2.6", feedforward_pictures},   {"3.3.1", flow_pictures},
                                     {"3.5", cylinder_pictures},      {"4.3", all_difference_pictures},
                                     {"One set", table_set_pictures}, {"One axis", cylinder_set_pictures}};

}  // namespace

HtmlPage thesis_page(const std::vector<ThesisResult>& results, ThesisBench& bench) {
  HtmlPage page("The thesis beside ours", "pneuservo thesis", thesis_summary(results));
  page.paragraph(
      "Control Design of the Pneumatic Servo System Considering the Effect of Connected Pipelines. Each row: "
      "what is printed, what it should be, what this program gives now and on which plant; why: the sentence of that "
      "number below the table.");
  if (const std::string left_out = thesis_left_out(results); !left_out.empty()) page.paragraph(left_out);
  page.details("What the verdicts mean",
               {{"agrees", "with the print: within half a unit of its last digit, or a share that its reason explains"},
                {"corrected", "with the corrected print"},
                {"differs", "is not the print, for its reason, and is what it is known to be"},
                {"no figure", "the thesis says it in words or in a picture without digits"},
                {"not there", "wished for in 5.2; this program does not have it"},
                {"MOVED", "is not what it was: a change of the model, or a defect"}});
  for (const ThesisResult& result : results) {
    page.section(result.title);
    for (const Pictures& pictures : all_pictures)
      if (result.title.starts_with(pictures.title)) pictures.add(page, bench);
    page.table(thesis_table(result));
    for (const std::string& reason : thesis_reasons(result)) page.paragraph(reason);
    std::vector<std::pair<std::string, std::string>> commands;
    for (const ThesisFinding& finding : result.findings)
      commands.emplace_back(finding.row->place + ", " + finding.row->what, thesis_command(*finding.row));
    page.details("Commands to repeat each row", commands);
  }
  return page;
}

}  // namespace pneuservo
