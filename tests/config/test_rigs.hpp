// Configs that the tests of this folder share.
#pragma once
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"

namespace pneuservo::test {

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Every rig below config/, in order.
inline std::vector<std::filesystem::path> config_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::filesystem::path(PNEUSERVO_SOURCE_DIR) / "config"))
    if (entry.path().extension() == ".yaml" && entry.path().string().find("/scenarios/") == std::string::npos)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// Every rig.yaml of the shared data folder; empty where there is no such folder.
inline std::vector<std::filesystem::path> shared_rig_files() {
  const char* shared = std::getenv("PNEUSERVO_SHARED");
  const std::filesystem::path source = PNEUSERVO_SOURCE_DIR;
  const std::filesystem::path root = (shared != nullptr ? shared : source / ".." / "shared") / "concealed";
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::exists(root)) return files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root))
    if (entry.path().filename() == "rig.yaml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}
/// A config with one key a line; the line numbers in the tests' messages count from here.
inline const std::string plain_rig = R"(format: pneuservo-rig/1
name: plain
rig: cylinder
period_s: 0.001
supply:
  pressure_Pa: 700000
valve:
  command_max_V: 5.0
  area_per_volt_m2_per_V: 2.6e-6
  area_max_m2: 1.3e-5
  critical_pressure_ratio: 0.35
line_1:
  length_m: 10.0
  diameter_m: 0.00765
line_2:
  length_m: 10.0
  diameter_m: 0.00765
cylinder:
  stroke_m: 0.300
  area_1_m2: 1.257e-3
  area_2_m2: 1.056e-3
  dead_volume_1_m3: 2.0e-5
  dead_volume_2_m3: 2.0e-5
  wall_heat_W_per_m2K: 50.0
slider:
  mass_kg: 2.0
  viscous_friction_Ns_per_m: 60.0
sensors:
  position:
    quantum_m: 5.0e-6
  port_pressure:
    quantum_Pa: 100.0
controller:
  kind: pd_force
  pressure_source: estimated
  position_gain_N_per_m: 8000.0
  velocity_gain_Ns_per_m: 120.0
  velocity_filter_s: 0.003
  force_gain_V_per_N: 0.005
reference: {kind: sine, amplitude_m: 0.080, frequency_Hz: 1.0}
duration_s: 5.0
)";

/// The text with the first occurrence of `from` replaced.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  if (place == std::string::npos) throw std::logic_error("no '" + from + "' in the text");
  return text.replace(place, from.size(), to);
}

/// What refusal() says where nothing is wrong.
inline const std::string accepted;
/// Message of the refusal.
inline std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    parse_rig(text, "rig.yaml", overrides);
  } catch (const InputError& error) { return error.what(); }
  return accepted;
}

}  // namespace pneuservo::test
