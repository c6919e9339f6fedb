// Text, JSON and tables of the thesis' rows.
#include "thesis/report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuservo {
namespace {

std::string_view word(ThesisVerdict verdict) { return thesis_verdict_names[static_cast<std::size_t>(verdict)]; }
std::string_view word(ThesisPlant plant) { return thesis_plant_names[static_cast<std::size_t>(plant)]; }

std::string what_of(const ThesisRow& row) { return row.unit.empty() ? row.what : row.what + ", " + row.unit; }

/// What a moved row was held to be.
std::string moved_words(const ThesisRow& row) {
  const std::string& wanted = !row.held.empty() ? row.held : row.meant.empty() ? row.printed : row.meant;
  if (std::isnan(thesis_number(wanted))) return fmt::format("expected {}", wanted);
  return fmt::format("expected {} within {:.3g}", wanted,
                     thesis_tolerance(wanted, row.held.empty() ? row.within : row.held_within));
}

std::string reason_of(const ThesisFinding& finding) {
  if (finding.verdict != ThesisVerdict::moved) return finding.row->why;
  return moved_words(*finding.row) + (finding.row->why.empty() ? "" : "; " + finding.row->why);
}

/// Each reason of the group once, in the order of its rows.
std::vector<std::string> reasons_of(const ThesisResult& result) {
  std::vector<std::string> out;
  for (const ThesisFinding& finding : result.findings) {
    const std::string reason = reason_of(finding);
    if (!reason.empty() && std::ranges::find(out, reason) == out.end()) out.push_back(reason);
  }
  return out;
}

nlohmann::ordered_json row_json(const ThesisFinding& f) {
  const ThesisRow& row = *f.row;
  nlohmann::ordered_json out{{"place", row.place},     {"what", row.what},       {"unit", row.unit},
                             {"printed", row.printed}, {"corrected", row.meant}, {"plant", word(row.plant)}};
  if (!f.ours.words.empty()) out["ours"] = f.ours.words;
  else if (std::isfinite(f.ours.value)) out["ours"] = f.ours.value;
  else out["ours"] = nullptr;
  out["held"] = row.held;
  out["verdict"] = word(f.verdict);
  out["reason"] = reason_of(f);
  out["command"] = thesis_command(row);
  return out;
}

}  // namespace

std::vector<std::size_t> thesis_counts(const std::vector<ThesisResult>& results) {
  std::vector<std::size_t> counts(std::size(thesis_verdict_names));
  for (const ThesisResult& result : results)
    for (const ThesisFinding& finding : result.findings) ++counts[static_cast<std::size_t>(finding.verdict)];
  return counts;
}

std::string thesis_summary(const std::vector<ThesisResult>& results) {
  const auto counts = thesis_counts(results);
  std::size_t all = 0;
  for (const std::size_t count : counts) all += count;
  std::string text = fmt::format("{} rows", all);
  for (std::size_t i = 0; i < counts.size(); ++i)
    text += fmt::format("{} {} {}", i == 0 ? ":" : ",", counts[i], thesis_verdict_names[i]);
  return text;
}

std::string thesis_left_out(const std::vector<ThesisResult>& results) {
  const auto has = [&](std::string_view title) {
    return std::ranges::any_of(results, [&](const ThesisResult& one) { return one.title.starts_with(title); });
  };
  if (!has("2.4 Linear models") || has("2.4 What diagnose says")) return "";
  return "Left out: what diagnose says that each linear model of 2.4 lacks; it takes some minutes: pneuservo thesis "
         "--only 'Fig 2.2' --diagnose";
}

Table thesis_table(const ThesisResult& result) {
  const auto column = [&](const char* title, const auto& text) {
    std::vector<std::string> cells;
    for (const ThesisFinding& finding : result.findings) cells.push_back(text(finding));
    return text_column(title, cells);
  };
  const std::vector<std::string> reasons = reasons_of(result);
  const auto number = [&](const ThesisFinding& f) {
    const auto at = std::ranges::find(reasons, reason_of(f));
    return at == reasons.end() ? std::string() : fmt::format("[{}]", at - reasons.begin() + 1);
  };
  Table table{.title = result.title,
              .columns = {column("place", [](const ThesisFinding& f) { return f.row->place; }),
                          column("what", [](const ThesisFinding& f) { return what_of(*f.row); }),
                          column("printed", [](const ThesisFinding& f) { return f.row->printed; }),
                          column("should be", [](const ThesisFinding& f) { return f.row->meant; }),
                          column("ours", [](const ThesisFinding& f) { return thesis_value_text(f); }),
                          column("on", [](const ThesisFinding& f) { return std::string(word(f.row->plant)); }),
                          column("verdict", [](const ThesisFinding& f) { return std::string(word(f.verdict)); }),
                          column("why", number)}};
  return table;
}

std::vector<std::string> thesis_reasons(const ThesisResult& result) {
  std::vector<std::string> out;
  for (const std::string& reason : reasons_of(result)) out.push_back(fmt::format("[{}] {}", out.size() + 1, reason));
  return out;
}

std::string thesis_text(const std::vector<ThesisResult>& results) {
  std::string text;
  for (const ThesisResult& result : results) {
    text += text_table(thesis_table(result));
    for (const std::string& reason : thesis_reasons(result)) text += "  " + reason + "\n";
    text += "\n";
  }
  text += thesis_summary(results) + "\n";
  const std::string left_out = thesis_left_out(results);
  return left_out.empty() ? text : text + left_out + "\n";
}

nlohmann::ordered_json thesis_json(const std::vector<ThesisResult>& results) {
  nlohmann::ordered_json out;
  const auto counts = thesis_counts(results);
  for (std::size_t i = 0; i < counts.size(); ++i) out["verdicts"][std::string(thesis_verdict_names[i])] = counts[i];
  out["groups"] = nlohmann::ordered_json::array();
  for (const ThesisResult& result : results) {
    nlohmann::ordered_json group{{"title", result.title}, {"rows", nlohmann::ordered_json::array()}};
    for (const ThesisFinding& finding : result.findings) group["rows"].push_back(row_json(finding));
    out["groups"].push_back(group);
  }
  return out;
}

}  // namespace pneuservo
