// CiA 408, proportional valves: the states of the valve, the way to the one in which its spool follows the set point,
// and the simulated valve's side.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "can/canopen_node.hpp"
#include "can/sdo_client.hpp"

namespace pneuservo {

inline constexpr std::uint32_t valve_profile = 408;
inline constexpr std::uint16_t valve_control_word = 0x6040, valve_status_word = 0x6041, valve_mode = 0x6042,
                               valve_local = 0x604F, valve_set_point = 0x6300, valve_hold_set_point = 0x6314;

/// Bits of the status word; the control word's three lowest ask for the same, its fourth resets a fault.
enum ValveBit : std::uint32_t { valve_disabled = 1, valve_hold = 2, valve_active = 4, valve_ready = 8 };

/// Of a status word: "ACTIVE", "FAULT HOLD", ...
std::string_view valve_state_word(std::uint32_t status);

/// Brings a valve in the NMT state operational to ACTIVE, one state after the other, each seen in the status word; a
/// fault that stands is reset once. Returns what the user should know, or nothing. Throws SdoError or
/// std::runtime_error with one sentence.
std::string activate_valve(SdoClient& sdo);

/// The states of a simulated valve on its node.
class ValveStates {
 public:
  explicit ValveStates(CanopenNode& node);
  ValveStates(const ValveStates&) = delete;
  ValveStates& operator=(const ValveStates&) = delete;

  void power_on();
  /// The spool follows the set point; else it has the hold set point. Outside the NMT state operational a valve that
  /// followed falls into FAULT HOLD.
  bool follows_set_point();
  std::uint32_t status() const { return node_.dictionary().number(valve_status_word, 0); }
  void set_status(std::uint32_t status) { node_.dictionary().set_number(valve_status_word, 0, status); }

 private:
  void control(std::uint32_t word);

  CanopenNode& node_;
  std::uint32_t last_control_ = 0;
};

}  // namespace pneuservo
