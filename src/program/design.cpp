// Verb design: linear models, gains by a rule, poles, margins, step, feedforward of a config's axis.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "design/axis_design.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"
#include "record/result_file.hpp"
#include "report/design_json.hpp"
#include "report/design_report.hpp"
#include "report/design_summary.hpp"

namespace pneuservo {

namespace {

struct DesignOptions {
  std::string config, method = "config", write, report, json;
  std::vector<std::string> overrides;
  double position_gain_V_per_m = 0.0;
  bool coefficients = false, force = false;
  DesignRequest request;
};

/// Line of a rule; its options say which they belong to.
constexpr const char* rules = R"(methods:
  config      judge the gains that the config has
  alpha_beta  third order: s^3 + alpha w s^2 + beta w^2 s + w^3, w^3 = Kp K
  itae_7      two normalised coefficients of the full order: C6 of s, C5 of s^2
  itae_min    the velocity and acceleration gain that make the ITAE of the step least
  margins     the highest gains with gain margin 2 and phase margin 30 deg over stroke, payload range and supply
A rule keeps the position gain of the config unless --position-gain is given.
A warning stands where the gain margin is below 2 or the phase margin below 30 deg.)";

/// What stands against writing the design's gains; empty: nothing.
std::string unstable_words(const AxisDesign& design) {
  if (design.is_stable) return "";
  const double down = design.margins.gain_down > 0.0 ? design.margins.gain_down : design.exact_margins.gain_down;
  const double slowest = std::max_element(design.poles.begin(), design.poles.end(), [](const auto& a, const auto& b) {
                           return a.real() < b.real();
                         })->imag();
  return fmt::format(
      "the loop of these gains is unstable (it swings at {:.3g} Hz{})", std::fabs(slowest) / (2.0 * std::numbers::pi),
      down > 0.0 && down < 1.0 ? fmt::format(", its gain would have to fall to {:.3g} of this", down) : "");
}

int run_design(DesignOptions& options) {
  Rig rig = read_rig(options.config, options.overrides);
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads_of(rig)
      .writes("--write", options.write, ResultKind::config)
      .writes("--report", options.report, ResultKind::page)
      .writes("--json", options.json, ResultKind::json);
  require_valves("design", options.config, rig);
  for (std::size_t i = 0; i < design_method_names.size(); ++i)
    if (options.method == design_method_names[i]) options.request.method = static_cast<DesignMethod>(i);
  if (options.position_gain_V_per_m > 0.0) options.request.position_gain_V_per_m = options.position_gain_V_per_m;
  try {
    const AxisDesign design = design_axis(rig, options.request, load_reference_positions);
    Rig designed = rig;
    designed.controller = design.controller;
    if (options.json != "-") std::fputs(design_text(rig, design, options.coefficients).c_str(), stdout);
    write_json(options.json, design_json(rig, design, options.coefficients));
    if (!options.report.empty()) write_design_report(rig, design, dump_rig(designed), options.report);
    if (options.write.empty()) return 0;
    if (const std::string words = unstable_words(design); !words.empty() && !options.force) {
      std::cerr << fmt::format("{}: --write: {}; nothing is written to {}, --force writes it\n", options.config, words,
                               options.write);
      return 1;
    }
    write_result(options.write, dump_rig(designed));
  } catch (const std::invalid_argument& error) { throw InputError(options.config + ": " + error.what()); }
  return 0;
}

}  // namespace

void add_design(CommandLine& app, int& status) {
  auto options = std::make_shared<DesignOptions>();
  Verb verb = app.add_verb("design", "linear models, gains by a rule, poles, margins, step, feedforward");
  verb.footer(rules);
  verb.add_option("CONFIG", options->config, "rig to design for: a cylinder or a servo table").required();
  add_set_option(verb, options->overrides);
  verb.add_option("--method", options->method, "where the gains come from, see below")
      .among({"config", "alpha_beta", "itae_7", "itae_min", "margins"})
      .shows_default();
  verb.add_option("--position-gain", options->position_gain_V_per_m, "K_p of a rule in V/m (default: the config's)")
      .above_zero();
  verb.add_option("--alpha", options->request.alpha, "of alpha_beta").above_zero().shows_default();
  verb.add_option("--beta", options->request.beta, "of alpha_beta").above_zero().shows_default();
  verb.add_option("--c6", options->request.c_1, "of itae_7: of s").above_zero().shows_default();
  verb.add_option("--c5", options->request.c_2, "of itae_7: of s^2").above_zero().shows_default();
  verb.add_flag("--coefficients", options->coefficients,
                "normalised coefficients beside those of least ITAE (seconds)");
  verb.add_option("--write", options->write, "config with the design's gains, all keys commented");
  verb.add_flag("--force", options->force, "writes gains of an unstable loop too");
  verb.add_option("--report", options->report, "self-contained HTML page with pole loci and Bode diagrams");
  verb.add_option("--json", options->json, "result as JSON with units in the keys; - for standard output");
  verb.callback([options, &status] { status = run_design(*options); });
}

}  // namespace pneuservo
