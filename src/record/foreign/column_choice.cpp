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

}  // namespace pneuservo
