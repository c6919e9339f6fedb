// A valve that was measured: areas or flows over the command, turned into the numbers of a config.
#include "config/valve_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/valve.hpp>

#include "config/data_sheet.hpp"
#include "config/number_text.hpp"
#include "config/section_reader.hpp"

namespace pneuservo {

namespace {

constexpr std::size_t least_points = 8;  // twice the numbers of one edge's slope and ends
/// Offsets up to a tenth and overlaps up to half of the command are looked for, at last in steps of 1e-5 of it.
constexpr double most_offset = 0.1, most_overlap = 0.5, finest_step = 1e-5;
constexpr int grid_places = 10;  // to both sides

ValveParameters<double> valve_of(const ValveTableFit& fit, double command_max_V) {
  return {command_max_V, fit.area_per_volt_m2_per_V, fit.area_max_m2, 0.5};
}

/// Solves the normal equations of slope, slope * near_middle and slope * wide_open for a given offset and overlap.
/// Points at the largest area are the stop's and tell no slope.
void solve_slopes(std::span<const ValvePoint> points, double command_max_V, ValveTableFit& fit) {
  std::array<std::array<double, 4>, 3> rows{};
  for (const ValvePoint& point : points) {
    const double spool = std::abs(point.command_V + fit.offset_V), open = std::max(0.0, spool - fit.dead_band_V);
    if (open == 0.0 || point.area_m2 >= fit.area_max_m2) continue;
    const double bend = 0.1 * command_max_V;
    const std::array<double, 3> x{open, open * bend / (bend + spool), open * spool / command_max_V};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) rows[i][k] += x[i] * x[k];
      rows[i][3] += x[i] * point.area_m2;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) rows[i][i] *= 1.0 + 1e-9;  // also where the points tell less than three numbers
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == i || rows[i][i] == 0.0) continue;
      const double share = rows[k][i] / rows[i][i];
      for (std::size_t c = 0; c < 4; ++c) rows[k][c] -= share * rows[i][c];
    }
  const auto solved = [&](std::size_t i) { return rows[i][i] > 0.0 ? rows[i][3] / rows[i][i] : 0.0; };
  fit.area_per_volt_m2_per_V = std::max(solved(0), 1e-12);
  fit.near_middle = std::clamp(solved(1) / fit.area_per_volt_m2_per_V, -0.9, 10.0);
  fit.wide_open = std::clamp(solved(2) / fit.area_per_volt_m2_per_V, -0.9, 10.0);
}

double misfit(std::span<const ValvePoint> points, double command_max_V, const ValveTableFit& fit) {
  ValveEffects<double> effects;
  effects.valve_offset.offset_V = fit.offset_V;
  effects.valve_dead_band.width_V = fit.dead_band_V;
  effects.valve_curve = {fit.near_middle, fit.wide_open};
  Valve<double> valve;
  valve.configure(valve_of(fit, command_max_V), effects, 1e-3);
  double squares = 0;
  for (const ValvePoint& point : points) {
    const PortAreas<double> areas = valve.areas(point.command_V);
    squares += std::pow(areas.supply + areas.exhaust - point.area_m2, 2);
  }
  return std::sqrt(squares / static_cast<double>(points.size()));
}

const ConfigNode* value_at(const ConfigNode& map, const std::string& key) {
  const ConfigNode::Entry* entry = map.find(key);
  return entry == nullptr ? nullptr : &entry->value;
}

std::optional<double> number_at(const ConfigNode& map, const std::string& key) {
  const ConfigNode* node = value_at(map, key);
  return node == nullptr ? std::nullopt : number_from_text(node->text);
}

double positive_at(const ConfigNode& map, const std::string& path, const std::string& key) {
  const std::optional<double> number = number_at(map, key);
  if (!number || !(*number > 0.0))
    refuse(map.origin, join_path(path, key), number ? number_text(*number) : "nothing", "a number above 0");
  return *number;
}

