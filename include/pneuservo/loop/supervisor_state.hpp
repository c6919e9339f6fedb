// States of the supervisor and what leads from one to another: the one table that loop, recording and documents share.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace pneuservo {

/// What the axis may do; recorded in every row (column `state`). The valves have the safe output in all but `active`.
enum class SupervisorState : std::uint32_t {
  unconfigured,  ///< nothing is known of the rig
  inactive,      ///< configured; waits until every channel that is needed has given a value
  active,        ///< the law commands the valves, the enable output is on
  fault,         ///< a cause is latched
  safe_stop,     ///< the run was ended or stopped
};
inline constexpr std::array<std::string_view, 5> supervisor_state_names{"unconfigured", "inactive", "active", "fault",
                                                                        "safe_stop"};

enum class SupervisorEvent : std::uint8_t { configured, inputs_ready, fault_found, stop_asked, rearmed };
inline constexpr std::array<std::string_view, 5> supervisor_event_names{"configured", "inputs ready", "fault found",
                                                                        "stop asked", "re-armed"};

/// The state after an event; an event that means nothing in a state leaves it. A stop does not hide a fault.
constexpr SupervisorState next_state(SupervisorState state, SupervisorEvent event) noexcept {
  using S = SupervisorState;
  if (event == SupervisorEvent::configured) return S::inactive;
  if (state == S::unconfigured) return state;
  switch (event) {
    case SupervisorEvent::inputs_ready: return state == S::inactive ? S::active : state;
    case SupervisorEvent::fault_found: return S::fault;
    case SupervisorEvent::stop_asked: return state == S::fault ? state : S::safe_stop;
    case SupervisorEvent::rearmed: return S::inactive;
    case SupervisorEvent::configured: break;
  }
  return state;
}

}  // namespace pneuservo
