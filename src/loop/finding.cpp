// A finding: names of the levels, the worst of a list, the text table.
#include "loop/finding.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace pneuservo {

std::string_view name(FindingLevel level) {
  switch (level) {
    case FindingLevel::good: return "good";
    case FindingLevel::acceptable: return "acceptable";
    case FindingLevel::bad: return "bad";
    case FindingLevel::unsafe: return "unsafe";
  }
  return "";
}

FindingLevel worst_level(const std::vector<Finding>& findings) {
  FindingLevel worst = FindingLevel::good;
  for (const Finding& finding : findings) worst = std::max(worst, finding.level);
  return worst;
}

std::string finding_table(const std::vector<Finding>& findings) {
  std::size_t width = 0;
  for (const Finding& finding : findings) width = std::max(width, finding.topic.size());
  std::string table;
  for (const Finding& finding : findings) {
    table += fmt::format("{:<10}  {:<{}}  {}\n", name(finding.level), finding.topic, width, finding.what);
    if (!finding.remedy.empty()) table += fmt::format("{:<10}  {:<{}}  -> {}\n", "", "", width, finding.remedy);
  }
  return table;
}

}  // namespace pneuservo
