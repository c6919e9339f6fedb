// Zeros of channels from files that home, zero and commission wrote, as overrides of the config's section zeros.
#pragma once
#include <map>
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Which machine a rig is: its cylinder, encoder and channels with their objects and scales; sixteen hexadecimal digits.
/// Gains, references, limits and the name of the bus interface do not change it.
std::string machine_of(const Rig& rig);

/// `sets` and after them one zeros.CHANNEL=VALUE for each zero of the files. Throws InputError naming file and line, and
/// where a file was found on another rig than that of `config` with `sets`.
std::vector<std::string> with_zeros(const std::string& config, std::vector<std::string> sets,
                                    const std::vector<std::string>& files);

/// Writes a file for with_zeros, `comment` one or more lines without their mark. Throws InputError.
void write_zeros(const std::string& file, const Rig& rig, const std::map<std::string, double>& zeros,
                 const std::string& comment);

}  // namespace pneuservo
