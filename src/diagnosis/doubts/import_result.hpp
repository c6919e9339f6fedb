// What is understood of a foreign recording: columns, units, times, gaps, doubts, and the section that says so.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "record/foreign/column_guess.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// What was understood.
struct ImportResult {
  std::string path;
  std::vector<ColumnGuess> columns;
  std::vector<Recording> runs;           ///< in SI
  std::vector<std::string> understood;   ///< dialect, times, rows that are not used
  std::vector<std::string> doubts;       ///< of the rig's config; empty without one
  std::string section;                   ///< the config's section `import:`
};

/// Reads a table of any logger by the rig's section import, or by the names of its columns where it has none; with a
/// rig its physics doubts what was read. Throws InputError as read_table does, and where no column gives times.
ImportResult understand_recording(const std::string& path, std::optional<Rig> rig);

}  // namespace pneuservo
