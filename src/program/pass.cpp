// Verb pass: the command along the reference, learned on the config's own model.
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "pass/command_pass.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"
#include "record/result_file.hpp"
#include "report/html_page.hpp"

namespace pneuservo {
namespace {

struct PassOptions {
  std::string config, out, json, report;
  std::vector<std::string> sets;
};

/// A pass with what is told of it.
struct PassResult {
  CommandPass pass;
  double predicted_error_m = 0.0;
  std::string refusal;  ///< empty for one that the lines carry and the loop follows
};

PassResult result_of(const Rig& rig, const Reference& reference) {
  PassResult result{.pass = make_command_pass(rig, reference), .predicted_error_m = 0.0, .refusal = ""};
  result.predicted_error_m = predicted_error_m(rig, reference, result.pass, FeedforwardSource::pass);
  result.refusal = refusal_words(rig, reference, result.pass, PassWords::full);
  return result;
}

std::string text_of(const Rig& rig, const PassResult& result) {
  const CommandPass& pass = result.pass;
  std::string text =
      fmt::format("{}: {} runs of the model along the reference\n  largest command      {:>8.3f} V of {:g} V\n"
                  "  force left           {:>8.2f} N below {:g} Hz\n  predicted error      {:>8.3f} mm at most\n",
                  rig.name, pass.runs, pass.largest_command_V, rig.axis.valve.command_max_V, pass.left_N, judged_Hz,
                  1e3 * result.predicted_error_m);
  if (result.refusal.empty()) return text + "feasible: run it with --set controller.flow_feedforward=pass\n";
  return text + (pass.feasible ? "" : "not feasible: ") + result.refusal + "\n";
}

nlohmann::ordered_json json_of(const Rig& rig, const PassResult& result) {
  const CommandPass& pass = result.pass;
  return {{"config", rig.name},
          {"runs", pass.runs},
          {"largest_command_V", pass.largest_command_V},
          {"limited_share", pass.limited_share},
          {"force_left_N", pass.left_N},
          {"predicted_error_m", result.predicted_error_m},
          {"feasible", pass.feasible},
          {"refusal", result.refusal}};
}

std::string csv_of(const Rig& rig, const Reference& reference, const CommandPass& pass) {
  std::string text =
      "# Command pass of " + rig.name + "\nt_s,x_ref_m,u_V,chamber_force_N,force_wanted_N,p1_Pa,p2_Pa,p_supply_Pa\n";
  const auto table = pass.table(rig, true);
  for (std::size_t i = 0; i < pass.ticks.size(); ++i) {
    const double t_s = static_cast<double>(i) * rig.period_s;
    const LedTick& tick = pass.ticks[i];
    const PassRow& row = table->rows[i];
    text += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", t_s, reference.at(t_s).d[0],
                        tick.u_V, tick.force_N, tick.wanted_N, row.p1_Pa, row.p2_Pa, row.supply_Pa);
  }
  return text;
}

/// A line over the ticks of a pass.
template <class F> Curve curve_of(const Rig& rig, const CommandPass& pass, const char* name, Tone tone, F&& value) {
  Curve curve;
  curve.name = name;
  curve.tone = tone;
  for (std::size_t i = 0; i < pass.ticks.size(); ++i) {
    curve.x.push_back(static_cast<double>(i) * rig.period_s);
    curve.y.push_back(value(curve.x.back(), pass.ticks[i]));
  }
  return curve;
}

Plot plot_of(const Rig& rig, const char* title, const char* unit, std::vector<Curve> curves) {
  Plot plot;
  plot.title = title;
  plot.unit = unit;
  plot.curves = std::move(curves);
  plot.x_step = rig.period_s;
  return plot;
}

void write_page(const Rig& rig, const Reference& reference, const PassResult& result, const std::string& path) {
  const auto curve = [&](const char* name, Tone tone, auto&& value) {
    return curve_of(rig, result.pass, name, tone, value);
  };
  const CommandPass& pass = result.pass;
  const std::string headline =
      result.refusal.empty()
          ? fmt::format("The lines can carry this reference: the axis errs by {:.3f} mm at most on the model.",
                        1e3 * result.predicted_error_m)
          : fmt::format("{}{}.", pass.feasible ? "" : "Not feasible: ", result.refusal);
  HtmlPage page("Pass of " + rig.name, "pneuservo pass " + rig.name, headline);
  page.section("The command along the reference",
               fmt::format("The largest command is {:.3f} V of {:g} V; {:.2f} N of the force are left below {:g} Hz, "
                           "after {} runs of the "
                           "model.",
                           pass.largest_command_V, rig.axis.valve.command_max_V, pass.left_N, judged_Hz, pass.runs));
  page.plot(plot_of(rig, "Position", "mm", {curve("reference", Tone::neutral, [&](double t_s, const LedTick&) {
                      return 1e3 * reference.at(t_s).d[0];
                    })}));
  page.plot(plot_of(rig, "Command", "V",
                    {curve("of the pass", Tone::chamber, [](double, const LedTick& tick) { return tick.u_V; })}));
  page.plot(plot_of(rig, "Force", "N",
                    {curve("of the chambers", Tone::chamber, [](double, const LedTick& tick) { return tick.force_N; }),
                     curve("wanted", Tone::neutral, [](double, const LedTick& tick) { return tick.wanted_N; })}));
  const auto pressure = [&](const char* name, Tone tone, Signal signal) {
    return curve(name, tone, [signal](double, const LedTick& tick) { return 1e-3 * tick.values[signal]; });
  };
  page.plot(plot_of(rig, "Chamber pressures", "kPa",
                    {pressure("chamber 1", Tone::chamber, Signal::p1_chamber),
                     pressure("chamber 2", Tone::estimated, Signal::p2_chamber)}));
  page.write(path);
}

int run_pass(const PassOptions& options) {
  const Rig rig = read_rig(options.config, options.sets);
  require_valves("pass", options.config, rig, 1);
  if (options.out == "-")
    throw InputError("--out: found -, expected the name of a file; --json - writes to standard output");
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads_of(rig)
      .writes("--out", options.out, ResultKind::pass)
      .writes("--json", options.json, ResultKind::json)
      .writes("--report", options.report, ResultKind::page);
  try {
    const Reference reference(rig.reference, load_reference_positions);
    const PassResult result = result_of(rig, reference);
    if (options.json != "-") std::fputs(text_of(rig, result).c_str(), stdout);
    write_json(options.json, json_of(rig, result));
    if (!options.out.empty()) write_result(options.out, csv_of(rig, reference, result.pass));
    if (!options.report.empty()) write_page(rig, reference, result, options.report);
    return result.refusal.empty() ? 0 : 1;
  } catch (const std::invalid_argument& error) { throw InputError(options.config + ": " + error.what()); }
}

}  // namespace

void add_pass(CommandLine& app, int& status) {
  auto o = std::make_shared<PassOptions>();
  Verb verb = app.add_verb("pass", "the command along the reference, learned on the config's own model");
  verb.add_option("CONFIG", o->config, "rig whose reference is run ahead; its effects count").required();
  add_set_option(verb, o->sets);
  verb.add_option("--out", o->out, "command, force and pressures a tick, FILE.csv");
  verb.add_option("--json", o->json, "figures as JSON, - for standard output");
  verb.add_option("--report", o->report, "self-contained HTML page with plots");
  verb.footer("Runs follow it with controller.flow_feedforward: pass, where it is made before the run.\n"
              "Exit status: 0 feasible; 1 the lines cannot carry the reference, a sentence says what they can.");
  verb.callback([o, &status] { status = run_pass(*o); });
}

}  // namespace pneuservo
