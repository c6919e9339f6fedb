// What was identified of a line, in words, as JSON and as a page.
#pragma once
#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "acoustics/line_identification.hpp"

namespace pneuservo {

/// A line of a rig as it is believed and as it was found.
struct IdentifiedLine {
  LineBelief belief;
  double sensor_noise_Pa = 0.0;          ///< of the config, root mean square of both sensors
  std::string in_column, out_column;     ///< of the pressures at its ends
  std::size_t bridged_rows = 0;          ///< missing ones, by straight lines
  double port_age_s = 0.0;               ///< by which a simulated port is older than its chamber in the same row
  LineIdentification found;
};

std::string line_text(const IdentifiedLine& line);
nlohmann::ordered_json line_json(const IdentifiedLine& line);
/// Self-contained page with both tables and the response. Throws InputError naming the path if that fails.
void write_line_report(const IdentifiedLine& line, const std::string& rig, const std::string& path);

}  // namespace pneuservo
