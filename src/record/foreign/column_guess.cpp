// What the columns of a foreign table are likely to be.
#include "record/foreign/column_guess.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <pneuservo/core/signal.hpp>

#include "record/column_values.hpp"
#include "record/foreign/axis_names.hpp"
#include "record/foreign/column_choice.hpp"
#include "record/foreign/column_words.hpp"
#include "record/foreign/dialect.hpp"
#include "record/foreign/field_text.hpp"
#include "record/foreign/stamps.hpp"
#include "record/foreign/units.hpp"
#include "record/row_text.hpp"

namespace pneuservo {

namespace {

/// A name taken apart: "Weg [mm]", "[mm] Weg", "Weg_mm", "pos (mm)", "p1/bar", "Weg in mm", "posMm".
struct NameParts {
  std::string text;  ///< without the unit
  std::string unit;
};

/// "time.ms", "Weg: mm", "pressureABar": a unit behind a sign or a capital letter, of the quantity that is named
/// before.
std::optional<NameParts> with_joined_unit(const std::string& name) {
  const auto is_small = [&](std::size_t i) { return std::islower(static_cast<unsigned char>(name[i])) != 0; };
  std::size_t at = name.size();
  while (at > 0 && (is_small(at - 1) || name[at - 1] == '%')) --at;
  const bool is_capital = at > 1 && std::isupper(static_cast<unsigned char>(name[at - 1])) != 0;
  if (is_capital) --at;
  if (at == 0 || at == name.size()) return std::nullopt;
  const std::optional<Unit> unit = unit_in(name.substr(at));
  std::string before(trimmed(std::string_view(name).substr(0, at)));
  while (!before.empty() && std::string_view(".:-,; ").find(before.back()) != std::string_view::npos) before.pop_back();
  const std::optional<ColumnWord> word = column_word(before);
  if (!unit || unit->name == "in" || unit->name == "min" || !word || word->ours.empty()) return std::nullopt;
  const bool is_share = unit->name == "%" && word->quantity == Quantity::voltage;
  if (unit->quantity != word->quantity && !is_share) return std::nullopt;
  return NameParts{before, name.substr(at)};
}

/// Whether it may be a unit at all: not empty, no number alone such as a duplicate's, no word of column names.
bool may_be_unit(std::string_view text) {
  constexpr std::array<std::string_view, 6> none{"none", "n/a", "na", "unitless", "dimensionless", "unit"};
  const std::string small = in_small_letters(text);
  const bool has_sign = std::any_of(text.begin(), text.end(), is_letter);
  return unit_in(text) ||
         (has_sign && !is_made_of_words(text) && std::find(none.begin(), none.end(), small) == none.end());
}

/// "Weg [mm]", "[mm] Weg", "101 <Weg> (mm)": the brackets that hold a unit, else the first ones. Words of names in
/// brackets belong to the name: "Position (set)".
std::optional<NameParts> with_bracketed_unit(const std::string& name) {
  std::optional<NameParts> out;
  for (const std::string_view pair : {"[]", "<>", "{}", "()", "''"}) {
    const std::size_t open = name.find(pair[0]), close = name.rfind(pair[1]);
    if (open == std::string::npos || close == std::string::npos || close <= open) continue;
    const std::string inside(trimmed(std::string_view(name).substr(open + 1, close - open - 1)));
    NameParts parts{open > 0 ? name.substr(0, open) : name.substr(close + 1), inside};
    if (unit_in(inside)) return parts;
    if (out || pair[0] == '\'') continue;
    if (is_made_of_words(inside)) parts = {fmt::format("{} {}", parts.text, inside), ""};
    out = std::move(parts);
  }
  return out;
}

/// "p1_bar", "p1/bar", "p1_bar_rel", "Weg in mm", "u_pct": behind the last or the last but one sign.
std::optional<NameParts> with_suffixed_unit(const std::string& name) {
  if (name.find_last_of("[<") != std::string::npos) return std::nullopt;
  std::size_t last = name.find_last_of("_ /");
  for (int words = 1; words <= 2 && last != std::string::npos && last > 0; ++words) {
    const std::optional<Unit> suffix = unit_in(name.substr(last + 1));
    if (suffix && suffix->quantity < Quantity::raw && (words == 1 || suffix->quantity == Quantity::pressure)) {
      const std::string before(trimmed(std::string_view(name).substr(0, last)));
      return NameParts{before.ends_with(" in") ? before.substr(0, before.size() - 3) : before,
                       std::string(without_brackets(name.substr(last + 1)))};
    }
    if (suffix && words == 1 && (suffix->name == "%" || name.substr(last + 1) == "mA"))
      return NameParts{std::string(trimmed(std::string_view(name).substr(0, last))), std::string(suffix->name)};
    last = name.find_last_of("_ /", last - 1);
  }
  return std::nullopt;
}

/// "Druck [bar] (2)", "positions[0]": a number in brackets at the end numbers the column.
std::string without_number(const std::string& name) {
  const std::size_t open = name.find_last_of("[(");
  if (open == std::string::npos || open == 0 || name.size() - open < 3) return name;
  const bool is_number = name.find_first_not_of("0123456789", open + 1) == name.size() - 1 &&
                         (name.back() == ')' || name.back() == ']') && name.substr(open) != "[1]";
  return is_number ? std::string(trimmed(std::string_view(name).substr(0, open))) : name;
}

NameParts parts_of(const std::string& numbered_name) {
  const std::string name = without_number(numbered_name);
  const std::size_t labels = name.find('{');  // position_mm{axis="1"}
  if (labels != std::string::npos && labels > 0 && name.find('=', labels) != std::string::npos)
    return parts_of(name.substr(0, labels));
  if (std::optional<NameParts> parts = with_suffixed_unit(name)) return *parts;
  if (std::optional<NameParts> parts = with_bracketed_unit(name)) return *parts;
  return with_joined_unit(name).value_or(NameParts{name, ""});
}

bool is_ours(const std::string& name) {
  static const std::vector<std::string> columns = columns_of_the_format();
  return std::find(columns.begin(), columns.end(), name) != columns.end();
}

/// Why a column that is named like a quantity is not taken for it; empty: it is.
std::string objection(const ColumnWord& word, const std::optional<Unit>& unit, const std::string& stated) {
  if (!word.is_sure && !(unit && unit->quantity == word.quantity))
    return fmt::format("named like {}, without a unit of {}", word.word,
                       word.quantity == Quantity::mass_flow ? "flow"
                       : word.quantity == Quantity::length  ? "length"
                                                            : "pressure");
  if (word.ours.empty()) return fmt::format("named like {}, which nothing is compared with", word.word);
  if (unit && unit->quantity != word.quantity && unit->quantity != Quantity::raw)
    return fmt::format("name and unit disagree ({} in {})", word.ours, stated);
  const bool is_time = word.quantity == Quantity::time;
  if (!unit && !is_time && may_be_unit(stated))
    return fmt::format("named like {}, but {} is no unit that is known: state its factor", word.word, stated);
  const bool is_output = unit && unit->quantity == Quantity::raw && unit->name != "-" && unit->name != "1";
  // A command is a share of the valve's range, or a current.
  const bool is_of_range = is_output && (unit->factor != 1 || unit->name == "%" || unit->name.ends_with('A'));
  if (!is_output || stated.empty() || (word.quantity == Quantity::voltage && is_of_range)) return "";
  if (word.quantity != Quantity::voltage && !is_time)
    return fmt::format("named like {}, but {} is what a sensor gives: its scale is unknown", word.word, stated);
  return is_of_range ? "" : fmt::format("named like {}, but {} has no known scale", word.word, stated);
}

/// "Position x100": how many times the unit's the values are; 1 where the name says none.
double times_in(const std::string& name) {
  const std::string text(trimmed(name));
  const std::size_t sign = text.find_last_of(" _");
  if (sign == std::string::npos || sign + 3 > text.size() || text[sign + 1] != 'x' || text[sign + 2] != '1') return 1;
  const std::string_view zeros = std::string_view(text).substr(sign + 3);
  return zeros.empty() || zeros.find_first_not_of('0') != std::string_view::npos
             ? 1
             : std::pow(10, static_cast<double>(zeros.size()));
}

/// The unit that the file states for a column of this name, in a row or in the name; empty: none.
std::string unit_by(const CsvTable& table, std::size_t column, const std::string& full_name) {
  const std::string& in_row = table.units[column];
  const std::string text(in_row.empty() ? parts_of(half_width(full_name)).unit : without_brackets(in_row));
  const std::optional<Unit> unit = unit_in(text);
  return unit && unit->name == "%" ? "%" : text;  // "percent"
}

/// By a name, which is the column's own or a part of it.
ColumnGuess guess_column(const CsvTable& table, std::size_t column, const std::string& name, double atmosphere_Pa) {
  ColumnGuess out{table.names[column], "", "", 1, 0, "", false, ""};
  if (is_ours(name)) return {out.column, name, "", 1, 0, "a name of the recording format", true, ""};
  const NameParts parts = parts_of(half_width(name));
  const bool in_row = !table.units[column].empty();
  const std::string stated = out.unit = unit_by(table, column, name);
  const std::optional<ColumnWord> word = column_word(parts.text);
  if (table.is_clock[column] != 0) return {out.column, "t_s", "date", 1, 0, "holds dates or times of day", false, ""};
  // "millis" is both.
  const bool is_named_by_unit = stated.empty() && word && word->quantity == Quantity::time && parts.text.size() > 1;
  const std::optional<Unit> unit = unit_in(is_named_by_unit ? parts.text : stated);
  out.evidence = word ? objection(*word, unit, stated) : "no known name";
  if (!out.evidence.empty()) return out;
  out.ours = word->ours;
  out.evidence = fmt::format("named like {}", word->word);
  if (!unit || unit->quantity == Quantity::raw) {
    out.factor = unit ? unit->factor : 1;  // of thousandths that are meant in per cent
    out.evidence += stated.empty()    ? ", no unit stated: taken for SI"
                    : out.factor != 1 ? fmt::format(", unit {}: taken for a share", stated)
                                      : fmt::format(", unit {} is none of the quantity: taken for SI", stated);
    return out;
  }
  out.has_unit = true;
  const double times = times_in(parts.text);
  out.factor = unit->factor / times;
  out.offset = is_above_atmosphere(*unit, word) ? atmosphere_Pa : 0;
  out.evidence += in_row ? ", unit stated beside the names" : ", unit from its name";
  if (unit->is_multiple || times != 1) out.evidence += fmt::format(": 1 is taken for {:g} in SI", out.factor);
  if (out.offset != 0 && !unit->is_gauge) out.evidence += ", above the atmosphere by its name";
  return out;
}

/// Times in millionths of days since 1899-12-30, which WinCC calls milliseconds: 2000 to 2090 with decimals, where a
/// counter of milliseconds has whole numbers.
bool are_millionths_of_days(const std::vector<double>& values) {
  constexpr double first = 36526e6, last = 69400e6;
  bool has_decimals = false;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (value < first || value > last) return false;
    has_decimals = has_decimals || value != std::round(value);
  }
  return has_decimals;
}

/// Whether it goes on from row to row, but where a second, a minute or an hour ends.
bool is_course_of_time(const std::vector<double>& values, double unit_s) {
  if (values.size() < 3 || !std::isfinite(values[0])) return false;
  return course_of(values) + 1 + 2 * turns_of(values, unit_s).rows.size() >= values.size();
}

/// Where nothing is named a time: the first column in a unit of time, or named as one, that goes on from row to row.
void take_time_by_unit(const CsvTable& table, std::vector<ColumnGuess>& guesses) {
  constexpr std::size_t least_letters = 3;
  for (ColumnGuess& guess : guesses) {
    const auto c = static_cast<std::size_t>(&guess - guesses.data());
    const bool is_named = guess.unit.empty() && guess.column.size() >= least_letters && guess.column != "min";
    const std::optional<Unit> unit = unit_in(is_named ? guess.column : guess.unit);
    if (!unit || unit->quantity != Quantity::time || !is_course_of_time(table.values[c], unit->factor)) continue;
    guess.ours = "t_s";
    guess.factor = unit->factor;
    guess.has_unit = true;
    guess.evidence = fmt::format("in {}, and goes on from row to row", is_named ? guess.column : guess.unit);
    return;
  }
}

/// Whether a word that tells axes apart leaves a signal of one.
bool is_of_axis(const std::string& ours) {
  return !ours.empty() && ours != "t_s" && (ours == "x_ref_m" || ours == "u_V" || signal_of_column(ours).has_value());
}

/// With the words of axes left out of the names.
std::vector<ColumnGuess> guesses_by(const CsvTable& table, const std::vector<AxisOfColumn>& axes,
                                    double atmosphere_Pa) {
  const auto name_of = [&](std::size_t c) { return axes[c].is_of_axis ? axes[c].name : table.names[c]; };
  std::vector<ColumnGuess> out;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    out.push_back(guess_column(table, c, name_of(c), atmosphere_Pa));
    if (out[c].ours == "t_s" && out[c].factor == 1e-3 && are_millionths_of_days(table.values[c])) {
      out[c].factor = 86400e-6;
      out[c].evidence += ", holds millionths of days";
    }
  }
  std::vector<std::string> texts;
  for (std::size_t c = 0; c < out.size(); ++c) texts.push_back(parts_of(half_width(name_of(c))).text);
  take_one_axis(table, axes, out);
  take_valve_ports(texts, out, atmosphere_Pa);
  leave_one_of_each(table, texts, out);
  return out;
}

}  // namespace

