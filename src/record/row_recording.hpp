// Rows of a run as a recording in memory.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include <pneuservo/record/row.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// Columns t_s, x_m, the command of each of `valves` valves and the six pressures that there are.
Recording recording_of(const std::vector<Row>& rows, const std::string& rig, double period_s, std::size_t valves);

}  // namespace pneuservo
