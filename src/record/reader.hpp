// Reads recordings of docs/recording.md's format: a table whose times are checked.
#pragma once
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <pneuservo/record/import_parameters.hpp>

#include "record/table.hpp"

namespace pneuservo {

/// A table with strictly increasing `t_s`; rows that break the order are reported and left out.
struct Recording : CsvTable {
  std::string rig;  ///< the config's name; empty if the header lacks it
  /// Interval of the rows, > 0: the header's; of a recording that is imported from the stamps. NaN: neither.
  double period_s = std::numeric_limits<double>::quiet_NaN();

  const std::vector<double>& t_s() const { return column("t_s"); }
  bool is_held_out = false;  ///< as a whole: kept from every fit of a diagnosis
  /// Where a column comes from in the file, as a section import would say it. Columns that are not here bear their own
  /// names and values.
  std::map<std::string, ImportedColumn> sources;
  /// Units that the file states for columns whose source says nothing of them, as "%" for u_V.
  std::map<std::string, std::string> stated_units;
  /// What of its config the machine had otherwise while this was made (another supply pressure): paths and values.
  std::vector<std::pair<std::string, double>> changed;
  /// Rows that gaps in time show to be missing, and how many of them the recorder marked as dropped by itself.
  std::size_t missing_rows = 0, dropped_rows = 0;
};

/// The source of a column; its own name where none is stated.
ImportedColumn source_of(const Recording& recording, const std::string& column);

/// Median of the steps forward; NaN where there is none.
double median_step_s(const std::vector<double>& time_s);

/// Between its rows: as its stamps or its maker say it, else the median step.
double row_interval_s(const Recording& recording);

/// Whether the header names this program's format.
bool is_own_format(const CsvTable& table);
/// Takes rig and period from the header, and tells what is wrong there.
void read_keys(Recording& recording);
/// Takes out, and tells, rows that break the order of time; tells gaps where the period is known. Throws InputError
/// where no row has a time.
void check_times(Recording& recording);

/// The rows as one recording, whatever their times; for more than one run: read_recordings (record/import.hpp).
/// Throws InputError as read_table does, and where there is no column t_s or no row with a time.
Recording read_recording(const std::string& path);

}  // namespace pneuservo
