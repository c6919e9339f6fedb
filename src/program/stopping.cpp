// Verb stopping: how far and how long a rig goes on after a fault, and what stays in it.
#include <iostream>
#include <memory>
#include <stdexcept>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "loop/stopping.hpp"
#include "program/loop_check.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"
#include "report/stopping_report.hpp"

namespace pneuservo {
namespace {

struct StoppingOptions {
  std::string config, json;
  std::vector<std::string> sets;
};

void run_stopping(const StoppingOptions& options) {
  OutputFiles().reads("CONFIG", options.config).writes("--json", options.json, ResultKind::json);
  Rig rig = read_rig(options.config, options.sets);
  heed_pass(options.config, rig);
  require_valves("stopping", options.config, rig);
  try {
    const StoppingTable table = stopping_table(rig, load_reference_positions);
    if (options.json != "-") std::cout << stopping_text(rig, table);
    write_json(options.json, stopping_json(rig, table));
  } catch (const std::invalid_argument& error) { throw InputError(options.config + ": " + error.what()); }
}

}  // namespace

void add_stopping(CommandLine& app, int&) {
  auto o = std::make_shared<StoppingOptions>();
  Verb verb = app.add_verb("stopping", "stopping time and distance of a rig, simulated from its config");
  verb.add_option("CONFIG", o->config, "rig to stop, e.g. config/cylinder-10m-7.65mm.yaml").required();
  add_set_option(verb, o->sets);
  verb.add_option("--json", o->json, "result as JSON with units in the keys; - for standard output");
  verb.footer("The loop runs along the config's reference and along moves at three places of the stroke, with the\n"
              "smallest and the largest payload (limits.payload_max_kg) and supply (tolerances); 64 times along\n"
              "each the safe output begins. docs/safety.md says what the figures are for.\n"
              "  pneuservo stopping config/cylinder-10m-7.65mm.yaml --set safe_output.action=centre");
  verb.callback([o] { run_stopping(*o); });
}

}  // namespace pneuservo
