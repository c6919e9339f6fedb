// Rigs for the tests of the loop: the project's own configs, shortened.
#pragma once
#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/record/row.hpp>

#include "config/read_rig.hpp"

namespace pneuservo {

inline std::string config_path(const std::string& name) {
  return std::string(PNEUSERVO_SOURCE_DIR) + "/config/" + name + ".yaml";
}

inline Rig config_rig(const std::string& name, const std::vector<std::string>& sets = {}) {
  return read_rig(config_path(name), sets);
}

/// A recorded term of the rig's law by its name; fails where the law has none of it.
inline double term(const Rig& rig, const Row& row, std::string_view name) {
  const auto names = law_columns(rig.controller.kind);
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) throw std::logic_error("no term " + std::string(name));
  return row.terms[static_cast<std::size_t>(at - names.begin())];
}

/// The nine lines.
inline std::vector<std::string> nine_configs() {
  std::vector<std::string> names;
  for (const char* length : {"2m", "5m", "10m"})
    for (const char* diameter : {"4.15mm", "6.10mm", "7.65mm"})
      names.push_back(std::string("cylinder-") + length + "-" + diameter);
  return names;
}
/// The shortest and widest, the middle, and the longest and narrowest of them.
inline std::vector<std::string> lines_of_the_range() {
  return {"cylinder-2m-7.65mm", "cylinder-5m-6.10mm", "cylinder-10m-4.15mm"};
}

}  // namespace pneuservo
