// What was understood of a foreign recording, in a table and a page.
#pragma once
#include <string>

#include <report/table.hpp>

#include "diagnosis/doubts/import_result.hpp"

namespace pneuservo {

/// Columns with what they are taken for, their ranges and the evidence.
Table import_table(const ImportResult& result);
/// Runs with rows, times, interval and gaps.
Table runs_table(const ImportResult& result);

/// Writes the page; throws InputError naming the path if that fails.
void write_import_report(const ImportResult& result, const std::string& path);

}  // namespace pneuservo
