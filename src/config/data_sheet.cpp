// Keys of data sheets beside the SI keys of a config: values with units, and what follows from several of them.
#include "config/data_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include <pneuservo/elements/orifice.hpp>

#include "config/number_text.hpp"
#include "config/units.hpp"

namespace pneuservo {

namespace {

/// Values of a form's keys in SI: one number, or both ends of a range.
using FormValues = std::map<std::string_view, std::array<double, 2>>;
/// SI values of the keys that a form gives; throws nothing. A key that it cannot give is left out.
using FormResult = std::map<std::string, double>;

struct Form {
  DataSheetForm words;
  std::vector<std::string_view> ranges;  ///< keys that are ranges
  std::vector<std::string_view> needs;   ///< SI keys of the section that it computes with
  std::function<FormResult(const FormValues&, const Rig&)> compute;
};

constexpr double standard_gravity_mps2 = 9.80665;
/// Free air of ISO 8778 and ISO 6358.
constexpr double free_air_Pa = 1e5, free_air_K = 293.15;
/// NE 43: a signal of 4 to 20 mA measures from 3.8 to 20.5 mA; the same shares of other signals.
constexpr double below_share = 0.2 / 16.0, above_share = 0.5 / 16.0;

FormResult areas_of_bore(const FormValues& v, const Rig&) {
  const double bore = bore_area_m2(v.at("bore")[0]), rod_2 = bore_area_m2(v.at("rod")[0]);
  const double rod_1 = v.contains("rod_1") ? bore_area_m2(v.at("rod_1")[0]) : 0.0;
  return {{"area_1_m2", bore - rod_1}, {"area_2_m2", bore - rod_2}};
}

double free_air_density_kgpm3(const Air<double>& air) { return free_air_Pa / (air.R * free_air_K); }

FormResult valve_of_area(double area_m2, const FormValues& v) {
  return {{"area_max_m2", area_m2}, {"area_per_volt_m2_per_V", area_m2 / v.at("command_max_V")[0]}};
}

/// C = K_f S/(rho_0 sqrt(R T_0)).
FormResult areas_of_conductance(const FormValues& v, const Rig& rig) {
  const Air<double> air(rig.axis.air);
  return valve_of_area(v.at("sonic_conductance")[0] * free_air_density_kgpm3(air) * std::sqrt(air.R * free_air_K) /
                           air.flow_constant,
                       v);
}

/// From 6 to 5 bar gauge at 20 degC.
FormResult areas_of_nominal_flow(const FormValues& v, const Rig& rig) {
  const Air<double> air(rig.axis.air);
  const double flux = orifice_flux(air, 6e5 + air.atmosphere_Pa, free_air_K, 5e5 + air.atmosphere_Pa,
                                   v.at("critical_pressure_ratio")[0]);
  return valve_of_area(v.at("nominal_flow")[0] * free_air_density_kgpm3(air) / flux, v);
}

FormResult command_of_signal(const FormValues& v, const Rig&) {
  return {{"command_max_V", 0.5 * std::fabs(v.at("signal")[1] - v.at("signal")[0])}};
}

/// Signal and what it measures, both with two ends.
template <class Keys>
FormResult line_through_ends(const std::array<double, 2>& signal, const std::array<double, 2>& measures) {
  const double slope = (measures[1] - measures[0]) / (signal[1] - signal[0]);
  const double span = measures[1] - measures[0];
  const std::array<double, 2> ends{measures[0] - below_share * span, measures[1] + above_share * span};
  return {{std::string(Keys::scale_V), slope},
          {std::string(Keys::zero), measures[0] - slope * signal[0]},
          {std::string(Keys::lowest), std::min(ends[0], ends[1])},
          {std::string(Keys::highest), std::max(ends[0], ends[1])}};
}

/// The command counts from the neutral voltage; both ends of the signal are as far from it as they are.
FormResult command_of_terminal(const FormValues& v, const Rig&) {
  const double neutral_V = v.at("neutral")[0];
  return {{"scale_V_per_V", 1.0},
          {"zero_V", -neutral_V},
          {"lowest_V", v.at("signal")[0] - neutral_V},
          {"highest_V", v.at("signal")[1] - neutral_V}};
}

FormResult weight_on_incline(const FormValues& v, const Rig& rig) {
  const double mass_kg = rig.axis.slider.mass_kg + rig.axis.slider.payload_kg;
  return {{"force_N", mass_kg * standard_gravity_mps2 * std::sin(v.at("incline")[0])}};
}

constexpr auto optional = Presence::optional;

/// A sensor's step from its range and the bits of its converter.
Form resolution(std::string_view unit, std::string_view quantum) {
  return {
      {{Field{"range", unit, -infinite, infinite, "measured from one end of the converter to the other (0 to 10 bar)"},
        Field{"bits", "-", 1, 32, "of the converter"}},
       {quantum},
       "range / 2^bits"},
      {"range"},
      {},
      [quantum](const FormValues& v, const Rig&) -> FormResult {
        return {{std::string(quantum),
                 std::ldexp(std::fabs(v.at("range")[1] - v.at("range")[0]), -static_cast<int>(v.at("bits")[0]))}};
      }};
}

/// A channel of a board by the signal of its sensor.
template <class Keys> Form scaling(double lowest_value) {
  return {{{Field{"signal", "V", -infinite, infinite, "of the sensor (0 to 10 V; 4 to 20 mA with a shunt)"},
            Field{"measures", Keys::unit, lowest_value, infinite, "at the ends of the signal (0 to 10 bar gauge)"},
            Field{"shunt", "V/A", 1e-3, 1e6, "resistor that turns a current into a voltage (250 ohm)", optional}},
           {Keys::scale_V, Keys::zero, Keys::lowest, Keys::highest},
           "straight through both ends; no measurement beyond the signal by more than NE 43 allows"},
          {"signal", "measures"},
          {},
          [](const FormValues& v, const Rig&) { return line_through_ends<Keys>(v.at("signal"), v.at("measures")); }};
}

/// For the list of keys alone: the table is no number and is read by valve_table.hpp.
Form measured_valve() {
  return {{{Field{"table", "", -infinite, infinite,
                  "of a measurement: command_V with area_m2, or with flow_kgps, upstream_Pa, downstream_Pa; gives "
                  "valve_offset, valve_dead_band and valve_curve under effects, too"}},
           {"area_max_m2", "area_per_volt_m2_per_V"},
           "the curve nearest to the measured points"},
          {},
          {},
          [](const FormValues&, const Rig&) -> FormResult { return {}; }};
}

Form signal_at_terminal() {
  return {{{Field{"signal", "V", -1000, 1000, "that the valve takes (0 to 10 V)"},
            Field{"neutral", "V", -1000, 1000, "at which the valve is closed (5 V)"}},
           {"scale_V_per_V", "zero_V", "lowest_V", "highest_V"},
           "commands count from the neutral voltage"},
          {"signal"},
          {},
          command_of_terminal};
}

const std::vector<Form>& all_forms() {
  static const std::vector<Form> forms{
      {{{Field{"bore", "m", 1e-3, 1, "of the cylinder"}, Field{"rod", "m", 0, 1, "on the side of chamber 2; 0: none"},
         Field{"rod_1", "m", 0, 1, "on the side of chamber 1, of a through rod", optional}},
        {"area_1_m2", "area_2_m2"},
        "pi/4 (bore^2 - rod^2)"},
       {},
       {},
       areas_of_bore},
      {{{Field{"signal", "V", -1000, 1000, "of the valve, from end to end (0 to 10 V)"}},
        {"command_max_V"},
        "half of the range: commands count from its middle"},
       {"signal"},
       {},
       command_of_signal},
      {{{Field{"sonic_conductance", "m3/(s Pa)", 1e-13, 1e-4, "C of ISO 6358 of the open valve (2.5 l/(s bar))"}},
        {"area_max_m2", "area_per_volt_m2_per_V"},
        "C rho_0 sqrt(R T_0)/K_f, reached at command_max_V"},
       {},
       {"command_max_V"},
       areas_of_conductance},
      {{{Field{"nominal_flow", "m3/s", 1e-8, 10,
               "of free air from 6 to 5 bar gauge through the open valve (700 l/min; Nl/min: DIN 1343)"}},
        {"area_max_m2", "area_per_volt_m2_per_V"},
        "by the ellipse of ISO 6358 with critical_pressure_ratio, reached at command_max_V"},
       {},
       {"command_max_V", "critical_pressure_ratio"},
       areas_of_nominal_flow},
      measured_valve(),
      resolution("m", "quantum_m"),
      resolution("Pa", "quantum_Pa"),
      resolution("kg/s", "quantum_kgps"),
      scaling<PressureKeys>(1.0),
      scaling<PositionKeys>(-infinite),
      scaling<FlowKeys>(-infinite),
      signal_at_terminal(),
      {{{Field{"incline", "rad", -3.2, 3.2, "of the axis, positive where x points up (90 deg: vertical)"}},
        {"force_N"},
        "weight of slider and payload along the axis"},
       {},
       {},
       weight_on_incline},
  };
  return forms;
}

bool has_key(const std::vector<Field>& fields, std::string_view key) {
  return std::ranges::find(fields, key, &Field::key) != fields.end();
}

bool fits(const Form& form, const std::vector<Field>& fields) {
  const auto has = [&](std::string_view key) { return has_key(fields, key); };
  // A weight acts either way; friction, which has the same key, does not.
  if (form.words.gives[0] == "force_N" && (fields.size() != 1 || fields[0].minimum >= 0.0)) return false;
  return std::ranges::all_of(form.words.gives, has) && std::ranges::all_of(form.needs, has);
}

/// One section's translation.
class Translation {
 public:
  Translation(ConfigNode& map, const std::string& path, const std::vector<Field>& fields, ReadContext& context)
      : map_(map), path_(path), fields_(fields), context_(context) {}

