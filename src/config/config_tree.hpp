// A YAML document as a plain tree in which every node knows where it was written: file and line, or a --set.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace pneuservo {

/// One value of a document.
struct ConfigNode {
  enum class Type { nothing, scalar, list, map };
  struct Entry;

  Type type = Type::nothing;
  std::string text;             ///< of a scalar
  bool quoted = false;          ///< "5" is a text, 5 a number
  std::string origin;           ///< "rig.yaml:12" or "--set line_1.length_m=5"
  std::string written;          ///< as the user wrote it, where `text` was computed from it; else empty
  std::vector<ConfigNode> items;
  std::vector<Entry> entries;   ///< of a map, in their order, each key once

  const Entry* find(const std::string& key) const;
  Entry* find(const std::string& key);
};

struct ConfigNode::Entry {
  std::string key;
  std::string origin;  ///< where the key stands
  ConfigNode value;
};

/// Parses one YAML document. Throws InputError naming file and line: text that is not YAML, an empty or second
/// document, a key that stands twice, nesting or aliases beyond all reason.
ConfigNode parse_config_tree(const std::string& yaml_text, const std::string& source_name);

/// The document in a file; `expected` says what the file should be. Throws InputError.
ConfigNode read_config_tree(const std::filesystem::path& file, const std::string& expected);

/// Applies one `PATH=VALUE`; VALUE is YAML. Maps on the way are created, list items are named by their index from 0.
/// Throws InputError naming the --set.
void apply_override(ConfigNode& root, const std::string& path_and_value);

/// What stands at a node, for the words after "found".
std::string describe(const ConfigNode& node);
/// Text from outside as it may be shown on a terminal: a space for each control character.
std::string printable(std::string_view text);

/// Throws InputError `ORIGIN: PATH: found FOUND, expected EXPECTED`.
[[noreturn]] void refuse(const std::string& origin, const std::string& path, const std::string& found,
                         const std::string& expected);

/// PATH.KEY, or KEY at the top.
std::string join_path(const std::string& path, std::string_view key);

}  // namespace pneuservo
