// The section `hal`: which device stands behind each channel of a rig, and how it is spoken to.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <pneuservo/core/field.hpp>
#include <pneuservo/hal/can_object.hpp>

namespace pneuservo {

/// Who decides what lies in a node's PDOs: the config writes it, or the device has it and it is read.
enum class CanMapping { write, read };
inline constexpr std::array<std::string_view, 2> can_mapping_names{"write", "read"};
/// What makes a node send its inputs: our SYNC once a period, or its own timer.
enum class CanTransmission { sync, event };
inline constexpr std::array<std::string_view, 2> can_transmission_names{"sync", "event"};

/// One CANopen device.
struct CanNodeParameters {
  std::uint32_t node_id = 1;
  std::uint32_t profile = 0;
  CanMapping mapping = CanMapping::write;
  CanTransmission transmission = CanTransmission::sync;
  double heartbeat_s = 0.02;
  double boot_timeout_s = 2.0;
  std::string eds;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"node_id", "-", 1, 127, "CANopen node number"}, p.node_id...);
    v(Field{"profile", "-", 0, 65535, "device profile that 0x1000 must state, 401 or 406; 0: any", optional},
      p.profile...);
    v(Field{"mapping", "", 0, 0,
            "write: the PDO mapping below is written into the device; read: the device's own is "
            "used and the objects are looked up in it",
            optional, can_mapping_names},
      p.mapping...);
    v(Field{"transmission", "", 0, 0, "of its inputs: once a SYNC, or by the device's own timer of one period",
            optional, can_transmission_names},
      p.transmission...);
    v(Field{"heartbeat_s", "s", 0.001, 10, "its heartbeat is written to 0x1017; silence of 2.5 times that is a fault",
            optional},
      p.heartbeat_s...);
    v(Field{"boot_timeout_s", "s", 0.01, 60, "it must have come up after a reset within this time", optional},
      p.boot_timeout_s...);
    v(Field{"eds", "", 0, 0, "EDS or DCF file of the device, from the config's folder; what a DCF states is written",
            optional},
      p.eds...);
  }
};

/// The bus and its nodes.
struct CanBusParameters {
  std::string interface;
  double bit_rate_bps = 1e6;
  std::uint32_t node_id = 126;
  double heartbeat_s = 0.02;
  double watchdog_s = 0.06;
  std::map<std::string, CanNodeParameters> nodes;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"interface", "", 0, 0,
            "can0 (SocketCAN), slcan:/dev/ttyACM0 (serial adapter), unix:PATH (socket of the verb "
            "device)"},
      p.interface...);
    v(Field{"bit_rate_bps", "1/s", 10000, 1000000, "bit rate of the bus, bits per second", optional},
      p.bit_rate_bps...);
    v(Field{"node_id", "-", 1, 127, "of this program's own heartbeat", optional}, p.node_id...);
    v(Field{"heartbeat_s", "s", 0.001, 10, "this program's heartbeat, sent by the loop itself", optional},
      p.heartbeat_s...);
    v(Field{"watchdog_s", "s", 0.002, 30, "silence of it after which the devices give their substitute output (0x1016)",
            optional},
      p.watchdog_s...);
    v(Field{"nodes", "", 0, 0, "devices by name"}, p.nodes...);
  }
};

/// What the keys of a channel's scale and limits are called; keys carry the channel's unit.
struct PositionKeys {
  static constexpr std::string_view unit = "m", scale = "scale_m_per_count", zero = "zero_m", lowest = "lowest_m",
                                    highest = "highest_m";
};
struct PressureKeys {
  static constexpr std::string_view unit = "Pa", scale = "scale_Pa_per_count", zero = "zero_Pa", lowest = "lowest_Pa",
                                    highest = "highest_Pa";
};
struct ForceKeys {
  static constexpr std::string_view unit = "N", scale = "scale_N_per_count", zero = "zero_N", lowest = "lowest_N",
                                    highest = "highest_N";
};
struct VoltageKeys {
  static constexpr std::string_view unit = "V", scale = "scale_V_per_count", zero = "zero_V", lowest = "lowest_V",
                                    highest = "highest_V";
};

/// A channel behind an object of a CANopen node: value = zero + scale * counts.
template <class Keys> struct CanChannelParameters {
  std::string node;
  std::uint32_t pdo = 1;
  CanObject object;
  bool is_signed = true;
  double scale = 1.0, zero = 0.0, lowest = 0.0, highest = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"node", "", 0, 0, "name of the node in hal.can.nodes"}, p.node...);
    v(Field{"pdo", "-", 1, 4, "number of the process data object"}, p.pdo...);
    v(Field{"object", "", 0, 0, "as in the device's mapping: index, sub-index, bits, e.g. 0x64010110"}, p.object...);
    v(Field{"signed", "", 0, 0, "counts are two's complement", optional}, p.is_signed...);
    v(Field{Keys::scale, Keys::unit, -1e12, 1e12, "of one count; negative turns the direction round"}, p.scale...);
    v(Field{Keys::zero, Keys::unit, -1e12, 1e12, "value at 0 counts (gauge sensors: the atmosphere)", optional},
      p.zero...);
    v(Field{Keys::lowest, Keys::unit, -1e12, 1e12, "below it is no measurement; an output is held at it"}, p.lowest...);
    v(Field{Keys::highest, Keys::unit, -1e12, 1e12, "above it is no measurement; an output is held at it"},
      p.highest...);
  }
};

/// One channel of the rig: at most one source. Without any it is absent, and never silently simulated.
template <class Keys> struct ChannelParameters {
  bool simulated = false;
  std::optional<CanChannelParameters<Keys>> can;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"simulated", "", 0, 0, "the simulated plant stands behind it", Presence::optional}, p.simulated...);
    v(Field{"can", "", 0, 0, "an object of a CANopen node", Presence::optional}, p.can...);
  }
  bool is_absent() const noexcept { return !simulated && !can; }
};

/// Channels by the names of the recording's columns without their unit.
struct HalChannels {
  ChannelParameters<PositionKeys> x;
  ChannelParameters<PressureKeys> p1_port, p2_port, p1_chamber, p2_chamber, p_supply;
  ChannelParameters<VoltageKeys> u, u1, u2;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"x", "", 0, 0, "position", optional}, p.x...);
    v(Field{"p1_port", "", 0, 0, "pressure at valve port 1, absolute", optional}, p.p1_port...);
    v(Field{"p2_port", "", 0, 0, "pressure at valve port 2, absolute", optional}, p.p2_port...);
    v(Field{"p1_chamber", "", 0, 0, "pressure in chamber 1, absolute", optional}, p.p1_chamber...);
    v(Field{"p2_chamber", "", 0, 0, "pressure in chamber 2, absolute", optional}, p.p2_chamber...);
    v(Field{"p_supply", "", 0, 0, "supply pressure, absolute", optional}, p.p_supply...);
    v(Field{"u", "", 0, 0, "command of a cylinder's valve", optional}, p.u...);
    v(Field{"u1", "", 0, 0, "command of a servo table's valve 1", optional}, p.u1...);
    v(Field{"u2", "", 0, 0, "command of a servo table's valve 2", optional}, p.u2...);
  }
};

/// Devices and the channels behind them.
struct HalParameters {
  std::optional<CanBusParameters> can;
  HalChannels channels;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"can", "", 0, 0, "CANopen bus", Presence::optional}, p.can...);
    v(Field{"channels", "", 0, 0, "what stands behind each channel; one that is not named is absent"}, p.channels...);
  }
};

}  // namespace pneuservo
