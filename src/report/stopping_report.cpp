// Stopping times and distances of a rig in words and as JSON.
#include "report/stopping_report.hpp"

#include <cmath>

#include <fmt/format.h>

#include "report/json_number.hpp"
#include "report/table.hpp"

namespace pneuservo {
namespace {

std::string_view action_name(const Rig& rig) {
  return safe_action_names[static_cast<std::size_t>(rig.safe_output.action)];
}

std::string rows_text(const Rig& rig, const StoppingTable& table) {
  std::vector<double> speed, reaction, way, total, standstill, rest, further;
  for (const StoppingRow& row : table.rows) {
    speed.push_back(row.speed_mps);
    reaction.push_back(1e3 * row.speed_mps * table.reaction_s);
    way.push_back(1e3 * row.worst.distance_m);
    total.push_back(reaction.back() + way.back());
    standstill.push_back(1e3 * (row.standstill_s + table.reaction_s));
    rest.push_back(1e3 * (row.rest_s + table.reaction_s));
    further.push_back(1e3 * row.further_m);
  }
  return text_table(
      {.title = fmt::format("Stops of {} by safe_output.action: {}, the worst from up to each speed", rig.name,
                            action_name(rig)),
       .columns = {figure_column("speed", "m/s", speed, 3), figure_column("reaction", "mm", reaction, 1),
                   figure_column("stopping", "mm", way, 1), figure_column("together", "mm", total, 1),
                   figure_column("standstill after", "ms", standstill, 0),
                   figure_column("at rest after", "ms", rest, 0), figure_column("to and fro then", "mm", further, 1)}});
}

}  // namespace

std::string stopping_text(const Rig& rig, const StoppingTable& table) {
  if (table.rows.empty()) return rig.name + ": the axis does not move\n";
  const Stop& own = table.own_reference;
  std::string text = rows_text(rig, table);
  text += fmt::format(
      "\nThe machine as configured, at the top speed of its own reference: {} mm from {} m/s at t = {:.6g} s.\n",
      figure(1e3 * own.distance_m), figure(own.speed_mps), own.at_s);
  if (table.moves_left_out > 0)
    text += fmt::format("{} of {} moves at other places are left out: the law cannot be planned for them.\n",
                        table.moves_left_out, table.moves);
  text += fmt::format(
      "Reaction: {} ms from a cause at the inputs to the command at the valve. What finds the cause comes before.\n",
      figure(1e3 * table.reaction_s));
  if (table.watchdog_s > 0.0)
    text += fmt::format("By the devices' watchdog of {} ms alone, from top speed: {} mm.\n",
                        figure(1e3 * table.watchdog_s), figure(1e3 * table.watchdog_distance_m));
  text += fmt::format("Force of the gas on a slider that is held where the stop began: up to {} N.\n",
                      figure(table.held_force_N));
  text += std::isfinite(table.vent_s)
              ? fmt::format("Both chambers are vented {} s after it; before, the gas can do up to {} J.\n",
                            figure(table.vent_s), figure(table.stored_energy_J))
              : fmt::format("The gas stays in, for ever: it can do up to {} J.\n", figure(table.stored_energy_J));
  text += fmt::format(
      "A vented axis whose supply comes back on a fully open valve reaches {} m/s: the supply needs a soft start.\n",
      figure(table.repressurising_speed_mps));
  text +=
      std::isfinite(table.drop_s)
          ? fmt::format("Mounted upright, its carrying chamber open through the bore of the line: {} s for half the "
                        "stroke, {} m/s.\n",
                        figure(table.drop_s), figure(table.drop_speed_mps))
          : "Mounted upright, its carrying chamber open through the bore of the line: it sinks for more than 5 s.\n";
  return text + "Simulated from the config; no measurement of this machine, and no safety function (docs/safety.md).\n";
}

nlohmann::ordered_json stopping_json(const Rig& rig, const StoppingTable& table) {
  const auto stop = [](const Stop& one) {
    return Json{{"at_s", one.at_s},
                {"speed_mps", one.speed_mps},
                {"distance_m", one.distance_m},
                {"standstill_s", number(one.standstill_s)},
                {"rest_s", number(one.rest_s)},
                {"further_m", one.further_m},
                {"meets_end_stop", one.meets_end_stop}};
  };
  Json json{{"rig", rig.name},
            {"safe_output", std::string(action_name(rig))},
            {"top_speed_mps", table.top_speed_mps},
            {"reaction_s", table.reaction_s},
            {"own_reference", stop(table.own_reference)},
            {"moves", table.moves},
            {"moves_left_out", table.moves_left_out}};
  json["from_up_to"] = Json::array();
  for (const StoppingRow& row : table.rows)
    json["from_up_to"].push_back({{"speed_mps", row.speed_mps},
                                  {"reaction_m", row.speed_mps * table.reaction_s},
                                  {"distance_m", row.worst.distance_m},
                                  {"standstill_s", number(row.standstill_s)},
                                  {"rest_s", number(row.rest_s)},
                                  {"further_m", row.further_m},
                                  {"worst", stop(row.worst)}});
  json["watchdog_s"] = table.watchdog_s > 0.0 ? Json(table.watchdog_s) : Json(nullptr);
  json["watchdog_distance_m"] = table.watchdog_s > 0.0 ? Json(table.watchdog_distance_m) : Json(nullptr);
  json["held_force_N"] = table.held_force_N;
  json["stored_energy_J"] = table.stored_energy_J;
  json["vent_s"] = number(table.vent_s);
  json["repressurising_speed_mps"] = table.repressurising_speed_mps;
  json["drop_s"] = number(table.drop_s);
  json["drop_speed_mps"] = table.drop_speed_mps;
  return json;
}

}  // namespace pneuservo
