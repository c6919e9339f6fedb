// The recordings that verbs compare with a config, as their options name them.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "program/command_line.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// Options of verbs that read recordings of a machine.
struct RecordingChoice {
  std::vector<std::string> recordings, held_out, changed;
};

void add_recording_options(Verb& verb, RecordingChoice& choice);

/// All recordings with the columns that a diagnosis uses and what is stated of them. Throws InputError.
std::vector<Recording> read_all(const RecordingChoice& choice, const Rig& rig);

}  // namespace pneuservo
