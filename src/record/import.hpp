// Reads recordings of a foreign format by the column map of a config.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include <pneuservo/record/import_parameters.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// The runs of one file, in the order of their first rows: a recording of our own format where there is no map.
/// Otherwise columns are renamed and scaled, rows outside from_s to to_s are left out, and rows with other values in
/// the columns that tell runs make runs of their own. Within a run rows are put in the order of their times; repeats at
/// one time (the same event logged in several cycles) become their mean. period_s: of the config.
/// Throws InputError as read_table does, where a mapped t_s is missing, and where no row is left.
std::vector<Recording> read_recordings(const std::string& path, const std::optional<ImportParameters>& imported,
                                       double period_s);

}  // namespace pneuservo
