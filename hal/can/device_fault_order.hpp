// Faults that the simulated device shows on command: "freeze:x@2.5+0.1".
#pragma once
#include <array>
#include <limits>
#include <string>
#include <string_view>

namespace pneuservo {

enum class DeviceFaultKind { emergency, off, reboot, no_heartbeat, drop, late, freeze, bias, spike, saturate, bus_off };
/// Names and what stands after the colon.
struct DeviceFaultName {
  std::string_view name;
  std::string_view target;  ///< "node", "channel" or nothing
  std::string_view meaning;
};
inline constexpr std::array<DeviceFaultName, 11> device_fault_names{{
    {"emergency", "node", "sends an emergency (VALUE: its code, 0x5000 unless stated)"},
    {"off", "node", "loses its supply; back with a boot-up after DURATION"},
    {"reboot", "node", "restarts"},
    {"no_heartbeat", "node", "stops its heartbeat"},
    {"drop", "node", "does not answer SYNC"},
    {"late", "node", "answers SYNC a period late"},
    {"freeze", "channel", "repeats one value"},
    {"bias", "channel", "adds VALUE"},
    {"spike", "channel", "adds VALUE to one sample"},
    {"saturate", "channel", "shows the end of its counts"},
    {"bus_off", "", "puts the error frame of a controller that went bus-off on the bus"},
}};

struct DeviceFaultOrder {
  DeviceFaultKind kind{};
  std::string target;
  double value = 0.0;
  bool has_value = false;
  double start_s = 0.0;
  double duration_s = std::numeric_limits<double>::infinity();
};

/// KIND[:TARGET[:VALUE]][@START_S[+DURATION_S]]; without @ it begins at `now_s`. Throws InputError.
DeviceFaultOrder parse_fault_order(const std::string& text, double now_s);
/// The table above as text for a help page.
std::string fault_order_help();

}  // namespace pneuservo
