// Verb identify: natural frequency and damping of a line from a recording of the pressures at its two ends.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <pneuservo/elements/chamber.hpp>

#include "acoustics/line_identification.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"
#include "report/html_page.hpp"
#include "report/json_number.hpp"

namespace pneuservo {
namespace {

struct IdentifyOptions {
  std::string config, recording, json, report;
  std::vector<std::string> sets;
  int side = 1;
};

/// A line of the rig with what a result is compared with.
struct IdentifiedLine {
  LineBelief belief;
  double sensor_noise_Pa = 0.0;
  std::string in_column, out_column;
  std::size_t bridged_rows = 0;
  LineIdentification found;
};

/// Where the piston stands; it must not move, for the chamber's volume is one number.
double piston_position_m(const Rig& rig, const Recording& recording) {
  const std::string column(info(Signal::x).column);
  if (!recording.has(column)) return rig.initial.position_m;
  std::vector<double> x;
  for (const double value : recording.column(column))
    if (std::isfinite(value)) x.push_back(value);
  if (x.empty()) return rig.initial.position_m;
  std::ranges::sort(x);
  const double middle = x[x.size() / 2];
  // A hundredth of the stroke changes the volume by less than what is believed of it.
  if (x.back() - x.front() > 0.01 * rig.axis.cylinder.stroke_m)
    throw InputError(
        fmt::format("{}: {}: found a piston that moves by {:.3g} mm, expected one that is held: the volume "
                    "behind the line is one number",
                    recording.path, column, 1e3 * (x.back() - x.front())));
  return middle;
}

IdentifiedLine line_of(const IdentifyOptions& options, const Rig& rig, const Recording& recording) {
  IdentifiedLine out;
  const bool second = options.side == 2;
  out.in_column = info(second ? Signal::p2_port : Signal::p1_port).column;
  out.out_column = info(second ? Signal::p2_chamber : Signal::p1_chamber).column;
  LineBelief& belief = out.belief;
  belief.air = rig.axis.air;
  const auto take_line = [&](const LineParameters<double>& line) {
    belief.length_m = line.length_m;
    belief.diameter_m = line.diameter_m;
  };
  if (rig.is_pneumatic()) {
    const auto& c = rig.axis.cylinder;
    const double x_m = piston_position_m(rig, recording);
    const ChamberGeometry<double> chamber{second ? c.area_2_m2 : c.area_1_m2,
                                          second ? c.dead_volume_2_m3 : c.dead_volume_1_m3, c.wall_heat_W_per_m2K};
    const double s = 0.5 * c.stroke_m + (second ? -x_m : x_m);
    take_line(second ? rig.axis.line_2 : rig.axis.line_1);
    belief.ends = {0.0, chamber.volume_m3(s), chamber.wall_heat_W_per_m2K * chamber.wall_area_m2(s)};
  } else if (rig.kind == RigKind::vessel && rig.line && !second) {
    take_line(*rig.line);
    belief.ends = {0.0, rig.vessel.volume_m3, rig.vessel.wall_heat_W_per_K};
  } else {
    throw InputError(fmt::format("{}: rig: found {} {}, expected a cylinder, a servo table or a vessel with a line: "
                                 "identify needs pressures at both ends of one",
                                 options.config, info(rig.kind).name,
                                 second                    ? "with --side 2"
                                 : rig.controls_pressure() ? "as its kind"
                                                           : "without a line"));
  }
  out.sensor_noise_Pa = std::sqrt(
      0.5 * (std::pow(rig.sensors.port_pressure.rms_Pa(), 2) + std::pow(rig.sensors.chamber_pressure.rms_Pa(), 2)));
  return out;
}

/// Both pressures on an even grid of the median interval; straight lines bridge what is missing.
LinePressures even_pressures(const Recording& recording, IdentifiedLine& line) {
  recording.require({line.in_column, line.out_column});
  const auto &t = recording.t_s(), &in = recording.column(line.in_column), &out = recording.column(line.out_column);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (std::isfinite(in[i]) && std::isfinite(out[i])) rows.push_back(i);
  LinePressures p;
  p.period_s = row_interval_s(recording);
  if (rows.size() < 2) return p;
  std::size_t at = 0;
  for (std::size_t k = 0;; ++k) {
    const double time = t[rows.front()] + static_cast<double>(k) * p.period_s;
    if (time > t[rows.back()] + 0.5 * p.period_s) break;
    while (at + 2 < rows.size() && t[rows[at + 1]] < time) ++at;
    const std::size_t i = rows[at], j = rows[at + 1];
    const double share = std::clamp((time - t[i]) / (t[j] - t[i]), 0.0, 1.0);
    if (t[j] - t[i] > 1.5 * p.period_s) ++line.bridged_rows;
    p.in_Pa.push_back(in[i] + share * (in[j] - in[i]));
    p.out_Pa.push_back(out[i] + share * (out[j] - out[i]));
  }
  return p;
}

LineAcoustics theory(const IdentifiedLine& line, LineLoss loss) {
  return {line.belief.length_m, line.belief.diameter_m, line.found.mean_pressure_Pa, line.belief.air, loss};
}

/// Of exact or quasi-steady theory with the config's numbers; no numbers where there is no peak.
LineResonance expected(const IdentifiedLine& line, LineLoss loss) {
  try {
    return first_resonance(theory(line, loss), line.belief.ends);
  } catch (const std::invalid_argument&) {
    LineResonance none;
    none.natural_frequency_Hz = none.damping_ratio = std::nan("");
    return none;
  }
}

std::vector<std::string> remarks(const IdentifiedLine& line) {
  std::vector<std::string> out;
  const LineIdentification& f = line.found;
  if (!f.resonates) out.emplace_back("friction damps the first resonance away: there is no natural frequency");
  if (f.ends_share > 0.02)  // the ends move as much as the rest of the recording
    out.push_back(fmt::format("{} moves at the recording's ends ({:.0f} % of its changes lie in the first and last "
                              "hundredth): what went before is taken for rest, so record rest at both ends",
                              line.in_column, 100.0 * f.ends_share));
  if (line.sensor_noise_Pa > 0.0 && f.noise_Pa > 2.0 * line.sensor_noise_Pa)
    out.push_back(
        fmt::format("the fit leaves {:.0f} Pa where the sensors' noise is {:.0f} Pa: something that a line with "
                    "a volume does not have is in it (large swings, leaks, slow sensors)",
                    f.noise_Pa, line.sensor_noise_Pa));
  if (line.bridged_rows > 0)
    out.push_back(fmt::format("{} missing rows are bridged by straight lines", line.bridged_rows));
  return out;
}

std::string estimate_text(const EstimatedNumber& n, double factor = 1.0) {
  return fmt::format("{:.4g} +- {:.2g}", factor * n.value, factor * n.standard_error);
}

Table resonance_table(const IdentifiedLine& line) {
  const LineIdentification& f = line.found;
  const LineResonance exact = expected(line, LineLoss::frequency_dependent),
                      steady = expected(line, LineLoss::quasi_steady);
  const auto plain = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.4g}", value) : std::string("-");
  };
  Table table;
  table.title = "First resonance, valve flow to chamber flow";
  table.columns = {
      text_column("", {"identified", "exact theory, config", "quasi-steady theory, config"}),
      text_column("natural frequency [Hz]", {f.resonates ? estimate_text(f.natural_frequency_Hz) : "-",
                                             plain(exact.natural_frequency_Hz), plain(steady.natural_frequency_Hz)}),
      text_column("damping ratio [-]", {f.resonates ? estimate_text(f.damping_ratio) : "-", plain(exact.damping_ratio),
                                        plain(steady.damping_ratio)})};
  return table;
}