  std::set<std::string> run() {
    for (const Field& field : fields_) take_unit(field);
    for (const Form& form : all_forms())
      if (fits(form, fields_)) take_form(form);
    return std::move(excused_);
  }

 private:
  Datums datums() const {
    const AxisParameters<double>& axis = context_.rig.axis;
    return {axis.air.atmosphere_Pa, axis.cylinder.stroke_m, free_air_density_kgpm3(Air<double>(axis.air))};
  }

  /// A key with its unit in the value becomes the SI key.
  void take_unit(const Field& field) {
    const std::string key(key_without_unit(field));
    if (key.empty() || has_key(fields_, key)) return;
    ConfigNode::Entry* entry = map_.find(key);
    if (entry == nullptr) return;
    ConfigNode value = entry->value;
    excused_.insert(std::string(field.key));
    if (context_.errors.collect([&] { convert(field, value, join_path(path_, key)); }))
      replace(key, {{std::string(field.key), value}});
    else erase(key);
  }
  void convert(const Field& field, ConfigNode& value, const std::string& path) const {
    if (value.type == ConfigNode::Type::list) {
      for (std::size_t i = 0; i < value.items.size(); ++i)
        convert(field, value.items[i], join_path(path, std::to_string(i)));
      return;
    }
    const ReadQuantity read = read_quantity(field, value.type == ConfigNode::Type::scalar ? value.text : "", datums());
    if (!read.value) refuse(value.origin, path, describe(value), read.expected);
    value.written = value.text;
    value.text = number_text(*read.value);
    value.quoted = false;
  }

