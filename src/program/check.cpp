// The verb check: grades the machine for running in real time and, where one is named, a config.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "can/bus_interface.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "iio/iio_backend.hpp"
#include "loop/bus_check.hpp"
#include "loop/device_grade.hpp"
#include "loop/machine_check.hpp"
#include "loop/rig_grade.hpp"
#include "loop/safety_grade.hpp"
#include "pass/command_pass.hpp"
#include "pass/move_pass.hpp"
#include "program/loop_check.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/import.hpp"

namespace pneuservo {
namespace {

struct CheckOptions {
  std::string config;
  std::string json;
  std::vector<std::string> sets;
  RealTimeSettings session;
};

/// The pass of the longest way at full speed, and how long it takes here.
std::vector<Finding> grade_move_passes(const Rig& rig) {
  const ReferenceSpec& live = rig.reference;
  MovePassMaker maker(rig);
  MovePass pass;
  const auto begin = std::chrono::steady_clock::now();
  const std::string why =
      maker.make({{1, true, 0, live.lowest_m, live.highest_m, live.speed_mps}, rig.initial.pressure_1_Pa}, pass,
                 [] { return true; });
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (!why.empty())
    return {{FindingLevel::acceptable, "command pass", why, "state less reference.speed_mps or acceleration_mps2"}};
  const std::string found =
      fmt::format("that of a move over the whole range at full speed takes {:.2g} s here, within {:g} s "
                  "(reference.pass_within_s)",
                  took.count(), live.pass_within_s);
  if (took.count() < live.pass_within_s) return {{FindingLevel::good, "command pass", found, ""}};
  return {{FindingLevel::acceptable, "command pass", found + ": it goes by the formula",
           "state a longer reference.pass_within_s"}};
}

/// What a run does where no pass can be made and the config goes on with the formula.
std::vector<Finding> grade_pass(const std::string& path, Rig& rig) {
  if (rig.controller.wants_pass() && rig.reference.kind == ReferenceKind::live) return grade_move_passes(rig);
  try {
    const std::string why = heed_missing_pass(path, rig, load_reference_positions);
    if (!why.empty())
      return {{FindingLevel::acceptable, "command pass", why + "; a run goes on with the formula",
               "state controller.flow_feedforward: formula, or a reference that the lines can carry"}};
  } catch (const InputError&) {}  // graded with the loop in motion
  return {};
}

/// What the kernel's Industrial I/O has on this machine, and what of the config it has not.
std::vector<Finding> grade_iio(const Rig& rig) {
  std::vector<Finding> findings;
  if (!rig.hal || !rig.hal->iio) return findings;
  for (const std::string& line : iio_devices()) findings.push_back({FindingLevel::good, "I/O device", line, ""});
  for (const std::string& why : iio_refusals(rig))
    findings.push_back({FindingLevel::bad, "I/O channel", why, "check on the machine that has the device"});
  return findings;
}

/// The config itself, and the kernel's interface where its devices are on one.
std::vector<Finding> check_config(const std::string& path, const std::vector<std::string>& sets) {
  Rig rig = read_rig(path, sets);
  if (rig.is_pneumatic()) require_reference_in_stroke(path, rig);
  const std::vector<Finding> pass = grade_pass(path, rig);
  std::vector<Finding> findings = grade_rig(rig);
  for (const auto& more :
       {pass, grade_devices(rig), grade_safety(rig, load_reference_positions), grade_loop(rig), grade_iio(rig)})
    findings.insert(findings.end(), more.begin(), more.end());
  if (!rig.hal || !rig.hal->can || rig.hal->can->interface.find(':') != std::string::npos) return findings;
  const CanBusParameters& bus = *rig.hal->can;
  for (Finding& finding : grade_bus_interface(bus.interface, read_bus_interface(bus.interface), bus.bit_rate_bps))
    findings.push_back(std::move(finding));
  return findings;
}

nlohmann::ordered_json as_json(const std::vector<Finding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"topic", finding.topic},
                    {"level", name(finding.level)},
                    {"found", finding.what},
                    {"remedy", finding.remedy}});
    if (!finding.figures.empty()) list.back()["figures"] = finding.figures;
  }
  return list;
}

int run_check(const CheckOptions& options) {
  OutputFiles().reads("CONFIG", options.config).writes("--json", options.json, ResultKind::json);
  const std::vector<Finding> machine = check_machine(options.session);
  const std::vector<Finding> config =
      options.config.empty() ? std::vector<Finding>{} : check_config(options.config, options.sets);
  const FindingLevel worst = std::max(worst_level(machine), worst_level(config));
  const bool ready = worst < FindingLevel::bad;
  const char* verdict = ready                        ? "nothing speaks against running in real time"
                        : worst == FindingLevel::bad ? "not ready: see the lines marked bad"
                                                     : "unsafe: see the lines marked unsafe";
  if (options.json != "-") {
    std::cout << "machine\n" << finding_table(machine);
    if (!options.config.empty()) std::cout << "\n" << options.config << "\n" << finding_table(config);
    std::cout << "\n" << verdict << '\n';
  }
  if (!options.json.empty()) {
    nlohmann::ordered_json json{{"ready", ready}, {"machine", as_json(machine)}};
    if (!options.config.empty()) json["config"] = as_json(config);
    write_json(options.json, json);
  }
  return ready ? 0 : 1;
}

}  // namespace

void add_check(CommandLine& app, int& status) {
  auto options = std::make_shared<CheckOptions>();
  Verb verb = app.add_verb("check", "grade the machine for real time, and a config; exit status 1 if anything is bad");
  verb.add_option("CONFIG", options->config, "config to check as well");
  add_set_option(verb, options->sets);
  verb.add_option("--cpu", options->session.cpu, "processor that the loop shall be pinned to");
  verb.add_option("--priority", options->session.priority, "SCHED_FIFO priority that is tried")
      .within(1, 99)
      .shows_default();
  verb.add_option("--json", options->json, "write the findings here; - is standard output");
  verb.callback([options, &status] { status = run_check(*options); });
}

}  // namespace pneuservo