std::vector<double> numbers_at(const ConfigNode& table, const std::string& key) {
  const std::string path = join_path("valve.table", key);
  const ConfigNode* list = value_at(table, key);
  if (list == nullptr) refuse(table.origin, path, "nothing", "a list of numbers");
  std::vector<double> out;
  for (const ConfigNode& item : list->items) {
    const std::optional<double> number = number_from_text(item.text);
    if (!number || !std::isfinite(*number)) refuse(item.origin, path, describe(item), "a number");
    out.push_back(*number);
  }
  if (out.size() < least_points)
    refuse(list->origin, path, fmt::format("{} numbers", out.size()), fmt::format("at least {}", least_points));
  return out;
}

/// A section with units and data-sheet keys as SI numbers. What is wrong in it is told where it is read.
template <class Section> ConfigNode as_numbers(ConfigNode section, const std::string& path) {
  InputErrors told_elsewhere;
  const Rig no_rig;
  ReadContext context{no_rig, told_elsewhere};
  translate_data_sheet(section, path, fields_of(Section{}), context);
  return section;
}

/// Area of a hole that passes 1 kg/s as the measurement was made.
double area_per_flow(const ConfigNode& root, const ConfigNode& valve, const ConfigNode& table) {
  AirParameters<double> parameters;
  if (const ConfigNode* stated = value_at(root, "air")) {
    const ConfigNode air = as_numbers<AirParameters<double>>(*stated, "air");
    if (const auto R = number_at(air, "gas_constant_J_per_kgK")) parameters.gas_constant_J_per_kgK = *R;
    if (const auto T = number_at(air, "temperature_K")) parameters.temperature_K = *T;
  }
  const double from_Pa = positive_at(table, "valve.table", "upstream_Pa"),
               to_Pa = positive_at(table, "valve.table", "downstream_Pa");
  if (from_Pa <= to_Pa)
    refuse(table.origin, "valve.table.upstream_Pa", number_text(from_Pa),
           fmt::format("more than downstream_Pa, which is {}", number_text(to_Pa)));
  return 1.0 / orifice_flux(Air<double>(parameters), from_Pa, parameters.temperature_K, to_Pa,
                            positive_at(valve, "valve", "critical_pressure_ratio"));
}

constexpr std::array<std::string_view, 5> table_keys{"command_V", "area_m2", "flow_kgps", "upstream_Pa",
                                                     "downstream_Pa"};

std::vector<ValvePoint> points_of(const ConfigNode& root, const ConfigNode& valve, const ConfigNode& table,
                                  double command_max_V) {
  const bool is_flow = table.find("flow_kgps") != nullptr;
  for (const ConfigNode::Entry& entry : table.entries)
    if (std::ranges::find(table_keys, entry.key) == table_keys.end())
      refuse(entry.origin, join_path("valve.table", entry.key), "an unknown key",
             "command_V with area_m2, or with flow_kgps, upstream_Pa and downstream_Pa");
  const std::string key = is_flow ? "flow_kgps" : "area_m2";
  const std::vector<double> commands = numbers_at(table, "command_V"), values = numbers_at(table, key);
  if (commands.size() != values.size())
    refuse(table.origin, join_path("valve.table", key), fmt::format("{} numbers", values.size()),
           fmt::format("{}, one for each of command_V", commands.size()));
  const double factor = is_flow ? area_per_flow(root, valve, table) : 1.0;
  std::vector<ValvePoint> out;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (std::abs(commands[i]) > command_max_V)
      refuse(table.origin, "valve.table.command_V", number_text(commands[i]),
             fmt::format("commands within +-command_max_V, {} V", number_text(command_max_V)));
    out.push_back({commands[i], factor * std::abs(values[i])});
  }
  if (std::ranges::max(out, {}, &ValvePoint::area_m2).area_m2 <= 0.0)
    refuse(table.origin, join_path("valve.table", key), "no value but 0", "those of a valve that opens");
  return out;
}

