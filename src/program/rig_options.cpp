// What verbs that take a CONFIG share.
#include "program/rig_options.hpp"

#include <iostream>

#include <fmt/format.h>
#include <sys/utsname.h>

#include <pneuservo/loop/fault.hpp>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/version.hpp"
#include "origin_name.hpp"
#include "program/output_files.hpp"
#include "record/result_file.hpp"

namespace pneuservo {

void add_set_option(Verb& verb, std::vector<std::string>& sets) {
  verb.add_option("--set", sets,
                  "overrides a key of the config, e.g. --set supply.pressure_Pa=6e5; may stand several times")
      .type_name("PATH=VALUE");
}

void write_json(const std::string& path, const nlohmann::ordered_json& json) {
  if (path.empty()) return;
  if (path == "-") {
    std::cout << json.dump(2) << "\n";
    return;
  }
  write_result(path, json.dump(2) + "\n");
}

namespace {

/// What the bits of the column `fault` mean, so that a recording says by itself why its run ended.
std::string fault_legend() {
  std::string legend;
  for (const FaultText& text : fault_texts)
    legend += fmt::format("{}: \"{}: {}\"\n", text.bit, text.name, text.meaning);
  return legend;
}

}  // namespace

Facts machine_facts(const RealTimeState* session) {
  utsname system{};
  uname(&system);
  Facts facts{{"version", std::string(version())},
              {"code_path", std::string(code_path())},
              {"time", session == nullptr ? "simulated" : "real"},
              {"kernel", std::string(system.sysname) + " " + system.release},
              {"machine", system.machine}};
  if (session == nullptr) return facts;
  facts.emplace_back("preempt_rt", session->preempt_rt ? "true" : "false");
  facts.emplace_back("policy", session->policy);
  facts.emplace_back("priority", std::to_string(session->priority));
  facts.emplace_back("memory_locked", session->memory_locked ? "true" : "false");
  facts.emplace_back("cpu_latency_held", session->cpu_latency_held ? "true" : "false");
  facts.emplace_back("cpu", session->cpu ? std::to_string(*session->cpu) : "any");
  return facts;
}

Facts channel_facts(const Backend& backend) {
  Facts facts;
  const Origins origins = backend.origins();
  for (const Signal signal : channel_signals)
    facts.emplace_back(info(signal).name, origin_name(origins.channels[signal]));
  facts.emplace_back("command", origin_name(origins.command));
  for (std::size_t i = 0; i < origins.lines.size(); ++i)
    if (origins.lines[i] != Origin::absent) facts.emplace_back(digital_line_names[i], origin_name(origins.lines[i]));
  return facts;
}

std::vector<std::string> recorded_columns(const Rig& rig, const Backend& backend, RecordedTime time) {
  std::vector<std::string> columns;
  const auto origins = backend.origins().channels;
  const bool truth = backend.name() == "sim";
  Row row;
  Row::visit(
      [&](std::string_view name, auto&) {
        if (const auto signal = signal_of_column(name); signal && origins[*signal] == Origin::absent) return;
        if (name.find("_true_") != std::string_view::npos && !truth) return;
        if (!is_column_of(name, rig.controls_pressure())) return;
        if ((name == "x_estimated_m" || name == "x_bound_m" || name == "switches") && !rig.position.is_estimated())
          return;
        if (name == (rig.valves() == 2 ? "u_V" : "u1_V")) return;
        if (name == "u2_V" && rig.valves() != 2) return;
        if ((name == "lateness_us" || name == "work_us") && !time.real_time) return;
        if (name.starts_with("command") && !time.commanded) return;
        columns.emplace_back(name);
      },
      row);
  for (const std::string_view name : law_columns(rig.controller.kind)) columns.emplace_back(name);
  return columns;
}

RecordingHeader run_header(const Rig& rig, const Backend& backend, const Facts& machine, int moves) {
  RecordingHeader header(rig.name, rig.period_s);
  header.add_text("backend", backend.name());
  header.add_number("moves", moves);
  if (!rig.controls_pressure()) header.add_yaml("reference", dump_reference(rig.reference));
  for (const auto& [key, value] : machine)
    if (key != "version" && key != "code_path") header.add_text(key, value);
  std::string channels = "{";
  for (const auto& [channel, origin] : channel_facts(backend))
    channels += fmt::format("{}{}: {}", channels.size() > 1 ? ", " : "", channel, origin);
  header.add_yaml("channels", channels + "}");
  header.add_yaml("fault_bits", fault_legend());
  header.add_text("config", dump_rig(rig));
  return header;
}

}  // namespace pneuservo
