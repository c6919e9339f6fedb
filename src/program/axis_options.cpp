// Options of verbs that run an axis.
#include "program/axis_options.hpp"

#include <optional>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "loop/device_grade.hpp"
#include "program/rig_options.hpp"
#include "program/zeros.hpp"

namespace pneuservo {
namespace {

bool on_devices(const AxisOptions& options, const Rig& rig) {
  return backend_of(options, rig) == "configured" && rig.hal && rig.hal->has_devices();
}

}  // namespace

void add_axis_options(Verb& verb, AxisOptions& options, const std::string& config_help) {
  verb.add_option("CONFIG", options.config, config_help).required();
  add_set_option(verb, options.sets);
  verb.add_option("--time", options.time, "simulated: as fast as it goes; real: on the machine's clock")
      .among({"real", "simulated"})
      .shows_default();
  verb.add_option("--hal", options.backend,
                  "backend: sim, or configured (each channel from its source in the config's section hal); "
                  "default: configured where the config has that section");
  verb.add_flag("--allow-unstable", options.allowed.unstable_loop,
                "run on devices although the linear model finds the loop unstable ('pneuservo check')");
  verb.add_option("--zeros", options.zeros, "zeros of the channels, a file that the verbs home and zero wrote");
  verb.add_option("--scenario", options.scenarios, "faults to inject into the backend sim, a file (docs/faults.md)");
  verb.add_option("--fault", options.faults, "a fault to inject; may stand several times")
      .type_name("KIND[:TARGET[:VALUE]][@START_S[+DURATION_S]]");
  verb.add_option("--priority", options.priority, "SCHED_FIFO priority in real time").within(1, 99);
  verb.add_option("--cpu", options.cpu, "processor to pin the loop to in real time");
}

std::string backend_of(const AxisOptions& options, const Rig& rig) {
  if (!options.backend.empty()) return options.backend;
  return rig.hal ? "configured" : "sim";
}

Rig read_axis(std::string_view verb, const AxisOptions& options, const std::vector<std::string>& more) {
  std::vector<std::string> sets = with_zeros(options.config, options.sets, options.zeros);
  sets.insert(sets.end(), more.begin(), more.end());
  Rig rig = read_rig(options.config, sets, options.backend == "sim" ? ConfigUse::simulation : ConfigUse::machine);
  if (rig.sensors.position.incremental && backend_of(options, rig) != "sim" && !rig.zeros.contains("x"))
    throw InputError(options.config + ": sensors.position.incremental: found true without a zero of x, expected "
                                      "--zeros FILE of the verb home, run after the encoder was switched on");
  if (verb == "run" || verb == "serve") require_loop(verb, options.config, rig);
  else require_valves(verb, options.config, rig);
  return rig;
}

void heed_axis(const AxisOptions& options, const Rig& rig) {
  if (!options.real_time() && on_devices(options, rig))
    throw InputError(
        "--time: found simulated with channels on real devices, expected --time real, or --hal sim for the "
        "simulated plant");
  if (!options.zeros.empty() && backend_of(options, rig) != "configured")
    throw InputError("--zeros: found with the backend " + backend_of(options, rig) +
                     ", expected devices, whose values the zeros are added to");
  require_reference_in_stroke(options.config, rig);
  heed_loop(options.config, rig, options.real_time() && on_devices(options, rig), options.allowed);
}

std::unique_ptr<RealTimeSession> realtime_session(const AxisOptions& options) {
  if (!options.real_time()) return nullptr;
  return std::make_unique<RealTimeSession>(RealTimeSettings{
      .priority = options.priority, .cpu = options.cpu >= 0 ? std::optional(options.cpu) : std::nullopt});
}

}  // namespace pneuservo
