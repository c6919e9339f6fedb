// Units that lines of a head state in words.
#include "record/foreign/head_units.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pneuservo/core/signal.hpp>

#include "record/foreign/column_guess.hpp"
#include "record/foreign/column_words.hpp"
#include "record/foreign/field_text.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

namespace {

constexpr std::size_t longest_line = 500;  ///< that is read for units

/// Pieces between any of the signs, without blanks around them; signs in brackets do not part.
std::vector<std::string> pieces_of(std::string_view text, std::string_view signs) {
  std::vector<std::string> out(1);
  int depth = 0;
  for (const char c : text) {
    depth += (c == '(' || c == '[') - (c == ')' || c == ']');
    if (depth == 0 && signs.find(c) != std::string_view::npos) out.emplace_back();
    else out.back() += c;
  }
  for (std::string& piece : out) piece = std::string(trimmed(piece));
  std::erase(out, std::string());
  return out;
}

/// "p1 and p2" is p1, p2; "all pressures" is pressures.
std::vector<std::string> names_of(std::string_view text) {
  constexpr std::array<std::string_view, 9> joints{"and", "und", "et", "y", "e", "och", "en", "i", "with"},
      all{"all", "alle", "the", "every", "both", "tous", "todas", "todos", "tutte"};
  const auto is_one_of = [](const auto& words, const std::string& word) {
    return std::ranges::find(words, in_small_letters(word)) != words.end();
  };
  std::vector<std::string> out;
  for (const std::string& piece : pieces_of(text, "&+/")) {
    out.emplace_back();
    for (const std::string& word : pieces_of(piece, " \t")) {
      if (is_one_of(joints, word) && !out.back().empty()) out.emplace_back();
      else if (!is_one_of(all, word)) out.back() += (out.back().empty() ? "" : " ") + word;
    }
  }
  std::erase(out, std::string());
  return out;
}

/// A word for a quantity that every column of it may bear; "stroke", "timer" and "ambient pressure" say something else.
bool is_quantity_word(const std::string& name) {
  constexpr std::array<std::string_view, 26> words{
      "position",  "positions", "pressure", "pressures", "time",     "times",      "command",   "commands", "zeit",
      "zeiten",    "druck",     "drücke",   "drucke",    "wege",     "positionen", "weg",       "temps",    "pression",
      "pressions", "tiempo",    "presión",  "presiones", "posición", "posizione",  "pressione", "pressioni"};
  return std::ranges::find(words, in_small_letters(name)) != words.end();
}

/// A clause with names, and the text of their unit.
struct StatedUnits {
  std::string names, unit;
};

/// "x in mm", "Position: mm", "u = V", "p1 [bar]".
std::optional<StatedUnits> stated_in(const std::string& clause) {
  const auto cut = [&](std::size_t at, std::size_t size) {
    std::string unit(trimmed(std::string_view(clause).substr(at + size)));
    if (unit.size() > 1 && unit.back() == '.') unit.pop_back();
    return StatedUnits{std::string(trimmed(std::string_view(clause).substr(0, at))), unit};
  };
  for (const std::string_view sign : {" are in ", " is in ", " in ", " en ", ":", "="})
    if (const std::size_t at = clause.rfind(sign); at != std::string::npos && at > 0) {
      StatedUnits out = cut(at, sign.size());
      // "Position: 10 mm" is a value.
      const bool is_value =
          sign.size() == 1 && !out.unit.empty() && std::isdigit(static_cast<unsigned char>(out.unit.front())) != 0;
      if (!is_value && unit_in(out.unit)) return out;
    }
  const std::size_t open = clause.find_last_of("[(");
  if (open == std::string::npos || open == 0 || (clause.back() != ']' && clause.back() != ')')) return std::nullopt;
  StatedUnits out = cut(open, 0);
  return unit_in(out.unit) ? std::optional(out) : std::nullopt;
}

std::optional<Quantity> quantity_of(const std::string& ours) {
  if (ours == "t_s") return Quantity::time;
  if (ours == "x_ref_m") return Quantity::length;
  if (ours == "u_V") return Quantity::voltage;
  const std::optional<Signal> signal = signal_of_column(ours);
  const std::optional<Unit> unit = signal ? unit_in(info(*signal).unit) : std::nullopt;
  return unit ? std::optional(unit->quantity) : std::nullopt;
}

class HeadUnits {
 public:
  explicit HeadUnits(CsvTable& table) : table_(table) {
    for (std::size_t c = 0; c < table.names.size(); ++c)
      meanings_.push_back(stated_unit(table, c).empty() && table.is_clock[c] == 0 ? meaning_of(table.names[c]) : "");
  }

