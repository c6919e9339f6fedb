// What the columns of a foreign table are likely to be: quantity by name, unit by name, brackets or a row of units.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/record/import_parameters.hpp>

#include "record/table.hpp"

namespace pneuservo {

struct ColumnGuess {
  std::string column;    ///< its name in the file
  std::string ours;      ///< a column of the recording format; empty: none that is known
  std::string unit;      ///< as the file states it; empty: not stated, taken for SI
  double factor = 1;     ///< ours = factor theirs + offset
  double offset = 0;
  std::string evidence;  ///< in words
  bool has_unit = false;  ///< the file states one of the quantity
  std::string axis;       ///< of a table with several axes: which one, quoted; empty: of none
};

/// One a column, in the file's order; no column of ours is given twice. atmosphere_Pa: what gauge units are raised by.
std::vector<ColumnGuess> guess_columns(const CsvTable& table, double atmosphere_Pa = 101325);

/// Which of several axes the columns are taken from, and which others there are; empty: there is one.
std::string axis_words(const std::vector<ColumnGuess>& guesses);

/// The column of ours that a name, with its unit or without, stands for by itself; empty: none.
std::string meaning_of(const std::string& name);

/// The unit that the file states for a column, in a row or in its name; empty: none.
std::string stated_unit(const CsvTable& table, std::size_t column);

/// Seconds of the unit of a column that is named as a time, alone, numbered or for the column behind it ("t3", "x_time"
/// before "x"); 1 where it states none; 0: it is no time.
double named_time_s(const CsvTable& table, std::size_t column);
/// The same of a column that is named as the time since the row before: "dt_ms"; 0 where it is not.
double named_interval_s(const CsvTable& table, std::size_t column);

/// The map of a config that says the same; columns without a meaning are left out.
ImportParameters import_map(const std::vector<ColumnGuess>& guesses);

/// {column: "Weg [mm]", factor: 0.001}: the right side of a column in the section `import:`.
std::string source_text(const ImportedColumn& source);
/// The section `import:` as it stands in a config, columns in the order of the file.
std::string import_section(const ImportParameters& map, const std::vector<ColumnGuess>& order);

}  // namespace pneuservo