Table parameter_table(const IdentifiedLine& line) {
  const LineIdentification& f = line.found;
  Table table;
  table.title = "What was fitted";
  table.columns = {text_column("", {"length at the config's speed of sound [m]", "losses over those of the air [-]",
                                    "volume at the end [cm3]", "gain of the far sensor over the near one [-]"}),
                   text_column("identified", {estimate_text(f.length_m), estimate_text(f.loss_ratio),
                                              estimate_text(f.volume_out_m3, 1e6), estimate_text(f.gain)}),
                   text_column("config", {fmt::format("{:.4g}", line.belief.length_m), "1",
                                          fmt::format("{:.4g}", 1e6 * line.belief.ends.volume_out_m3), "1"})};
  return table;
}

std::string headline(const IdentifiedLine& line) {
  const LineIdentification& f = line.found;
  return fmt::format("{} to {}, {:.3g} bar, {:.3g} to {:.3g} Hz; the fit leaves {:.3g} Pa", line.in_column,
                     line.out_column, 1e-5 * f.mean_pressure_Pa, f.lowest_Hz, f.highest_Hz, f.noise_Pa);
}

std::string text_of(const IdentifiedLine& line) {
  std::string text = headline(line) + "\n" + text_table(resonance_table(line)) + text_table(parameter_table(line));
  for (const std::string& remark : remarks(line)) text += remark + "\n";
  return text;
}

