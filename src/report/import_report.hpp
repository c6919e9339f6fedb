// What was understood of a foreign recording, in a table and a page.
#pragma once
#include <string>
#include <vector>

#include <report/table.hpp>

#include "record/column_guess.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// What the verb `import` shows.
struct ImportResult {
  std::string path;
  std::vector<ColumnGuess> columns;
  std::vector<Recording> runs;           ///< in SI
  std::vector<std::string> understood;   ///< dialect, times, rows that are not used
  std::vector<std::string> doubts;       ///< of the rig's config; empty without one
  std::string section;                   ///< the config's section `import:`
};

/// Columns with what they are taken for, their ranges and the evidence.
Table import_table(const ImportResult& result);
/// Runs with rows, times, interval and gaps.
Table runs_table(const ImportResult& result);

/// Writes the page; throws InputError naming the path if that fails.
void write_import_report(const ImportResult& result, const std::string& path);

}  // namespace pneuservo
