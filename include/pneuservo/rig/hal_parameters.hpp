// The section `hal`: which device stands behind each channel of a rig, and how it is spoken to.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include <pneuservo/core/field.hpp>
#include <pneuservo/core/signal.hpp>
#include <pneuservo/hal/can_object.hpp>

namespace pneuservo {

/// Who decides what lies in a node's PDOs: the config writes it, or the device has it and it is read.
enum class CanMapping { write, read };
inline constexpr std::array<std::string_view, 2> can_mapping_names{"write", "read"};
/// What makes a node send its inputs: our SYNC once a period, or its own timer.
enum class CanTransmission { sync, event };
inline constexpr std::array<std::string_view, 2> can_transmission_names{"sync", "event"};

/// Whose SYNC the bus has: this program's, sent by its clock, or another master's, which the loop waits for.
enum class CanSync { own, foreign };
inline constexpr std::array<std::string_view, 2> can_sync_names{"own", "foreign"};

/// One CANopen device.
struct CanNodeParameters {
  std::uint32_t node_id = 1;
  std::uint32_t profile = 0;
  CanMapping mapping = CanMapping::write;
  CanTransmission transmission = CanTransmission::sync;
  double heartbeat_s = 0.02;
  double boot_timeout_s = 2.0;
  double sdo_timeout_s = 1.0;
  std::uint32_t vendor = 0, product = 0;
  std::string eds;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"node_id", "-", 1, 127, "CANopen node number"}, p.node_id...);
    v(Field{"profile", "-", 0, 65535, "device profile that 0x1000 must state: 401, 404, 406 or 408; 0: any", optional},
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
    v(Field{"sdo_timeout_s", "s", 0.01, 60, "it must answer a request within this time; asked three times", optional},
      p.sdo_timeout_s...);
    v(Field{"vendor", "-", 0, 4294967295.0, "vendor that 0x1018:1 must state; 0: that of the EDS, or any", optional},
      p.vendor...);
    v(Field{"product", "-", 0, 4294967295.0, "product that 0x1018:2 must state; 0: that of the EDS, or any", optional},
      p.product...);
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
  CanSync sync = CanSync::own;
  double sync_timeout_s = 0.0;
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
    v(Field{"sync", "", 0, 0, "own: this program sends SYNC; foreign: another master does, and each tick waits for it",
            optional, can_sync_names},
      p.sync...);
    v(Field{"sync_timeout_s", "s", 0, 10, "a foreign SYNC that is missing for so long is a fault; 0: 2.5 periods",
            optional},
      p.sync_timeout_s...);
    v(Field{"nodes", "", 0, 0, "devices by name"}, p.nodes...);
  }
};

/// What the keys of a channel's scale and limits are called; keys carry the channel's unit.
struct PositionKeys {
  static constexpr std::string_view unit = "m", scale = "scale_m_per_count", scale_V = "scale_m_per_V", zero = "zero_m",
                                    lowest = "lowest_m", highest = "highest_m";
};
struct PressureKeys {
  static constexpr std::string_view unit = "Pa", scale = "scale_Pa_per_count", scale_V = "scale_Pa_per_V",
                                    zero = "zero_Pa", lowest = "lowest_Pa", highest = "highest_Pa";
};
struct FlowKeys {
  static constexpr std::string_view unit = "kg/s", scale = "scale_kgps_per_count", scale_V = "scale_kgps_per_V",
                                    zero = "zero_kgps", lowest = "lowest_kgps", highest = "highest_kgps";
};
struct VoltageKeys {
  static constexpr std::string_view unit = "V", scale = "scale_V_per_count", scale_V = "scale_V_per_V", zero = "zero_V",
                                    lowest = "lowest_V", highest = "highest_V";
};

/// Where a device keeps what an output shall be when the device misses this program.
struct CanSubstitute {
  CanObject value, mode;
  std::uint32_t mode_value = 1;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"value", "", 0, 0, "object that gets the counts of the safe output, e.g. 0x64440120"}, p.value...);
    v(Field{"mode", "", 0, 0, "object that switches the substitute on, e.g. 0x64430108; none: it is always on",
            optional},
      p.mode...);
    v(Field{"mode_value", "-", 0, 4294967295.0, "what is written into mode", optional}, p.mode_value...);
  }
};

