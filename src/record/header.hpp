// The comment header of a recording: an ordered list of keys with YAML values.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pneuservo {

/// Starts with the keys that every recording has: format, rig, period_s, version, code_path.
class RecordingHeader {
 public:
  static constexpr std::string_view format = "pneuservo-recording/1";

  /// `rig`: the config's name; `period_s` > 0.
  RecordingHeader(std::string_view rig, double period_s);

  /// Adds a key whose value is a piece of YAML, e.g. ("reference", "{kind: steps, ...}") or a nested map of several
  /// lines. Throws std::invalid_argument if the key is there already or the value is not YAML.
  void add_yaml(std::string key, std::string_view yaml);
  /// Adds a key whose value is text, quoted as needed; several lines (a dumped config) become a block scalar.
  void add_text(std::string key, std::string_view text);
  void add_number(std::string key, double value);

  /// The header as it stands in the file: every line starts with `# `.
  std::string comment_lines() const;

 private:
  void add(std::string key, std::string value);
  std::vector<std::pair<std::string, std::string>> entries_;  // value as it follows `key:`
};

}  // namespace pneuservo
