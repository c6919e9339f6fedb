// What checks of a whole config share: where a path was written, and how a contradiction is told.
#pragma once
#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/config_tree.hpp"
#include "config/input_error.hpp"
#include "config/input_errors.hpp"

namespace pneuservo {

/// Where a path was written: the deepest node of it that the config has.
inline std::string origin_of(const ConfigNode& root, const std::string& path) {
  const ConfigNode* node = &root;
  std::string origin = root.origin;
  for (std::size_t start = 0; start <= path.size() && node->type == ConfigNode::Type::map;) {
    const std::size_t dot = std::min(path.find('.', start), path.size());
    const ConfigNode::Entry* entry = node->find(path.substr(start, dot - start));
    if (entry == nullptr) break;
    node = &entry->value;
    origin = node->origin;
    start = dot + 1;
  }
  return origin;
}

inline bool is_stated(const ConfigNode& root, const std::string& section, const std::string& key) {
  const ConfigNode::Entry* entry = root.find(section);
  return entry != nullptr && entry->value.find(key) != nullptr;
}

/// Tells what is wrong at `path` with the line it stands on, or with the --set that made one of the `others` contradict
/// it.
struct Check {
  const ConfigNode& root;
  InputErrors& errors;
  void refuse(const std::string& path, const std::vector<std::string>& others, const std::string& found,
              const std::string& expected) const {
    std::string origin = origin_of(root, path);
    for (const std::string& other : others) {
      const std::string from = origin_of(root, other);
      if (from.starts_with("--set") && !origin.starts_with("--set")) origin = from;
    }
    errors.collect([&] { pneuservo::refuse(origin, path, found, expected); });
  }
  /// Runs a check of sections that were read without an error.
  template <class Step> void of(std::initializer_list<std::string_view> sections, Step&& step) const {
    for (const std::string_view section : sections)
      if (errors.concern(section)) return;
    errors.collect(std::forward<Step>(step));
  }
};

}  // namespace pneuservo
