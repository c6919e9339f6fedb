// Names of columns for a sentence.
#include "record/foreign/names_text.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace pneuservo {

std::string names_text(const std::vector<std::string>& names) {
  constexpr std::size_t most_names = 20, most_letters = 60;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most_names); ++i) {
    std::size_t end = std::min(names[i].size(), most_letters);
    while (end < names[i].size() && end > 0 && (static_cast<unsigned char>(names[i][end]) & 0xc0) == 0x80) --end;
    text += (i > 0 ? ", " : "") + names[i].substr(0, end) + (end < names[i].size() ? "..." : "");
  }
  return names.size() > most_names ? fmt::format("{} and {} more", text, names.size() - most_names) : text;
}

}  // namespace pneuservo
