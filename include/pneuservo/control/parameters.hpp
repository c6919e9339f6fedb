// Parameters of the controllers and of the command's limits.
#pragma once
#include <array>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// Which pressures close the force loop.
enum class PressureSource { valve, chamber, estimated };
inline constexpr std::array<std::string_view, 3> pressure_source_names{"valve", "chamber", "estimated"};

enum class ControllerKind { pd_force };
inline constexpr std::array<std::string_view, 1> controller_kind_names{"pd_force"};

/// PD with force feedback (chapter 3; docs/physics/pd_force.md has the law).
struct PdForceParameters {
  ControllerKind kind = ControllerKind::pd_force;
  PressureSource pressure_source = PressureSource::estimated;
  double position_gain_N_per_m = 0.0;
  double velocity_gain_Ns_per_m = 0.0;
  double velocity_filter_s = 0.002;
  double force_gain_V_per_N = 0.0;
  double force_integral_V_per_Ns = 0.0;
  bool flow_feedforward = false;
  double feedforward_lead_s = 0.0;
  double command_rate_V_per_s = infinite;

  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"kind", "", 0, 0, "control law", Presence::required, controller_kind_names}, p.kind...);
    v(Field{"pressure_source", "", 0, 0, "pressures that close the force loop", Presence::required,
            pressure_source_names},
      p.pressure_source...);
    v(Field{"position_gain_N_per_m", "N/m", 0, 1e9, "K_p: force per position error"}, p.position_gain_N_per_m...);
    v(Field{"velocity_gain_Ns_per_m", "N s/m", 0, 1e9, "K_v: force per velocity error"}, p.velocity_gain_Ns_per_m...);
    v(Field{"velocity_filter_s", "s", 0, 1, "time constant of the velocity filter"}, p.velocity_filter_s...);
    v(Field{"force_gain_V_per_N", "V/N", 0, 1e6, "K_f: command per force error"}, p.force_gain_V_per_N...);
    v(Field{"force_integral_V_per_Ns", "V/(N s)", 0, 1e6, "K_i: command per integral of force error", optional},
      p.force_integral_V_per_Ns...);
    v(Field{"flow_feedforward", "", 0, 1, "add the command that the reference's flow needs", optional},
      p.flow_feedforward...);
    v(Field{"feedforward_lead_s", "s", 0, 1, "the feedforward looks this far ahead", optional},
      p.feedforward_lead_s...);
    v(Field{"command_rate_V_per_s", "V/s", 1e-6, infinite, "largest rate of the command; .inf: none", optional},
      p.command_rate_V_per_s...);
  }
};

}  // namespace pneuservo
