// The manual page of the config format, made from the declarations that the reader uses.
#include "config/config_manual.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "config/data_sheet.hpp"
#include "config/field_text.hpp"
#include "config/reference_fields.hpp"
#include "config/section_reader.hpp"

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

namespace {

struct Row {
  std::string key, unit, range, standard, help;
  bool operator==(const Row&) const = default;
};
struct Table {
  std::string title, note;
  std::vector<Row> rows;
};

Row make_row(const std::string& key, const Field& field, const std::string& range, const std::string& standard) {
  return {key, std::string(field.unit), range, standard, std::string(field.help)};
}
std::string section_presence(const Field& field) {
  return field.presence == Presence::required ? "required" : "optional";
}

/// Default of an optional key as the struct has it.
template <class T> std::string standard_text(const Field& field, const T& value) {
  if (field.presence == Presence::required) return "required";
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::string>)
    return is_unstated(field, value) ? (std::is_same_v<T, std::string> ? "not stated" : "see help")
                                     : value_text(field, value);
  else return "not stated";
}

/// Keys of data sheets that a section takes instead of SI keys.
template <class Section> void add_sheet_rows(std::vector<Row>& rows, const std::string& prefix,
                                             const Section& section) {
  for (const DataSheetForm& form : forms_of(fields_of(section)))
    for (const Field& key : form.keys)
      rows.push_back(make_row(prefix + std::string(key.key), key, range_text(key),
                              fmt::format("gives {}", fmt::join(form.gives, ", "))));
}

/// Rows of a section; the keys of sections within it follow with their path.
struct RowCollector {
  std::vector<Row>& rows;
  std::string prefix;

  template <class T> void operator()(const Field& field, const T& value) const {
    const std::string key = prefix + std::string(field.key);
    if constexpr (ParameterSection<T>) {
      rows.push_back(make_row(key, field, "section", section_presence(field)));
      T::visit(RowCollector{rows, key + "."}, value);
      add_sheet_rows(rows, key + ".", value);
    } else {
      rows.push_back(make_row(key, field, accepted_text(field, value), standard_text(field, value)));
    }
  }
  template <ParameterSection T> void operator()(const Field& field, const std::map<std::string, T>&) const {
    const std::string key = prefix + std::string(field.key);
    rows.push_back(make_row(key, field, "section of sections", section_presence(field)));
    const T section;
    T::visit(RowCollector{rows, key + ".NAME."}, section);
  }
  template <class T> void operator()(const Field& field, const std::optional<T>&) const {
    if constexpr (ParameterSection<T>) (*this)(field, T{});
    else rows.push_back(make_row(prefix + std::string(field.key), field, range_text(field), "not stated"));
  }
};

/// One table a section, after one with the keys of the top.
struct TableCollector {
  std::vector<Table>& tables;
  template <class T> void operator()(const Field& field, const T& value) const {
    if constexpr (std::is_same_v<T, PressureReferenceParameters>) add_pressure_reference(field);
    else if constexpr (ParameterSection<T>) add_section(field, value);
    else if constexpr (std::is_same_v<T, ReferenceSpec>) add_references(field);
    else RowCollector{tables.front().rows, ""}(field, value);
  }
  template <ParameterSection T> void operator()(const Field& field, const std::optional<T>&) const {
    add_section(field, T{});
  }

