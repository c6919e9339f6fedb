// The recordings that verbs compare with a config.
#include "program/recording_choice.hpp"

#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/input_error.hpp"
#include "config/number_text.hpp"
#include "record/import.hpp"

namespace pneuservo {
namespace {

/// Columns that a diagnosis uses; the others need no memory.
const std::set<std::string>& used_columns() {
  static const std::set<std::string> used = [] {
    std::set<std::string> columns{"t_s", "x_ref_m", "u_V", "u1_V", "u2_V"};
    for (const SignalInfo& signal : signal_table) columns.emplace(signal.column);
    return columns;
  }();
  return used;
}

void keep_used_columns(Recording& recording) {
  recording.keep_columns([](const std::string& name) { return used_columns().contains(name); });
}

/// A recording that names another rig is told, not refused: configs are copied and renamed.
void compare_names(const Rig& rig, Recording& recording) {
  if (!recording.rig.empty() && recording.rig != rig.name)
    recording.report(0, ProblemKind::header,
                     fmt::format("was made with rig '{}', the config is '{}'", recording.rig, rig.name));
}

/// What --changed says of a recording.
struct StatedChange {
  std::set<std::string> paths;  ///< of the recordings meant
  std::string key;
  double value = 0;
};

/// RECORDING:PATH=VALUE; the recording by its path, or by its file's name where no other has the same.
StatedChange stated_change(const std::string& stated, const std::vector<Recording>& recordings) {
  StatedChange out;
  std::set<std::string> known;
  const auto name_of = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
  const auto take = [&](const std::string& path, const std::string& name) {
    if (!stated.starts_with(name + ":")) return;
    out.paths.insert(path);
    out.key = stated.substr(name.size() + 1);
  };
  for (const Recording& recording : recordings) known.insert(recording.path);
  for (const std::string& path : known) take(path, path);
  if (out.paths.empty())
    for (const std::string& path : known) take(path, name_of(path));
  const std::size_t equals = out.key.rfind('=');
  if (out.paths.size() != 1 || equals == std::string::npos)
    throw InputError(fmt::format("--changed {}: found {}, expected RECORDING:PATH=VALUE with one of {}", stated,
                                 out.paths.empty()       ? "no recording of that name"
                                 : out.paths.size() != 1 ? "several recordings of that name"
                                                         : "no value",
                                 fmt::join(known, ", ")));
  const std::string text = out.key.substr(equals + 1);
  const std::optional<double> value = number_from_text(text);
  if (!value || !std::isfinite(*value))
    throw InputError(fmt::format("--changed {}: found '{}', expected a number in the unit of its key", stated, text));
  out.value = *value;
  out.key.resize(equals);
  return out;
}

void apply_changes(const std::vector<std::string>& changes, std::vector<Recording>& recordings) {
  for (const std::string& stated : changes) {
    const StatedChange change = stated_change(stated, recordings);
    for (Recording& recording : recordings)
      if (change.paths.contains(recording.path)) recording.changed.emplace_back(change.key, change.value);
  }
}

}  // namespace

void add_recording_options(Verb& verb, RecordingChoice& choice) {
  verb.add_option("RECORDING", choice.recordings, "recordings of the machine (.csv.gz)").required();
  verb.add_option("--held-out", choice.held_out,
                  "recordings kept from every fit, for the proof; the others are then fitted whole");
  verb.add_option("--changed", choice.changed,
                  "RECORDING:PATH=VALUE: what the machine had otherwise while this recording was made, e.g. "
                  "slow.csv.gz:supply.pressure_Pa=525e3");
}

std::vector<Recording> read_all(const RecordingChoice& choice, const Rig& rig) {
  std::vector<Recording> recordings;
  std::set<std::string> wanted = used_columns();
  wanted.insert("flags");  // they tell which rows the recorder dropped
  const auto add = [&](const std::string& path, bool is_held_out) {
    for (Recording& run : read_recordings(path, rig.imported, rig.period_s, wanted)) {
      compare_names(rig, run);
      run.is_held_out = is_held_out;
      keep_used_columns(run);
      recordings.push_back(std::move(run));
    }
  };
  std::set<std::filesystem::path> seen;
  for (const auto* paths : {&choice.recordings, &choice.held_out})
    for (const std::string& path : *paths)
      if (!seen.insert(std::filesystem::weakly_canonical(path)).second)
        throw InputError(path +
                         ": found twice, expected each recording once; held-out ones are those that no fit sees");
  for (const std::string& path : choice.recordings) add(path, false);
  for (const std::string& path : choice.held_out) add(path, true);
  apply_changes(choice.changed, recordings);
  return recordings;
}

}  // namespace pneuservo