  /// The first of some names is taken over by the values.
  void replace(const std::string& key, const std::map<std::string, ConfigNode>& values) {
    const std::string origin = map_.find(key)->origin;
    erase(key);
    for (const auto& [si_key, value] : values) {
      const ConfigNode::Entry* stated = map_.find(si_key);
      if (stated == nullptr) map_.entries.push_back({si_key, origin, value});
      else if (!is_set(stated->origin) && is_set(origin)) map_.find(si_key)->value = value;
      else if (is_set(stated->origin) == is_set(origin))
        context_.errors.collect([&] {
          refuse(origin, join_path(path_, key), fmt::format("it beside {} (at {})", si_key, stated->origin),
                 "one of the two");
        });
    }
  }
  static bool is_set(const std::string& origin) { return origin.starts_with("--set"); }
  void erase(const std::string& key) {
    std::erase_if(map_.entries, [&](const ConfigNode::Entry& entry) { return entry.key == key; });
  }

  void take_form(const Form& form) {
    const ConfigNode::Entry* first = nullptr;
    for (const Field& key : form.words.keys)
      if (const ConfigNode::Entry* entry = map_.find(std::string(key.key));
          entry != nullptr && first == nullptr && !has_key(fields_, key.key))
        first = entry;
    if (first == nullptr || !names_form(form)) return;
    for (const std::string_view key : form.words.gives) excused_.insert(std::string(key));
    const std::string first_key = first->key, origin = first->origin;
    FormValues values;
    const std::string written = fmt::format("by {}", first_key);
    if (context_.errors.collect([&] { values = read_keys(form); })) {
      std::map<std::string, ConfigNode> results;
      for (const auto& [key, value] : computed(form, values))
        results[key] = {ConfigNode::Type::scalar, number_text(value), false, origin, written, {}, {}};
      replace(first_key, results);
    }
    for (const Field& key : form.words.keys)
      if (!has_key(fields_, key.key)) erase(std::string(key.key));
  }
  /// Two forms of one section may share a key (signal of a sensor and of a valve): the one with all it needs is meant.
  bool names_form(const Form& form) const {
    return std::ranges::all_of(form.words.keys, [&](const Field& key) {
      return key.presence == Presence::optional || map_.find(std::string(key.key)) != nullptr ||
             std::ranges::none_of(all_forms(), [&](const Form& other) {
               return &other != &form && fits(other, fields_) && shares_stated_key(other, form);
             });
    });
  }
  bool shares_stated_key(const Form& a, const Form& b) const {
    return std::ranges::any_of(a.words.keys, [&](const Field& key) {
      return has_key(b.words.keys, key.key) && map_.find(std::string(key.key)) != nullptr;
    });
  }
  FormResult computed(const Form& form, const FormValues& values) const {
    for (const std::string_view key : form.needs)
      if (!values.contains(key)) return {};
    return form.compute(values, context_.rig);
  }

