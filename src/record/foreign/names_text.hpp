// Names of columns for a sentence.
#pragma once
#include <string>
#include <vector>

namespace pneuservo {

/// The first twenty, none too long to read, and how many more there are.
std::string names_text(const std::vector<std::string>& names);

}  // namespace pneuservo
