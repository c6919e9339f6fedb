// Reads the fields of a foreign or an own table as numbers, and tells what was taken for what.
#include "record/foreign/field_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "record/column_values.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

namespace {

constexpr double least_mark = 9.9e37;   ///< what instruments write for no value (9.91E37) and overflow
constexpr std::size_t most_told = 100;  ///< fields of a column that are told one by one
constexpr std::size_t least_signed = 10;  ///< numbers that show by their digits that a sign parts thousands

/// As in "1.#QNAN" and "-1,#IND": what follows is no remark, it makes the number none.
bool ends_in_decimal_sign(std::string_view text) { return text.ends_with('.') || text.ends_with(','); }

/// The number before a mark that loggers put behind a value: "5.002*", "5.002 (*)", "5.002 OK". Marks that make the
/// number a bound or say that it is bad, such as "<", are none.
std::string_view before_mark(std::string_view field) {
  constexpr std::array<std::string_view, 6> marks{"(*)", "*", "!", "?", " OK", " ok"};
  for (const std::string_view mark : marks)
    if (field.size() > mark.size() && field.ends_with(mark))
      return trimmed(field.substr(0, field.size() - mark.size()));
  return {};
}

}  // namespace

void FieldReader::start(bool is_own) {
  is_own_ = is_own;
  is_sign_sure_ = is_own;
  columns_.assign(table_.names.size(), {});
  for (std::size_t c = 0; c < columns_.size() && !is_own; ++c)
    columns_[c].may_be_digits = stated_unit(table_, c).empty();
}

double FieldReader::read(std::string_view field, std::size_t column, std::size_t line) {
  if (field.empty()) return no_value;
  double value;
  Column& own = columns_[column];
  const std::optional<double> digits_s = own.may_be_digits ? digits_clock_in(field) : std::nullopt;
  const bool is_number = number(field, column, value);
  if (digits_s && is_number) own.digits.emplace_back(table_.line_numbers.size(), value);
  if (digits_s || !is_number) {
    if (const auto s = digits_s ? digits_s : own.clock.take(field, table_.line_numbers.size())) {
      table_.is_clock[column] = 1;
      return *s;
    }
    const bool is_taken = takes_other_sign(field, column, line, value) ||
                          takes_other_unit(field, column, line, value) || takes_remark(field, value) ||
                          takes_hexadecimal(field, column, value) || takes_mark(field, column, line, value) ||
                          takes_prefix(field, column, line, value);
    if (!is_taken) return refuse(field, column, line);
    return value * dialect_.factor;
  }
  ++own.numbers;
  if (const bool is_mark = !is_own_ && std::abs(value) >= least_mark; is_mark || !std::isfinite(value)) {
    table_.report(line, ProblemKind::not_a_number, fmt::format("{} is {}", table_.names[column], field));
    return is_mark ? no_value : value;
  }
  if (!is_sign_sure_) weigh_sign(field, own, value);
  return value * dialect_.factor;
}

/// With the column's unit behind it or without.
bool FieldReader::number(std::string_view field, std::size_t column, double& value) {
  const std::string& unit = dialect_.value_units[column];
  if (!unit.empty() && field.ends_with(unit) &&
      number_in(trimmed(field.substr(0, field.size() - unit.size())), dialect_.style.decimal, value))
    return true;
  return number_in(field, dialect_.style.decimal, value);
}

void FieldReader::tell_once(bool& is_told, std::size_t column, std::size_t line, std::string_view field,
                            std::string_view what) {
  if (!std::exchange(is_told, true))
    table_.report(line, ProblemKind::dialect,
                  fmt::format("{} is \"{}\": {}", table_.names[column], shown(field), what));
}

/// Units that change from row to row, as in "999 ms" and "1.2 s": the value in the column's unit.
bool FieldReader::takes_other_unit(std::string_view field, std::size_t column, std::size_t line, double& value) {
  const std::size_t start = is_own_ ? field.size() : unit_start(field);
  if (start == field.size() || dialect_.value_units[column].empty()) return false;
  const std::optional<Unit> own = unit_in(field.substr(start));
  const std::optional<double> factor = factor_between(field.substr(start), dialect_.value_units[column]);
  if (!factor || own->quantity >= Quantity::raw) return false;
  if (!number_in(trimmed(field.substr(0, start)), dialect_.style.decimal, value)) return false;
  value *= *factor;
  tell_once(columns_[column].has_other_units, column, line, field,
            fmt::format("every value of this column is read with its own unit, {} being the first",
                        dialect_.value_units[column]));
  return true;
}

