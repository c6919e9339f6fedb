// A rig: everything a config says about one axis, as plain structs.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/control/parameters.hpp>
#include <pneuservo/control/pressure_reference.hpp>
#include <pneuservo/control/reference.hpp>
#include <pneuservo/core/signal.hpp>
#include <pneuservo/elements/cushion.hpp>
#include <pneuservo/elements/elastic_volume.hpp>
#include <pneuservo/elements/valves.hpp>
#include <pneuservo/elements/vessel_effects.hpp>
#include <pneuservo/record/import_parameters.hpp>
#include <pneuservo/rig/axis.hpp>
#include <pneuservo/rig/hal_parameters.hpp>
#include <pneuservo/rig/limit_parameters.hpp>
#include <pneuservo/rig/position_parameters.hpp>
#include <pneuservo/rig/serve_parameters.hpp>
#include <pneuservo/rig/switched_parameters.hpp>

namespace pneuservo {

/// Step of the readings of a sensor, its white noise (rms) and the most that it shows to both sides, in the unit of its
/// signal.
struct SensorResolution {
  double quantum = 0.0, noise = 0.0, range = infinite;
  double rms() const noexcept { return rms_with_quantum(noise, quantum); }
};

struct SensorsParameters {
  PositionSensorParameters position;
  PressureSensorParameters port_pressure;
  PressureSensorParameters chamber_pressure;
  PressureSensorParameters supply_pressure;
  FlowSensorParameters supply_flow;
  DifferentialSensorParameters differential_pressure;
  ForceSensorParameters force;  ///< of a driven axis, which has position and force alone
  /// Of the sensor of a signal, in the signal's unit.
  SensorResolution resolution(Signal signal) const noexcept {
    switch (info(signal).sensor) {
      case SensorKind::position: return {position.quantum_m, position.noise_m};
      case SensorKind::port_pressure: return {port_pressure.quantum_Pa, port_pressure.noise_Pa};
      case SensorKind::chamber_pressure: return {chamber_pressure.quantum_Pa, chamber_pressure.noise_Pa};
      case SensorKind::supply_pressure: return {supply_pressure.quantum_Pa, supply_pressure.noise_Pa};
      case SensorKind::supply_flow: return {supply_flow.quantum_kgps, supply_flow.noise_kgps};
      case SensorKind::differential_pressure:
        return {differential_pressure.quantum_Pa, differential_pressure.noise_Pa, differential_pressure.range_Pa};
      case SensorKind::force: break;
    }
    return {force.quantum_N, force.noise_N};
  }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"position", "", 0, 0, "encoder"}, p.position...);
    v(Field{"port_pressure", "", 0, 0, "at the valve ports"}, p.port_pressure...);
    v(Field{"chamber_pressure", "", 0, 0, "in the chambers", Presence::optional}, p.chamber_pressure...);
    v(Field{"supply_pressure", "", 0, 0, "at the supply", Presence::optional}, p.supply_pressure...);
    v(Field{"supply_flow", "", 0, 0, "flow meter between supply and valves", Presence::optional}, p.supply_flow...);
    v(Field{"differential_pressure", "", 0, 0, "over the lines, port less chamber", Presence::optional},
      p.differential_pressure...);
  }
};

/// What the simulated plant is computed on; the estimator has its own, coarser grid.
struct SimulationParameters {
  double cells_per_m = 4.0;
  std::uint32_t input_age_periods = 0;
  double valve_drive_period_s = 0.0;
  double spool_quantum_m = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"cells_per_m", "1/m", 0.1, 1000, "cells of the simulated lines", Presence::optional}, p.cells_per_m...);
    v(Field{"input_age_periods", "-", 0, 1, "1: inputs are those of the tick before, as over a bus",
            Presence::optional},
      p.input_age_periods...);
    v(Field{"valve_drive_period_s", "s", 0, 1e-3,
            "of the simulated valves' own loop, with spool and coil (spool_loop.md), such as 1e-4; 0: a lag",
            Presence::optional},
      p.valve_drive_period_s...);
    v(Field{"spool_quantum_m", "m", 0, 1e-5, "of that loop's sensor", Presence::optional}, p.spool_quantum_m...);
  }
};

