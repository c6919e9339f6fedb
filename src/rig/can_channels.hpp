// The section `hal` as one list: every channel that a CANopen object stands behind, whatever its unit.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One channel on the bus.
struct CanChannel {
  std::string name;     ///< as in hal.channels: "x", "u"
  Signal signal;        ///< of an input
  std::size_t command;  ///< of an output or its readback: counts as in Command
  bool is_output;
  std::string unit;
  std::string node;
  std::uint32_t pdo;
  CanObject object;
  bool is_signed;
  double scale, zero, lowest, highest;
  std::optional<CanSubstitute> substitute{};  ///< of an output
  bool is_readback = false;                   ///< an input that shows the command
  double tolerance_V = 0.0;                   ///< of a readback
  double wrap_counts = 0.0;                   ///< as the config states them; 0: as the device does
};

/// In the order of the config's manual: inputs, then commands, each with its readback behind it.
std::vector<CanChannel> can_channels(const HalParameters& hal);

/// One PDO as the channels use it, in the order of can_channels.
struct CanPdo {
  std::string node;
  std::uint32_t pdo;
  bool is_output;                    ///< sent by us
  std::vector<std::size_t> signals;  ///< indices in can_channels
  unsigned bits = 0;                 ///< of these signals alone
};
std::vector<CanPdo> can_pdos(const std::vector<CanChannel>& channels);

}  // namespace pneuservo
