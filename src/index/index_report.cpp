// What the verb index says: text, JSON, HTML.
#include "index/index_report.hpp"

#include <fmt/core.h>

#include "index/index_map.hpp"

namespace pneuservo {

namespace {
constexpr const char* index_limits =
    "The index knows the lines and the speed, not the gains: a softer loop may do without the model above 1. pneuservo "
    "thesis --only 'Table 4' tries every verdict by simulation, with two sets of gains.";

NecessityIndex ours(const PrintedIndex& e, int side = 1) {
  return necessity_index(thesis_side(side, e.length_m, e.diameter_m), thesis_peak_speed_mps(e.frequency_Hz));
}
const char* word(double index) { return is_pipeline_model_needed(index) ? "needed" : "not needed"; }

std::string escape(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '&': out += "&amp;"; break;
      default: out += c;
    }
  return out;
}

std::string verdict(const RigNecessity& r) {
  const auto& worst = r.index[static_cast<std::size_t>(r.dominating)];
  return fmt::format(
      "The pipeline model is {}: line {} loses {:.3g} kPa at peak speed, {} the limit of {:g} kPa (index {:.3g}).",
      r.needed ? "needed" : "not needed", r.dominating + 1, 1e-3 * worst.loss_Pa, r.needed ? "at least" : "below",
      1e-3 * necessity_loss_limit_Pa, worst.index);
}

std::string page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html><html lang='en'><head><meta charset='utf-8'><title>" + escape(title) +
         "</title><style>body{font:15px/1.5 system-ui,sans-serif;color:#1f2933;max-width:820px;margin:32px "
         "auto;padding:0 16px}"
         "h1{font-size:24px}h2{font-size:18px;margin-top:28px}table{border-collapse:collapse;margin:10px 0}"
         "th,td{padding:3px 12px;text-align:right;border-bottom:1px solid "
         "#d9dee3}th{font-weight:600}td.word,th.word{text-align:left}"
         "tr.differs td{background:#fff1d6}.verdict{font-size:17px;padding:10px 14px;border-left:4px solid "
         "#b3541e;background:#fdf3ea}"
         ".verdict.no{border-color:#2f6ea5;background:#eef5fb}svg{max-width:100%;height:auto}svg text{font:12px "
         "system-ui,sans-serif;fill:#1f2933}"
         ".grid{stroke:#1f2933;stroke-opacity:.12}.iso{fill:none;stroke:#1f2933;stroke-opacity:.35}.limit{fill:none;"
         "stroke:#1f2933;stroke-width:2.5}"
         "svg .limit-label,svg "
         ".point{font-weight:600;paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}circle.filled{"
         "fill:#1f2933;stroke:#fff;stroke-width:1.5}circle.open{fill:#fff;stroke:#1f2933;stroke-width:2}"
         ".note{color:#52606d}</style></head><body><h1>" +
         escape(title) + "</h1>" + body + "</body></html>\n";
}

std::string map_note(const NecessitySide& side, double speed_mps, int number) {
  return fmt::format(
      "<p class='note'>Side {}: {:.4g} kPa, piston area {:.4g} mm², peak speed {:.4g} m/s, viscosity {:.3g} Pa s. "
      "Index = line loss at peak speed / {:g} kPa; on the warm side of the bold line (index of 1 or more) the pipeline "
      "model is needed.</p>",
      number, 1e-3 * side.pressure_Pa, 1e6 * side.piston_area_m2, speed_mps, side.viscosity_Pas,
      1e-3 * necessity_loss_limit_Pa);
}
}  // namespace

std::string index_text(const std::string& rig_name, const RigNecessity& r) {
  std::string out =
      fmt::format("{}\n{}\n\nside  length m  diameter mm  rest kPa  area mm2  line m/s  Reynolds  loss kPa   index\n",
                  rig_name, r.motion);
  for (std::size_t i = 0; i < 2; ++i)
    out += fmt::format("{:>4}  {:>8.4g}  {:>11.4g}  {:>8.1f}  {:>8.1f}  {:>8.3f}  {:>8.0f}  {:>8.3f}  {:>6.3f}{}\n",
                       i + 1, r.side[i].length_m, 1e3 * r.side[i].diameter_m, 1e-3 * r.side[i].pressure_Pa,
                       1e6 * r.side[i].piston_area_m2, r.index[i].line_velocity_mps, r.index[i].reynolds,
                       1e-3 * r.index[i].loss_Pa, r.index[i].index,
                       static_cast<int>(i) == r.dominating ? "  <- dominates" : "");
  return out + "\n" + verdict(r) + "\n";
}

nlohmann::ordered_json index_json(const std::string& rig_name, const RigNecessity& r) {
  nlohmann::ordered_json out{
      {"config", rig_name}, {"peak_speed_mps", r.peak_speed_mps}, {"loss_limit_Pa", necessity_loss_limit_Pa}};
  for (std::size_t i = 0; i < 2; ++i)
    out["sides"].push_back({{"side", i + 1},
                            {"length_m", r.side[i].length_m},
                            {"diameter_m", r.side[i].diameter_m},
                            {"pressure_Pa", r.side[i].pressure_Pa},
                            {"piston_area_m2", r.side[i].piston_area_m2},
                            {"line_velocity_mps", r.index[i].line_velocity_mps},
                            {"reynolds", r.index[i].reynolds},
                            {"turbulent", r.index[i].turbulent},
                            {"loss_Pa", r.index[i].loss_Pa},
                            {"index", r.index[i].index}});
  out["dominating_side"] = r.dominating + 1;
  out["index"] = r.index[static_cast<std::size_t>(r.dominating)].index;
  out["pipeline_model_needed"] = r.needed;
  return out;
}

