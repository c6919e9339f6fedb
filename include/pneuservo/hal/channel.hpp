// What crosses the hardware boundary: measurements with age and validity per channel, and the command; SI throughout.
#pragma once
#include <array>
#include <cstdint>
#include <limits>

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
};

/// Everything measured at the start of a tick. Pressures are absolute [Pa], position [m] with 0 at mid-stroke.
struct Measurement {
  Channel position_m;
  Channel port_pressure_1_Pa, port_pressure_2_Pa;
  Channel chamber_pressure_1_Pa, chamber_pressure_2_Pa;
  Channel supply_pressure_Pa;
  std::uint32_t device_faults = 0;  ///< bits of DeviceFault
};

/// All channels in the order of the recording's columns: position, ports, chambers, supply.
inline std::array<Channel*, 6> channels_of(Measurement& m) noexcept {
  return {&m.position_m,
          &m.port_pressure_1_Pa,
          &m.port_pressure_2_Pa,
          &m.chamber_pressure_1_Pa,
          &m.chamber_pressure_2_Pa,
          &m.supply_pressure_Pa};
}

/// What is sent to the valves in a tick; a cylinder has the first alone, a servo table one a line.
struct Command {
  double valve_V = 0.0;
  double valve_2_V = 0.0;
};

/// The simulated plant's own state; for evaluation and recording only, never for a controller.
struct Truth {
  double position_m = std::numeric_limits<double>::quiet_NaN();
  double chamber_pressure_1_Pa = std::numeric_limits<double>::quiet_NaN();
  double chamber_pressure_2_Pa = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace pneuservo
