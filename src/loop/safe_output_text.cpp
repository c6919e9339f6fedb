// What is known of the safe output after a fault, in one sentence.
#include "loop/safe_output_text.hpp"

#include <fmt/format.h>

namespace pneuservo {

std::string safe_output_text(const SafeOutput& safe, const Rig& rig) {
  const double volts = safe_commands_V(rig)[0];
  const auto at = [&](std::int64_t tick) {
    return fmt::format("t = {:.6g} s", static_cast<double>(tick) * rig.period_s);
  };
  if (safe.is_simulated && safe.sent_tick >= 0)
    return fmt::format("the simulated valve has its safe output of {} V since {}", volts, at(safe.sent_tick));
  std::string text = safe.sent_tick >= 0
                         ? fmt::format("the safe output of {} V was sent at {}", volts, at(safe.sent_tick))
                         : fmt::format("the safe output of {} V could not be sent", volts);
  if (safe.confirmed_tick >= 0) text += " and read back at " + at(safe.confirmed_tick);
  else if (safe.is_read_back) text += ", NOT confirmed: it was not read back, look at the valve before you come near";
  else text += ", not confirmed: nothing reads it back (key readback of the output)";
  if (safe.stop_tick >= 0) text += "; the device was told to stop (NMT) at " + at(safe.stop_tick);
  if (safe.substitute_tick >= 0)
    text += fmt::format("; the device said at {} that it {} and gives its substitute output", at(safe.substitute_tick),
                        safe.stop_tick >= 0 ? "is stopped or misses us" : "misses us");
  return text;
}

}  // namespace pneuservo