using Sizes = std::vector<std::pair<std::string, double>>;

ConfigNode map_of(const std::string& origin, const Sizes& sizes) {
  ConfigNode map;
  map.type = ConfigNode::Type::map;
  map.origin = origin;
  for (const auto& [key, value] : sizes)
    map.entries.push_back(
        {key, origin, {ConfigNode::Type::scalar, number_text(value), false, origin, "by valve.table", {}, {}}});
  return map;
}

void put_effects(ConfigNode& root, const std::string& origin, const ValveTableFit& fit) {
  if (root.find("effects") == nullptr) root.entries.push_back({"effects", origin, map_of(origin, {})});
  ConfigNode& effects = root.find("effects")->value;
  const auto put = [&](const std::string& name, const Sizes& sizes) {
    if (effects.find(name) == nullptr) effects.entries.push_back({name, origin, map_of(origin, sizes)});
  };
  put("valve_offset", {{"offset_V", fit.offset_V}});
  put("valve_dead_band", {{"width_V", fit.dead_band_V}});
  put("valve_curve", {{"near_middle", fit.near_middle}, {"wide_open", fit.wide_open}});
}

void translate(ConfigNode& root, ConfigNode& valve) {
  const ConfigNode table = valve.find("table")->value;
  std::erase_if(valve.entries, [](const ConfigNode::Entry& entry) { return entry.key == "table"; });
  for (const char* key : {"area_per_volt_m2_per_V", "area_max_m2"})
    if (const ConfigNode::Entry* stated = valve.find(key))
      refuse(table.origin, "valve.table", fmt::format("it beside {} (at {})", key, stated->origin), "one of the two");
  const ConfigNode numbers = as_numbers<ValveParameters<double>>(valve, "valve");
  const double command_max_V = positive_at(numbers, "valve", "command_max_V");
  const ValveTableFit fit = fit_valve_table(points_of(root, numbers, table, command_max_V), command_max_V);
  const Sizes areas{{"area_per_volt_m2_per_V", fit.area_per_volt_m2_per_V}, {"area_max_m2", fit.area_max_m2}};
  for (ConfigNode::Entry& entry : map_of(table.origin, areas).entries) valve.entries.push_back(entry);
  put_effects(root, table.origin, fit);
}

}  // namespace

ValveTableFit fit_valve_table(std::span<const ValvePoint> points, double command_max_V) {
  ValveTableFit best;
  best.misfit_m2 = infinite;
  ValveTableFit center;
  center.area_max_m2 = std::ranges::max(points, {}, &ValvePoint::area_m2).area_m2;
  center.dead_band_V = 0.5 * most_overlap * command_max_V;
  // A grid about the best place so far, a fifth as wide each time.
  for (double share = 1.0; share * most_offset > grid_places * finest_step; share *= 0.2) {
    for (int i = -grid_places; i <= grid_places; ++i)
      for (int k = -grid_places; k <= grid_places; ++k) {
        ValveTableFit tried = center;
        tried.offset_V += share * most_offset * command_max_V * i / grid_places;
        tried.dead_band_V =
            std::max(0.0, tried.dead_band_V + share * 0.5 * most_overlap * command_max_V * k / grid_places);
        solve_slopes(points, command_max_V, tried);
        tried.misfit_m2 = misfit(points, command_max_V, tried);
        if (tried.misfit_m2 < best.misfit_m2) best = tried;
      }
    center.offset_V = best.offset_V;
    center.dead_band_V = best.dead_band_V;
  }
  return best;
}

void translate_valve_table(ConfigNode& root, InputErrors& errors) {
  ConfigNode::Entry* valve = root.find("valve");
  if (valve == nullptr || valve->value.find("table") == nullptr) return;
  ConfigNode section = valve->value;
  errors.collect([&] { translate(root, section); });
  root.find("valve")->value = std::move(section);
}

}  // namespace pneuservo
