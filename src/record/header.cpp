// The comment header of a recording: an ordered list of keys with YAML values.
#include "record/header.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "config/version.hpp"
#include "record/number_text.hpp"

namespace pneuservo {

namespace {

/// Every line of the text, with the prefix before it and LF after it.
std::string prefixed(std::string_view text, std::string_view prefix) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    result.append(line.empty() ? prefix.substr(0, prefix.find(' ')) : prefix).append(line) += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

bool one_line(std::string_view text) { return text.find('\n') == std::string_view::npos; }

}  // namespace

RecordingHeader::RecordingHeader(std::string_view rig, double period_s) {
  add_text("format", format);
  add_text("rig", rig);
  add_number("period_s", period_s);
  add_text("version", version());
  add_text("code_path", code_path());
}

void RecordingHeader::add_yaml(std::string key, std::string_view yaml) {
  add(std::move(key), one_line(yaml) ? fmt::format(" {}", yaml) : fmt::format("\n{}", prefixed(yaml, "  ")));
}

void RecordingHeader::add_text(std::string key, std::string_view text) {
  if (one_line(text)) {
    YAML::Emitter emitter;
    emitter << std::string(text);
    add(std::move(key), fmt::format(" {}", emitter.c_str()));
  } else {
    // The 2 states the indentation, so that a first line may begin with spaces itself.
    add(std::move(key), fmt::format(" |2\n{}", prefixed(text, "  ")));
  }
}

void RecordingHeader::add_number(std::string key, double value) {
  char text[number_text_size];
  add(std::move(key),
      fmt::format(" {}", std::string_view(text, static_cast<std::size_t>(number_text(text, value) - text))));
}

void RecordingHeader::add(std::string key, std::string value) {
  for (const auto& entry : entries_)
    if (entry.first == key) throw std::invalid_argument("recording header: key " + key + " is given twice");
  try {
    if (!YAML::Load(key + ":" + value).IsMap()) throw std::invalid_argument("not a key");
  } catch (const std::exception&) {
    throw std::invalid_argument("recording header: the value of key " + key + " is not YAML");
  }
  entries_.emplace_back(std::move(key), std::move(value));
}

std::string RecordingHeader::comment_lines() const {
  std::string result;
  for (const auto& [key, value] : entries_) result += prefixed(fmt::format("{}:{}", key, value), "# ");
  return result;
}

}  // namespace pneuservo