Json json_of(const IdentifiedLine& line) {
  const LineIdentification& f = line.found;
  const auto estimated = [](const EstimatedNumber& n) {
    return Json{{"value", number(n.value)}, {"standard_error", number(n.standard_error)}};
  };
  const auto resonance = [&](LineLoss loss) {
    const LineResonance r = expected(line, loss);
    return Json{{"natural_frequency_Hz", number(r.natural_frequency_Hz)}, {"damping_ratio", number(r.damping_ratio)}};
  };
  Json response = Json::array();
  for (const ResponsePoint& p : f.response)
    response.push_back({{"Hz", p.Hz},
                        {"magnitude", std::abs(p.measured)},
                        {"magnitude_standard_error", p.standard_error},
                        {"phase_rad", std::arg(p.measured)},
                        {"fitted_magnitude", std::abs(p.fitted)},
                        {"fitted_phase_rad", std::arg(p.fitted)}});
  return {{"in", line.in_column},
          {"out", line.out_column},
          {"mean_pressure_Pa", f.mean_pressure_Pa},
          {"lowest_Hz", f.lowest_Hz},
          {"highest_Hz", f.highest_Hz},
          {"natural_frequency_Hz", estimated(f.natural_frequency_Hz)},
          {"damping_ratio", estimated(f.damping_ratio)},
          {"exact_theory", resonance(LineLoss::frequency_dependent)},
          {"quasi_steady_theory", resonance(LineLoss::quasi_steady)},
          {"length_m", estimated(f.length_m)},
          {"loss_ratio", estimated(f.loss_ratio)},
          {"volume_out_m3", estimated(f.volume_out_m3)},
          {"gain", estimated(f.gain)},
          {"noise_Pa", f.noise_Pa},
          {"sensor_noise_Pa", line.sensor_noise_Pa},
          {"remarks", remarks(line)},
          {"response", std::move(response)}};
}

Plot response_plot(const char* title, const char* unit) {
  Plot plot;
  plot.title = title;
  plot.unit = unit;
  plot.x_title = "frequency";
  plot.x_unit = "Hz";
  plot.group = "frequency";
  plot.log_x = true;
  plot.height_px = 280;
  return plot;
}

