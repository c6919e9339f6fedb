// Options of verbs that run an axis on the backend of its config: what they share of reading, checks and real time.
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "loop/realtime.hpp"
#include "program/command_line.hpp"
#include "program/loop_check.hpp"

namespace pneuservo {

struct AxisOptions {
  std::string config, time, backend;
  std::vector<std::string> sets, scenarios, faults, zeros;
  int priority = 80, cpu = -1;
  AllowedRisks allowed;
  bool real_time() const { return time == "real"; }
};

/// Adds CONFIG with its help, --set, --time (default: the one that `options` has), --hal, --allow-unstable, --zeros,
/// --scenario,
/// --fault, --priority and --cpu; `options` lives as long as the verb.
void add_axis_options(Verb& verb, AxisOptions& options, const std::string& config_help);
/// sim or configured: a config that names its devices runs on them unless told otherwise.
std::string backend_of(const AxisOptions& options, const Rig& rig);
/// The config with the zeros and the overrides of the options, then `more`. Throws InputError, also where an
/// incremental encoder has no zero.
Rig read_axis(std::string_view verb, const AxisOptions& options, const std::vector<std::string>& more = {});
/// Before the axis runs: reference and loop (loop_check.hpp), devices in simulated time, zeros without devices. Throws
/// InputError.
void heed_axis(const AxisOptions& options, const Rig& rig);
/// Of --time real; else null.
std::unique_ptr<RealTimeSession> realtime_session(const AxisOptions& options);

}  // namespace pneuservo
