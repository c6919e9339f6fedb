// Parameters of the controllers and of the command's limits.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// Which pressures close the force loop.
enum class PressureSource { valve, chamber, estimated };
inline constexpr std::array<std::string_view, 3> pressure_source_names{"valve", "chamber", "estimated"};

enum class ControllerKind { pd_force, ppd2 };
inline constexpr std::array<std::string_view, 2> controller_kind_names{"pd_force", "ppd2"};

/// PD with force feedback (chapter 3; docs/physics/pd_force.md has the law).
struct PdForceParameters {
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
    v(Field{"pressure_source", "", 0, 0, "pressures that close the force loop", Presence::required,
            pressure_source_names},
      p.pressure_source...);
    visit_outer_loop(v, p...);
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

  /// The loop of position and velocity alone: all there is where the drive gives its force at once.
  template <class V, class... P> static void visit_outer_loop(V&& v, P&... p) {
    v(Field{"position_gain_N_per_m", "N/m", 0, 1e9, "K_p: force per position error"}, p.position_gain_N_per_m...);
    v(Field{"velocity_gain_Ns_per_m", "N s/m", 0, 1e9, "K_v: force per velocity error"}, p.velocity_gain_Ns_per_m...);
    v(Field{"velocity_filter_s", "s", 0, 1, "time constant of the velocity filter"}, p.velocity_filter_s...);
  }
};

/// What the observer of ppd2 runs on: the measured position, or its error against the reference.
enum class ObserverInput { measured, error };
inline constexpr std::array<std::string_view, 2> observer_input_names{"measured", "error"};

/// Feedforward of ppd2: inverse of the linear closed loop of that order, or of the nonlinear plant.
enum class FeedforwardKind { none, order_3, order_5, order_7, flatness };
inline constexpr std::array<std::string_view, 5> feedforward_kind_names{"none", "3", "5", "7", "flatness"};

/// What a finished move teaches the next one: the valve's effective area, or the flow that the feedback had to add.
enum class Learning { none, area, flow };
inline constexpr std::array<std::string_view, 3> learning_names{"none", "area", "flow"};

/// Position, velocity and acceleration feedback with observer and feedforward (chapter 2; docs/physics/ppd2.md).
struct Ppd2Parameters {
  double position_gain_V_per_m = 0.0;
  double velocity_gain_Vs_per_m = 0.0;
  double acceleration_gain_Vs2_per_m = 0.0;
  double integral_gain_V_per_m_s = 0.0;
  ObserverInput observer = ObserverInput::error;
  double observer_rad_per_s = 1000.0;
  std::optional<std::vector<double>> observer_gains;  ///< l1 [1/s], l2 [1/s2], l3 [1/s3]
  double command_delay_s = 0.0;
  FeedforwardKind feedforward = FeedforwardKind::none;
  double equilibrium_pressure_Pa = 110000.0;
  double mean_pressure_Pa = 140000.0;
  Learning learning = Learning::none;
  double command_rate_V_per_s = infinite;

  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"position_gain_V_per_m", "V/m", 0, 1e9, "K_p: command per position error"}, p.position_gain_V_per_m...);
    v(Field{"velocity_gain_Vs_per_m", "V s/m", 0, 1e9, "K_v: command per velocity error"}, p.velocity_gain_Vs_per_m...);
    v(Field{"acceleration_gain_Vs2_per_m", "V s2/m", 0, 1e9, "K_a: command per acceleration error"},
      p.acceleration_gain_Vs2_per_m...);
    v(Field{"integral_gain_V_per_m_s", "V/(m s)", 0, 1e9, "K_i: command per integral of the position error", optional},
      p.integral_gain_V_per_m_s...);
    v(Field{"observer", "", 0, 0, "what the observer of velocity and acceleration runs on", optional,
            observer_input_names},
      p.observer...);
    v(Field{"observer_rad_per_s", "rad/s", 1, 1e6, "w of the observer's gains 2 w, 2 w^2, w^3", optional},
      p.observer_rad_per_s...);
    v(Field{"observer_gains", "", 0, 1e18, "l1, l2, l3 in 1/s, 1/s2, 1/s3 instead of observer_rad_per_s", optional},
      p.observer_gains...);
    v(Field{"command_delay_s", "s", 0, 0.1, "delay from command to valve that the feedforward makes up for", optional},
      p.command_delay_s...);
    v(Field{"feedforward", "", 0, 0, "order of the linear inverse, or the inverse of the nonlinear plant", optional,
            feedforward_kind_names},
      p.feedforward...);
    v(Field{"equilibrium_pressure_Pa", "Pa", 1e4, 2e6, "P0 at which the linear models are taken", optional},
      p.equilibrium_pressure_Pa...);
    v(Field{"mean_pressure_Pa", "Pa", 1e4, 2e6, "mean of both chamber pressures, held", optional},
      p.mean_pressure_Pa...);
    v(Field{"learning", "", 0, 0, "what a finished move teaches the next one", optional, learning_names},
      p.learning...);
    v(Field{"command_rate_V_per_s", "V/s", 1e-6, infinite, "largest rate of the command; .inf: none", optional},
      p.command_rate_V_per_s...);
  }
};

/// The control law and its parameters; the keys follow the kind.
struct ControllerParameters {
  ControllerKind kind = ControllerKind::pd_force;
  PdForceParameters pd_force;
  Ppd2Parameters ppd2;

  template <class V, class First, class... Rest> static void visit(V&& v, First& first, Rest&... rest) {
    v(Field{"kind", "", 0, 0, "control law", Presence::required, controller_kind_names}, first.kind, rest.kind...);
    if (first.kind == ControllerKind::pd_force) PdForceParameters::visit(v, first.pd_force, rest.pd_force...);
    else Ppd2Parameters::visit(v, first.ppd2, rest.ppd2...);
  }
};

}  // namespace pneuservo
