// Time that the frames of a config take on a classic CAN bus: bits with the worst stuffing against the period.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Bits of a data frame with an 11-bit identifier, the gap of 3 bits behind it included. Without stuffing 47 + 8 n; the
/// worst case adds one bit after four in the 34 + 8 n bits that are stuffed: floor((33 + 8 n) / 4).
constexpr int can_frame_bits(int bytes) { return 47 + 8 * bytes; }
constexpr int can_frame_bits_worst(int bytes) { return can_frame_bits(bytes) + (33 + 8 * bytes) / 4; }

/// One kind of frame and how often it is sent.
struct BusFrame {
  std::string name;
  int bytes = 0;
  double per_period = 1.0;
  double worst_s = 0.0;  ///< time of one such frame with the worst stuffing
};

struct BusLoad {
  std::vector<BusFrame> frames;
  double share = 0.0;  ///< of the period, worst stuffing, heartbeats included
  double longest_period_s = 0.0;  ///< a period with all of them at once takes so long
};

/// Of rig.hal.can; a PDO whose mapping is the device's own counts 8 bytes.
BusLoad bus_load(const Rig& rig);

/// Above it nothing is left for emergencies and repeated frames: refused.
inline constexpr double bus_load_limit = 0.9;
inline constexpr double bus_load_comfortable = 0.7;

/// The load in words: "SYNC 55 us, io RPDO2 ... : 74 % of 1 ms".
std::string bus_load_text(const BusLoad& load, double period_s);

}  // namespace pneuservo