void add_response(HtmlPage& page, const IdentifiedLine& line) {
  Plot magnitude = response_plot("Chamber over port: magnitude", "dB"),
       phase = response_plot("Chamber over port: phase", "deg");
  Curve measured{.name = "recorded", .tone = Tone::valve, .x = {}, .y = {}}, fitted = measured, believed = measured;
  fitted.name = "fitted", fitted.tone = Tone::estimated;
  believed.name = "exact theory, config", believed.tone = Tone::neutral, believed.dashed = true;
  Curve measured_phase = measured, fitted_phase = fitted, believed_phase = believed;
  Band band{.name = "two standard errors", .tone = Tone::valve, .x = {}, .low = {}, .high = {}};
  const LineAcoustics exact = theory(line, LineLoss::frequency_dependent);
  const auto decibel = [](double value) { return 20.0 * std::log10(std::max(value, 1e-6)); };
  const auto add = [&](Curve& size, Curve& angle, double Hz, std::complex<double> value) {
    size.x.push_back(Hz), angle.x.push_back(Hz);
    size.y.push_back(decibel(std::abs(value)));
    angle.y.push_back(std::arg(value) * 180.0 / std::numbers::pi);
  };
  for (const ResponsePoint& p : line.found.response) {
    add(measured, measured_phase, p.Hz, p.measured);
    add(fitted, fitted_phase, p.Hz, p.fitted);
    add(believed, believed_phase, p.Hz,
        pressure_transfer(exact, line.belief.ends, std::complex<double>(0.0, 2.0 * std::numbers::pi * p.Hz)));
    band.x.push_back(p.Hz);
    band.low.push_back(decibel(std::abs(p.measured) - 2.0 * p.standard_error));
    band.high.push_back(decibel(std::abs(p.measured) + 2.0 * p.standard_error));
  }
  magnitude.bands = {band};
  magnitude.curves = {measured, fitted, believed};
  phase.curves = {measured_phase, fitted_phase, believed_phase};
  if (line.found.resonates) magnitude.marks.push_back({line.found.natural_frequency_Hz.value, "flow resonance"});
  page.section("Pressure at the chamber over pressure at the valve's port", "Recorded, with its noise, and as fitted.");
  page.plots({magnitude, phase});
}

void write_page(const IdentifiedLine& line, const Rig& rig, const std::string& path) {
  HtmlPage page("Line of " + rig.name, "pneuservo identify", "Line of " + rig.name + ": frequency and damping");
  page.paragraph(headline(line));
  for (const std::string& remark : remarks(line)) page.alert(remark);
  page.table(resonance_table(line));
  page.table(parameter_table(line));
  add_response(page, line);
  page.write(path);
}

void run_identify(const IdentifyOptions& options) {
  const Rig rig = read_rig(options.config, options.sets);
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads_of(rig)
      .reads("RECORDING", options.recording)
      .writes("--json", options.json, ResultKind::json)
      .writes("--report", options.report, ResultKind::page);
  const Recording recording = read_first_recording(options.recording, rig.imported, rig.period_s);
  for (const auto& problem : problem_lines(recording)) std::fprintf(stderr, "%s\n", problem.c_str());
  IdentifiedLine line = line_of(options, rig, recording);
  try {
    line.found = identify_line(even_pressures(recording, line), line.belief);
  } catch (const std::invalid_argument& error) {
    throw InputError(
        fmt::format("{}: {} and {}: {}", options.recording, line.in_column, line.out_column, error.what()));
  }
  if (options.json != "-") std::fputs(text_of(line).c_str(), stdout);
  write_json(options.json, json_of(line));
  if (!options.report.empty()) write_page(line, rig, options.report);
}

}  // namespace

void add_identify(CommandLine& app, int&) {
  auto options = std::make_shared<IdentifyOptions>();
  Verb verb = app.add_verb("identify", "natural frequency and damping of a line from the pressures at its ends");
  verb.add_option("CONFIG", options->config, "rig with the line and the volume behind it as they are believed")
      .required();
  verb.add_option("RECORDING", options->recording, "with the pressures at valve port and chamber").required();
  verb.add_option("--side", options->side, "line of chamber 1 or 2").within(1, 2).shows_default();
  verb.add_option("--json", options->json, "result as JSON; - for standard output");
  verb.add_option("--report", options->report, "self-contained HTML page with the response");
  add_set_option(verb, options->sets);
  verb.footer(
      "The piston is held. Move the valve about its neutral, slowly to fast (a swept sine up to twice the expected\n"
      "frequency), and begin and end at rest; sample ten times as fast as the line swings.");
  verb.callback([options] { run_identify(*options); });
}

}  // namespace pneuservo