/// What the output `object` has: as the config states it, or as CiA 401 defines it for 16-bit analog outputs and CiA
/// 408 for the set point of a valve, which has its hold set point in a fault.
constexpr std::optional<CanSubstitute> substitute_of(CanObject object, const std::optional<CanSubstitute>& stated) {
  if (stated) return stated;
  const std::uint32_t sub = object.sub();
  if (object.index() == 0x6300) return CanSubstitute{{0x63140000u | sub << 8 | object.bits()}, {}, 1};
  if (object.index() != 0x6411) return {};
  return CanSubstitute{{0x64440020u | sub << 8}, {0x64430008u | sub << 8}, 1};
}

/// An object in which a device shows what an output is.
struct CanReadback {
  std::uint32_t pdo = 1;
  CanObject object;
  double tolerance_V = 0.05;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"pdo", "-", 1, 4, "process data object in which the device sends it"}, p.pdo...);
    v(Field{"object", "", 0, 0, "counts as the output does; default: the output's own object", optional}, p.object...);
    v(Field{"tolerance_V", "V", 1e-6, 100, "a longer deviation from what was sent is a fault", optional},
      p.tolerance_V...);
  }
};

/// A channel behind an object of a CANopen node: value = zero + scale * counts.
template <class Keys> struct CanChannelParameters {
  std::string node;
  std::uint32_t pdo = 1;
  CanObject object;
  bool is_signed = true;
  double scale = 1.0, zero = 0.0, lowest = 0.0, highest = 0.0, wrap_counts = 0.0;
  std::optional<CanSubstitute> substitute;
  std::optional<CanReadback> readback;
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
    if constexpr (std::is_same_v<Keys, PositionKeys>)
      v(Field{"wrap_counts", "-", 0, 4294967296.0,
              "after so many counts the encoder begins at 0 again, 2^25 or its 0x6002; 0: as its 0x6002 states",
              optional},
        p.wrap_counts...);
    if constexpr (std::is_same_v<Keys, VoltageKeys>) {
      v(Field{"substitute", "", 0, 0, "the device's objects for the output without master; default: those of 0x6411",
              optional},
        p.substitute...);
      v(Field{"readback", "", 0, 0, "checks the output by what the device shows of it", optional}, p.readback...);
    }
  }
};

/// What a DA/AD board measures a voltage against.
enum class ComediReference { ground, common, differential };
inline constexpr std::array<std::string_view, 3> comedi_reference_names{"ground", "common", "differential"};

/// Reading an output back: a board's analog input that is wired to it.
struct ComediReadback {
  std::uint32_t channel = 0;
  std::uint32_t range = 0;
  double tolerance_V = 0.05;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"channel", "-", 0, 65535, "analog input that the output is wired to"}, p.channel...);
    v(Field{"range", "-", 0, 255, "of that input, number in the board's list", optional}, p.range...);
    v(Field{"tolerance_V", "V", 1e-6, 100, "at the board's terminal; a longer deviation is a fault", optional},
      p.tolerance_V...);
  }
};

/// What every analog channel has: its scale at the terminal, its limits, and the readback of an output.
template <class Keys, class V, class... P> void visit_volts(V& v, P&... p) {
  constexpr auto optional = Presence::optional;
  v(Field{Keys::scale_V, Keys::unit, -1e12, 1e12, "of one volt; negative turns the direction round"}, p.scale...);
  v(Field{Keys::zero, Keys::unit, -1e12, 1e12, "value at 0 V (gauge sensors: the atmosphere)", optional}, p.zero...);
  v(Field{Keys::lowest, Keys::unit, -1e12, 1e12, "below it is no measurement; an output is held at it"}, p.lowest...);
  v(Field{Keys::highest, Keys::unit, -1e12, 1e12, "above it is no measurement; an output is held at it"}, p.highest...);
  if constexpr (std::is_same_v<Keys, VoltageKeys>)
    v(Field{"readback", "", 0, 0, "checks the output by an input that is wired to it", optional}, p.readback...);
}

/// A channel behind an analog input or output of a DA/AD board: value = zero + scale * volts at the board's terminal.
template <class Keys> struct ComediChannelParameters {
  std::uint32_t channel = 0, range = 0;
  ComediReference reference = ComediReference::ground;
  double scale = 1.0, zero = 0.0, lowest = 0.0, highest = 0.0;
  std::optional<ComediReadback> readback;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"channel", "-", 0, 65535, "number of the board's analog input, of its output for a command"}, p.channel...);
    v(Field{"range", "-", 0, 255, "number in the board's list of ranges", optional}, p.range...);
    v(Field{"reference", "", 0, 0, "what the voltage is against", optional, comedi_reference_names}, p.reference...);
    visit_volts<Keys>(v, p...);
  }
};