  FormValues read_keys(const Form& form) {
    FormValues values;
    for (const Field& key : form.words.keys) {
      const std::string name(key.key), path = join_path(path_, name);
      const ConfigNode::Entry* entry = map_.find(name);
      if (entry == nullptr && key.presence == Presence::optional) continue;
      if (entry == nullptr)
        refuse(map_.origin, path, "nothing", fmt::format("it beside the others of its form ({})", form.words.rule));
      const bool is_range = std::ranges::find(form.ranges, key.key) != form.ranges.end();
      values[key.key] = is_range ? range_of(key, entry->value, path) : one_of(key, entry->value, path);
    }
    for (const std::string_view key : form.needs) {
      const ConfigNode::Entry* entry = map_.find(std::string(key));
      const auto number = entry != nullptr ? number_from_text(entry->value.text) : std::nullopt;
      if (number && *number > 0.0) values[key] = {*number, *number};
    }
    return values;
  }
  std::array<double, 2> one_of(const Field& key, const ConfigNode& node, const std::string& path) const {
    const bool is_pure = key.unit == "-";
    const ReadQuantity read =
        is_pure ? ReadQuantity{number_from_text(node.text), "a number"} : read_quantity(key, node.text, datums());
    if (!read.value || !(*read.value >= key.minimum && *read.value <= key.maximum))
      refuse(node.origin, path, describe(node),
             fmt::format("{}, {} to {} in {}", read.expected, number_text(key.minimum), number_text(key.maximum),
                         key.unit));
    return {*read.value, *read.value};
  }
  /// A current becomes a voltage by the shunt.
  std::array<double, 2> range_of(const Field& key, const ConfigNode& node, const std::string& path) const {
    const ReadRange read = read_range(key, node.text, datums());
    if (read.ends) return *read.ends;
    const ConfigNode::Entry* shunt = map_.find("shunt");
    if (key.key == "signal" && shunt != nullptr) {
      const Field current{"signal", "A", -1, 1, ""}, resistor{"shunt", "V/A", 1e-3, 1e6, ""};
      const ReadRange amperes = read_range(current, node.text, datums());
      const ReadQuantity ohms = read_quantity(resistor, shunt->value.text, datums());
      if (amperes.ends && ohms.value) return {(*amperes.ends)[0] * *ohms.value, (*amperes.ends)[1] * *ohms.value};
    }
    refuse(node.origin, path, describe(node), read.expected);
  }

  ConfigNode& map_;
  const std::string& path_;
  const std::vector<Field>& fields_;
  ReadContext& context_;
  std::set<std::string> excused_;
};

}  // namespace

std::vector<DataSheetForm> forms_of(const std::vector<Field>& fields) {
  std::vector<DataSheetForm> out;
  for (const Form& form : all_forms())
    if (fits(form, fields)) out.push_back(form.words);
  return out;
}

std::set<std::string> translate_data_sheet(ConfigNode& map, const std::string& path, const std::vector<Field>& fields,
                                           ReadContext& context) {
  return Translation(map, path, fields, context).run();
}

}  // namespace pneuservo
