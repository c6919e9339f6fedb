// Verbs commission, home and zero: what is found on the machine before its first run, written for run --zeros.
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "backends.hpp"
#include "config/input_error.hpp"
#include "config/number_text.hpp"
#include "config/read_rig.hpp"
#include "loop/calibration.hpp"
#include "loop/commission.hpp"
#include "loop/realtime.hpp"
#include "loop/realtime_stop.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "program/zeros.hpp"

namespace pneuservo {
namespace {

struct CalibrateOptions {
  std::string config, write, json, end = "low", time = "simulated";
  std::vector<std::string> sets, zeros;
  double command_V = 0.0, duration_s = 1.0;
  ResultKind kind = ResultKind::zeros;
  ExistingFile existing = ExistingFile::replace;
};

Rig read_calibrated(std::string_view verb, const CalibrateOptions& options) {
  const Rig rig = read_rig(options.config, with_zeros(options.config, options.sets, options.zeros));
  if (verb == "zero") require_loop(verb, options.config, rig);
  else require_valves(verb, options.config, rig);
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads_of(rig)
      .reads("--zeros", options.zeros)
      .writes("--write", options.write, options.kind, options.existing)
      .writes("--json", options.json, ResultKind::json);
  return rig;
}

std::unique_ptr<Backend> opened(const CalibrateOptions& options, const Rig& rig) {
  if (!rig.hal)
    throw InputError(options.config + ": hal: found nothing, expected the channels that are to be looked at");
  if (rig.hal->has_devices() && options.time != "real")
    throw InputError("--time: found simulated with channels on real devices, expected --time real");
  auto backend = make_backend("configured", rig);
  backend->configure();
  return backend;
}

/// Zeros add to those that the config had when they were found.
int report(const CalibrateOptions& options, const Rig& rig, const std::vector<ChannelZero>& found) {
  std::map<std::string, double> zeros = rig.zeros;
  for (const ChannelZero& zero : found) {
    zeros[zero.channel] += zero.zero;
    std::cout << fmt::format("{:<12} {:<28} zero {}\n", zero.channel, zero.what, number_text(zeros[zero.channel]));
  }
  if (options.write.empty()) return 0;
  write_zeros(options.write, rig, zeros, "Zeros of " + rig.name + ", for run --zeros.");
  return 0;
}

int home(const CalibrateOptions& options) {
  const Rig rig = read_calibrated("home", options);
  StopRequest stop;
  const auto backend = opened(options, rig);
  HomingSettings settings;
  settings.end = options.end == "high" ? HomingEnd::high : HomingEnd::low;
  settings.command_V = options.command_V;
  settings.real_time = options.time == "real";
  std::unique_ptr<RealTimeSession> session;
  if (settings.real_time) session = std::make_unique<RealTimeSession>(RealTimeSettings{});
  return report(options, rig, {find_home(rig, *backend, settings)});
}

const char* word(CommissionVerdict verdict) {
  switch (verdict) {
    case CommissionVerdict::good: return "ok";
    case CommissionVerdict::unclear: return "unclear";
    case CommissionVerdict::wrong: break;
  }
  return "wrong";
}

nlohmann::ordered_json json_of(const Rig& rig, const CommissionResult& found) {
  nlohmann::ordered_json json{{"format", "pneuservo-commission/1"},
                              {"rig", rig.name},
                              {"machine", machine_of(rig)},
                              {"passed", found.passed()},
                              {"checks", nlohmann::ordered_json::array()}};
  for (const CommissionCheck& check : found.checks)
    json["checks"].push_back(
        {{"name", check.name}, {"verdict", word(check.verdict)}, {"found", check.what}, {"remedy", check.remedy}});
  if (found.neutral_V) json["neutral_V"] = *found.neutral_V, json["neutral_error_V"] = *found.neutral_error_V;
  if (found.dead_band_V) json["dead_band_V"] = *found.dead_band_V;
  if (found.encoder_scale) json["encoder_scale"] = *found.encoder_scale;
  json["farthest_m"] = found.farthest_m;
  json["fastest_mps"] = found.fastest_mps;
  return json;
}

int commission(const CalibrateOptions& options) {
  const Rig rig = read_calibrated("commission", options);
  StopRequest stop;
  const auto backend = opened(options, rig);
  std::unique_ptr<RealTimeSession> session;
  if (options.time == "real") session = std::make_unique<RealTimeSession>(RealTimeSettings{});
  const CommissionResult found = commission_axis(rig, *backend, options.time == "real");
  std::string text;
  for (const CommissionCheck& check : found.checks)
    text += fmt::format("{:<16} {:<8} {}{}{}\n", check.name, word(check.verdict), check.what,
                        check.remedy.empty() ? "" : ": ", check.remedy);
  text += fmt::format("{} moved {:.1f} mm at most, at {:.1f} mm/s at most: {}\n", rig.name, 1e3 * found.farthest_m,
                      1e3 * found.fastest_mps, found.passed() ? "passed" : "not passed");
  if (options.json != "-") std::cout << text;
  write_json(options.json, json_of(rig, found));
  if (!options.write.empty())
    write_zeros(options.write, rig, rig.zeros, "Commissioning of " + rig.name + ", for run --zeros:\n" + text,
                CommissionSection{found.passed(), found.neutral_V.value_or(0.0), found.neutral_error_V.value_or(0.0)});
  return found.passed() ? 0 : 1;
}

int zero(const CalibrateOptions& options) {
  const Rig rig = read_calibrated("zero", options);
  StopRequest stop;
  const auto backend = opened(options, rig);
  return report(options, rig, find_pressure_zeros(rig, *backend, options.duration_s, options.time == "real"));
}

void add_common(Verb& verb, CalibrateOptions& o) {
  verb.add_option("CONFIG", o.config, "rig, e.g. config/can/cylinder-10m-7.65mm.yaml").required();
  add_set_option(verb, o.sets);
  verb.add_option("--zeros", o.zeros, "zeros found before; those found now are added to them");
  verb.add_option("--write", o.write, "file for run --zeros");
  verb.add_option("--time", o.time, "real: on the machine's clock, for devices; simulated: as fast as it goes")
      .among({"real", "simulated"});
}

}  // namespace

void add_home(CommandLine& app, int& status) {
  auto o = std::make_shared<CalibrateOptions>();
  Verb verb = app.add_verb("home", "find the zero of an incremental encoder at an end stop");
  add_common(verb, *o);
  verb.add_option("--end", o->end, "end stop to drive to").among({"low", "high"});
  verb.add_option("--command-V", o->command_V, "command that pushes there [V] (default: 2 % of the valve's range)")
      .above_zero();
  verb.footer("The slider moves: keep clear. An incremental encoder is homed after each time it was switched on.");
  verb.callback([o, &status] { status = home(*o); });
}

void add_commission(CommandLine& app, int& status) {
  auto o = std::make_shared<CalibrateOptions>();
  Verb verb = app.add_verb("commission", "prove signs, hoses, sensors and neutral by moves of some millimetres");
  add_common(verb, *o);
  verb.add_option("--json", o->json, "what was found as JSON, - for standard output");
  o->kind = ResultKind::commission;
  o->existing = ExistingFile::refuse;
  verb.add_flag(
      "--force", [o] { o->existing = ExistingFile::replace; }, "replaces an older commissioning of that name");
  verb.footer(
      "The slider moves by some millimetres each way, at 20 mm/s or so: keep clear. Let it stand away from both ends.\n"
      "Exit status: 0 all proven, 1 something is wrong or not proven, 2 unusable input.");
  verb.callback([o, &status] { status = commission(*o); });
}

void add_zero(CommandLine& app, int& status) {
  auto o = std::make_shared<CalibrateOptions>();
  Verb verb = app.add_verb("zero", "zero the pressure sensors and tell gauge from absolute");
  add_common(verb, *o);
  verb.add_option("--duration-s", o->duration_s, "length of the mean [s]").above_zero();
  verb.footer(
      "Shut off the supply and vent both lines first; a sensor that then shows neither the atmosphere nor 0 is\n"
      "refused.");
  verb.callback([o, &status] { status = zero(*o); });
}

}  // namespace pneuservo
