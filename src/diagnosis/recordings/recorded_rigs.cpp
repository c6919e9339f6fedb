// A supposed rig as it was while each recording was made.
#include "diagnosis/recordings/recorded_rigs.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/rig_parameters.hpp"

namespace pneuservo {
namespace {

/// The parts of a machine that somebody changes between recordings: with another cylinder it is another machine, and
/// sensors and controller stay as the config has them.
constexpr std::array<std::string_view, 6> sections{"air", "supply", "valve", "line_1", "line_2", "slider"};

bool is_of_the_machine(const std::string& path) {
  return std::find(sections.begin(), sections.end(), path.substr(0, path.find('.'))) != sections.end();
}

}  // namespace

MachineChanges machine_changes(const Rig& owner, const Recording& recording) {
  MachineChanges changes;
  const std::vector<ParameterPath> known = parameter_paths(owner);
  for (const auto& [path, value] : recording.changed) {
    if (!is_of_the_machine(path))
      throw InputError(fmt::format("{}: changed for it: found {}, expected a number of air, supply, valve, "
                                   "lines or slider, such as "
                                   "supply.pressure_Pa or slider.payload_kg",
                                   recording.path, path));
    Rig checked = owner;
    try {
      set_parameter(checked, path, value);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: changed for it: {}", recording.path, error.what()));
    }
    const auto at =
        std::find_if(known.begin(), known.end(), [&, &path = path](const auto& k) { return k.path == path; });
    if (at == known.end())
      throw InputError(fmt::format("{}: changed for it: found {}, which the config does not state, expected it there",
                                   recording.path, path));
    if (std::any_of(changes.begin(), changes.end(),
                    [&, &path = path](const auto& c) { return c.number.path() == path; }))
      throw InputError(fmt::format("{}: changed for it: found {} twice, expected it once", recording.path, path));
    const bool is_added = at->value == 0;
    changes.push_back({ParameterHandle(owner, path), is_added ? 1 : value / at->value, is_added ? value : 0,
                       at->field.minimum, at->field.maximum});
  }
  return changes;
}

Rig changed_rig(Rig rig, const MachineChanges& changes) {
  for (const MachineChange& change : changes)
    change.number.set(rig,
                      std::clamp(change.factor * change.number.value(rig) + change.added, change.lower, change.upper));
  return rig;
}

}  // namespace pneuservo