struct EstimatorSettings {
  double cells_per_m = 1.0;
  double flow_correction = 0.0;
  bool frequency_dependent_losses = false;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"cells_per_m", "1/m", 0.1, 100, "cells of the estimator's lines, at least one a line", Presence::optional},
      p.cells_per_m...);
    v(Field{"flow_correction", "-", 0, 0.5, "share of the valve's flow innovation that corrects the port pressure",
            Presence::optional},
      p.flow_correction...);
    v(Field{"frequency_dependent_losses", "", 0, 0, "the known effect of this name counts in the estimator, too",
            Presence::optional},
      p.frequency_dependent_losses...);
  }
};

/// What the valves do when the loop ends or faults.
enum class SafeAction {
  hold,  ///< command_V, the command that closes the valve: the air stays in the chambers
  vent,  ///< to the exhaust; only three-port valves can
  centre,  ///< 0 V: the spool's own centre, whatever the valve does there
};
inline constexpr std::array<std::string_view, 3> safe_action_names{"hold", "vent", "centre"};

struct SafeOutputParameters {
  SafeAction action = SafeAction::hold;
  double command_V = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"action", "", 0, 0, "hold: command_V; vent: to the exhaust, by three-port valves; centre: 0 V",
            Presence::optional, safe_action_names},
      p.action...);
    v(Field{"command_V", "V", -1000, 1000, "command of hold; 0 closes a closed-centre valve", Presence::optional},
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

/// The drive of a driven axis: its force is what the controller asks for, within its limit.
struct DriveParameters {
  double force_max_N = 0.0;
  double force_per_volt_N_per_V = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"force_max_N", "N", 1e-6, 1e9, "largest drive force"}, p.force_max_N...);
    v(Field{"force_per_volt_N_per_V", "N/V", 0, 1e9, "force of a command in V; 0: the command is the force",
            Presence::optional},
      p.force_per_volt_N_per_V...);
  }
};

/// A cylinder with a five-port valve, a table with two three-port valves, an axis whose drive force is known; and two
/// that are recorded and diagnosed, not run: a vessel behind an on/off valve, a cylinder that an on/off valve sends
/// from end to end; and a volume behind a hose whose pressure a three-port valve controls.
enum class RigKind { cylinder, servo_table, driven_axis, vessel, switched_cylinder, pressure };
/// What a kind of rig is. `valves`: proportional valves that commands drive, one for both sides or one a side.
struct RigKindInfo {
  std::string_view name;
  std::size_t valves;
  bool has_controller;  ///< follows a reference
  bool has_seals;  ///< that rub; an air bearing has none
  bool has_slider = true;
};
/// In the order of RigKind.
inline constexpr std::array rig_kind_table{
    RigKindInfo{"cylinder", 1, true, true},           RigKindInfo{"servo_table", 2, true, false},
    RigKindInfo{"driven_axis", 0, true, true},        RigKindInfo{"vessel", 0, false, false, false},
    RigKindInfo{"switched_cylinder", 0, false, true}, RigKindInfo{"pressure", 1, true, false, false},
};
inline constexpr auto rig_kind_names = [] {
  std::array<std::string_view, rig_kind_table.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = rig_kind_table[i].name;
  return names;
}();
constexpr const RigKindInfo& info(RigKind kind) noexcept { return rig_kind_table[static_cast<std::size_t>(kind)]; }
inline constexpr std::array<std::string_view, 1> rig_format_names{"pneuservo-rig/1"};

