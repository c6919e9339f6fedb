// Verbs home and zero: what is to be added to a device's values, found on the machine and written for run --zeros.
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "backends.hpp"
#include "config/input_error.hpp"
#include "config/number_text.hpp"
#include "config/read_rig.hpp"
#include "loop/calibration.hpp"
#include "loop/realtime.hpp"
#include "loop/realtime_stop.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "program/zeros.hpp"

namespace pneuservo {
namespace {

struct CalibrateOptions {
  std::string config, write, end = "low", time = "simulated";
  std::vector<std::string> sets, zeros;
  double command_V = 0.0, duration_s = 1.0;
};

Rig read_calibrated(const CalibrateOptions& options) {
  const Rig rig = read_rig(options.config, with_zeros(options.sets, options.zeros));
  require_kind("home and zero", options.config, rig, {RigKind::cylinder, RigKind::servo_table});
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads_of(rig)
      .reads("--zeros", options.zeros)
      .writes("--write", options.write, ResultKind::zeros);
  return rig;
}

std::unique_ptr<Backend> opened(const CalibrateOptions& options, const Rig& rig) {
  if (!rig.hal)
    throw InputError(options.config + ": hal: found nothing, expected the channels whose zeros are to be found");
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
  std::string text = "# Zeros of " + rig.name + ", for run --zeros.\nzeros:\n";
  for (const auto& [channel, zero] : zeros) text += "  " + channel + ": " + number_text(zero) + "\n";
  write_result(options.write, text);
  return 0;
}

int home(const CalibrateOptions& options) {
  const Rig rig = read_calibrated(options);
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

int zero(const CalibrateOptions& options) {
  const Rig rig = read_calibrated(options);
  StopRequest stop;
  const auto backend = opened(options, rig);
  return report(options, rig, find_pressure_zeros(rig, *backend, options.duration_s, options.time == "real"));
}

void add_common(CLI::App& verb, CalibrateOptions& o) {
  verb.add_option("CONFIG", o.config, "rig, e.g. config/can/cylinder-10m-7.65mm.yaml")->required();
  verb.add_option("--set", o.sets, "override one key: PATH=VALUE")->type_name("PATH=VALUE");
  verb.add_option("--zeros", o.zeros, "zeros found before; those found now are added to them");
  verb.add_option("--write", o.write, "file for run --zeros");
  verb.add_option("--time", o.time, "real: on the machine's clock, for devices; simulated: as fast as it goes")
      ->check(CLI::IsMember({"real", "simulated"}));
}

}  // namespace

void add_home(CLI::App& app, int& status) {
  auto o = std::make_shared<CalibrateOptions>();
  CLI::App* verb = app.add_subcommand("home", "find the zero of an incremental encoder at an end stop");
  add_common(*verb, *o);
  verb->add_option("--end", o->end, "end stop to drive to")->check(CLI::IsMember({"low", "high"}));
  verb->add_option("--command-V", o->command_V, "command that pushes there [V] (default: 2 % of the valve's range)")
      ->check(CLI::PositiveNumber);
  verb->footer("The slider moves: keep clear. An incremental encoder is homed after each time it was switched on.");
  verb->callback([o, &status] { status = home(*o); });
}

void add_zero(CLI::App& app, int& status) {
  auto o = std::make_shared<CalibrateOptions>();
  CLI::App* verb = app.add_subcommand("zero", "zero the pressure sensors and tell gauge from absolute");
  add_common(*verb, *o);
  verb->add_option("--duration-s", o->duration_s, "length of the mean [s]")->check(CLI::PositiveNumber);
  verb->footer(
      "Shut off the supply and vent both lines first; a sensor that then shows neither the atmosphere nor 0 is\n"
      "refused.");
  verb->callback([o, &status] { status = zero(*o); });
}

}  // namespace pneuservo
