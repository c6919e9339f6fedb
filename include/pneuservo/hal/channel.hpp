// What crosses the hardware boundary: measurements with age and validity per channel, and the command; SI throughout.
#pragma once
#include <array>
#include <cstdint>
#include <limits>

#include <pneuservo/core/signal.hpp>

namespace pneuservo {

/// Where a channel's value comes from; written into every recording.
enum class Origin : std::uint8_t { absent, real, simulated, replayed };

/// One measured value. `valid` is what the backend knows (fresh, in range of the converter); plausibility against the
/// rig is judged by the loop. `age_s` counts from the sampling instant to the start of the tick.
struct Channel {
  double value = std::numeric_limits<double>::quiet_NaN();
  double age_s = 0.0;
  bool valid = false;
  Origin origin = Origin::absent;
};

/// What devices say of themselves; each bit ends the motion (fault.hpp has a fault of the same name).
enum DeviceFault : std::uint32_t {
  device_bus_off = 1u << 0,
  device_link_down = 1u << 1,
  device_node_lost = 1u << 2,
  device_emergency = 1u << 3,
  device_double_answer = 1u << 4,  ///< more than one answer a cycle: two devices with one number, or two masters
  device_output_unconfirmed = 1u << 5,  ///< the read-back output is not the one that was sent
  device_guard_lost = 1u << 6,  ///< what watches this program from outside does not answer
};

/// A digital line. Polarity is the backend's: `on` is what the line's name says, whatever the wire carries. A line that
/// the config names and that cannot be read is `unreadable`, never the last state.
enum class LineState : std::uint8_t { absent, off, on, unreadable };

/// One digital input with the age of its last edge as the kernel stamped it; NaN: none seen or no stamp.
struct DigitalLine {
  LineState state = LineState::absent;
  double edge_age_s = std::numeric_limits<double>::quiet_NaN();
};

/// Digital inputs at the start of a tick; fault.hpp says what ends the motion.
struct DigitalInputs {
  DigitalLine emergency_stop;  ///< on: pressed
  DigitalLine limit_low, limit_high;  ///< on: the slider is at the switch at the end of negative, positive position
  DigitalLine valve_power;  ///< on: the valve has its supply
  DigitalLine switch_low, switch_high;  ///< on: the slider is beyond the switch along its way; no fault rests on it
};

/// Both switches along the way as one number of a recording, four states of a line each.
constexpr std::uint32_t switch_bits(const DigitalInputs& digital) noexcept {
  return static_cast<std::uint32_t>(digital.switch_low.state) | static_cast<std::uint32_t>(digital.switch_high.state)
                                                                    << 2;
}
constexpr void set_switches(DigitalInputs& digital, std::uint32_t bits) noexcept {
  digital.switch_low.state = static_cast<LineState>(bits & 3u);
  digital.switch_high.state = static_cast<LineState>(bits >> 2 & 3u);
}

/// Everything measured at the start of a tick, in the units of signal_table.
struct Measurement {
  PerSignal<Channel> channel{};
  std::uint32_t device_faults = 0;  ///< bits of DeviceFault
  DigitalInputs digital;
};

/// What is sent to the valves in a tick; a cylinder has the first alone, a servo table one a line.
struct Command {
  double valve_V = 0.0;
  double valve_2_V = 0.0;
  bool enable = false;  ///< the enable output: on only while the axis is active
  bool ended = false;  ///< a fault or the end of the run: the safe output stays, signs of life stop until activate()
};

/// All digital inputs, in the order of their declaration.
inline constexpr std::array<const char*, 6> digital_line_names{"emergency_stop", "limit_low",  "limit_high",
                                                               "valve_power",    "switch_low", "switch_high"};
inline constexpr std::size_t digital_line_count = digital_line_names.size();
inline std::array<DigitalLine*, digital_line_count> lines_of(DigitalInputs& d) noexcept {
  return {&d.emergency_stop, &d.limit_low, &d.limit_high, &d.valve_power, &d.switch_low, &d.switch_high};
}

/// Where everything of a run comes from and goes to.
struct Origins {
  PerSignal<Origin> channels{};
  std::array<Origin, digital_line_count> lines{};  ///< in the order of lines_of
  Origin command = Origin::absent;  ///< whose valve is told
};

/// The simulated plant's own state; for evaluation and recording only, never for a controller.
struct Truth {
  double x_m = std::numeric_limits<double>::quiet_NaN();
  double p1_chamber_Pa = std::numeric_limits<double>::quiet_NaN(), p2_chamber_Pa = p1_chamber_Pa;
};

}  // namespace pneuservo
