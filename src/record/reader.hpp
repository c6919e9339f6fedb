// Reads recordings of docs/recording.md's format: a table whose times are checked.
#pragma once
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "record/table.hpp"

namespace pneuservo {

/// A table with strictly increasing `t_s`; rows that break the order are reported and left out.
struct Recording : CsvTable {
  std::string rig;  ///< the config's name; empty if the header lacks it
  double period_s =
      std::numeric_limits<double>::quiet_NaN();  ///< > 0, or NaN if the header lacks it (gaps are not sought then)

  const std::vector<double>& t_s() const { return column("t_s"); }
  bool is_held_out = false;  ///< as a whole: kept from every fit of a diagnosis
  /// What of its config the machine had otherwise while this was made (another supply pressure): paths and values.
  std::vector<std::pair<std::string, double>> changed;
  /// Rows that gaps in time show to be missing, and how many of them the recorder marked as dropped by itself.
  std::size_t missing_rows = 0, dropped_rows = 0;
};

/// Throws InputError as read_table does, and where there is no column t_s or no row with a time.
Recording read_recording(const std::string& path);

}  // namespace pneuservo