std::vector<ColumnGuess> guess_columns(const CsvTable& table, double atmosphere_Pa) {
  const auto meaning = [&](std::size_t c, const std::string& name) {
    const std::string ours = guess_column(table, c, name, atmosphere_Pa).ours;
    return is_of_axis(ours) ? ours : "";
  };
  const std::vector<AxisOfColumn> axes = axes_in(table.names, meaning);
  std::vector<ColumnGuess> out = guesses_by(table, axes, atmosphere_Pa);
  if (std::ranges::any_of(axes, &AxisOfColumn::is_of_axis)) {
    std::vector<ColumnGuess> plain = guesses_by(table, std::vector<AxisOfColumn>(axes.size()), atmosphere_Pa);
    bool is_meant = false;  // a word that a name has its meaning by: "p1"
    for (std::size_t c = 0; c < axes.size() && !is_meant; ++c)
      is_meant = axes[c].is_of_axis && meaning(c, axes[c].name).empty() && !meaning(c, table.names[c]).empty();
    if (is_meant || loses_by_sides(axes, plain, out)) out = std::move(plain);
  }
  if (std::none_of(out.begin(), out.end(), [](const ColumnGuess& guess) { return guess.ours == "t_s"; }))
    take_time_by_unit(table, out);
  return out;
}