  void take_line(std::string_view line) {
    const std::size_t colon = line.find(':');
    const std::string_view label = trimmed(line.substr(0, std::min(colon, line.size())));
    const bool is_labelled = colon != std::string_view::npos && is_unit_word(label);
    if (is_labelled) line = trimmed(line.substr(colon + 1));
    if (is_labelled && take_list(line)) return;
    std::string pending;  // "p1, p2 in bar"
    std::vector<StatedUnits> found;
    const std::vector<std::string> clauses = pieces_of(line, ",;\t|");
    for (std::size_t i = 0; i < clauses.size(); ++i) {
      std::optional<StatedUnits> stated = stated_in(clauses[i]);
      if (!stated) {
        pending += clauses[i] + " & ";
        continue;
      }
      // "p1 and p2 in bar, gauge"
      if (i + 1 < clauses.size() && unit_in(stated->unit + " " + clauses[i + 1])) stated->unit += " " + clauses[++i];
      for (const std::string& name : names_of(pending + stated->names)) found.push_back({name, stated->unit});
      pending.clear();
    }
    // A line that says anything else ("noise of x in um", "was: x in mm, now: x in m") says no units of columns.
    if (!pending.empty() || !std::ranges::all_of(found, [&](const StatedUnits& one) { return is_known(one.names); }))
      return;
    for (const StatedUnits& one : found) take(one.names, one.unit);
  }

  void tell() const {
    if (!told_.empty())
      table_.report(0, ProblemKind::dialect, fmt::format("units by the head: {}", fmt::join(told_, ", ")));
  }

 private:
  /// A unit for each column, in their order.
  bool take_list(std::string_view text) {
    for (const std::string_view signs : {",", ";", "\t", "|", " "}) {
      const std::vector<std::string> list = pieces_of(text, signs);
      const bool is_list = list.size() == table_.names.size() && std::ranges::all_of(list, [](const std::string& unit) {
                             return unit_in(unit) || unit == "none" || unit == "n/a";
                           });
      if (!is_list || list.size() < 2) continue;
      for (std::size_t c = 0; c < list.size(); ++c) set(c, list[c]);
      return true;
    }
    return false;
  }

  bool is_column(const std::string& name) const {
    return std::ranges::any_of(
        table_.names, [&](const std::string& column) { return in_small_letters(column) == in_small_letters(name); });
  }
  bool is_known(const std::string& name) const { return is_column(name) || is_quantity_word(name); }

  void take(const std::string& name, const std::string& unit) {
    const bool is_exact = is_column(name);
    const std::string meaning = meaning_of(name);
    const bool is_any_pressure = meaning.empty() && says_pressure(name);
    for (std::size_t c = 0; c < table_.names.size(); ++c) {
      if (meanings_[c].empty()) continue;
      const bool is_meant = is_exact ? in_small_letters(table_.names[c]) == in_small_letters(name)
                                     : meaning == meanings_[c] || (meaning == "x_m" && meanings_[c] == "x_ref_m") ||
                                           (is_any_pressure && quantity_of(meanings_[c]) == Quantity::pressure);
      if (is_meant) set(c, unit);
    }
  }

  void set(std::size_t column, const std::string& text) {
    const std::optional<Unit> unit = unit_in(text);
    const std::optional<Quantity> quantity = quantity_of(meanings_[column]);
    if (!table_.units[column].empty() || !unit || !quantity) return;
    const bool is_share = unit->quantity == Quantity::raw && unit->name != "-" && unit->name != "1";
    if (unit->quantity != *quantity && !is_share) return;
    table_.units[column] = text;
    told_.push_back(fmt::format("{} in {}", table_.names[column], without_brackets(text)));
  }

  CsvTable& table_;
  std::vector<std::string> meanings_;  ///< of columns without a unit
  std::vector<std::string> told_;
};

}  // namespace

void take_head_units(CsvTable& table) {
  if (table.comments.empty()) return;
  HeadUnits units(table);
  for (std::string_view rest = table.comments; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    while (!line.empty() && std::string_view("#% \t;\"").find(line.front()) != std::string_view::npos)
      line.remove_prefix(1);
    if (line.size() <= longest_line) units.take_line(trimmed(line));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  units.tell();
}

}  // namespace pneuservo