/// Whether a law runs that kind of rig: it drives as many valves, or gives the force of a driven axis.
constexpr bool runs(ControllerKind law, RigKind rig) {
  return with_law(law, [kind = info(rig), rig]<class L>(LawTag<L>) {
    if (ControlsPressure<L> || rig == RigKind::pressure) return ControlsPressure<L> && rig == RigKind::pressure;
    return kind.valves > 0 ? L::valves == kind.valves : kind.has_controller && HasOuterLoop<L>;
  });
}
/// The laws that run that kind of rig, in the order of the list.
inline std::vector<ControllerKind> laws_of(RigKind rig) {
  std::vector<ControllerKind> out;
  for (std::size_t i = 0; i < law_count; ++i)
    if (runs(static_cast<ControllerKind>(i), rig)) out.push_back(static_cast<ControllerKind>(i));
  return out;
}

/// Everything one config file says. Keys, units, ranges, defaults and help stand in the visits.
struct Rig {
  std::string format{rig_format_names[0]};
  std::string name;
  RigKind kind = RigKind::cylinder;
  double period_s = 0.001;
  AxisParameters<double> axis;  ///< air ... slider, effects
  PerSignal<SensorEffects<double>> sensor_effects;  ///< effects `sensor_*:CHANNEL`
  SensorsParameters sensors;
  PositionParameters position;
  ControllerParameters controller;
  DriveParameters drive;  ///< of a driven axis
  ElasticVolumeParameters<double> volume;  ///< of a pressure rig, at the end of line_1
  PressureReferenceParameters pressure_reference;  ///< of a pressure rig
  VesselParameters vessel;
  OnOffValveParameters on_off_valve;  ///< of a vessel
  std::optional<LineParameters<double>> line;  ///< between on/off valve and vessel
  VesselEffects<double> vessel_effects;
  ThrottleParameters throttle_1, throttle_2;  ///< of a switched cylinder
  CushionParameters<double> cushion_1, cushion_2;
  double cylinder_critical_ratio = 0.35;  ///< b of its valve and throttles
  ProgramParameters program;
  ModelErrorParameters model_error;
  ReferenceSpec reference;
  double duration_s = 0.0;
  std::optional<EvaluationParameters> evaluation;
  std::uint64_t seed = 1;
  InitialParameters initial;
  std::map<std::string, double> tolerances;  ///< relative standard deviation by config path
  std::map<std::string, double> deviations;  ///< of the simulated plant from the config, relative, by config path
  /// What the simulated machine has in place of the effects of the same names: values by config path.
  std::map<std::string, double> concealed;
  SimulationParameters simulation;
  EstimatorSettings estimator;
  LimitParameters limits;
  SafeOutputParameters safe_output;
  std::map<std::string, double> zeros;  ///< added to what a device gives, by channel name, in its SI unit
  std::optional<HalParameters> hal;
  std::optional<ServeParameters> serve;  ///< of an axis that is commanded; not stated: its defaults
  std::optional<ImportParameters> imported;  ///< how recordings of a foreign format are read

  /// Valves with an output each: two of a servo table, two that are on or off.
  bool has_two_outputs() const noexcept { return valves() == 2 || axis.valve.on_off.has_value(); }
  /// Proportional valves that commands drive.
  std::size_t valves() const noexcept { return info(kind).valves; }
  /// Whether it is a pneumatic servo axis: proportional valves, lines and chambers.
  bool is_pneumatic() const noexcept { return valves() > 0 && info(kind).has_slider; }
  bool controls_pressure() const noexcept { return kind == RigKind::pressure; }
  /// Whether a controller leads it along a reference.
  bool has_controller() const noexcept { return info(kind).has_controller; }
  /// Whether pressures act on its slider.
  bool has_pistons() const noexcept {
    return info(kind).has_slider && (axis.cylinder.area_1_m2 > 0.0 || axis.cylinder.area_2_m2 > 0.0);
  }
  /// Whether its recordings may hold this signal.
  bool has_sensor(Signal signal) const noexcept {
    switch (kind) {
      case RigKind::driven_axis:
        return signal == Signal::x || signal == Signal::F ||
               (signal == Signal::p1_chamber && axis.cylinder.area_1_m2 > 0.0) ||
               (signal == Signal::p2_chamber && axis.cylinder.area_2_m2 > 0.0);
      case RigKind::vessel: return signal == Signal::p1_chamber || (signal == Signal::p1_port && line.has_value());
      case RigKind::switched_cylinder: return signal == Signal::x;
      case RigKind::pressure:
        return signal == Signal::p1_port || signal == Signal::p1_chamber || signal == Signal::p_supply;
      default: return is_difference(signal) ? sensors.differential_pressure.range_Pa > 0.0 : signal != Signal::F;
    }
  }

