// Long tables: a row for each value, with the name of its channel, as historians and message loggers write them.
#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "record/foreign/field_text.hpp"
#include "record/foreign/timed_groups.hpp"
#include "record/table.hpp"

namespace pneuservo {

/// Which field of a row is what.
struct LongRows {
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  FieldStyle style;
  std::size_t fields = 0;     ///< of each row; 0: the table is no long one
  std::size_t first_row = 0;  ///< index of the first row in the sample
  std::vector<std::string> names;  ///< of the fields; empty: the file has none
  std::vector<std::size_t> tags;   ///< whose texts together name the channel
  std::vector<std::size_t> values;  ///< one, or those that each row has for its channel
  std::size_t time = none, unit = none, quality = none;
  std::size_t date = none;  ///< of the day, where `time` is of the day's time alone
  bool has_bits_of_quality = false;  ///< numbers as OPC's of eight bits, 192 for good, and not status codes of OPC UA

  bool found() const { return fields > 0; }
  std::string name_of(std::size_t field) const;
  bool has_value(std::size_t field) const;
};

/// By the names of the fields, or as channels alternate beside the one value of each row, or beside several at the same
/// times. `lines`: the first ones.
LongRows find_long_rows(const std::vector<std::string>& lines);

/// Takes the rows, and makes a column of each channel.
class LongTable {
 public:
  LongTable(const LongRows& how, CsvTable& table, std::size_t most_bytes)
      : how_(how), table_(table), most_bytes_(most_bytes) {}

  void add(std::string_view line, std::size_t number);
  /// The table has its columns; throws InputError where no row could be used.
  void finish();

 private:
  bool take_time(double& time_s);
  bool take_value(std::size_t field, double& value);
  bool is_bad() const;
  /// The value in its channel's unit, which is that of the first row with one.
  bool take_unit(std::string_view unit, std::string& of, double& value);
  TimedGroup& channel();
  void tell(std::size_t rows) const;

  LongRows how_;
  CsvTable& table_;
  std::size_t most_bytes_, rows_ = 0;
  std::vector<std::string_view> fields_;
  std::map<std::string, std::size_t, std::less<>> places_;  ///< of the channels
  std::vector<TimedGroup> channels_;
  std::string tag_;
  std::size_t untimed_ = 0, bad_ = 0, unreadable_ = 0, out_of_order_ = 0;
  std::size_t converted_ = 0, other_units_ = 0;
  std::string first_unreadable_, first_other_unit_;
  bool is_clock_ = false;
};

}  // namespace pneuservo