bool FieldReader::takes_mark(std::string_view field, std::size_t column, std::size_t line, double& value) {
  const std::string_view plain = is_own_ ? std::string_view() : before_mark(field);
  if (plain.empty() || !number(plain, column, value)) return false;
  tell_once(columns_[column].has_marks, column, line, field,
            "the number is used, the mark behind it is left out here and below");
  return true;
}

bool FieldReader::takes_prefix(std::string_view field, std::size_t column, std::size_t line, double& value) {
  if (is_own_ || !prefixed_number(field, dialect_.style.decimal, value)) return false;
  tell_once(columns_[column].has_prefixes, column, line, field,
            "the letter is taken for a power of ten of the column's unit, k for thousand");
  return true;
}

bool FieldReader::takes_remark(std::string_view field, double& value) const {
  const std::size_t at = is_own_ ? std::string_view::npos : std::min(field.find('#'), field.find("//"));
  return at != std::string_view::npos && !ends_in_decimal_sign(field.substr(0, at)) &&
         number_in(trimmed(field.substr(0, at)), dialect_.style.decimal, value);
}

bool FieldReader::takes_hexadecimal(std::string_view field, std::size_t column, double& value) {
  if (is_own_ || !hexadecimal_in(field, value)) return false;
  Column& text = columns_[column];
  if (text.hexadecimal.empty()) text.first_hexadecimal = shown(field);
  text.hexadecimal.push_back(table_.line_numbers.size());
  return true;
}

double FieldReader::refuse(std::string_view field, std::size_t column, std::size_t line) {
  Column& text = columns_[column];
  if (text.unreadable++ == 0) text.first_unreadable = shown(field);
  if (text.unreadable <= most_told) text.told.push_back(table_.problems.size());
  if (text.unreadable <= most_told)
    table_.report(
        line, ProblemKind::unreadable_field,
        fmt::format("{} is \"{}\", which is no number; it is read as no value", table_.names[column], shown(field)));
  return no_value;
}

/// The sign that is not the decimal one of the rows: between groups of three digits as in "1,000" it stands for
/// thousands. Where a column shows it otherwise, as in "0.25", it is a decimal sign, there, elsewhere and before.
bool FieldReader::takes_other_sign(std::string_view field, std::size_t column, std::size_t line, double& value) {
  Column& text = columns_[column];
  const char decimal = dialect_.style.decimal, sign = decimal == '.' ? ',' : '.';
  if (!dialect_.style.has_groups || field.find(sign) == std::string_view::npos) return false;
  const bool is_group = !shows_other_decimals_ && number_with_groups(field, decimal, value);
  if (!is_group && !number_in(field, sign, value)) return false;
  if (is_group && std::count(field.begin(), field.end(), sign) == 1) text.grouped.push_back(table_.line_numbers.size());
  are_no_groups_ = are_no_groups_ || (!is_group && !shows_other_decimals_);
  shows_other_decimals_ = shows_other_decimals_ || !is_group;
  tell_once(is_group ? text.has_groups : text.has_own_decimals, column, line, field,
            fmt::format("{} is taken for {} in this column{}", sign == '.' ? "a point" : "a comma",
                        is_group ? "thousands" : "the decimal sign", is_group ? " from here on" : ""));
  return true;
}

void FieldReader::end_row() {
  if (!std::exchange(are_no_groups_, false)) return;
  for (std::size_t c = 0; c < columns_.size(); ++c)
    for (const std::size_t at : std::exchange(columns_[c].grouped, {})) table_.values[c][at] /= 1000;
}