std::string index_html(const std::string& rig_name, const RigNecessity& r) {
  std::string body =
      fmt::format("<p class='verdict{}'>{}</p><p>{}</p>", r.needed ? "" : " no", escape(verdict(r)), escape(r.motion));
  body += "<table><tr><th>side</th><th>length, m</th><th>diameter, mm</th><th>at rest, kPa</th><th>line, "
          "m/s</th><th>Reynolds</th><th>loss, kPa</th><th>index</th></tr>";
  for (std::size_t i = 0; i < 2; ++i)
    body += fmt::format("<tr><td>{}</td><td>{:.4g}</td><td>{:.4g}</td><td>{:.1f}</td><td>{:.2f}</td><td>{:.0f}</"
                        "td><td>{:.3f}</td><td>{:.3f}</td></tr>",
                        i + 1, r.side[i].length_m, 1e3 * r.side[i].diameter_m, 1e-3 * r.side[i].pressure_Pa,
                        r.index[i].line_velocity_mps, r.index[i].reynolds, 1e-3 * r.index[i].loss_Pa, r.index[i].index);
  body += "</table>";
  const auto& worst = r.side[static_cast<std::size_t>(r.dominating)];
  if (r.peak_speed_mps > 0.0) {
    body += "<h2>Index over length and diameter for this motion</h2>";
    body += index_map_svg(
        worst, r.peak_speed_mps,
        {{worst.length_m, worst.diameter_m,
          fmt::format("line {}: {:.3g}", r.dominating + 1, r.index[static_cast<std::size_t>(r.dominating)].index),
          true}});
    body += map_note(worst, r.peak_speed_mps, r.dominating + 1);
  }
  return page("Necessity of the pipeline model: " + rig_name, body);
}

std::string index_table_text() {
  std::string out = fmt::format("Necessity index, thesis tables 4.2 and 4.3 (80 mm sine, viscosity {:g} Pa s)\n\n"
                                "table  diameter mm  length m  frequency Hz  printed    ours  side 2  pipeline model\n",
                                thesis_viscosity_Pas);
  std::string remarks;
  for (const PrintedIndex& e : printed_indices()) {
    const double index = ours(e).index;
    out += fmt::format("{:>5}  {:>11.2f}  {:>8g}  {:>12g}  {:>7.2f}  {:>6.3f}  {:>6.3f}  {}{}\n", e.table,
                       1e3 * e.diameter_m, e.length_m, e.frequency_Hz, e.printed, index, ours(e, 2).index, word(index),
                       reproduces(e) ? "" : "  (*)");
    if (!reproduces(e))
      remarks += fmt::format("(*) {:.2f} mm x {:g} m: {}\n", 1e3 * e.diameter_m, e.length_m, e.remark);
  }
  return out + "\n" + remarks + "\n" + index_limits + "\n";
}

nlohmann::ordered_json index_table_json() {
  nlohmann::ordered_json out{
      {"viscosity_Pas", thesis_viscosity_Pas}, {"amplitude_m", 0.08}, {"loss_limit_Pa", necessity_loss_limit_Pa}};
  for (const PrintedIndex& e : printed_indices()) {
    nlohmann::ordered_json row{{"table", e.table},
                               {"diameter_m", e.diameter_m},
                               {"length_m", e.length_m},
                               {"frequency_Hz", e.frequency_Hz},
                               {"printed", e.printed},
                               {"index", ours(e).index},
                               {"index_side_2", ours(e, 2).index},
                               {"reproduced", reproduces(e)},
                               {"pipeline_model_needed", is_pipeline_model_needed(ours(e).index)}};
    if (!reproduces(e)) row["remark"] = e.remark;
    out["entries"].push_back(row);
  }
  return out;
}

std::string index_table_html() {
  std::string body, remarks;
  std::vector<MapPoint> points;
  for (const char* table : {"4.2", "4.3"}) {
    body += fmt::format("<h2>Table {}</h2><table><tr><th>diameter, mm</th><th>length, m</th><th>frequency, "
                        "Hz</th><th>printed</th><th>ours</th>"
                        "<th>side 2</th><th class='word'>pipeline model</th></tr>",
                        table);
    for (const PrintedIndex& e : printed_indices()) {
      if (std::string(e.table) != table) continue;
      const double index = ours(e).index;
      body += fmt::format("<tr{}><td>{:.2f}</td><td>{:g}</td><td>{:g}</td><td>{:.2f}</td><td>{:.3f}</td><td>{:.3f}</"
                          "td><td class='word'>{}</td></tr>",
                          reproduces(e) ? "" : " class='differs'", 1e3 * e.diameter_m, e.length_m, e.frequency_Hz,
                          e.printed, index, ours(e, 2).index, word(index));
      if (std::string(table) == "4.2")
        points.push_back({e.length_m, e.diameter_m, fmt::format("{:.2f}", index), reproduces(e)});
      if (!reproduces(e))
        remarks += fmt::format("<p class='note'>{:.2f} mm x {:g} m: {}.</p>", 1e3 * e.diameter_m, e.length_m,
                               escape(e.remark));
    }
    body += "</table>" + (std::string(table) == "4.2" ? remarks : std::string());
  }
  const NecessitySide side = thesis_side(1, 10, 0.0061);
  body += "<h2>Table 4.2 on the map (80 mm sine, 1 Hz)</h2>" + index_map_svg(side, thesis_peak_speed_mps(1.0), points) +
          map_note(side, thesis_peak_speed_mps(1.0), 1) + fmt::format("<p class='note'>{}</p>", escape(index_limits));
  return page("Necessity index: thesis tables 4.2 and 4.3", body);
}

}  // namespace pneuservo