/// A channel behind a counter of a DA/AD board: value = zero + scale * counts since the start, past its end and on.
template <class Keys> struct ComediCounterParameters {
  std::uint32_t subdevice = 0, channel = 0;
  double scale = 1.0, zero = 0.0, lowest = 0.0, highest = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"subdevice", "-", 0, 255, "number of the board's counter subdevice"}, p.subdevice...);
    v(Field{"channel", "-", 0, 65535, "number of the counter", Presence::optional}, p.channel...);
    v(Field{Keys::scale, Keys::unit, -1e12, 1e12, "of one count; negative turns the direction round"}, p.scale...);
    v(Field{Keys::zero, Keys::unit, -1e12, 1e12, "value where the counter stands at the start", Presence::optional},
      p.zero...);
    v(Field{Keys::lowest, Keys::unit, -1e12, 1e12, "below it is no measurement"}, p.lowest...);
    v(Field{Keys::highest, Keys::unit, -1e12, 1e12, "above it is no measurement"}, p.highest...);
  }
};

/// What closes the valve of a board when this program is gone: a board keeps its outputs.
enum class BoardWatchdog { enable_line, guard, external, none, board };
inline constexpr std::array<std::string_view, 5> board_watchdog_names{"enable_line", "guard", "external", "none",
                                                                      "board"};
/// Of a board whose driver knows none of its own.
inline constexpr std::span<const std::string_view> outer_watchdog_names = std::span(board_watchdog_names).first(4);

/// A DA/AD board of the PC.
struct ComediParameters {
  std::string device = "/dev/comedi0";
  std::string calibration;
  std::optional<BoardWatchdog> watchdog;
  std::uint32_t watchdog_subdevice = 0;
  double watchdog_s = 0.1;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"device", "", 0, 0, "device file of the board", optional}, p.device...);
    v(Field{"calibration", "", 0, 0, "calibration file; default: where comedi_calibrate puts it", optional},
      p.calibration...);
    v(Field{"watchdog", "", 0, 0,
            "what closes the valve when this program is gone: the board's own, hal.gpio.enable, pneuservo guard, "
            "something outside, or nothing; must be stated where an output is on the board",
            optional, board_watchdog_names},
      p.watchdog...);
    v(Field{"watchdog_subdevice", "-", 0, 255, "of the board's own watchdog", optional}, p.watchdog_subdevice...);
    v(Field{"watchdog_s", "s", 0.02, 5.12, "the board's own acts after so long, in steps of 20 ms", optional},
      p.watchdog_s...);
  }
};

/// Reading an output back: an input channel that is wired to it.
struct IioReadback {
  std::string device, channel;
  double V_per_count = 0.0, tolerance_V = 0.05;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"device", "", 0, 0, "name of its device; default: the output's own", optional}, p.device...);
    v(Field{"channel", "", 0, 0, "input that the output is wired to, e.g. voltage3"}, p.channel...);
    v(Field{"V_per_count", "V", -1e6, 1e6, "for a driver that states no scale; 0: as the driver states", optional},
      p.V_per_count...);
    v(Field{"tolerance_V", "V", 1e-6, 100, "at the device's terminal; a longer deviation is a fault", optional},
      p.tolerance_V...);
  }
};

/// A channel of a device of the kernel's Industrial I/O: value = zero + scale * volts at its terminal, which are
/// (count + offset) * scale as its driver states both.
template <class Keys> struct IioChannelParameters {
  std::string device, channel;
  double V_per_count = 0.0, scale = 1.0, zero = 0.0, lowest = 0.0, highest = 0.0;
  std::optional<IioReadback> readback;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"device", "", 0, 0, "name, label or number of the device: ad7606-8, iio:device0"}, p.device...);
    v(Field{"channel", "", 0, 0, "its channel: voltage0, voltage1-voltage2; an output for a command"}, p.channel...);
    v(Field{"V_per_count", "V", -1e6, 1e6, "for a driver that states no scale; 0: as the driver states", optional},
      p.V_per_count...);
    visit_volts<Keys>(v, p...);
  }
};