  /// The keys of a config in their order; sections follow the kind of rig. The keys of a reference depend on its kind
  /// (src/config/reference_fields.hpp); effects `sensor_*:CHANNEL` stand under `effects` too, in `sensor_effects`.
  template <class V, class First, class... Rest> static void visit(V&& v, First& first, Rest&... rest) {
    visit_head(v, first, rest...);
    if (first.is_pneumatic()) visit_pneumatic(v, first, rest...);
    else if (first.kind == RigKind::vessel) visit_vessel(v, first, rest...);
    else if (first.kind == RigKind::switched_cylinder) visit_switched_cylinder(v, first, rest...);
    else if (first.controls_pressure()) return visit_pressure(v, first, rest...);
    else visit_driven(v, first, rest...);
    if (first.has_controller()) visit_run(v, first, rest...);
    else visit_recorded(v, first, rest...);
    if (first.is_pneumatic()) visit_plant(v, first, rest...);
    const auto optional = Presence::optional;
    v(Field{"import", "", 0, 0, "recordings of a foreign format", optional}, first.imported, rest.imported...);
  }

 private:
  /// A section whose values stand where every rig has them: Keys{}(visitor, rigs...) visits them.
  template <class Keys, class R> struct Section {
    R& rig;
    template <class V, class... P> static void visit(V&& v, P&... p) { Keys{}(v, p.rig...); }
  };
  template <class V, class Keys, class... P> static void visit_section(V& v, const Field& field, Keys, P&... p) {
    [&](auto... sections) { v(field, sections...); }(Section<Keys, P>{p}...);
  }