std::string axis_words(const std::vector<ColumnGuess>& guesses) {
  std::set<std::string> taken, others;
  for (const ColumnGuess& guess : guesses)
    if (!guess.axis.empty() && !guess.ours.empty()) taken.insert(guess.axis);
  for (const ColumnGuess& guess : guesses)
    if (!guess.axis.empty() && !taken.contains(guess.axis)) others.insert(guess.axis);
  if (taken.empty() || others.empty()) return "";
  return fmt::format("the columns are of several axes: {} is taken, {} {} left out; import.columns of a config names "
                     "those of another one",
                     fmt::join(taken, ", "), fmt::join(others, ", "), others.size() == 1 ? "is" : "are");
}

std::string meaning_of(const std::string& name) {
  if (is_ours(name)) return name;
  const std::optional<ColumnWord> word = column_word(parts_of(half_width(name)).text);
  return word ? std::string(word->ours) : "";
}

std::string stated_unit(const CsvTable& table, std::size_t column) {
  return unit_by(table, column, table.names[column]);
}

namespace {

/// The unit that a column states in a row or in its name.
std::optional<Unit> unit_of(const CsvTable& table, std::size_t column, const NameParts& parts) {
  return unit_in(table.units[column].empty() ? parts.unit : table.units[column]);
}

}  // namespace