/// Devices of the kernel's Industrial I/O.
struct IioParameters {
  std::optional<BoardWatchdog> watchdog;
  std::string trigger;
  double sample_timeout_s = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"watchdog", "", 0, 0,
            "what closes the valve when this program is gone: hal.gpio.enable, pneuservo guard, something outside, or "
            "nothing; must be stated where an output is on such a device",
            optional, outer_watchdog_names},
      p.watchdog...);
    v(Field{"trigger", "", 0, 0,
            "name of the trigger that samples all inputs, whose scans each tick waits for; default: each tick reads "
            "the inputs itself",
            optional},
      p.trigger...);
    v(Field{"sample_timeout_s", "s", 0, 10, "a scan that is missing for so long is a fault; 0: 2.5 periods", optional},
      p.sample_timeout_s...);
  }
};

/// What holds an input line where nothing drives it.
enum class GpioBias { as_is, none, pull_up, pull_down };
inline constexpr std::array<std::string_view, 4> gpio_bias_names{"as_is", "none", "pull_up", "pull_down"};

/// A digital line.
struct GpioLineParameters {
  std::string chip;
  std::string line;
  bool active_low = false;
  GpioBias bias = GpioBias::as_is;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"chip", "", 0, 0, "gpiochip0, its label or path; default: the chip that has a line of this name", optional},
      p.chip...);
    v(Field{"line", "", 0, 0, "name of the line, or its number on the chip"}, p.line...);
    v(Field{"active_low", "", 0, 0, "a low level is what the key's name says", optional}, p.active_low...);
    v(Field{"bias", "", 0, 0, "resistor of the chip at an input", optional, gpio_bias_names}, p.bias...);
  }
};

/// Digital lines by their meaning.
struct GpioParameters {
  std::optional<GpioLineParameters> emergency_stop, limit_low, limit_high, valve_power, switch_low, switch_high, enable;
  std::optional<BoardWatchdog> watchdog;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"emergency_stop", "", 0, 0, "input, active: pressed", optional}, p.emergency_stop...);
    v(Field{"limit_low", "", 0, 0, "input, active: the slider is at the switch at the end of negative positions",
            optional},
      p.limit_low...);
    v(Field{"limit_high", "", 0, 0, "input, active: the slider is at the switch at the end of positive positions",
            optional},
      p.limit_high...);
    v(Field{"valve_power", "", 0, 0, "input, active: the valve has its supply", optional}, p.valve_power...);
    v(Field{"switch_low", "", 0, 0, "input, active: the slider is below position.low_m", optional}, p.switch_low...);
    v(Field{"switch_high", "", 0, 0, "input, active: the slider is above position.high_m", optional}, p.switch_high...);
    v(Field{"enable", "", 0, 0, "output, active only while the axis is active", optional}, p.enable...);
    v(Field{"watchdog", "", 0, 0,
            "what closes the valves when this program is gone, as hal.comedi.watchdog; must be stated where a valve is "
            "on a line",
            optional, outer_watchdog_names},
      p.watchdog...);
  }
};

/// The program `pneuservo guard`, which writes the safe output when this program's sign of life stops.
struct GuardParameters {
  std::string name;
  double timeout_s = 0.05;
  std::optional<GpioLineParameters> enable;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"name", "", 0, 0, "by which run and guard find each other; default: the rig's name", optional}, p.name...);
    v(Field{"timeout_s", "s", 0.002, 10, "the guard acts when the loop has not written for so long", optional},
      p.timeout_s...);
    v(Field{"enable", "", 0, 0,
            "output of the guard's own, in series with hal.gpio.enable: active while the loop lives", optional},
      p.enable...);
  }
};

