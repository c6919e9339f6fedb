// Which of several columns with one meaning is taken.
#include "record/foreign/column_choice.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include <pneuservo/core/signal.hpp>

#include "record/column_values.hpp"
#include "record/foreign/column_words.hpp"
#include "record/foreign/field_text.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

namespace {

/// Of several axes the one that a column belongs to: the path before its name, or a numbered first word.
std::string axis_of(const std::string& text) {
  const std::size_t sign = text.find_last_of("/.:\\|");
  if (sign != std::string::npos && sign > 0) return text.substr(0, sign);
  const auto is_digit = [&](std::size_t i) {
    return i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0;
  };
  std::size_t end = std::min(text.find_first_of("_ "), text.size());
  if (is_digit(end + 1)) end = std::min(text.find_first_of("_ ", end + 1), text.size());
  return end > 1 && end < text.size() && is_digit(end - 1) ? text.substr(0, end) : "";
}

/// The greater one is taken; of equal ones the first.
using Merit = std::array<std::size_t, 7>;

Merit merit_of(const std::vector<double>& values, const std::string& text, const ColumnGuess& guess,
               std::size_t known_of_axis) {
  if (guess.ours == "t_s") return {course_of(values)};
  const std::optional<ColumnWord> word = column_word(text);
  return {has_value(values),  guess.ours == guess.column,   known_of_axis,
          has_motion(values), !(word && word->is_computed), word && word->is_actual,
          guess.has_unit};
}

/// A number, a letter or a word that may say a side of one axis, or one of its sensors.
bool may_be_side(const std::string& axis) {
  constexpr std::array<std::string_view, 18> sides{"left",  "right", "links", "rechts", "top",    "bottom",
                                                   "upper", "lower", "oben",  "unten",  "front",  "rear",
                                                   "back",  "vorn",  "vorne", "hinten", "inside", "outside"};
  const std::string word = in_small_letters(axis);
  if (word.size() < 2) return word != "x" && word != "y" && word != "z";
  return std::ranges::any_of(word, [](unsigned char c) { return std::isdigit(c) != 0; }) ||
         std::ranges::find(sides, word) != sides.end();
}

std::string quoted(const std::string& axis) {
  return axis.empty() ? "the one without a number" : fmt::format("\"{}\"", axis);
}

std::string words_of_axis(const std::string& axis) {
  return axis.empty() ? "the axis without a number" : fmt::format("axis \"{}\"", axis);
}

/// Whether two columns show one signal: they differ by less than a sensor's noise.
bool agree(const CsvTable& table, std::size_t one, std::size_t other, const std::vector<ColumnGuess>& guesses) {
  constexpr double most_of_stroke = 0.01, most_of_value = 0.02;
  double least = HUGE_VAL, most = -HUGE_VAL, sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < table.values[one].size(); ++i) {
    const double a = guesses[one].factor * table.values[one][i] + guesses[one].offset;
    const double b = guesses[other].factor * table.values[other][i] + guesses[other].offset;
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    least = std::min(least, a), most = std::max(most, a);
    sum += (a - b) * (a - b), ++count;
  }
  const bool is_position = guesses[one].ours == "x_m" || guesses[one].ours == "x_ref_m";
  const double scale =
      is_position ? most_of_stroke * (most - least) : most_of_value * std::max(std::abs(least), std::abs(most));
  return count > 1 && most > least && std::sqrt(sum / static_cast<double>(count)) < scale;
}

/// Whether another word names a second logger of the same axis: both have the position, and what both have agrees.
bool are_loggers_of_one(const CsvTable& table, const std::vector<AxisOfColumn>& axes, const std::string& taken,
                        const std::string& other, const std::vector<ColumnGuess>& guesses) {
  if (may_be_side(taken) || may_be_side(other)) return false;
  bool have_position = false;
  for (std::size_t c = 0; c < guesses.size(); ++c) {
    if (!axes[c].is_of_axis || axes[c].axis != taken || guesses[c].ours.empty()) continue;
    for (std::size_t d = 0; d < guesses.size(); ++d) {
      if (!axes[d].is_of_axis || axes[d].axis != other || guesses[d].ours != guesses[c].ours) continue;
      if (!agree(table, c, d, guesses)) return false;
      have_position = have_position || guesses[c].ours == "x_m";
    }
  }
  return have_position;
}

}  // namespace

std::size_t course_of(const std::vector<double>& values) {
  std::size_t up = 0, down = 0;
  for (std::size_t i = 1; i < values.size(); ++i) up += values[i] > values[i - 1], down += values[i] < values[i - 1];
  return std::max(up, down) - std::min(up, down);
}