double named_time_s(const CsvTable& table, std::size_t column) {
  const auto parts_at = [&](std::size_t c) {
    NameParts parts = parts_of(half_width(table.names[c]));
    parts.text = trimmed(parts.text);
    return parts;
  };
  NameParts parts = parts_at(column);
  const std::string behind = column + 1 < table.names.size() ? parts_at(column + 1).text : "";
  std::string_view text = parts.text;
  if (!behind.empty() && text.size() > behind.size()) {
    if (text.starts_with(behind)) text.remove_prefix(behind.size());
    else if (text.ends_with(behind)) text.remove_suffix(behind.size());
  }
  const std::size_t end = text.find_last_not_of("0123456789 ()_#.");
  text = text.substr(0, end == std::string_view::npos ? 0 : end + 1);
  const std::optional<ColumnWord> word = column_word(text);
  if (!word || word->ours != "t_s") return 0;
  const std::optional<Unit> unit = unit_of(table, column, parts);
  if (unit && unit->quantity != Quantity::time) return 0;
  const std::optional<Unit> by_name = !unit && text.size() > 1 ? unit_in(text) : std::nullopt;  // "millis"
  return unit ? unit->factor : by_name && by_name->quantity == Quantity::time ? by_name->factor : 1;
}

double named_interval_s(const CsvTable& table, std::size_t column) {
  constexpr std::array<std::string_view, 12> names{"dt",       "deltat",   "deltatime", "timedelta",
                                                   "interval", "timestep", "tdelta",    "steptime",
                                                   "tstep",    "\u0394t",  "\u03b4t",   "\u2206t"};
  const NameParts parts = parts_of(half_width(table.names[column]));
  std::string text;
  for (const char c : in_small_letters(parts.text))
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80) text += c;
  if (std::find(names.begin(), names.end(), text) == names.end()) return 0;
  const std::optional<Unit> unit = unit_of(table, column, parts);
  if (unit && unit->quantity != Quantity::time) return 0;
  return unit ? unit->factor : 1;
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