/// One channel of the rig: at most one source. Without any it is absent, and never silently simulated.
template <class Keys> struct ChannelParameters {
  bool simulated = false;
  std::optional<CanChannelParameters<Keys>> can;
  std::optional<ComediChannelParameters<Keys>> comedi;
  std::optional<ComediCounterParameters<Keys>> comedi_counter;
  std::optional<IioChannelParameters<Keys>> iio;
  std::optional<GpioLineParameters> gpio;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"simulated", "", 0, 0, "the simulated plant stands behind it", optional}, p.simulated...);
    v(Field{"can", "", 0, 0, "an object of a CANopen node", optional}, p.can...);
    v(Field{"comedi", "", 0, 0, "an analog channel of a DA/AD board", optional}, p.comedi...);
    if constexpr (std::is_same_v<Keys, PositionKeys>)
      v(Field{"comedi_counter", "", 0, 0, "a counter of a DA/AD board, for incremental encoders", optional},
        p.comedi_counter...);
    v(Field{"iio", "", 0, 0, "a channel of a device of the kernel's Industrial I/O", optional}, p.iio...);
    if constexpr (std::is_same_v<Keys, VoltageKeys>)
      v(Field{"gpio", "", 0, 0, "a digital line, active while the on/off valve's coil has power", optional}, p.gpio...);
  }
  int sources() const noexcept {
    return simulated + can.has_value() + comedi.has_value() + comedi_counter.has_value() + iio.has_value() +
           gpio.has_value();
  }
  bool is_absent() const noexcept { return sources() == 0; }
  bool is_real() const noexcept { return sources() > (simulated ? 1 : 0); }
  bool is_on_board() const noexcept { return comedi || comedi_counter; }
};

/// What stands behind each signal and each command.
struct HalChannels {
  ChannelParameters<PositionKeys> position;
  PerSignal<ChannelParameters<PressureKeys>> pressures;  ///< of the signals in Pa
  ChannelParameters<FlowKeys> supply_flow;
  ChannelParameters<VoltageKeys> u, u1, u2;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    for (const Signal signal : channel_signals) {
      const Field field{info(signal).name, "", 0, 0, info(signal).words, optional};
      if (is_in_pascal(signal)) v(field, p.pressures[signal]...);
      else if (signal == Signal::x) v(field, p.position...);
      else v(field, p.supply_flow...);
    }
    v(Field{"u", "", 0, 0, "command of the one valve of a cylinder or pressure rig", optional}, p.u...);
    v(Field{"u1", "", 0, 0, "command of a servo table's valve 1, or of the on/off valve that fills", optional},
      p.u1...);
    v(Field{"u2", "", 0, 0, "command of a servo table's valve 2, or of the on/off valve that empties", optional},
      p.u2...);
  }
  /// f(signal, parameters) for every measured channel, in the order of signal_table.
  template <class F> void for_each_input(F&& f) const {
    for (const Signal signal : channel_signals)
      if (is_in_pascal(signal)) f(signal, pressures[signal]);
      else if (signal == Signal::x) f(signal, position);
      else f(signal, supply_flow);
  }
  bool is_absent(Signal signal) const {
    bool is_absent = true;
    for_each_input([&](Signal other, const auto& source) {
      if (other == signal) is_absent = source.is_absent();
    });
    return is_absent;
  }
  /// f(key, valve, parameters) for every command; valve counts as in Command.
  template <class F> void for_each_command(F&& f) const {
    f(std::string_view("u"), std::size_t{0}, u);
    f(std::string_view("u1"), std::size_t{0}, u1);
    f(std::string_view("u2"), std::size_t{1}, u2);
  }
};

/// Devices and the channels behind them.
struct HalParameters {
  std::optional<CanBusParameters> can;
  std::optional<ComediParameters> comedi;
  std::optional<IioParameters> iio;
  std::optional<GpioParameters> gpio;
  std::optional<GuardParameters> guard;
  bool bench = false;
  HalChannels channels;
  /// Anything beside the simulated plant, which alone can be run in simulated time.
  bool has_devices() const noexcept { return can || comedi || iio || gpio; }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"can", "", 0, 0, "CANopen bus", Presence::optional}, p.can...);
    v(Field{"comedi", "", 0, 0, "DA/AD board", Presence::optional}, p.comedi...);
    v(Field{"iio", "", 0, 0, "devices of the kernel's Industrial I/O", Presence::optional}, p.iio...);
    v(Field{"gpio", "", 0, 0, "digital lines", Presence::optional}, p.gpio...);
    v(Field{"guard", "", 0, 0, "a second process that closes the valve when the loop dies", Presence::optional},
      p.guard...);
    v(Field{"bench", "", 0, 0, "true: no machine moves; a real valve may follow simulated sensors", Presence::optional},
      p.bench...);
    v(Field{"channels", "", 0, 0, "what stands behind each channel; one that is not named is absent"}, p.channels...);
  }
};

}  // namespace pneuservo
