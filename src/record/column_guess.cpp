// What the columns of a foreign table are likely to be.
#include "record/column_guess.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <pneuservo/core/signal.hpp>

#include "record/dialect.hpp"
#include "record/field_text.hpp"
#include "record/row_text.hpp"
#include "record/units.hpp"

namespace pneuservo {

namespace {

/// Words that a column's name may begin with, in small letters without signs, and what it then is. The first that fits.
struct Word {
  std::string_view word, ours;
  Quantity quantity;
};
constexpr std::string_view column_of(Signal signal) { return info(signal).column; }
constexpr std::array<Word, 54> words{{{"timestamp", "t_s", Quantity::time},
                                      {"time", "t_s", Quantity::time},
                                      {"zeit", "t_s", Quantity::time},
                                      {"temps", "t_s", Quantity::time},
                                      {"elapsed", "t_s", Quantity::time},
                                      {"uhrzeit", "t_s", Quantity::time},
                                      {"date", "t_s", Quantity::time},
                                      {"datum", "t_s", Quantity::time},
                                      {"xvalue", "t_s", Quantity::time},
                                      {"t", "t_s", Quantity::time},
                                      {"xref", "x_ref_m", Quantity::length},
                                      {"setpoint", "x_ref_m", Quantity::length},
                                      {"sollwert", "x_ref_m", Quantity::length},
                                      {"soll", "x_ref_m", Quantity::length},
                                      {"position", column_of(Signal::x), Quantity::length},
                                      {"pos", column_of(Signal::x), Quantity::length},
                                      {"displacement", column_of(Signal::x), Quantity::length},
                                      {"actualposition", column_of(Signal::x), Quantity::length},
                                      {"istposition", column_of(Signal::x), Quantity::length},
                                      {"weg", column_of(Signal::x), Quantity::length},
                                      {"lage", column_of(Signal::x), Quantity::length},
                                      {"hub", column_of(Signal::x), Quantity::length},
                                      {"stroke", column_of(Signal::x), Quantity::length},
                                      {"course", column_of(Signal::x), Quantity::length},
                                      {"x", column_of(Signal::x), Quantity::length},
                                      {"s", column_of(Signal::x), Quantity::length},
                                      {"command", "u_V", Quantity::voltage},
                                      {"cmd", "u_V", Quantity::voltage},
                                      {"valve", "u_V", Quantity::voltage},
                                      {"ventil", "u_V", Quantity::voltage},
                                      {"stell", "u_V", Quantity::voltage},
                                      {"u", "u_V", Quantity::voltage},
                                      {"p1chamber", column_of(Signal::p1_chamber), Quantity::pressure},
                                      {"p2chamber", column_of(Signal::p2_chamber), Quantity::pressure},
                                      {"chamber1", column_of(Signal::p1_chamber), Quantity::pressure},
                                      {"chamber2", column_of(Signal::p2_chamber), Quantity::pressure},
                                      {"kammer1", column_of(Signal::p1_chamber), Quantity::pressure},
                                      {"kammer2", column_of(Signal::p2_chamber), Quantity::pressure},
                                      {"psupply", column_of(Signal::p_supply), Quantity::pressure},
                                      {"supply", column_of(Signal::p_supply), Quantity::pressure},
                                      {"versorgung", column_of(Signal::p_supply), Quantity::pressure},
                                      {"ps", column_of(Signal::p_supply), Quantity::pressure},
                                      {"p0", column_of(Signal::p_supply), Quantity::pressure},
                                      {"p1", column_of(Signal::p1_port), Quantity::pressure},
                                      {"p2", column_of(Signal::p2_port), Quantity::pressure},
                                      {"pressure1", column_of(Signal::p1_port), Quantity::pressure},
                                      {"pressure2", column_of(Signal::p2_port), Quantity::pressure},
                                      {"druck1", column_of(Signal::p1_port), Quantity::pressure},
                                      {"druck2", column_of(Signal::p2_port), Quantity::pressure},
                                      {"pa", column_of(Signal::p1_port), Quantity::pressure},
                                      {"pb", column_of(Signal::p2_port), Quantity::pressure},
                                      {"force", column_of(Signal::F), Quantity::force},
                                      {"kraft", column_of(Signal::F), Quantity::force},
                                      {"f", column_of(Signal::F), Quantity::force}}};
constexpr std::size_t whole_word = 2;  ///< letters: so short a word must be all of the name

/// A name taken apart: "Weg [mm]", "Weg_mm", "pos (mm)", "p1/bar", "Weg in mm".
struct NameParts {
  std::string text;  ///< without the unit
  std::string unit;
};

std::string letters_of(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)))
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

NameParts parts_of(const std::string& name) {
  const std::size_t last = name.find_last_of("_ /");
  const Unit* suffix = last == std::string::npos || last == 0 ? nullptr : unit_in(name.substr(last + 1));
  if (suffix != nullptr && suffix->quantity < Quantity::raw && name.find_last_of("[<") == std::string::npos) {
    const std::string before(trimmed(std::string_view(name).substr(0, last)));
    return {before.ends_with(" in") ? before.substr(0, before.size() - 3) : before,
            std::string(without_brackets(name.substr(last + 1)))};
  }
  for (const std::string_view pair : {"[]", "<>", "()"}) {
    const std::size_t open = name.find(pair[0]), close = name.rfind(pair[1]);
    if (open != std::string::npos && close != std::string::npos && close > open)
      return {name.substr(0, open), std::string(trimmed(std::string_view(name).substr(open + 1, close - open - 1)))};
  }
  return {name, ""};
}

