// States of a CiA 408 valve, asked for by SDO, and simulated.
#include "can/fluid_valve.hpp"

#include <chrono>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

namespace pneuservo {

namespace {
constexpr std::uint32_t state_bits = valve_disabled | valve_hold | valve_active | valve_ready;
constexpr std::uint32_t reset_fault = valve_ready;
/// A valve takes a state within its cycle, some milliseconds.
constexpr int most_looks = 100;
constexpr std::chrono::milliseconds look_every{1};

[[noreturn]] void refuse(const SdoClient& sdo, const std::string& what) {
  throw std::runtime_error(fmt::format("node {} ({}): {}", sdo.name(), sdo.node(), what));
}

/// The status word's state after these bits were seen, or after the last look.
std::uint32_t wait_for(SdoClient& sdo, std::uint32_t bits) {
  std::uint32_t status = 0;
  for (int look = 0; look < most_looks; ++look) {
    status = sdo.read_number(valve_status_word, 0) & state_bits;
    if (status == bits) break;
    std::this_thread::sleep_for(look_every);
  }
  return status;
}
}  // namespace

std::string_view valve_state_word(std::uint32_t status) {
  switch (status & state_bits) {
    case 0: return "FAULT INIT or not ready";
    case valve_disabled: return "FAULT DISABLED";
    case valve_disabled | valve_hold: return "FAULT HOLD";
    case valve_disabled | valve_hold | valve_active: return "FAULT REACTION";
    case valve_ready: return "INIT";
    case valve_ready | valve_disabled: return "DISABLED";
    case valve_ready | valve_disabled | valve_hold: return "HOLD";
    case state_bits: return "ACTIVE";
    default: return "no state of CiA 408";
  }
}

std::string activate_valve(SdoClient& sdo) {
  if (sdo.find_number(valve_local, 0).value_or(0) != 0)
    refuse(sdo, "its 0x604f is 1, it is operated at the valve itself: switch it to the bus before this axis moves");
  if (sdo.find_number(valve_mode, 0).value_or(1) != 1) sdo.write_checked(valve_mode, 0, 1);  // set point from the bus
  std::string note;
  const std::uint32_t before = sdo.read_number(valve_status_word, 0);
  if ((before & valve_ready) == 0) {
    sdo.write(valve_control_word, 0, 0, 2);
    sdo.write(valve_control_word, 0, reset_fault, 2);
    const std::uint32_t after = wait_for(sdo, valve_ready);
    if ((after & valve_ready) == 0)
      refuse(sdo,
             fmt::format("the valve is in the state {} (0x6041 is 0x{:04x}) also after its fault was reset: mend the "
                         "cause before this axis moves",
                         valve_state_word(after), after));
    note = fmt::format("the valve was in the state {} and was reset", valve_state_word(before));
  }
  std::uint32_t word = 0;
  for (const std::uint32_t bit : {valve_disabled, valve_hold, valve_active}) {
    word |= bit;
    sdo.write(valve_control_word, 0, word, 2);
    const std::uint32_t status = wait_for(sdo, word | valve_ready);
    if (status != (word | valve_ready))
      refuse(sdo,
             fmt::format(
                 "the valve is in the state {} (0x6041 is 0x{:04x}) after control word 0x{:04x}, expected {}: does it "
                 "have its supply and its enable input?",
                 valve_state_word(status), status, word, valve_state_word(word | valve_ready)));
  }
  return note;
}

ValveStates::ValveStates(CanopenNode& node) : node_(node) {
  ObjectDictionary& dictionary = node.dictionary();
  dictionary.add(valve_control_word, 0, {.bits = 16, .can_write = true, .can_map = true});
  dictionary.add(valve_status_word, 0, {.bits = 16, .can_write = false, .can_map = true});
  dictionary.add_number(valve_mode, 0, 8, 1, true);
  dictionary.add_number(valve_local, 0, 8, 0, false);
  node.accept_application = [this](std::uint16_t index, std::uint8_t, std::uint32_t value) {
    if (index == valve_control_word) control(value);
    return SdoAbort::none;
  };
  power_on();
}

void ValveStates::power_on() {
  last_control_ = 0;
  set_status(valve_ready);
}

void ValveStates::control(std::uint32_t word) {
  const bool resets = (word & reset_fault) != 0 && (last_control_ & reset_fault) == 0;
  last_control_ = word;
  if ((status() & valve_ready) == 0) {
    if (resets) set_status(valve_ready);
    return;
  }
  // A state needs all below it.
  std::uint32_t reached = 0;
  for (const std::uint32_t bit : {valve_disabled, valve_hold, valve_active}) {
    if ((word & bit) == 0) break;
    reached |= bit;
  }
  set_status(valve_ready | reached);
}

bool ValveStates::follows_set_point() {
  const bool followed = (status() & state_bits) == state_bits;
  if (followed && node_.state() != NmtState::operational) set_status(valve_disabled | valve_hold);
  return followed && node_.state() == NmtState::operational;
}

}  // namespace pneuservo