  static constexpr Field sensors_field() { return {"sensors", "", 0, 0, "resolution and noise of the sensors"}; }
  template <class V, class... P> static void visit_head(V& v, P&... p) {
    constexpr auto required = Presence::required;
    v(Field{"format", "", 0, 0, "version of this format", required, rig_format_names}, p.format...);
    v(Field{"name", "", 0, 0, "name of the rig, in recordings and reports"}, p.name...);
    v(Field{"rig", "", 0, 0, "kind of rig", required, rig_kind_names}, p.kind...);
    v(Field{"period_s", "s", 1e-5, 0.1, "period of the control loop"}, p.period_s...);
  }
  template <class V, class... P> static void visit_pneumatic(V& v, P&... p) {
    AxisParameters<double>::visit(v, p.axis...);
    v(sensors_field(), p.sensors...);
    v(Field{"position", "", 0, 0, "where the position comes from; not stated: from an encoder", Presence::optional},
      p.position...);
    v(Field{"controller", "", 0, 0, "control law and its gains"}, p.controller...);
    v(Field{"initial", "", 0, 0, "state at the start of a simulation", Presence::optional}, p.initial...);
  }
  template <class V, class... P> static void visit_driven(V& v, P&... p) {
    constexpr auto optional = Presence::optional;
    visit_section(
        v, Field{"slider", "", 0, 0, "moving mass and its drive"},
        [](auto& keys, auto&... rig) {
          SliderParameters<double>::visit(keys, rig.axis.slider...);
          keys(Field{"stroke_m", "m", 1e-3, 100, "from end stop to end stop"}, rig.axis.cylinder.stroke_m...);
          DriveParameters::visit(keys, rig.drive...);
        },
        p...);
    visit_section(
        v, Field{"cylinder", "", 0, 0, "pistons that measured pressures push", optional},
        [](auto& keys, auto&... rig) {
          keys(Field{"area_1_m2", "m2", 0, 1, "effective piston area that p1_chamber_Pa pushes to positive x",
                     Presence::optional},
               rig.axis.cylinder.area_1_m2...);
          keys(Field{"area_2_m2", "m2", 0, 1, "effective piston area that p2_chamber_Pa pushes to negative x",
                     Presence::optional},
               rig.axis.cylinder.area_2_m2...);
        },
        p...);
    v(Field{"effects", "", 0, 0, "known physics beside the nominal model, by name", optional}, p.axis.effects...);
    visit_section(
        v, sensors_field(),
        [](auto& keys, auto&... rig) {
          keys(Field{"position", "", 0, 0, "encoder"}, rig.sensors.position...);
          keys(Field{"force", "", 0, 0, "drive force, measured or commanded"}, rig.sensors.force...);
          keys(Field{"chamber_pressure", "", 0, 0, "where pressures act on the slider", Presence::optional},
               rig.sensors.chamber_pressure...);
        },
        p...);
    visit_section(
        v, Field{"controller", "", 0, 0, "control law and its gains"},
        [](auto& keys, auto&... rig) { ControllerParameters::visit_outer_loop(keys, rig.controller...); }, p...);
    visit_section(
        v, Field{"initial", "", 0, 0, "state at the start of a simulation", optional},
        [](auto& keys, auto&... rig) {
          keys(Field{"position_m", "m", -100, 100, "slider position", Presence::optional}, rig.initial.position_m...);
        },
        p...);
  }
  template <class V, class... P> static void visit_vessel(V& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"air", "", 0, 0, "gas and surroundings", optional}, p.axis.air...);
    visit_section(
        v, Field{"supply", "", 0, 0, "pressure supply", optional},
        [](auto& keys, auto&... rig) {
          keys(Field{"pressure_Pa", "Pa", 0, 2e6, "supply pressure, absolute, where a recording has no p_supply_Pa"},
               rig.axis.supply.pressure_Pa...);
        },
        p...);
    v(Field{"valve", "", 0, 0, "on/off valve: command 1 to supply, -1 to exhaust, 0 closed", optional},
      p.on_off_valve...);
    v(Field{"line", "", 0, 0, "pipeline from valve to vessel", optional}, p.line...);
    v(Field{"vessel", "", 0, 0, "rigid volume"}, p.vessel...);
    v(Field{"effects", "", 0, 0, "known physics beside the nominal model, by name", optional}, p.vessel_effects...);
    visit_section(
        v, sensors_field(),
        [](auto& keys, auto&... rig) {
          keys(Field{"pressure", "", 0, 0, "in the vessel, and at the valve's port"}, rig.sensors.chamber_pressure...);
        },
        p...);
  }
  template <class V, class... P> static void visit_switched_cylinder(V& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"air", "", 0, 0, "gas and surroundings", optional}, p.axis.air...);
    v(Field{"supply", "", 0, 0, "pressure supply"}, p.axis.supply...);
    visit_section(
        v, Field{"valve", "", 0, 0, "on/off five-port valve: command 1 fills chamber 1, -1 chamber 2"},
        [](auto& keys, auto&... rig) {
          keys(Field{"critical_pressure_ratio", "-", 0.05, 0.9, "b of valve and throttles"},
               rig.cylinder_critical_ratio...);
        },
        p...);
    v(Field{"throttle_1", "", 0, 0, "flow control valve of chamber 1"}, p.throttle_1...);
    v(Field{"throttle_2", "", 0, 0, "flow control valve of chamber 2"}, p.throttle_2...);
    v(Field{"cylinder", "", 0, 0, "double-acting cylinder"}, p.axis.cylinder...);
    v(Field{"cushion_1", "", 0, 0, "end cushioning at chamber 1's end", optional}, p.cushion_1...);
    v(Field{"cushion_2", "", 0, 0, "end cushioning at chamber 2's end", optional}, p.cushion_2...);
    v(Field{"slider", "", 0, 0, "moving mass"}, p.axis.slider...);
    v(Field{"effects", "", 0, 0, "known physics beside the nominal model, by name", optional}, p.axis.effects...);
    visit_section(
        v, sensors_field(),
        [](auto& keys, auto&... rig) { keys(Field{"position", "", 0, 0, "encoder"}, rig.sensors.position...); }, p...);
  }
  template <class V, class... P> static void visit_pressure(V& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"air", "", 0, 0, "gas and surroundings", optional}, p.axis.air...);
    v(Field{"supply", "", 0, 0, "pressure supply"}, p.axis.supply...);
    v(Field{"valve", "", 0, 0, "three-port valve: a command above 0 fills, below 0 empties"}, p.axis.valve...);
    v(Field{"on_off_valves", "", 0, 0, "valve is two on/off valves: one fills, one empties, pulsed; else proportional",
            optional},
      p.axis.valve.on_off...);
    v(Field{"line_1", "", 0, 0, "hose from the valve's port to the volume"}, p.axis.line_1...);
    v(Field{"volume", "", 0, 0, "at the far end of the hose"}, p.volume...);
    v(Field{"effects", "", 0, 0, "known physics beside the nominal model, by name", optional}, p.axis.effects...);
    visit_section(
        v, sensors_field(),
        [](auto& keys, auto&... rig) {
          keys(Field{"port_pressure", "", 0, 0, "at the valve's port"}, rig.sensors.port_pressure...);
          keys(Field{"chamber_pressure", "", 0, 0, "in the volume; not stated: there is none", Presence::optional},
               rig.sensors.chamber_pressure...);
          keys(Field{"supply_pressure", "", 0, 0, "at the supply", Presence::optional}, rig.sensors.supply_pressure...);
        },
        p...);
    v(Field{"controller", "", 0, 0, "control law and its gains"}, p.controller...);
    visit_section(
        v, Field{"initial", "", 0, 0, "state at the start of a simulation", optional},
        [](auto& keys, auto&... rig) {
          keys(Field{"pressure_1_Pa", "Pa", 1e4, 2e6, "hose and volume, absolute; default: atmosphere",
                     Presence::optional},
               rig.initial.pressure_1_Pa...);
        },
        p...);
    v(Field{"reference", "", 0, 0, "what the pressure shall do"}, p.pressure_reference...);
    v(Field{"duration_s", "s", 1e-3, 1e6, "of a run; default: 2 s more than the last point, ten periods of a sine",
            optional},
      p.duration_s...);
    v(Field{"evaluation", "", 0, 0, "window of the errors; default: the whole run", optional}, p.evaluation...);
    v(Field{"seed", "", 0, 0, "of the simulated noise", optional}, p.seed...);
    visit_tolerances(v, p...);
    visit_machine(v, p...);
    visit_section(
        v, Field{"limits", "", 0, 0, "a breach ends the run in the safe output", optional},
        [](auto& keys, auto&... rig) { LimitParameters::visit_of_pressure(keys, rig.limits...); }, p...);
    visit_plant(v, p...);
  }
  /// Of every rig, whether it is run or recorded.
  template <class V, class... P> static void visit_tolerances(V& v, P&... p) {
    v(Field{"tolerances", "", 0, 10, "one standard deviation, relative, of what the owner knows, by path",
            Presence::optional},
      p.tolerances...);
  }
  /// Of rigs that are recorded, not run.
  template <class V, class... P> static void visit_recorded(V& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"program", "", 0, 0, "command where a recording has no column u_V", optional}, p.program...);
    v(Field{"model_error", "", 0, 0, "by how much the model of a healthy machine is known to miss", optional},
      p.model_error...);
    visit_tolerances(v, p...);
  }
  template <class V, class... P> static void visit_run(V& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"reference", "", 0, 0, "what the slider shall do"}, p.reference...);
    v(Field{"duration_s", "s", 1e-3, 1e6, "of a run; default: 1 s more than a move, ramp and ten periods of a sine",
            optional},
      p.duration_s...);
    v(Field{"evaluation", "", 0, 0,
            "window of the errors; default: second half of a sine, a move until 0.6 s after its end", optional},
      p.evaluation...);
    v(Field{"seed", "", 0, 0, "of the simulated noise", optional}, p.seed...);
    visit_tolerances(v, p...);
    visit_machine(v, p...);
    v(Field{"limits", "", 0, 0, "a breach ends the motion in the safe output", optional}, p.limits...);
  }
  /// The simulated machine where it is not what the config says.
  template <class V, class... P> static void visit_machine(V& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"deviations", "", -0.9, 10,
            "of the simulated plant from what controller and estimator believe, relative, by path", optional},
      p.deviations...);
    v(Field{"concealed", "", 0, 0,
            "effects of the simulated machine alone, as under `effects` and in place of those of the same name",
            optional},
      p.concealed...);
  }
  template <class V, class... P> static void visit_grids(V& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"simulation", "", 0, 0, "grid of the simulated lines", optional}, p.simulation...);
    v(Field{"estimator", "", 0, 0, "pipeline estimator", optional}, p.estimator...);
    v(Field{"safe_output", "", 0, 0, "what the valve is given when the loop ends or faults", optional},
      p.safe_output...);
  }
  template <class V, class... P> static void visit_plant(V& v, P&... p) {
    constexpr auto optional = Presence::optional;
    visit_grids(v, p...);
    v(Field{"zeros", "", -1e7, 1e7, "added to what a device gives, by channel; written by the verb zero", optional},
      p.zeros...);
    v(Field{"hal", "", 0, 0, "devices behind the channels; without it all of them are simulated", optional}, p.hal...);
    v(Field{"serve", "", 0, 0, "commander and recordings of the verb serve", optional}, p.serve...);
  }
};