const Word* word_in(const std::string& letters) {
  for (const Word& word : words)
    if (letters == word.word || (word.word.size() > whole_word && letters.starts_with(word.word))) return &word;
  return nullptr;
}

/// What the name says; of a path such as /axis/position, Main.x its last part.
const Word* word_of(const std::string& text) {
  if (const Word* whole = word_in(letters_of(text))) return whole;
  const std::size_t last = text.find_last_of("/.:\\|");
  return last == std::string::npos ? nullptr : word_in(letters_of(text.substr(last + 1)));
}

bool is_ours(const std::string& name) {
  static const std::vector<std::string> columns = columns_of_the_format();
  return std::find(columns.begin(), columns.end(), name) != columns.end();
}

ColumnGuess guess_column(const CsvTable& table, std::size_t column, double atmosphere_Pa) {
  ColumnGuess out{table.names[column], "", "", 1, 0, ""};
  if (is_ours(out.column)) {
    out.ours = out.column;
    out.evidence = "a name of the recording format";
    return out;
  }
  const NameParts parts = parts_of(out.column);
  const bool in_row = !table.units[column].empty();
  const std::string stated = in_row ? std::string(without_brackets(table.units[column])) : parts.unit;
  out.unit = stated;
  const Word* word = word_of(parts.text);
  if (table.is_clock[column] != 0) {
    out.ours = "t_s";
    out.unit = "date";
    out.evidence = "holds dates or times of day";
    return out;
  }
  const Unit* unit = stated.empty() ? nullptr : unit_in(stated);
  if (word == nullptr || (unit != nullptr && unit->quantity != word->quantity && unit->quantity != Quantity::raw)) {
    out.evidence =
        word == nullptr ? "no known name" : fmt::format("name and unit disagree ({} in {})", word->ours, stated);
    return out;
  }
  out.ours = word->ours;
  out.evidence = fmt::format("named like {}", word->word);
  if (unit == nullptr || unit->quantity == Quantity::raw) {
    out.evidence += stated.empty() ? ", no unit stated: taken for SI"
                                   : fmt::format(", unit {} is none of the quantity: taken for SI", stated);
    return out;
  }
  out.factor = unit->factor;
  out.offset = unit->is_gauge ? atmosphere_Pa : 0;
  out.evidence += in_row ? ", unit stated below the names" : ", unit from its name";
  return out;
}

/// Steps from row to row in which the column's value differs: what tells rows apart is the better clock.
std::size_t changes_of(const std::vector<double>& values) {
  std::size_t changes = 0;
  for (std::size_t i = 1; i < values.size(); ++i) changes += values[i] != values[i - 1];
  return changes;
}

}  // namespace

std::vector<ColumnGuess> guess_columns(const CsvTable& table, double atmosphere_Pa) {
  std::vector<ColumnGuess> out;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    out.push_back(guess_column(table, c, atmosphere_Pa));
    for (std::size_t i = 0; i < c; ++i)
      if (!out[c].ours.empty() && out[i].ours == out[c].ours) {
        const bool is_finer = out[c].ours == "t_s" && changes_of(table.values[c]) > changes_of(table.values[i]);
        ColumnGuess &taken = is_finer ? out[c] : out[i], &left = is_finer ? out[i] : out[c];
        left.evidence = fmt::format("as {}, which is taken for {}", taken.column, taken.ours);
        left.ours.clear();
      }
  }
  return out;
}

ImportParameters import_map(const std::vector<ColumnGuess>& guesses) {
  ImportParameters out;
  for (const ColumnGuess& guess : guesses) {
    if (guess.ours.empty()) continue;
    ImportedColumn column;
    column.column = guess.column;
    column.factor = guess.factor;
    column.offset = guess.offset;
    out.columns[guess.ours] = column;
  }
  return out;
}

std::string source_text(const ImportedColumn& source) {
  YAML::Emitter name;
  name << YAML::DoubleQuoted << source.column;
  const std::string_view sampling = sampling_names[static_cast<std::size_t>(source.sampling)];
  return fmt::format("{{column: {}{}{}{}{}}}", name.c_str(),
                     source.factor != 1 ? fmt::format(", factor: {:.10g}", source.factor) : "",
                     source.offset != 0 ? fmt::format(", offset: {:.10g}", source.offset) : "",
                     source.tells_runs ? ", tells_runs: true" : "",
                     source.sampling != Sampling::unstated ? fmt::format(", sampling: {}", sampling) : "");
}

std::string import_section(const ImportParameters& map, const std::vector<ColumnGuess>& order) {
  std::string out = "import:\n  columns:\n";
  for (const ColumnGuess& guess : order)
    if (const auto found = map.columns.find(guess.ours); found != map.columns.end())
      out += fmt::format("    {}: {}\n", found->first, source_text(found->second));
  if (std::isfinite(map.from_s)) out += fmt::format("  from_s: {:g}\n", map.from_s);
  if (std::isfinite(map.to_s)) out += fmt::format("  to_s: {:g}\n", map.to_s);
  return out;
}

}  // namespace pneuservo
