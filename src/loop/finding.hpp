// A finding: one thing that was looked at, how good it is, what was found and what to do about it.
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace pneuservo {

/// bad: it will not do what it shall; unsafe: it may do what hurts somebody or breaks something.
enum class FindingLevel { good, acceptable, bad, unsafe };
std::string_view name(FindingLevel level);

/// `remedy` is a command or an instruction; empty only for FindingLevel::good.
struct Finding {
  FindingLevel level = FindingLevel::good;
  std::string topic;   ///< what was looked at, e.g. "scheduling policy"
  std::string what;    ///< what was found, with its value
  std::string remedy;
  std::vector<std::map<std::string, double>>
      figures{};  ///< numbers of `what`, by key with unit, for the JSON; NaN: none
};

/// The worst level of a list; good when it is empty.
FindingLevel worst_level(const std::vector<Finding>& findings);

/// The findings as a text table with aligned columns, remedies on lines of their own.
std::string finding_table(const std::vector<Finding>& findings);

}  // namespace pneuservo
