// The kind of rig that a recording was made on.
#include "program/recorded_kind.hpp"

#include <optional>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"

namespace pneuservo {

void require_same_kind(const Recording& recording, const std::string& config, const Rig& rig) {
  const YAML::Node text = recording.header["config"];
  if (!text || !text.IsScalar()) return;
  std::optional<RigKind> recorded;
  try {
    recorded = parse_rig(text.Scalar(), recording.path + ", header").kind;
  } catch (const InputError&) { return; }  // of another version: its columns and times speak for themselves
  const auto name = [](RigKind kind) { return rig_kind_names[static_cast<std::size_t>(kind)]; };
  if (*recorded != rig.kind)
    throw InputError(fmt::format("{}: found a recording of '{}', a rig of kind {}, expected one of kind {}, as {} is",
                                 recording.path, recording.rig, name(*recorded), name(rig.kind), config));
}

}  // namespace pneuservo