inline ValveArrangement valve_arrangement(const Rig& rig) noexcept {
  return rig.valves() == 2 || rig.controls_pressure() ? ValveArrangement::three_port_pair : ValveArrangement::five_port;
}

/// Columns of a recording that say what the valves are given: one valve for both sides, or one a side.
inline std::vector<std::string> command_columns(const Rig& rig) {
  if (rig.valves() == 2) return {"u1_V", "u2_V"};
  return {"u_V"};
}

/// What each valve is given in the safe state [V].
inline std::array<double, 2> safe_commands_V(const Rig& rig) noexcept {
  switch (rig.safe_output.action) {
    case SafeAction::vent: return {-rig.axis.valve.command_max_V, -rig.axis.valve.command_max_V};
    case SafeAction::centre: return {0.0, 0.0};
    case SafeAction::hold: break;
  }
  return {rig.safe_output.command_V, rig.safe_output.command_V};
}

/// What each output is given for these commands: of two on/off valves each has a coil of its own, which knows no sign.
inline std::array<double, 2> outputs_V(const Rig& rig, const std::array<double, 2>& command_V) noexcept {
  if (!rig.axis.valve.on_off) return command_V;
  return {std::max(0.0, command_V[0]), std::max(0.0, -command_V[0])};
}
/// The commands that these outputs are.
inline std::array<double, 2> commands_of_outputs_V(const Rig& rig, const std::array<double, 2>& output_V) noexcept {
  if (!rig.axis.valve.on_off) return output_V;
  return {output_V[0] - output_V[1], output_V[0] - output_V[1]};
}
/// Outputs in the safe state.
inline std::array<double, 2> safe_outputs_V(const Rig& rig) noexcept { return outputs_V(rig, safe_commands_V(rig)); }

/// Visits the effects that this kind of rig can have, one struct each; those of the sensors stand apart.
template <class RigType, class V> void visit_effects(RigType& rig, const V& v) {
  using Effects = AxisEffects<double>;
  switch (rig.kind) {
    case RigKind::driven_axis:
      if (rig.has_pistons()) MotionEffects<double>::visit(v, rig.axis.effects.motion);
      else Effects::visit_without_air(v, rig.axis.effects);
      break;
    case RigKind::vessel: VesselEffects<double>::visit(v, rig.vessel_effects); break;
    case RigKind::pressure: Effects::visit_of_one_side(v, rig.axis.effects); break;
    case RigKind::switched_cylinder: Effects::visit_switched(v, rig.axis.effects); break;
    default: Effects::visit(v, rig.axis.effects);
  }
}

}  // namespace pneuservo