void take_valve_ports(const std::vector<std::string>& texts, std::vector<ColumnGuess>& guesses, double atmosphere_Pa) {
  constexpr std::array<std::string_view, 5> ours{info(Signal::p_supply).column, info(port_signals[1]).column, "",
                                                 info(port_signals[0]).column, ""};
  std::array<std::size_t, 5> columns{}, count{};
  bool has_supply = false;
  for (std::size_t c = 0; c < guesses.size(); ++c) {
    const std::optional<Unit> unit = unit_in(guesses[c].unit);
    const std::optional<int> number = port_number(texts[c]);
    if (number && (unit ? unit->quantity == Quantity::pressure : guesses[c].unit.empty()))
      columns[static_cast<std::size_t>(*number - 1)] = c, ++count[static_cast<std::size_t>(*number - 1)];
    else has_supply = has_supply || guesses[c].ours == ours[0];
  }
  // Sensors 1 to 4 are no ports of a valve, whose exhausts are 3 and 5.
  if (count[1] != 1 || count[3] != 1 || count[0] > 1 || count[2] != count[4] || (count[0] == 1 && has_supply)) return;
  for (std::size_t port = 0; port < ours.size(); ++port) {
    if (count[port] == 0) continue;
    ColumnGuess& guess = guesses[columns[port]];
    const std::optional<Unit> unit = unit_in(guess.unit);
    guess.ours = ours[port];
    guess.has_unit = unit.has_value();
    guess.factor = unit ? unit->factor : 1;
    guess.offset = unit && is_above_atmosphere(*unit, column_word(texts[columns[port]])) ? atmosphere_Pa : 0;
    guess.evidence = fmt::format("port {} of a valve by ISO 11727, for 2 and 4 both stand", port + 1);
  }
}

void leave_one_of_each(const CsvTable& table, const std::vector<std::string>& texts,
                       std::vector<ColumnGuess>& guesses) {
  std::map<std::string, std::set<std::string>> known;  // of each axis
  for (std::size_t c = 0; c < guesses.size(); ++c)
    if (!guesses[c].ours.empty() && has_value(table.values[c])) known[axis_of(texts[c])].insert(guesses[c].ours);
  std::map<std::string, std::pair<std::size_t, Merit>> taken;
  for (std::size_t c = 0; c < guesses.size(); ++c) {
    if (guesses[c].ours.empty()) continue;
    const Merit merit = merit_of(table.values[c], texts[c], guesses[c], known[axis_of(texts[c])].size());
    const auto [kept, is_new] = taken.try_emplace(guesses[c].ours, c, merit);
    if (is_new) continue;
    const bool is_better = merit > kept->second.second;
    const std::size_t one = is_better ? c : kept->second.first, other = is_better ? kept->second.first : c;
    guesses[other].evidence = fmt::format("as {}, which is taken for {}", guesses[one].column, guesses[one].ours);
    guesses[other].ours.clear();
    kept->second = {one, is_better ? merit : kept->second.second};
  }
}

void take_one_axis(const CsvTable& table, const std::vector<AxisOfColumn>& axes, std::vector<ColumnGuess>& guesses) {
  std::map<std::string, std::pair<std::set<std::string>, bool>> known;  // signals of each, and whether it moves
  for (std::size_t c = 0; c < guesses.size(); ++c) {
    if (!axes[c].is_of_axis) continue;
    guesses[c].axis = quoted(axes[c].axis);
    auto& [signals, moves] = known[axes[c].axis];
    if (guesses[c].ours.empty() || !has_value(table.values[c])) continue;
    signals.insert(guesses[c].ours);
    moves = moves || (guesses[c].ours == "x_m" && has_motion(table.values[c]));
  }
  auto taken = known.end();
  std::pair<std::size_t, bool> most{};
  for (const AxisOfColumn& axis : axes) {
    const auto at = axis.is_of_axis ? known.find(axis.axis) : known.end();
    if (at == known.end()) continue;
    const std::pair<std::size_t, bool> merit{at->second.first.size(), at->second.second};
    if (taken == known.end() || merit > most) taken = at, most = merit;
  }
  if (taken == known.end()) return;
  const std::string axis_taken = quoted(taken->first);
  std::map<std::string, bool> is_logger;
  for (const auto& [axis, of_axis] : known)
    is_logger[axis] = axis != taken->first && are_loggers_of_one(table, axes, taken->first, axis, guesses);
  for (std::size_t c = 0; c < guesses.size(); ++c) {
    if (!axes[c].is_of_axis) continue;
    const std::string& axis = axes[c].axis;
    if (axis == taken->first) guesses[c].evidence += fmt::format(", of {}", words_of_axis(axis));
    else if (is_logger[axis] && !guesses[c].ours.empty() && !taken->second.first.contains(guesses[c].ours))
      guesses[c].evidence += fmt::format(", of {}, whose position is that of {}", guesses[c].axis, axis_taken);
    else {
      guesses[c].evidence = fmt::format("of {}, where {} is taken", words_of_axis(axis), axis_taken);
      guesses[c].ours.clear();
    }
  }
}

bool loses_by_sides(const std::vector<AxisOfColumn>& axes, const std::vector<ColumnGuess>& without,
                    const std::vector<ColumnGuess>& with) {
  if (std::ranges::none_of(axes, [](const AxisOfColumn& of) { return of.is_of_axis && may_be_side(of.axis); }))
    return false;
  const auto known_of = [](const std::vector<ColumnGuess>& guesses) {
    std::set<std::string> out;
    for (const ColumnGuess& guess : guesses)
      if (guess.ours == "x_m" || guess.ours == "u_V") out.insert(guess.ours);
      else if (guess.ours.ends_with("_Pa")) out.insert(guess.ours.substr(0, 2));  // a port's or its chamber's
    return out;
  };
  return !std::ranges::includes(known_of(with), known_of(without));
}

}  // namespace pneuservo
