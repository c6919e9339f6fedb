// What no single field can say: values of a config that contradict each other, and defaults that follow from others.
#include "config/rig_checks.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include <pneuservo/elements/air.hpp>

#include "config/check.hpp"
#include "config/hal_checks.hpp"
#include "config/input_error.hpp"
#include "config/key_suggestion.hpp"
#include "config/law_checks.hpp"
#include "config/number_text.hpp"
#include "config/pressure_checks.hpp"
#include "config/reference_checks.hpp"
#include "config/rig_parameters.hpp"

namespace pneuservo {

namespace {

/// Pressure of chamber 2 that balances the piston at rest: A_1 p_1 - A_2 p_2 - (A_1 - A_2) p_atm = 0.
double balancing_pressure_2_Pa(const Rig& rig, double pressure_1_Pa) {
  const double atmosphere = rig.axis.air.atmosphere_Pa;
  return atmosphere + rig.axis.cylinder.area_1_m2 / rig.axis.cylinder.area_2_m2 * (pressure_1_Pa - atmosphere);
}

void check_line_models(const Rig& rig, const Check& check) {
  const LineParameters<double>&line_1 = rig.axis.line_1, &line_2 = rig.axis.line_2;
  const auto name = [](const LineParameters<double>& line) {
    return std::string(line_model_names[static_cast<std::size_t>(line.model)]);
  };
  if (line_1.model != line_2.model)
    check.refuse("line_2.model", {"line_1.model"}, name(line_2), "the model of line_1: " + name(line_1));
  if (line_1.model != LineModel::second_order_lag) return;
  // The third order has no lag; a plan through the line needs one.
  const bool needs_none = rig.axis.cylinder.linear_about_Pa > 0.0 && rig.controller.kind == kind_of<Ppd2> &&
                          rig.controller.of<Ppd2>().feedforward != FeedforwardKind::flatness;
  for (const auto& [line, key] : {std::pair{&line_1, "line_1"}, std::pair{&line_2, "line_2"}})
    if (line->natural_frequency_Hz <= 0.0 && !needs_none)
      check.refuse(std::string(key) + ".natural_frequency_Hz", {std::string(key) + ".model"},
                   number_text(line->natural_frequency_Hz), "the frequency of the second_order_lag, above 0 Hz");
}

/// Linear flows and chambers are those of (2.3) to (2.6): choked from the supply, about a pressure between it and air.
void check_linear_sides(const Rig& rig, const Check& check) {
  const double about_Pa = rig.axis.cylinder.linear_about_Pa, supply_Pa = rig.axis.supply.pressure_Pa;
  const double atmosphere_Pa = rig.axis.air.atmosphere_Pa;
  constexpr const char* key = "cylinder.linear_about_Pa";
  if (about_Pa == 0.0) return;
  if (rig.axis.line_1.model != LineModel::second_order_lag)
    return check.refuse(key, {"line_1.model"}, number_text(about_Pa), "0, or line_1.model: second_order_lag");
  if (about_Pa > atmosphere_Pa && about_Pa < supply_Pa) return;
  check.refuse(key, {"supply.pressure_Pa", "air.atmosphere_Pa"}, number_text(about_Pa),
               fmt::format("a pressure between air.atmosphere_Pa ({}) and supply.pressure_Pa ({})",
                           number_text(atmosphere_Pa), number_text(supply_Pa)));
}

/// A line that is one lag has no inside. `section`: where the effects were stated.
void check_line_effects(const Rig& rig, std::string_view section, const Check& check) {
  if (rig.axis.line_1.model != LineModel::second_order_lag) return;
  visit_effects(rig, [&](const Field& effect, const auto& parameters) {
    using Effect = std::remove_cvref_t<decltype(parameters)>;
    if constexpr (requires { Effect::is_inside_line; }) {
      // The first key is the size.
      bool is_size = true;
      const auto refuse_size = [&](const Field& key, double size) {
        if (std::exchange(is_size, false) && size > 0.0)
          check.refuse(fmt::format("{}.{}", section, effect.key), {"line_1.model"},
                       fmt::format("{} {}", number_text(size), key.unit),
                       "none: a second_order_lag has no inside; line_1.model: distributed");
      };
      Effect::visit(refuse_size, parameters);
    }
  });
}

void check_line(const LineParameters<double>& line, const std::string& name, const Check& check) {
  if (line.laminar_reynolds > line.turbulent_reynolds)
    check.refuse(name + ".laminar_reynolds", {name + ".turbulent_reynolds"}, number_text(line.laminar_reynolds),
                 fmt::format("at most {}.turbulent_reynolds ({})", name, number_text(line.turbulent_reynolds)));
}

void check_lines(const Rig& rig, const Check& check) {
  check_line(rig.axis.line_1, "line_1", check);
  check_line(rig.axis.line_2, "line_2", check);
  check_line_models(rig, check);
}

void check_controller(const Rig& rig, const Check& check) {
  const bool has_sensors = is_stated(check.root, "sensors", "chamber_pressure");
  if (rig.controller.takes_chambers() && !has_sensors)
    check.refuse("controller.pressure_source", {}, "'chamber' without sensors.chamber_pressure",
                 "valve or estimated, or the section sensors.chamber_pressure");
  if (rig.controller.takes_differences() && !(rig.sensors.differential_pressure.range_Pa > 0.0))
    check.refuse("controller.pressure_source", {}, "'differential' without sensors.differential_pressure.range_Pa",
                 "valve or estimated, or the section sensors.differential_pressure with a range above 0");
  const double command_max = rig.axis.valve.command_max_V;
  if (std::fabs(rig.safe_output.command_V) > command_max)
    check.refuse("safe_output.command_V", {"valve.command_max_V"}, number_text(rig.safe_output.command_V),
                 fmt::format("at most +-valve.command_max_V ({})", number_text(command_max)));
}

/// What the observer of the position is made for, and two switches that it can pass.
void check_position(const Rig& rig, const Check& check) {
  const PositionParameters& p = rig.position;
  if (!p.is_estimated()) return;
  const double half_m = 0.5 * rig.axis.cylinder.stroke_m;
  const std::string range = fmt::format("positions of both switches within the stroke of +-{}, low_m + hysteresis_m "
                                        "below high_m - hysteresis_m",
                                        number_text(half_m));
  if (p.low_m < -half_m || p.high_m > half_m || p.low_m + p.hysteresis_m >= p.high_m - p.hysteresis_m)
    check.refuse("position.low_m", {"position.high_m", "position.hysteresis_m", "cylinder.stroke_m"},
                 fmt::format("{} beside high_m {}", number_text(p.low_m), number_text(p.high_m)), range);
  if (std::fabs(p.start_m) > half_m)
    check.refuse("position.start_m", {"cylinder.stroke_m"}, number_text(p.start_m),
                 fmt::format("a position within the stroke of +-{}", number_text(half_m)));
  if (rig.kind != RigKind::cylinder || rig.axis.valve.on_off)
    check.refuse("position.source", {"rig"}, "estimated",
                 "encoder: without one the air of a five-port valve is counted, of a rig of kind cylinder");
  if (rig.reference.kind == ReferenceKind::live)
    check.refuse("position.source", {"reference.kind"}, "estimated with reference.kind live",
                 "encoder: an axis that is started anew from where it stands has to be seen there");
}

/// A load on a coupling is a part of what moves.
void check_coupled_loads(const Rig& rig, std::string_view section, const Check& check) {
  const double moves_kg = rig.axis.slider.mass_kg + rig.axis.slider.payload_kg;
  const MotionEffects<double>& effects = rig.axis.effects.motion;
  double coupled_kg = 0.0;
  for (const auto& [effect, mass_kg] : {std::pair{"elastic_load", effects.elastic_load.mass_kg},
                                        std::pair{"load_backlash", effects.load_backlash.mass_kg}}) {
    coupled_kg += mass_kg;
    if (mass_kg > 0.0 && coupled_kg >= moves_kg)
      check.refuse(
          fmt::format("{}.{}.mass_kg", section, effect), {"slider.mass_kg", "slider.payload_kg"}, number_text(mass_kg),
          fmt::format("coupled loads of less than slider.mass_kg + slider.payload_kg ({})", number_text(moves_kg)));
  }
}

/// What is put down was there.
void check_payload_change(const Rig& rig, std::string_view section, const Check& check) {
  const double moves_kg = rig.axis.slider.mass_kg + rig.axis.slider.payload_kg,
               change_kg = rig.axis.effects.motion.payload_change.mass_kg;
  if (change_kg < 0.0 && moves_kg + change_kg <= 0.0)
    check.refuse(fmt::format("{}.payload_change.mass_kg", section), {"slider.mass_kg", "slider.payload_kg"},
                 number_text(change_kg),
                 fmt::format("more than -(slider.mass_kg + slider.payload_kg) ({})", number_text(-moves_kg)));
}

/// Points of a table ascend, where it has values.
void check_tables(const Rig& rig, std::string_view section, const Check& check) {
  visit_effects(rig, [&](const Field& effect, const auto& table) {
    using Effect = std::remove_cvref_t<decltype(table)>;
    if constexpr (requires { table.place; }) {
      if (!table.is_there()) return;
      std::vector<std::string_view> keys;
      Effect::visit([&](const Field& key, double) { keys.push_back(key.key); }, table);
      for (std::size_t i = 1; i < table.place.size(); ++i)
        if (!(table.place[i] > table.place[i - 1]))
          check.refuse(fmt::format("{}.{}.{}", section, effect.key, keys[i]), {}, number_text(table.place[i]),
                       fmt::format("more than {} ({}): points in ascending order", keys[i - 1],
                                   number_text(table.place[i - 1])));
    }
  });
}

/// A supply that swings stays one.
void check_supply_swing(const Rig& rig, std::string_view section, const Check& check) {
  const double swing_Pa = rig.axis.effects.supply_swing.amplitude_Pa,
               most_Pa = rig.axis.supply.pressure_Pa - rig.axis.air.atmosphere_Pa;
  if (swing_Pa > 0.0 && swing_Pa > most_Pa)
    check.refuse(fmt::format("{}.supply_swing.amplitude_Pa", section), {"supply.pressure_Pa"}, number_text(swing_Pa),
                 fmt::format("at most what the supply has above the atmosphere ({})", number_text(most_Pa)));
}

/// Dry friction that the config itself puts on the slider.
double dry_friction_N(const Rig& rig) {
  const MotionEffects<double>& motion = rig.axis.effects.motion;
  return std::max({motion.coulomb_friction.force_N,
                   motion.stribeck_friction.coulomb_force_N + motion.stribeck_friction.extra_force_N,
                   motion.direction_dependent_friction.forward_N, motion.direction_dependent_friction.backward_N});
}

/// What three standard deviations of noise, and a quantum, of the encoder are in the speed that the law filters.
double encoder_speed_mps(const Rig& rig) {
  const double filter_s = rig.controller.velocity_filter_s();
  const double share = filter_s > 0.0 ? -std::expm1(-rig.period_s / filter_s) : 1.0;
  return share * (rig.sensors.position.quantum_m + 3.0 * rig.sensors.position.noise_m) / rig.period_s;
}

/// Limits that end every run, or that allow for less than the config has.
void check_limits(const Rig& rig, const Check& check) {
  const LimitParameters& limits = rig.limits;
  const double encoder_m = rig.sensors.position.quantum_m + 3.0 * rig.sensors.position.noise_m;
  if (limits.deviation_m && *limits.deviation_m > 0.0 && *limits.deviation_m <= encoder_m)
    check.refuse("limits.deviation_m", {"sensors.position"}, number_text(*limits.deviation_m),
                 fmt::format("more than the encoder's quantum and noise ({}), or nothing: it is derived",
                             number_text(encoder_m)));
  const double speed_mps = encoder_speed_mps(rig);
  if (limits.speed_deviation_mps && *limits.speed_deviation_mps > 0.0 && *limits.speed_deviation_mps <= speed_mps)
    check.refuse("limits.speed_deviation_mps", {"sensors.position"}, number_text(*limits.speed_deviation_mps),
                 fmt::format("more than the encoder's quantum and noise give ({}), or nothing: it is derived",
                             number_text(speed_mps)));
  if (!rig.is_pneumatic()) return;
  const double friction_N = dry_friction_N(rig);
  if (limits.dry_friction_max_N && *limits.dry_friction_max_N < friction_N)
    check.refuse("limits.dry_friction_max_N", {"effects"}, number_text(*limits.dry_friction_max_N),
                 fmt::format("at least the dry friction of effects ({})", number_text(friction_N)));
  const auto& cylinder = rig.axis.cylinder;
  const double pressure_Pa = rig.sensors.port_pressure.quantum_Pa + 3.0 * rig.sensors.port_pressure.noise_Pa;
  const double resting_N = friction_N + pressure_Pa * std::hypot(cylinder.area_1_m2, cylinder.area_2_m2);
  if (limits.stall_force_N && *limits.stall_force_N > 0.0 && *limits.stall_force_N <= resting_N)
    check.refuse("limits.stall_force_N", {"effects", "sensors.port_pressure"}, number_text(*limits.stall_force_N),
                 fmt::format("more than dry friction and noise of the pressures show at rest ({}), or nothing: it is "
                             "derived",
                             number_text(resting_N)));
  if (limits.pressure_Pa && *limits.pressure_Pa <= rig.axis.supply.pressure_Pa)
    check.refuse("limits.pressure_Pa", {"supply.pressure_Pa"}, number_text(*limits.pressure_Pa),
                 fmt::format("more than supply.pressure_Pa ({})", number_text(rig.axis.supply.pressure_Pa)));
  if (limits.age_periods < 1.0 && rig.simulation.input_age_periods > 0)
    check.refuse("limits.age_periods", {"simulation.input_age_periods"}, number_text(limits.age_periods),
                 "at least the age that simulation.input_age_periods gives every sample (1)");
}

/// The drive of the simulated valves: whole ticks a period, a lag that its loop can make.
void check_valve_drive(const Rig& rig, const Check& check) {
  const double period_s = rig.simulation.valve_drive_period_s;
  if (period_s == 0.0) return;
  if (!rig.is_pneumatic())
    check.refuse("simulation.valve_drive_period_s", {"rig"}, number_text(period_s),
                 "none: a rig of kind cylinder or servo_table has valves with a drive of their own");
  constexpr double shortest_s = 1e-6;  // no drive has a quicker loop, and each of its ticks is simulated
  if (period_s < shortest_s)
    check.refuse("simulation.valve_drive_period_s", {}, number_text(period_s), "0, or 1 us at least");
  const double ticks = rig.period_s / period_s;
  if (ticks < 0.5 || std::fabs(ticks - std::round(ticks)) > 1e-6)
    check.refuse("simulation.valve_drive_period_s", {"period_s"}, number_text(period_s),
                 fmt::format("a whole part of period_s ({})", number_text(rig.period_s)));
  const double Hz = rig.axis.valve.natural_frequency_Hz;
  if (Hz < 50.0 || Hz > 300.0)
    check.refuse("valve.natural_frequency_Hz", {"simulation.valve_drive_period_s"}, number_text(Hz),
                 "50 to 300 Hz, which the drive's loop can make, or no valve_drive_period_s");
}

/// What the valves of this rig can do in the safe state.
void check_safe_output(const Rig& rig, const Check& check) {
  const SafeOutputParameters& safe = rig.safe_output;
  if (safe.action == SafeAction::vent && valve_arrangement(rig) == ValveArrangement::five_port)
    check.refuse("safe_output.action", {"rig"},
                 "vent with a five-port valve, which feeds one side when it vents the other",
                 "hold or centre; vent takes three-port valves, as rigs of kind servo_table and pressure have them");
  if (safe.action != SafeAction::hold && safe.command_V != 0.0)
    check.refuse("safe_output.command_V", {"safe_output.action"}, number_text(safe.command_V),
                 "none: only the action hold has a command of its own");
}

void check_zeros(const Rig& rig, const Check& check) {
  std::vector<std::string_view> known;
  for (const Signal signal : channel_signals)
    if (rig.has_sensor(signal)) known.push_back(info(signal).name);
  for (const auto& [channel, zero] : rig.zeros)
    if (std::ranges::find(known, channel) == known.end())
      check.refuse(join_path("zeros", channel), {}, "no channel of this rig",
                   fmt::format("one of {}", fmt::join(known, ", ")));
}

void check_times(const Rig& rig, const Check& check) {
  if (rig.duration_s < rig.period_s)
    check.refuse("duration_s", {"period_s"}, number_text(rig.duration_s),
                 fmt::format("at least period_s ({})", number_text(rig.period_s)));
  if (!rig.evaluation) return;
  if (!(rig.evaluation->from_s < rig.evaluation->to_s))
    check.refuse("evaluation.from_s", {"evaluation.to_s"}, number_text(rig.evaluation->from_s),
                 fmt::format("less than evaluation.to_s ({})", number_text(rig.evaluation->to_s)));
  if (rig.evaluation->to_s > rig.duration_s)
    check.refuse("evaluation.to_s", {"duration_s"}, number_text(rig.evaluation->to_s),
                 fmt::format("at most duration_s ({})", number_text(rig.duration_s)));
}

void check_initial_position(const Rig& rig, const Check& check) {
  const double half_stroke = 0.5 * rig.axis.cylinder.stroke_m;
  if (std::fabs(rig.initial.position_m) > half_stroke)
    check.refuse("initial.position_m", {stroke_key(rig)}, number_text(rig.initial.position_m),
                 fmt::format("at most +-half of {} ({})", stroke_key(rig), number_text(half_stroke)));
}

void check_initial_pressures(const Rig& rig, const Check& check) {
  const double supply = rig.axis.supply.pressure_Pa;
  const std::string limit = fmt::format("at most supply.pressure_Pa ({})", number_text(supply));
  const double pressure_1 = rig.initial.pressure_1_Pa, balancing = balancing_pressure_2_Pa(rig, pressure_1);
  if (pressure_1 > supply)
    return check.refuse("initial.pressure_1_Pa", {"supply.pressure_Pa"}, number_text(pressure_1), limit);
  if (rig.initial.pressure_2_Pa.value_or(0.0) > supply)
    check.refuse("initial.pressure_2_Pa", {"supply.pressure_Pa"}, number_text(*rig.initial.pressure_2_Pa), limit);
  if (!rig.initial.pressure_2_Pa && !(balancing > 0.0 && balancing <= supply))
    check.refuse("initial.pressure_1_Pa", {"supply.pressure_Pa", "cylinder"},
                 fmt::format("{}, which {:.6g} Pa in chamber 2 would balance", number_text(pressure_1), balancing),
                 fmt::format("a pressure whose balance lies between 0 and supply.pressure_Pa ({}), or pressure_2_Pa",
                             number_text(supply)));
}

/// The keys of a section that are paths of this rig's numbers.
void check_paths(const Rig& rig, const Check& check, const std::string& section_name,
                 const std::map<std::string, double>& section_values) {
  for (const auto& [path, value] : section_values) {
    if (has_parameter(rig, path)) continue;
    std::vector<std::string> known;
    for (const ParameterPath& parameter : parameter_paths(rig)) known.push_back(parameter.path);
    const std::vector<std::string> near = near_names(path, known);
    const ConfigNode& section = check.root.find(section_name)->value;
    const std::string known_near = fmt::format("a known path (did you mean {}?)", fmt::join(near, ", "));
    check.errors.collect([&] {
      refuse(section.find(path)->origin, join_path(section_name, path), "a path that names no number of this rig",
             near.empty() ? "a path such as slider.mass_kg" : known_near);
    });
  }
}

/// What a simulated plant can have of its own: the physical axis, with numbers that a factor changes.
void check_deviations(const Rig& rig, const Check& check) {
  check_paths(rig, check, "deviations", rig.deviations);
  for (const auto& [path, deviation] : rig.deviations) {
    if (!has_parameter(rig, path)) continue;
    const std::string section = path.substr(0, path.find('.'));
    bool physical = false;
    AxisParameters<double>::visit([&](const Field& field, const auto&) { physical = physical || field.key == section; },
                                  rig.axis);
    physical = physical || (rig.controls_pressure() && section == "volume") ||
               (section == "on_off_valves" && !path.ends_with(PulsedValveParameters::of_the_loop));
    if (physical && get_parameter(rig, path) != 0.0) continue;
    check.errors.collect([&] {
      refuse(check.root.find("deviations")->value.find(path)->origin, join_path("deviations", path),
             physical ? "a number that is 0" : "a number of no part of the plant",
             "a path of air, supply, valve, lines, cylinder, slider or effects with a value of its own");
    });
  }
}

/// Weather and height move the atmosphere by a hundredth and more. A config that does not state it leaves it open, but
/// where the gauge pressures of a recording are read as above it.
void leave_atmosphere_open(Rig& rig, const ConfigNode& root) {
  constexpr double weather = 0.01;
  if (rig.kind != RigKind::vessel || is_stated(root, "air", "atmosphere_Pa")) return;
  const auto is_gauge = [](const auto& column) { return column.first.ends_with("_Pa") && column.second.offset != 0; };
  if (rig.imported && std::any_of(rig.imported->columns.begin(), rig.imported->columns.end(), is_gauge)) return;
  rig.tolerances.try_emplace("air.atmosphere_Pa", weather);
}

}  // namespace

void complete_rig(Rig& rig, const ConfigNode& root) {
  leave_atmosphere_open(rig, root);
  if (!rig.has_controller()) return;
  if (rig.controls_pressure()) return complete_pressure_rig(rig, root);
  check_reference_keys(rig.reference, root.find("reference")->value, "reference");
  if (root.find("duration_s") == nullptr) {
    if (needs_file(rig.reference))
      refuse(root.origin, "duration_s", "nothing", "the key: a reference from a file does not tell its end");
    rig.duration_s = default_duration_s(rig.reference, root);
  }
  if (!rig.is_pneumatic() || is_stated(root, "initial", "pressure_1_Pa")) return;
  if (const auto rest_Pa = rig.controller.rest_pressure_Pa()) {
    rig.initial.pressure_1_Pa = *rest_Pa;
  } else {
    const double supply = rig.axis.supply.pressure_Pa, atmosphere = rig.axis.air.atmosphere_Pa;
    const double usual = rig.initial.pressure_1_Pa;
    const double area_ratio = rig.axis.cylinder.area_2_m2 / rig.axis.cylinder.area_1_m2;
    if (std::max(usual, balancing_pressure_2_Pa(rig, usual)) > supply)
      rig.initial.pressure_1_Pa = atmosphere + 0.6 * std::min(1.0, area_ratio) * (supply - atmosphere);
  }
}

namespace {

void check_program(const Rig& rig, const Check& check) {
  const ProgramParameters& program = rig.program;
  if (program.times_s.size() != program.commands.size())
    check.refuse("program.commands", {"program.times_s"}, fmt::format("{} commands", program.commands.size()),
                 fmt::format("as many as times_s has ({})", program.times_s.size()));
  for (std::size_t i = 1; i < program.times_s.size(); ++i)
    if (!(program.times_s[i] > program.times_s[i - 1]))
      check.refuse("program.times_s", {},
                   fmt::format("{} after {}", number_text(program.times_s[i]), number_text(program.times_s[i - 1])),
                   "strictly increasing times");
}

/// The loop is the one master of its own bus; a drive there would have two.
void check_serve(const Rig& rig, const Check& check) {
  if (!rig.serve || !rig.serve->drive || !rig.hal || !rig.hal->can) return;
  if (rig.serve->drive->interface == rig.hal->can->interface)
    check.refuse("serve.drive.interface", {"hal.can.interface"}, "'" + rig.serve->drive->interface + "'",
                 "another bus than the one of hal.can");
}

}  // namespace

void check_choice_of_law(RigKind kind, const ConfigNode& root, InputErrors& errors) {
  const ConfigNode::Entry* controller = root.find("controller");
  const ConfigNode::Entry* stated = controller != nullptr ? controller->value.find("kind") : nullptr;
  if (stated == nullptr) return;
  const auto law = std::ranges::find(controller_kind_names, stated->value.text);
  if (law == controller_kind_names.end()) return;  // the reader says which laws there are
  if (runs(static_cast<ControllerKind>(law - controller_kind_names.begin()), kind)) return;
  std::vector<std::string_view> names;
  for (const ControllerKind able : laws_of(kind)) names.push_back(name_of(able));
  Check{root, errors}.refuse("controller.kind", {"rig"}, std::string(*law),
                             fmt::format("{}, the law{} of a {}", fmt::join(names, " or "), names.size() > 1 ? "s" : "",
                                         rig_kind_names[static_cast<std::size_t>(kind)]));
}

namespace {

void check_pneumatic(const Rig& rig, const Check& check) {
  check.of({"line_1", "line_2"}, [&] { check_lines(rig, check); });
  check.of({"controller", "sensors", "valve", "safe_output"}, [&] { check_controller(rig, check); });
  check.of({"safe_output", "valve"}, [&] { check_safe_output(rig, check); });
  check.of({"zeros"}, [&] { check_zeros(rig, check); });
  check.of({"position", "cylinder", "reference"}, [&] { check_position(rig, check); });
  check.of({"air", "supply", "cylinder", "initial", "controller"}, [&] { check_initial_pressures(rig, check); });
}

/// Effects that contradict the axis which has them.
void check_effects(const Rig& rig, std::string_view section, const Check& check) {
  check.of({"slider", section}, [&] { check_coupled_loads(rig, section, check); });
  check.of({"slider", section}, [&] { check_payload_change(rig, section, check); });
  check.of({section}, [&] { check_tables(rig, section, check); });
  if (!rig.is_pneumatic() && !rig.controls_pressure()) return;
  check.of({"line_1", "line_2", section}, [&] { check_line_effects(rig, section, check); });
  check.of({"air", "supply", section}, [&] { check_supply_swing(rig, section, check); });
}

}  // namespace

namespace {

void check_devices(const Rig& rig, const Check& check) {
  check.of({"hal", "controller", "safe_output", "valve", "on_off_valves", "period_s"}, [&] {
    check_hal(rig, check.errors, [&](const std::string& path, const std::string& found, const std::string& expected) {
      refuse(origin_of(check.root, path), path, found, expected);
    });
  });
}

/// The valve's own edges against the volume, and what is sensed.
void check_pressure_rig(const Rig& rig, const Check& check) {
  check.of({"controller", "sensors", "valve", "safe_output"}, [&] { check_controller(rig, check); });
  check.of({"safe_output", "valve"}, [&] { check_safe_output(rig, check); });
  check.of({"zeros"}, [&] { check_zeros(rig, check); });
  check.of({"line_1"}, [&] { check_line(rig.axis.line_1, "line_1", check); });
  check_pressure_numbers(rig, check);
  check.of({"period_s", "duration_s", "evaluation"}, [&] { check_times(rig, check); });
  check.of({"tolerances"}, [&] { check_paths(rig, check, "tolerances", rig.tolerances); });
  check.of({"deviations"}, [&] { check_deviations(rig, check); });
  check_devices(rig, check);
}

}  // namespace

void check_rig(const Rig& rig, const ConfigNode& root, InputErrors& errors) {
  const Check check{root, errors};
  check.of({"air", "supply", "line_1", "cylinder"}, [&] { check_linear_sides(rig, check); });
  check_effects(rig, "effects", check);
  if (!rig.concealed.empty()) check_effects(simulated_rig(rig), "concealed", check);
  if (rig.controls_pressure()) return check_pressure_rig(rig, check);
  if (!rig.has_controller()) {
    check.of({"program"}, [&] { check_program(rig, check); });
    check.of({"tolerances"}, [&] { check_paths(rig, check, "tolerances", rig.tolerances); });
    return;
  }
  check.of({"air", "supply", "line_1", "line_2", "controller", "reference"}, [&] { check_law(rig, check); });
  check.of({"supply", "sensors", "controller", "cylinder", "effects", "limits", "simulation"},
           [&] { check_limits(rig, check); });
  check.of({"rig", "period_s", "simulation", "valve"}, [&] { check_valve_drive(rig, check); });
  if (rig.is_pneumatic()) check_pneumatic(rig, check);
  check.of({"cylinder", "slider", "initial"}, [&] { check_initial_position(rig, check); });
  check.of({"period_s", "duration_s", "evaluation", "reference"}, [&] { check_times(rig, check); });
  check.of({"period_s", "duration_s", "reference", "cylinder", "slider"}, [&] { check_reference_range(rig, check); });
  check.of({"duration_s", "reference", "air", "supply", "valve", "cylinder", "slider", "limits"},
           [&] { check_reference_motion(rig, check); });
  check.of({"tolerances"}, [&] { check_paths(rig, check, "tolerances", rig.tolerances); });
  check.of({"deviations"}, [&] { check_deviations(rig, check); });
  check.of({"serve", "hal"}, [&] { check_serve(rig, check); });
  check_devices(rig, check);
}

void check_machine_rig(const Rig& rig, const ConfigNode& root) {
  check_outputs_without_us(rig, [&](const std::string& path, const std::string& found, const std::string& expected) {
    refuse(origin_of(root, path), path, found, expected);
  });
}

}  // namespace pneuservo
