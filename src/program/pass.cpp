// Verb pass: the command along the reference, learned on the config's own model.
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "config/read_rig.hpp"
#include "pass/command_pass.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"

namespace pneuservo {
namespace {
struct PassOptions {
  std::string config, out, json;
  std::vector<std::string> sets;
};
void run_pass(const PassOptions& o) {
  const Rig rig = read_rig(o.config, o.sets);
  require_valves("pass", o.config, rig, 1);
  const Reference reference(rig.reference, load_reference_positions);
  const CommandPass pass = make_command_pass(rig, reference);
  std::printf("%s max u %g V left %g N limited %g predicted %g mm\n", rig.name.c_str(), pass.largest_command_V, pass.left_N,
              pass.limited_share, 1e3 * predicted_error_m(rig, reference, pass));
}
}  // namespace

void add_pass(CLI::App& app, int&) {
  auto o = std::make_shared<PassOptions>();
  CLI::App* verb = app.add_subcommand("pass", "the command along the reference, learned on the config's model");
  verb->add_option("CONFIG", o->config, "rig whose reference is run ahead")->required();
  add_set_option(*verb, o->sets);
  verb->callback([o] { run_pass(*o); });
}

}  // namespace pneuservo
