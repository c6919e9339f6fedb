// Channels with stamps of their own, brought to the rows of one table.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "record/table.hpp"

namespace pneuservo {

/// Channels that share their stamps.
struct TimedGroup {
  std::vector<double> times;  ///< in one unit for all groups; those that are none are left out
  std::vector<std::size_t> lines;  ///< of each stamp
  std::vector<std::string> names, units;
  std::vector<std::vector<double>> values;  ///< of each channel
};

/// Rows in order of time; those at one time in that of before.
void sort_by_time(TimedGroup& group);

/// The table's columns become the times and all channels, its rows those of the fastest even group, of a command's
/// before others. A channel as fast as the rows has a value in each, a slower one as many values as it has samples:
/// those of commands and references stand at the next row, others are drawn to it by cubics. Where no group is even,
/// each stamp is a row, and commands stay at their value up to the next one. All of it is told.
/// Column 0 of the table holds the name, unit and kind of the times.
void join_groups(CsvTable& table, std::vector<TimedGroup> groups);

}  // namespace pneuservo
