// Reads a config file into a Rig; every mistake in it is one sentence with file, line, key, found and expected.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// What a config is read for: a machine whose valve may be driven, or computations and simulated devices alone.
enum class ConfigUse { machine, simulation };

/// Reads a config. `overrides` are PATH=VALUE (the program's --set), applied in order; VALUE is YAML, and a mistake in
/// one names the --set. A relative `reference.path` of the file is taken from the file's folder.
/// Throws InputError: file missing or unreadable, not YAML, unknown, missing or repeated keys, wrong types, impossible
/// values, values that contradict each other; for a machine, outputs that would stay open without this program.
Rig read_rig(const std::filesystem::path& file, const std::vector<std::string>& overrides = {},
             ConfigUse use = ConfigUse::machine);

/// The same from text; `source_name` stands for the file in messages.
Rig parse_rig(const std::string& yaml_text, const std::string& source_name,
              const std::vector<std::string>& overrides = {});

/// A reference alone, as a recording's header states it.
ReferenceSpec parse_reference(const std::string& yaml_text, const std::string& source_name);

}  // namespace pneuservo