 private:
  template <class T> void add_section(const Field& field, const T& section) const {
    add_top_row(field);
    Table table{fmt::format("`{}`", field.key), std::string(field.help), {}};
    T::visit(RowCollector{table.rows, ""}, section);
    add_sheet_rows(table.rows, "", section);
    if constexpr (std::is_same_v<T, AxisEffects<double>>) add_sensor_effects(table);
    tables.push_back(std::move(table));
  }
  static void add_sensor_effects(Table& table) {
    std::vector<Row> rows;
    const SensorEffects<double> neutral;
    SensorEffects<double>::visit(RowCollector{rows, ""}, neutral);
    for (Row& row : rows) {
      row.key.insert(std::min(row.key.find('.'), row.key.size()), ":CHANNEL");
      table.rows.push_back(std::move(row));
    }
    table.note += fmt::format(". Neutral where absent. CHANNEL is one of {}", fmt::join(names_of(all_signals), ", "));
  }
  void add_references(const Field& field) const {
    add_top_row(field);
    for (std::size_t i = 0; i < reference_kind_names.size(); ++i) {
      ReferenceSpec reference;
      reference.kind = static_cast<ReferenceKind>(i);
      reference.smoothness = default_smoothness(reference.kind);
      Table table{fmt::format("`reference` of kind `{}`", reference_kind_names[i]), "", {}};
      visit_reference(reference.kind, RowCollector{table.rows, ""}, static_cast<const ReferenceSpec&>(reference));
      tables.push_back(std::move(table));
    }
  }
  /// Keys of a pressure's reference beyond those of the kind that the rig has here.
  void add_pressure_reference(const Field& field) const {
    add_top_row(field);
    for (std::size_t i = 0; i < pressure_reference_names.size(); ++i) {
      PressureReferenceParameters reference;
      reference.kind = static_cast<PressureReferenceKind>(i);
      Table table{fmt::format("`reference` of kind `{}`", pressure_reference_names[i]), "", {}};
      PressureReferenceParameters::visit(RowCollector{table.rows, ""}, std::as_const(reference));
      tables.push_back(std::move(table));
    }
  }
  void add_top_row(const Field& field) const {
    tables.front().rows.push_back(make_row(std::string(field.key), field, "section", section_presence(field)));
  }
};

std::vector<Table> tables_of(RigKind kind, ControllerKind law) {
  std::vector<Table> tables{{"Top of the file", "Sections have their own tables below", {}}};
  Rig rig;
  rig.kind = kind;
  rig.controller.kind = law;
  if (rig.controls_pressure()) rig.initial.pressure_1_Pa = 0.0;  // not stated: that of the atmosphere
  Rig::visit(TableCollector{tables}, std::as_const(rig));
  return tables;
}

/// Appends the rows of a further kind of rig that the table does not have yet.
void merge_rows(Table& table, const Table& other) {
  for (const Row& row : other.rows)
    if (std::none_of(table.rows.begin(), table.rows.end(), [&](const Row& r) { return r.key == row.key; }))
      table.rows.push_back(row);
}

/// Sections that another kind of rig, or another law, has with other keys follow as tables of their own.
void add_tables(std::vector<Table>& tables, std::vector<Table> further, const std::string& of) {
  if (tables.empty()) {
    tables = std::move(further);
    return;
  }
  merge_rows(tables.front(), further.front());
  for (std::size_t i = 1; i < further.size(); ++i) {
    Table& table = further[i];
    const auto is_same = [&](const Table& t) {
      return t.title.starts_with(table.title) && t.note == table.note && t.rows == table.rows;
    };
    if (const auto same = std::find_if(tables.begin(), tables.end(), is_same); same != tables.end()) {
      if (same->title != table.title) same->title += " and" + of;
      continue;
    }
    table.title += of;
    tables.push_back(std::move(table));
  }
}

std::vector<Table> all_tables() {
  std::vector<Table> tables;
  for (std::size_t i = 0; i < rig_kind_names.size(); ++i) {
    const auto kind = static_cast<RigKind>(i);
    std::vector<ControllerKind> laws = laws_of(kind);
    if (laws.empty()) laws.emplace_back();
    for (const ControllerKind law : laws)
      add_tables(tables, tables_of(kind, law),
                 law == laws.front() ? fmt::format(" of a `{}`", rig_kind_names[i])
                                     : fmt::format(" of a `{}` with the law `{}`", rig_kind_names[i], name_of(law)));
  }
  return tables;
}

std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

constexpr const char* example = R"(format: pneuservo-rig/1
name: example
rig: cylinder
period_s: 0.001                      # one control period

supply:   {pressure_Pa: 700000}      # pressures are absolute
valve:    {command_max_V: 5.0, area_per_volt_m2_per_V: 2.6e-6, area_max_m2: 1.3e-5, critical_pressure_ratio: 0.35}
line_1:   {length_m: 10.0, diameter_m: 0.00765}    # valve port 1 to chamber 1
line_2:   {length_m: 10.0, diameter_m: 0.00765}

