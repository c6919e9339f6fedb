// Which of several columns with one meaning is taken.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "record/foreign/axis_names.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/table.hpp"

namespace pneuservo {

/// Steps from row to row one way less those the other way: what tells rows apart and goes on is the better clock.
std::size_t course_of(const std::vector<double>& values);

/// Where ports 2 and 4 of a valve both stand, these are the cylinder's, 4 the one that pushes outwards, and 1 is the
/// supply (ISO 11727). texts: the columns' names without units.
void take_valve_ports(const std::vector<std::string>& texts, std::vector<ColumnGuess>& guesses, double atmosphere_Pa);

/// Of several columns with one meaning one keeps it: of times the one that goes on; else one with values before an
/// empty one, one of the recording format, one of the axis that most is known of, one that moves, one that is no
/// model's, one that says that it is measured, one with a unit, the first.
void leave_one_of_each(const CsvTable& table, const std::vector<std::string>& texts, std::vector<ColumnGuess>& guesses);

/// Of several axes the one with most known signals that have values and move; nothing is taken from the others. Where
/// words such as "PLC" and "DAQ" name loggers, whose common signals agree, what it lacks is taken from the other.
void take_one_axis(const CsvTable& table, const std::vector<AxisOfColumn>& axes, std::vector<ColumnGuess>& guesses);

/// Whether words that may be sides or numbers of sensors lose a position, command or pressure that is known without
/// them: then they tell no axes.
bool loses_by_sides(const std::vector<AxisOfColumn>& axes, const std::vector<ColumnGuess>& without,
                    const std::vector<ColumnGuess>& with);

}  // namespace pneuservo
