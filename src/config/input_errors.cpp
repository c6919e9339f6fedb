// The errors of one input, collected so that all of them are told at once.
#include "config/input_errors.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

namespace pneuservo {

namespace {

/// Line of "rig.yaml:12: KEY: ..."; what has none (a --set) stands behind all lines.
int line_of(std::string_view sentence) {
  const std::string_view origin = sentence.substr(0, sentence.find(": "));
  int line = std::numeric_limits<int>::max();
  if (const std::size_t colon = origin.rfind(':'); colon != std::string_view::npos)
    std::from_chars(origin.data() + colon + 1, origin.data() + origin.size(), line);
  return line;
}

}  // namespace

void InputErrors::add(const std::string& sentences) {
  std::istringstream lines(sentences);
  for (std::string line; std::getline(lines, line);)
    if (std::ranges::find(sentences_, line) == sentences_.end()) sentences_.push_back(line);
}

bool InputErrors::concern(std::string_view top_key) const {
  if (doubted_.contains(top_key)) return true;
  const std::string itself = fmt::format(": {}: ", top_key), below = fmt::format(": {}.", top_key);
  return std::ranges::any_of(sentences_, [&](const std::string& sentence) {
    return sentence.find(itself) != std::string::npos || sentence.find(below) != std::string::npos;
  });
}

void InputErrors::throw_if_any() const {
  if (sentences_.empty()) return;
  std::vector<std::string> sorted = sentences_;
  std::ranges::stable_sort(sorted, {}, [](const std::string& sentence) { return line_of(sentence); });
  throw InputError(fmt::format("{}", fmt::join(sorted, "\n")));
}

}  // namespace pneuservo