/// Counts what tells a decimal sign from one between thousands: the digits behind it and those before.
void FieldReader::weigh_sign(std::string_view field, Column& column, double value) {
  const char decimal = dialect_.style.decimal;
  double grouped = 0;
  if (field.find(decimal) == std::string_view::npos) {
    if (value != 0) ++(std::abs(value) < 1000 ? column.small : column.large);  // a sensor's start value may be a bare 0
  } else if (number_with_groups(field, decimal == '.' ? ',' : '.', grouped)) {
    if (column.signed_rows.empty()) column.first_signed = shown(field);
    column.signed_rows.push_back(table_.line_numbers.size());
  } else {
    is_sign_sure_ = true;
    for (Column& other : columns_) other.signed_rows = {};
  }
}

/// "-4,690" beside "35" and "970": every sign has three digits behind it, and what is below a thousand has none.
bool FieldReader::shows_groups(std::size_t column) const {
  const Column& text = columns_[column];
  return !is_sign_sure_ && text.signed_rows.size() >= least_signed && text.small >= least_signed && text.large == 0;
}

/// A file has one sign between thousands.
void FieldReader::judge_groups(std::size_t column) {
  const Column& text = columns_[column];
  if (text.signed_rows.empty()) return;
  for (const std::size_t row : text.signed_rows) table_.values[column][row] *= 1000;
  table_.report(
      0, ProblemKind::dialect,
      fmt::format("column {} is \"{}\", and no number of the file shows a decimal sign: {} is taken for thousands",
                  table_.names[column], text.first_signed, dialect_.style.decimal == '.' ? "a point" : "a comma"));
}

/// A column all of whose values are hexadecimal holds counts; between other numbers they are text.
void FieldReader::judge_hexadecimal(std::size_t column) {
  Column& text = columns_[column];
  if (text.hexadecimal.empty()) return;
  std::vector<double>& values = table_.values[column];
  std::size_t next = 0, others = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (next < text.hexadecimal.size() && text.hexadecimal[next] == i) ++next;
    else
      others += std::isfinite(values[i]) && !(values[i] >= 0 && values[i] < 10 && values[i] == std::round(values[i]));
  }
  if (others == 0)
    return table_.report(0, ProblemKind::dialect,
                         fmt::format("column {} holds hexadecimal numbers such as {}: read as counts",
                                     table_.names[column], text.first_hexadecimal));
  for (const std::size_t row : text.hexadecimal) values[row] = no_value;
  if (text.unreadable == 0) text.first_unreadable = text.first_hexadecimal;
  text.unreadable += text.hexadecimal.size() + most_told;  // told as a whole
}

/// Digits of a date count where all numbers of the column are such: a counter may look like one for a while.
void FieldReader::judge_digits(std::size_t column) {
  const Column& own = columns_[column];
  if (own.digits.empty() || own.numbers == 0) return;
  for (const auto& [row, value] : own.digits) table_.values[column][row] = value;
  table_.is_clock[column] = 0;
}

/// A column of text is told once, and so is how often another holds text.
std::vector<std::size_t> FieldReader::judge_text(std::size_t column) {
  const Column& text = columns_[column];
  const std::vector<double>& values = table_.values[column];
  const bool is_text = text.unreadable > 1 && !has_value(values);
  if (is_text || text.unreadable > most_told)
    table_.report(0, ProblemKind::dialect,
                  fmt::format("column {} holds {} such as \"{}\", read as no value", table_.names[column],
                              is_text ? "text" : fmt::format("{} fields of text", text.unreadable),
                              text.first_unreadable));
  return is_text ? text.told : std::vector<std::size_t>();
}

void FieldReader::finish() {
  bool has_groups = false;
  for (std::size_t c = 0; c < columns_.size(); ++c) has_groups = has_groups || shows_groups(c);
  std::vector<char> is_told_once(table_.problems.size(), 0);
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    judge_digits(c);
    if (const std::string_view order = columns_[c].clock.settle(table_.values[c]); !order.empty())
      table_.report(0, ProblemKind::dialect,
                    fmt::format("dates of {} are read as {}: so the times go on", table_.names[c], order));
    if (has_groups) judge_groups(c);
    judge_hexadecimal(c);
    for (const std::size_t place : judge_text(c)) is_told_once[place] = 1;
  }
  std::vector<RecordingProblem> kept;
  for (std::size_t i = 0; i < table_.problems.size(); ++i)
    if (i >= is_told_once.size() || is_told_once[i] == 0) kept.push_back(std::move(table_.problems[i]));
  table_.problems = std::move(kept);
}

}  // namespace pneuservo
