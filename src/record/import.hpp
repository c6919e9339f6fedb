// The one way into the program for recordings: of our own format, or foreign by the column map of a config.
#pragma once
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <pneuservo/record/import_parameters.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// The runs of one file. With a map columns are renamed and scaled, and rows outside from_s to to_s are left out.
/// Times are brought to seconds (epoch times, dates, ms, us, ns) and begin at 0 where they were a calendar's. Rows with
/// other values in the columns that tell runs make runs of their own, in which repeats at one time become their mean;
/// otherwise a run begins where the time goes back and stays back. Recording::period_s is the interval of the stamps.
/// Whatever was supposed is told among the problems. period_s: of the config's loop; NaN: unknown.
/// wanted: as for read_table. Throws InputError as it does, for a map that names a column of no meaning, where t_s is
/// missing, and where no row is left.
std::vector<Recording> read_recordings(const std::string& path, const std::optional<ImportParameters>& imported,
                                       double period_s, const std::set<std::string>& wanted = {});

/// The same of a table that is read already.
std::vector<Recording> recordings_in(CsvTable table, const std::optional<ImportParameters>& imported, double period_s);

/// The first run, for verbs that take one; that there are others is told.
Recording read_first_recording(const std::string& path, const std::optional<ImportParameters>& imported,
                               double period_s);

/// Loads t_s and x_ref_m of a recording, for references of kind `file`. Throws InputError.
std::pair<std::vector<double>, std::vector<double>> load_reference_positions(const std::string& path);

}  // namespace pneuservo
