// Zeros of channels from files that home and zero wrote, as overrides of the config's section zeros.
#pragma once
#include <string>
#include <vector>

namespace pneuservo {

/// `sets` and after them one zeros.CHANNEL=VALUE for each zero of the files. Throws InputError naming file and line.
std::vector<std::string> with_zeros(std::vector<std::string> sets, const std::vector<std::string>& files);

}  // namespace pneuservo
