// Reads the fields of a foreign or an own table as numbers, and tells what was taken for what.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "record/foreign/clock_text.hpp"
#include "record/foreign/dialect.hpp"
#include "record/table.hpp"

namespace pneuservo {

class FieldReader {
 public:
  FieldReader(CsvTable& table, const Dialect& dialect) : table_(table), dialect_(dialect) {}

  /// To be called once the columns are known.
  void start(bool is_own);
  /// The number in a field of a column; no_value where there is none.
  double read(std::string_view field, std::size_t column, std::size_t line);
  /// To be called when the row's values are in the table.
  void end_row();
  /// Judges columns as a whole: text, counts in hexadecimal, digits in groups.
  void finish();

 private:
  struct Column {
    std::size_t unreadable = 0;
    ClockColumn clock;
    bool may_be_digits = false;  ///< no unit of a number stands there
    std::vector<std::pair<std::size_t, double>> digits;  ///< rows read as a date in digits, and their number
    std::size_t numbers = 0;
    std::vector<std::size_t> told;  ///< places of what is told of its fields among the table's problems
    std::string first_unreadable;
    bool has_groups = false, has_own_decimals = false;  ///< by the sign that is not the rows' decimal one
    bool has_other_units = false, has_marks = false, has_prefixes = false;
    std::vector<std::size_t> hexadecimal;  ///< rows whose field is so
    std::string first_hexadecimal;
    std::vector<std::size_t> grouped;  ///< rows whose number is thousands only if that sign is none of decimals
    std::vector<std::size_t> signed_rows;  ///< rows with the decimal sign before three digits at the end
    std::size_t small = 0, large = 0;  ///< numbers without that sign below a thousand, and from there on
    std::string first_signed;
  };

  bool number(std::string_view field, std::size_t column, double& value);
  bool takes_other_unit(std::string_view field, std::size_t column, std::size_t line, double& value);
  bool takes_mark(std::string_view field, std::size_t column, std::size_t line, double& value);
  bool takes_prefix(std::string_view field, std::size_t column, std::size_t line, double& value);
  bool takes_other_sign(std::string_view field, std::size_t column, std::size_t line, double& value);
  bool takes_remark(std::string_view field, double& value) const;
  bool takes_hexadecimal(std::string_view field, std::size_t column, double& value);
  double refuse(std::string_view field, std::size_t column, std::size_t line);
  void weigh_sign(std::string_view field, Column& column, double value);
  void tell_once(bool& is_told, std::size_t column, std::size_t line, std::string_view field, std::string_view what);
  bool shows_groups(std::size_t column) const;
  void judge_groups(std::size_t column);
  void judge_digits(std::size_t column);
  void judge_hexadecimal(std::size_t column);
  /// Places of what is told of the fields of a column that holds nothing but text.
  std::vector<std::size_t> judge_text(std::size_t column);

  CsvTable& table_;
  const Dialect& dialect_;
  bool is_own_ = false;
  bool is_sign_sure_ = false;  ///< a number shows that the decimal sign is one: "0.5", "12.34"
  bool shows_other_decimals_ = false;  ///< some column has the other decimal sign: it makes no groups
  bool are_no_groups_ = false;  ///< the row that is read has shown it: what was read as groups before is to be divided
  std::vector<Column> columns_;
};

}  // namespace pneuservo
