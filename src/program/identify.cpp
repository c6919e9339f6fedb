// Verb identify: natural frequency and damping of a line from a recording of the pressures at its two ends.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <pneuservo/elements/chamber.hpp>
#include <pneuservo/rig/plant.hpp>
#include <yaml-cpp/yaml.h>

#include "acoustics/line_identification.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"
#include "report/line_report.hpp"

namespace pneuservo {
namespace {

struct IdentifyOptions {
  std::string config, recording, json, report;
  std::vector<std::string> sets;
  int side = 1;
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

/// A simulated port is solved from the gas at the start of the last sub-step, its chamber from that at the end: in the
/// recording the port is one sub-step older. 0: a real port, a lumped line, or a recording that does not say.
double port_age_s(const Recording& recording, bool second) {
  const YAML::Node origins = recording.header["channels"], text = recording.header["config"];
  const YAML::Node origin = origins && origins.IsMap()
                                ? origins[std::string(info(second ? Signal::p2_port : Signal::p1_port).name)]
                                : YAML::Node();
  if (!text || !text.IsScalar() || !origin || origin.as<std::string>("") != "simulated") return 0.0;
  try {
    const Rig made = parse_rig(text.Scalar(), recording.path + ", header");
    if (!made.is_pneumatic() || made.axis.line_1.model != LineModel::distributed) return 0.0;
    AxisPlant<double> plant;
    plant.configure(made.axis, made.period_s, made.simulation.cells_per_m, valve_arrangement(made));
    return made.period_s / plant.sides().begin_period(made.period_s);
  } catch (const InputError&) { return 0.0; }  // of another version
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
  p.in_age_s = line.port_age_s;
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
  line.port_age_s = port_age_s(recording, options.side == 2);
  try {
    line.found = identify_line(even_pressures(recording, line), line.belief);
  } catch (const std::invalid_argument& error) {
    throw InputError(
        fmt::format("{}: {} and {}: {}", options.recording, line.in_column, line.out_column, error.what()));
  }
  if (options.json != "-") std::fputs(line_text(line).c_str(), stdout);
  write_json(options.json, line_json(line));
  if (!options.report.empty()) write_line_report(line, rig.name, options.report);
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
