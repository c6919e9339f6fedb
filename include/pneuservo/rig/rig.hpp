// A rig: everything a config says about one axis, as plain structs.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <pneuservo/control/parameters.hpp>
#include <pneuservo/control/reference.hpp>
#include <pneuservo/rig/axis.hpp>

namespace pneuservo {

struct SensorsParameters {
  PositionSensorParameters position;
  PressureSensorParameters port_pressure;
  PressureSensorParameters chamber_pressure;
  PressureSensorParameters supply_pressure;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"position", "", 0, 0, "encoder"}, p.position...);
    v(Field{"port_pressure", "", 0, 0, "at the valve ports"}, p.port_pressure...);
    v(Field{"chamber_pressure", "", 0, 0, "in the chambers", Presence::optional}, p.chamber_pressure...);
    v(Field{"supply_pressure", "", 0, 0, "at the supply", Presence::optional}, p.supply_pressure...);
  }
};

/// What the simulated plant is computed on; the estimator has its own, coarser grid.
struct SimulationParameters {
  double cells_per_m = 4.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"cells_per_m", "1/m", 0.1, 1000, "cells of the simulated lines", Presence::optional}, p.cells_per_m...);
  }
};

struct EstimatorSettings {
  double cells_per_m = 1.0;
  double flow_correction = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"cells_per_m", "1/m", 0.1, 100, "cells of the estimator's lines, at least one a line", Presence::optional},
      p.cells_per_m...);
    v(Field{"flow_correction", "-", 0, 0.5, "share of the valve's flow innovation that corrects the port pressure",
            Presence::optional},
      p.flow_correction...);
  }
};

/// Limits whose breach ends the motion in the safe output.
struct LimitParameters {
  double speed_mps = 5.0;
  double position_margin_m = 0.005;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"speed_mps", "m/s", 1e-3, 100, "measured speed above it is a fault", Presence::optional}, p.speed_mps...);
    v(Field{"position_margin_m", "m", 0, 1, "measured position further than this beyond an end stop is a fault",
            Presence::optional},
      p.position_margin_m...);
  }
};

/// What the valve is given when the loop ends or faults.
struct SafeOutputParameters {
  double command_V = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"command_V", "V", -1000, 1000, "command of the safe state; 0 closes a closed-centre valve (hold)",
            Presence::optional},
      p.command_V...);
  }
};

/// Time window over which the errors of a run are judged.
struct EvaluationParameters {
  double from_s = 0.0;
  double to_s = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"from_s", "s", 0, 1e6, "start of the window"}, p.from_s...);
    v(Field{"to_s", "s", 0, 1e6, "end of the window"}, p.to_s...);
  }
};

/// State at the start of a simulation; chamber 2 balances the piston unless its pressure is given.
struct InitialParameters {
  double position_m = 0.0;
  double pressure_1_Pa = 470000.0;
  std::optional<double> pressure_2_Pa;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"position_m", "m", -10, 10, "slider position", Presence::optional}, p.position_m...);
    v(Field{"pressure_1_Pa", "Pa", 1e4, 2e6, "chamber 1 and line 1, absolute", Presence::optional}, p.pressure_1_Pa...);
    v(Field{"pressure_2_Pa", "Pa", 1e4, 2e6, "chamber 2 and line 2; default: balances the piston", Presence::optional},
      p.pressure_2_Pa...);
  }
};

enum class RigKind { cylinder };
inline constexpr std::array<std::string_view, 1> rig_kind_names{"cylinder"};
inline constexpr std::array<std::string_view, 1> rig_format_names{"pneuservo-rig/1"};

/// The six measured channels of an axis, in the order of the recording's columns without their unit.
inline constexpr std::array<std::string_view, 6> channel_names{"x",          "p1_port",    "p2_port",
                                                               "p1_chamber", "p2_chamber", "p_supply"};

/// Everything one config file says. Keys, units, ranges, defaults and help stand in the visits.
struct Rig {
  std::string format{rig_format_names[0]};
  std::string name;
  RigKind kind = RigKind::cylinder;
  double period_s = 0.001;
  AxisParameters<double> axis;                          ///< air ... slider, effects
  std::array<SensorEffects<double>, 6> sensor_effects;  ///< effects `sensor_*:CHANNEL`, in the order of channel_names
  SensorsParameters sensors;
  PdForceParameters controller;
  ReferenceSpec reference;
  double duration_s = 0.0;
  std::optional<EvaluationParameters> evaluation;
  std::uint64_t seed = 1;
  InitialParameters initial;
  std::map<std::string, double> tolerances;  ///< relative standard deviation by config path
  SimulationParameters simulation;
  EstimatorSettings estimator;
  LimitParameters limits;
  SafeOutputParameters safe_output;

  /// The keys of a config in their order. The keys of a reference depend on its kind (src/config/reference_fields.hpp);
  /// effects `sensor_*:CHANNEL` stand under `effects` too, in `sensor_effects`.
  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto required = Presence::required, optional = Presence::optional;
    v(Field{"format", "", 0, 0, "version of this format", required, rig_format_names}, p.format...);
    v(Field{"name", "", 0, 0, "name of the rig, in recordings and reports"}, p.name...);
    v(Field{"rig", "", 0, 0, "kind of rig", required, rig_kind_names}, p.kind...);
    v(Field{"period_s", "s", 1e-5, 0.1, "period of the control loop"}, p.period_s...);
    AxisParameters<double>::visit(v, p.axis...);
    v(Field{"sensors", "", 0, 0, "resolution and noise of the sensors"}, p.sensors...);
    v(Field{"controller", "", 0, 0, "control law and its gains"}, p.controller...);
    v(Field{"reference", "", 0, 0, "what the slider shall do"}, p.reference...);
    v(Field{"duration_s", "s", 1e-3, 1e6, "of a run; default: 1 s more than a move, ramp and ten periods of a sine",
            optional},
      p.duration_s...);
    v(Field{"evaluation", "", 0, 0,
            "window of the errors; default: second half of a sine, a move until 0.6 s after its end", optional},
      p.evaluation...);
    v(Field{"seed", "", 0, 0, "of the simulated noise", optional}, p.seed...);
    v(Field{"initial", "", 0, 0, "state at the start of a simulation", optional}, p.initial...);
    v(Field{"tolerances", "", 0, 10, "one standard deviation, relative, of what the owner knows, by path", optional},
      p.tolerances...);
    v(Field{"simulation", "", 0, 0, "grid of the simulated lines", optional}, p.simulation...);
    v(Field{"estimator", "", 0, 0, "pipeline estimator", optional}, p.estimator...);
    v(Field{"limits", "", 0, 0, "a breach ends the motion in the safe output", optional}, p.limits...);
    v(Field{"safe_output", "", 0, 0, "what the valve is given when the loop ends or faults", optional},
      p.safe_output...);
  }
};

}  // namespace pneuservo
