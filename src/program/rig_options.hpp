// What verbs that take a CONFIG share: reading it with --set, writing results.
#pragma once
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <pneuservo/control/reference.hpp>
#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

#include "config/rig_kinds.hpp"
#include "loop/realtime.hpp"
#include "program/command_line.hpp"
#include "record/header.hpp"
#include "report/run_result.hpp"

namespace pneuservo {

/// The option --set PATH=VALUE of every verb that reads a config; it may stand several times.
void add_set_option(Verb& verb, std::vector<std::string>& sets);

/// Writes JSON to a file, or to standard output for "-"; nothing for an empty path. Throws InputError.
void write_json(const std::string& path, const nlohmann::ordered_json& json);

/// Kernel, policy, code path, version, ... of this run; without a session: simulated time.
Facts machine_facts(const RealTimeState* session);
/// Name and origin of each channel, of the command and of the digital lines that there are.
Facts channel_facts(const Backend& backend);

/// What decides on the columns of a recording beside rig and backend.
struct RecordedTime {
  bool real_time = false, commanded = false;
};
/// Columns that such a run has.
std::vector<std::string> recorded_columns(const Rig& rig, const Backend& backend, RecordedTime time);

/// Header of a run's recording: rig, config, reference, machine, channels.
RecordingHeader run_header(const Rig& rig, const Backend& backend, const Facts& machine, int moves);

}  // namespace pneuservo
