// Keys of a config for the verb serve: who may command the axis, and what it keeps of its motion.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// What an axis does when its commander is gone without a word.
enum class CommanderLost {
  finish,  ///< ends the move under way and holds its place; a jog stops
  stop,    ///< comes to rest as fast as the limits allow and holds its place
  safe,    ///< safe output at once
};
inline constexpr std::array<std::string_view, 3> commander_lost_names{"finish", "stop", "safe"};

/// The axis as a drive on a CAN bus (docs/drive.md).
struct CanDriveParameters {
  std::string interface;
  std::uint32_t node_id = 1;
  double bit_rate_bps = 1e6;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"interface", "", 0, 0,
            "bus of the PLC: can1 (SocketCAN), slcan:/dev/ttyACM1 (serial adapter), unix:PATH (local socket); not the "
            "one of hal.can"},
      p.interface...);
    v(Field{"node_id", "-", 1, 127, "CANopen node number of the drive"}, p.node_id...);
    v(Field{"bit_rate_bps", "1/s", 10000, 1000000, "bit rate of the bus, bits per second; told to a serial adapter",
            optional},
      p.bit_rate_bps...);
  }
};

struct ServeParameters {
  CommanderLost commander_lost = CommanderLost::stop;
  double commander_silent_s = 0.0;
  std::uint32_t tcp_port = 0;
  double part_s = 60.0;
  double recordings_MB = 1000.0;
  double kept_MB = 1000.0;
  double around_s = 10.0;
  std::optional<CanDriveParameters> drive;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"commander_lost", "", 0, 0, "when the commander is gone: finish the move, stop, or safe output at once",
            optional, commander_lost_names},
      p.commander_lost...);
    v(Field{"commander_silent_s", "s", 0, 3600, "a commander that says nothing for so long is gone, too; 0: it may",
            optional},
      p.commander_silent_s...);
    v(Field{"tcp_port", "", 0, 65535, "commands over TCP on this machine's loopback, too; 0: not", optional},
      p.tcp_port...);
    v(Field{"part_s", "s", 1, 86400, "length of one file of the recording", optional}, p.part_s...);
    v(Field{"recordings_MB", "MB", 1, 1e7, "recordings beyond it are deleted, the oldest first", optional},
      p.recordings_MB...);
    v(Field{"kept_MB", "MB", 1, 1e7,
            "files around faults and marks are kept up to this size and never deleted; beyond it new ones are not",
            optional},
      p.kept_MB...);
    v(Field{"around_s", "s", 0, 3600, "so long before and after a fault or mark the recording is kept", optional},
      p.around_s...);
    v(Field{"drive", "", 0, 0, "the axis as a CiA 402 drive on a CAN bus", optional}, p.drive...);
  }
};

}  // namespace pneuservo