cylinder:
  stroke_m: 0.300                    # x = 0 is mid-stroke
  area_1_m2: 1.257e-3
  area_2_m2: 1.056e-3
  dead_volume_1_m3: 2.0e-5
  dead_volume_2_m3: 2.0e-5
  wall_heat_W_per_m2K: 50.0
slider:   {mass_kg: 2.0, viscous_friction_Ns_per_m: 60.0}

sensors:
  position:      {quantum_m: 5.0e-6}
  port_pressure: {quantum_Pa: 100.0, noise_Pa: 300.0}

controller:
  kind: pd_force
  pressure_source: estimated         # the pipeline estimator's chamber pressures close the force loop
  position_gain_N_per_m: 7550
  velocity_gain_Ns_per_m: 95.6
  velocity_filter_s: 0.002
  force_gain_V_per_N: 0.00572

reference: {kind: sine, amplitude_m: 0.080, frequency_Hz: 1.0}
duration_s: 5.0

tolerances: {slider.mass_kg: 0.02}   # the owner knows the mass to 2 % (one standard deviation)
effects:                             # physics beside the nominal model, by name
  coulomb_friction: {force_N: 3.0}
)";

constexpr const char* rules =
    R"(One YAML file describes a rig and what to do with it. Numbers are SI and keys carry their unit. An unknown or
missing key, a wrong type, a value out of range or values that contradict each other end the program with status 2. All
errors of a file are told at once, one sentence `FILE:LINE: KEY: found ..., expected ...` each. `--set PATH=VALUE` replaces one key (`--set line_1.length_m=5`,
`--set effects.coulomb_friction.force_N=3`, `--set reference.components.0.1=0.5`); VALUE is YAML.

Without its unit a key takes a value with a unit: `length: 3.5 m` for `length_m: 3.5`, `pressure: 6 bar gauge`,
`area_per_volt: 2.6 mm2/V`, `temperature: 20 degC`. A pressure that counts from vacuum says `gauge` or `absolute`. A position
counts from mid-stroke, or `20 mm from end 1` (where chamber 1 is smallest). Pure numbers take `2 %`. Rows with `gives` are
keys of data sheets, which stand in place of the keys that they give.

)";

}  // namespace

std::string config_example() { return example; }

std::string config_manual() {
  std::string out = "# Config keys\n\n";
  out += "This page is the output of `pneuservo keys --markdown`.\n\n";
  out += rules;
  out += fmt::format("```yaml\n{}```\n", config_example());
  for (const Table& table : all_tables()) {
    out += fmt::format("\n## {}\n\n", table.title);
    if (!table.note.empty()) out += fmt::format("{}.\n\n", table.note);
    out += "| key | unit | range | default | meaning |\n|---|---|---|---|---|\n";
    for (const Row& row : table.rows)
      out += fmt::format("| `{}` | {} | {} | {} | {} |\n", row.key, cell(row.unit), cell(row.range), cell(row.standard),
                         cell(row.help));
  }
  return out;
}

std::string config_manual_text() {
  std::string out;
  for (const Table& table : all_tables()) {
    std::size_t key = 0, unit = 0, range = 0, standard = 0;
    for (const Row& row : table.rows) {
      key = std::max(key, row.key.size()), unit = std::max(unit, row.unit.size());
      range = std::max(range, row.range.size()), standard = std::max(standard, row.standard.size());
    }
    std::string title = table.title;
    std::erase(title, '`');
    if (!out.empty()) out += "\n";
    out += table.note.empty() ? fmt::format("{}\n", title) : fmt::format("{}: {}\n", title, table.note);
    for (const Row& row : table.rows)
      out += fmt::format("  {:<{}}  {:<{}}  {:<{}}  {:<{}}  {}\n", row.key, key, row.unit, unit, row.range, range,
                         row.standard, standard, row.help);
  }
  return out;
}

}  // namespace pneuservo
