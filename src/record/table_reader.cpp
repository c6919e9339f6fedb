// Reads a table of our own format or a foreign one, row by row.
#include "record/table.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "record/clock_text.hpp"
#include "record/dialect.hpp"
#include "record/keyed_rows.hpp"
#include "record/long_rows.hpp"
#include "record/names_text.hpp"
#include "record/table_bound.hpp"
#include "record/table_times.hpp"
#include "record/text_input.hpp"

namespace pneuservo {

namespace {

/// None where it is no YAML, or no map.
std::optional<YAML::Node> map_in(const std::string& text) {
  try {
    YAML::Node node = YAML::Load(text);
    return node.IsMap() ? std::optional(std::move(node)) : std::nullopt;
  } catch (const YAML::Exception&) { return std::nullopt; }
}

/// The keys of one stretch of text; nothing where it is no YAML, or no map.
void add_keys(const std::string& text, YAML::Node& header) {
  const auto entry = map_in(text);
  if (!entry) return;
  for (const auto& pair : *entry)
    if (pair.first.IsScalar()) header[pair.first.Scalar()] = pair.second;
}

/// A foreign file may mix keys with free text: then each key is read by itself, with the indented lines below it.
YAML::Node parse_header(const std::string& comments) {
  if (const auto whole = map_in(comments)) return *whole;
  YAML::Node header(YAML::NodeType::Map);
  for (std::size_t start = 0; start < comments.size();) {
    std::size_t end = comments.find('\n', start) + 1;
    while (end < comments.size() && comments[end] == ' ') end = comments.find('\n', end) + 1;
    add_keys(comments.substr(start, end - start), header);
    start = end;
  }
  return header;
}

/// Lines that a dialect is found from: enough that a header of any length leaves rows.
constexpr std::size_t sample_lines = 200;

constexpr std::size_t most_sampled_bytes = 1 << 20;
constexpr std::size_t most_columns = 10000;  ///< loggers have hundreds; more are rows that were written as columns

constexpr std::size_t longest_field_lines = 20;  ///< that a quoted field may go on for
constexpr double least_mark = 9.9e37;            ///< what instruments write for no value (9.91E37) and overflow
constexpr std::size_t most_told = 100;           ///< fields of a column that are told one by one
constexpr std::size_t rows_between_bounds = 4096;  ///< at the memory they take
constexpr std::size_t bytes_of_a_problem = 256;  ///< with its sentence
constexpr double most_skipped = 1e6;  ///< numbers of an index: more are those of another run

/// Whether a quote that begins a field is open at the end.
bool leaves_quote_open(std::string_view text) {
  bool is_open = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '"') continue;
    const bool is_behind_a_word = i > 0 && std::isalnum(static_cast<unsigned char>(text[i - 1])) != 0;
    is_open = !is_open && !is_behind_a_word;
  }
  return is_open;
}

/// As in "1.#QNAN" and "-1,#IND": what follows is no remark, it makes the number none.
bool ends_in_decimal_sign(std::string_view text) { return text.ends_with('.') || text.ends_with(','); }

/// Whether the whole line is one field in quotes, those inside it doubled: a table in the first column of a sheet.
bool is_quoted_line(std::string_view line) {
  if (line.size() < 2 || line.front() != '"' || line.back() != '"') return false;
  for (std::size_t i = 1; i + 1 < line.size(); ++i)
    if (line[i] == '"' && line[++i] != '"') return false;
  return true;
}

std::string unquoted_line(std::string_view line) {
  std::string out;
  for (std::size_t i = 1; i + 1 < line.size(); ++i)
    if (out += line[i]; line[i] == '"') ++i;
  return out;
}

class TableReader {
 public:
  TableReader(const std::string& path, const std::set<std::string>& wanted, std::size_t most_bytes)
      : input_(path), wanted_(wanted), most_bytes_(most_bytes) {
    table_.path = path;
  }

  CsvTable read() {
    std::vector<Line> lines;
    const std::vector<std::size_t> places = find_dialect_within(lines);
    if (long_rows_.found()) return read_long(lines, places);
    read_head(lines, places);
    std::string_view line;
    while (next_line(line)) read_row(line, line_number_);
    report_columns();
    if (!is_own_) join_times(table_, dialect_.has_pairs);
    if (!is_own_) add_fractions(table_);
    if (!is_own_) count_rows(table_, dialect_.style, missing_rows_);
    report_end();
    if (table_.rows() == 0)
      throw InputError(
          fmt::format("{}, line {}: there is no row that can be used{}; expected at least one line of {} numbers{}",
                      table_.path, input_.line_number() + 1, end_words(), table_.names.size(), other_count_words()));
    return std::move(table_);
  }

 private:
  /// The first row that had not as many fields as there are names.
  std::string other_count_words() const {
    const auto at = std::find_if(table_.problems.begin(), table_.problems.end(), [](const RecordingProblem& problem) {
      return problem.kind == ProblemKind::field_count;
    });
    if (at == table_.problems.end()) return "";
    return fmt::format(" under the names {}; {}", names_text(table_.names),
                       at->sentence.substr(table_.path.size() + 2));
  }

  struct Line {
    std::string text;
    std::size_t number;
  };

  /// The next line; where a quote that begins a field is open at its end, the lines up to its end are one.
  bool next_line(std::string_view& line) {
    if (!take_line(line)) return false;
    if (line.find('"') == std::string_view::npos || !leaves_quote_open(line)) return true;
    std::vector<Line> taken{{std::string(line), line_number_}};
    std::string joined = taken.front().text;
    while (taken.size() < longest_field_lines && leaves_quote_open(joined) && take_line(line)) {
      taken.push_back({std::string(line), line_number_});
      (joined += ' ') += taken.back().text;
    }
    if (leaves_quote_open(joined)) {  // a sign of inches or a damaged line: each stands by itself
      ahead_.insert(ahead_.begin(), taken.begin() + 1, taken.end());
      joined = taken.front().text;
      line_number_ = taken.front().number;
    }
    joined_ = std::move(joined);
    line = joined_;
    return true;
  }

  bool take_line(std::string_view& line) {
    if (!ahead_.empty()) {
      taken_ = std::move(ahead_.front());
      ahead_.pop_front();
      line = taken_.text;
      line_number_ = taken_.number;
      return true;
    }
    const bool is_there = input_.next_line(line);
    line_number_ = input_.line_number();
    return is_there;
  }

  bool is_own() const { return table_.comments.starts_with(own_format); }

  /// Comments go to the table; lines behind them are added up to so many, those of our own format one by one.
  void add_sample(std::vector<Line>& lines, std::size_t most) {
    std::string_view line;
    while (lines.size() < most && next_line(line)) {
      if (line_number_ == 1 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);  // byte order mark
      if (lines.empty() && (line.starts_with('#') || line.starts_with('%'))) {
        line.remove_prefix(1);
        if (line.starts_with(' ')) line.remove_prefix(1);
        table_.comments.append(as_utf8(line)) += '\n';
        refuse_beyond(most_bytes_, table_.comments.size(), table_.path, line_number_);
        if (!is_own() && !trimmed(line).empty()) last_comment_ = {std::string(line), line_number_};
      } else if (!lines.empty() || !trimmed(line).empty()) {
        lines.push_back({std::string(line), line_number_});
        sampled_bytes_ += line.size();
        if (is_own()) break;
      }
    }
  }

  /// A head may be longer than the sample, and the first rows may show no decimal sign: then more lines are read.
  std::vector<std::size_t> find_dialect_within(std::vector<Line>& lines) {
    add_sample(lines, sample_lines);
    if (lines.empty())
      throw InputError(
          fmt::format("{}, line {}: the file ends before the line of column names{}; expected one line such as "
                      "t_s,x_m,u_V after the comment lines",
                      table_.path, input_.line_number() + 1, end_words()));
    std::vector<std::size_t> places = find_dialect_in(lines);
    while (!is_own() && !dialect_.is_sure && sampled_bytes_ < most_sampled_bytes) {
      const std::size_t before = lines.size();
      add_sample(lines, 4 * before);
      if (lines.size() == before) break;
      places = find_dialect_in(lines);
    }
    return places;
  }

  void refuse_long_lines(const std::vector<std::string>& texts) const {
    for (const std::string& text : texts)
      for (const char separator : {',', ';', '\t', '|'}) {
        const auto count = static_cast<std::size_t>(std::count(text.begin(), text.end(), separator));
        if (count > most_columns)
          throw InputError(fmt::format("{}: a line has {} fields, expected a table of at most {} columns with one row "
                                       "a sample; does each line hold a channel? Write it the other way round",
                                       table_.path, count + 1, most_columns));
      }
  }

  /// Lines that say something, as indices; a comment that names the columns of rows without names is put before them.
  std::vector<std::size_t> find_dialect_in(std::vector<Line>& lines) {
    std::vector<std::string> texts;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (!trimmed(lines[i].text).empty() && !lines[i].text.starts_with('#')) {
        texts.push_back(as_utf8(lines[i].text));
        places.push_back(i);
      }
    is_line_quoted_ = std::all_of(texts.begin(), texts.end(), is_quoted_line);
    if (is_line_quoted_)
      for (std::string& text : texts) text = unquoted_line(text);
    if (!is_own()) refuse_long_lines(texts);
    if (!is_own() && keyed_.names.empty() && !texts.empty()) take_names_of_fields(lines, texts, places);
    const bool is_first_sample = lines.size() <= sample_lines + 1;
    if (!is_own() && is_first_sample && !is_line_quoted_ && !texts.empty()) long_rows_ = find_long_rows(texts);
    dialect_ = long_rows_.found() ? Dialect() : find_dialect(texts);
    if (!keyed_.names.empty()) keyed_.state_units(dialect_);
    if (long_rows_.found()) return dialect_.is_sure = true, places;
    if (!dialect_.is_nameless || trimmed(last_comment_.text).empty()) return places;
    texts.insert(texts.begin(), as_utf8(last_comment_.text));
    const Dialect named = find_dialect(texts);
    std::vector<std::string_view> fields;
    split_fields(texts[1], named.style, fields);
    const bool is_trailing = named.has_trailing || named.has_index;
    if (named.names_line != 0 || named.first_row != 1 || named.names.size() + (is_trailing ? 1 : 0) != fields.size())
      return places;
    dialect_ = named;
    lines.insert(lines.begin(), last_comment_);
    for (std::size_t& place : places) ++place;
    places.insert(places.begin(), 0);
    return places;
  }

  /// Where each field bears its name, the names become a line of their own and are taken off.
  void take_names_of_fields(std::vector<Line>& lines, std::vector<std::string>& texts,
                            std::vector<std::size_t>& places) {
    keyed_ = find_keyed_rows(texts);
    if (keyed_.names.empty()) return;
    for (std::size_t i = texts.size(); i-- > 0;) {
      if (keyed_.holds_values(texts[i])) continue;
      texts.erase(texts.begin() + static_cast<std::ptrdiff_t>(i));
      places.erase(places.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (std::string& text : texts) text = keyed_.row(text);
    keyed_.left_out.clear();  // the lines are read once more as rows
    lines.insert(lines.begin(), {keyed_.names_line(), lines.front().number});
    texts.insert(texts.begin(), lines.front().text);
    for (std::size_t& place : places) ++place;
    places.insert(places.begin(), 0);
  }

  /// A row for each value: its channels become the columns.
  CsvTable read_long(const std::vector<Line>& lines, const std::vector<std::size_t>& places) {
    for (std::size_t i = 0; i + 1 < long_rows_.first_row; ++i)
      table_.comments.append(as_utf8(lines[places[i]].text)) += '\n';
    table_.header = parse_header(table_.comments);
    LongTable rows(long_rows_, table_, most_bytes_);
    const auto add = [&](std::string_view line, std::size_t number) {
      if (!keyed_.names.empty()) line = keyless_ = keyed_.row(line);
      rows.add(line, number);
    };
    for (std::size_t i = places[long_rows_.first_row]; i < lines.size(); ++i) add(lines[i].text, lines[i].number);
    std::string_view line;
    while (next_line(line)) add(line, line_number_);
    rows.finish();
    report_end();
    return std::move(table_);
  }

  void read_head(std::vector<Line>& lines, const std::vector<std::size_t>& places) {
    const std::size_t names = places[dialect_.names_line];
    for (std::size_t i = 0; i < names; ++i) table_.comments.append(as_utf8(lines[i].text)) += '\n';
    table_.header = parse_header(table_.comments);
    take_names(lines[names].number);
    const std::string words =
        dialect_.words() + (input_.encoding().empty() ? "" : fmt::format(", {}", input_.encoding()));
    if (!words.empty())
      table_.report(0, ProblemKind::dialect, "read with " + words.substr(words.starts_with(", ") ? 2 : 0));
    const std::size_t first = dialect_.first_row < places.size() ? places[dialect_.first_row] : lines.size();
    const std::size_t start = dialect_.has_rows_between ? first : names + 1;
    for (std::size_t i = names + 1; i < start; ++i) table_.comments.append(as_utf8(lines[i].text)) += '\n';
    for (std::size_t i = start; i < lines.size(); ++i) read_row(lines[i].text, lines[i].number);
  }

  std::string_view end_words() const {
    return input_.end() == TextInput::End::whole ? "" : " (the file is cut off or damaged)";
  }

  /// A name for each column: foreign ones without a name get their place's, and repeated ones a number.
  std::string usable_name(std::string name, std::size_t line) {
    double number;
    if (name.empty() && !is_own()) return fmt::format("column {}", table_.names.size() + 1);
    if (name.empty() || number_in(name, '.', number))
      throw InputError(
          fmt::format("{}, line {}: found \"{}\" where a column name is expected; the first line after the "
                      "comment lines names the columns",
                      table_.path, line, name));
    if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' ' && c != '\t'; }))
      throw InputError(fmt::format("{}, line {}: found bytes that are no text where the column names are expected; "
                                   "expected a table written as text",
                                   table_.path, line));
    std::size_t& count = times_named_[name];
    if (++count == 1) return name;
    if (is_own()) throw InputError(fmt::format("{}, line {}: column {} is there twice", table_.path, line, name));
    while (times_named_.contains(fmt::format("{} ({})", name, count))) ++count;
    const std::string numbered = fmt::format("{} ({})", name, count);
    times_named_[numbered] = 1;
    table_.report(line, ProblemKind::dialect,
                  fmt::format("column {} is there again: the first bears the name, this one is {}", name, numbered));
    return numbered;
  }

  void take_names(std::size_t line) {
    for (const std::string& name : dialect_.names) table_.names.push_back(usable_name(name, line));
    known_names_.insert(dialect_.names.begin(), dialect_.names.end());
    dialect_.value_units.resize(table_.names.size());
    unreadable_.assign(table_.names.size(), {});
    table_.units = dialect_.units;
    table_.units.resize(table_.names.size());
    table_.is_clock.assign(table_.names.size(), 0);
    is_own_ = is_own();
    field_count_ = table_.names.size();
    for (std::size_t i = 0; i < field_count_; ++i) places_.push_back(i);
    leave_out_unwanted();
    table_.values.resize(table_.names.size());
    row_.resize(table_.names.size());
  }

  void leave_out_unwanted() {
    if (wanted_.empty() || !table_.comments.starts_with(own_format)) return;
    for (std::size_t i = table_.names.size(); i-- > 0;) {
      if (wanted_.contains(table_.names[i])) continue;
      const auto at = static_cast<std::ptrdiff_t>(i);
      table_.left_out.push_back(table_.names[i]);
      table_.names.erase(table_.names.begin() + at);
      table_.units.erase(table_.units.begin() + at);
      table_.is_clock.erase(table_.is_clock.begin() + at);
      dialect_.value_units.erase(dialect_.value_units.begin() + at);
      places_.erase(places_.begin() + at);
    }
  }

  /// Takes the fields of a row; false where the line is none.
  bool take_fields(std::string_view line, std::size_t number) {
    const std::size_t expected = field_count_, index = dialect_.has_index ? 1 : 0;
    if (is_line_quoted_ && is_quoted_line(line)) line = keyless_ = unquoted_line(line);
    if (!keyed_.names.empty()) line = keyless_ = keyed_.row(std::string(line));
    split_fields(line, dialect_.style, fields_);
    const bool may_end_empty = dialect_.has_trailing || !is_own_;
    while (may_end_empty && fields_.size() > expected + index && fields_.back().empty()) fields_.pop_back();
    if (dialect_.has_split_times && fields_.size() > 1) join_first_two();
    if (dialect_.least_fields > 0 && fields_.size() >= dialect_.least_fields)
      while (fields_.size() < expected + index) fields_.emplace_back();
    const bool is_empty = trimmed(line).empty();
    if (is_empty && expected > 1 && !is_own_) return false;
    if (is_names_again(number)) return false;
    // "#N/A;0.5;1" is a row.
    const bool is_comment = line.starts_with('#') && !(fields_.size() == expected + index && holds_number());
    if (fields_.size() == expected + index && !is_comment && !(is_empty && expected > 1)) return true;
    table_.report(number, ProblemKind::field_count,
                  is_comment ? "a comment line among the rows is not used"
                             : fmt::format("{} fields where {} are expected; the row is not used",
                                           is_empty ? 0 : fields_.size(), expected + index));
    if (!is_comment && !dialect_.has_index && holds_number()) missing_rows_.push_back({table_.rows(), 1});
    refuse_beyond(most_bytes_, table_.problems.size() * bytes_of_a_problem, table_.path, number);
    return false;
  }

  void join_first_two() {
    const char* from = fields_[0].data();
    fields_[0] = {from, static_cast<std::size_t>(fields_[1].data() + fields_[1].size() - from)};
    fields_.erase(fields_.begin() + 1);
  }

  bool holds_number() const {
    double value = 0;
    return !is_own_ && std::any_of(fields_.begin(), fields_.end(), [&](std::string_view field) {
      return number_in(field, dialect_.style.decimal, value);
    });
  }

  /// An index that skips numbers tells of rows that are missing.
  void follow_index() {
    double index = 0;
    if (!number_in(fields_.front(), '.', index)) return;
    const double skipped = index - last_index_ - 1;
    if (skipped >= 1 && skipped < most_skipped) missing_rows_.push_back({table_.rows(), std::llround(skipped)});
    last_index_ = index;
  }

  /// Names once more are passed over; other names, or the same in another order, begin another table.
  bool is_names_again(std::size_t line) {
    const auto known = std::count_if(fields_.begin(), fields_.end(), [&](std::string_view field) {
      return !field.empty() && known_names_.contains(field);
    });
    if (is_own_ || known < 2 || fields_.front().empty()) return false;  // a blank line between blanks has no field
    if (std::equal(fields_.begin(), fields_.end(), dialect_.names.begin(), dialect_.names.end())) {
      if (names_again_++ == 0)
        table_.report(line, ProblemKind::dialect, "the line of names stands here again: passed over");
      return true;
    }
    throw InputError(
        fmt::format("{}, line {}: found other column names, {}, expected those of the first rows, {}; split "
                    "the file here",
                    table_.path, line, names_text({fields_.begin(), fields_.end()}), names_text(dialect_.names)));
  }

  void read_row(std::string_view line, std::size_t number) {
    if (!take_fields(line, number)) return;
    const std::size_t index = dialect_.has_index ? 1 : 0;
    if (dialect_.has_index) follow_index();
    if (table_.rows() % rows_between_bounds == 0)
      refuse_beyond(most_bytes_, table_.rows() * (row_.size() + 1) * sizeof(double), table_.path, number);
    for (std::size_t i = 0; i < row_.size(); ++i) row_[i] = read_field(fields_[places_[i] + index], i, number);
    for (std::size_t i = 0; i < row_.size(); ++i) table_.values[i].push_back(row_[i]);
    table_.line_numbers.push_back(number);
    if (!std::exchange(are_no_groups_, false)) return;
    for (std::size_t i = 0; i < row_.size(); ++i)
      for (const std::size_t at : std::exchange(unreadable_[i].grouped, {})) table_.values[i][at] /= 1000;
  }

  double read_field(std::string_view field, std::size_t column, std::size_t line) {
    if (field.empty()) return no_value;
    double value;
    const std::string& unit = dialect_.value_units[column];
    if (!unit.empty() && field.ends_with(unit)) field = trimmed(field.substr(0, field.size() - unit.size()));
    const std::optional<double> digits_s = is_own_ ? std::nullopt : digits_clock_in(field);
    if (digits_s || !number_in(field, dialect_.style.decimal, value)) {
      if (const auto s = digits_s ? digits_s : unreadable_[column].clock.take(field, table_.line_numbers.size())) {
        table_.is_clock[column] = 1;
        return *s;
      }
      if (takes_other_sign(field, column, line, value)) return value;
      if (const std::size_t remark = is_own_ ? std::string_view::npos : std::min(field.find('#'), field.find("//"));
          remark != std::string_view::npos && !ends_in_decimal_sign(field.substr(0, remark)) &&
          number_in(trimmed(field.substr(0, remark)), dialect_.style.decimal, value))
        return value;
      if (!is_own_ && hexadecimal_in(field, value)) {
        Unreadable& text = unreadable_[column];
        if (text.hexadecimal.empty()) text.first_hexadecimal = shown(field);
        text.hexadecimal.push_back(table_.line_numbers.size());
        return value;
      }
      if (unreadable_[column].count++ == 0) unreadable_[column].first = shown(field);
      if (unreadable_[column].count <= most_told)
        table_.report(line, ProblemKind::unreadable_field,
                      fmt::format("{} is \"{}\", which is no number; it is read as no value", table_.names[column],
                                  shown(field)));
      return no_value;
    }
    if (const bool is_mark = !is_own_ && std::abs(value) >= least_mark; is_mark || !std::isfinite(value)) {
      table_.report(line, ProblemKind::not_a_number, fmt::format("{} is {}", table_.names[column], field));
      return is_mark ? no_value : value;
    }
    return value;
  }

  /// The sign that is not the decimal one of the rows: between groups of three digits as in "1,000" it stands for
  /// thousands. Where a column shows it otherwise, as in "0.25", it is a decimal sign, there, elsewhere and before.
  bool takes_other_sign(std::string_view field, std::size_t column, std::size_t line, double& value) {
    Unreadable& text = unreadable_[column];
    const char decimal = dialect_.style.decimal, sign = decimal == '.' ? ',' : '.';
    if (!dialect_.style.has_groups || field.find(sign) == std::string_view::npos) return false;
    const bool is_group = !shows_other_decimals_ && number_with_groups(field, decimal, value);
    if (!is_group && !number_in(field, sign, value)) return false;
    if (is_group && std::count(field.begin(), field.end(), sign) == 1)
      text.grouped.push_back(table_.line_numbers.size());
    are_no_groups_ = are_no_groups_ || (!is_group && !shows_other_decimals_);
    shows_other_decimals_ = shows_other_decimals_ || !is_group;
    if (!std::exchange(is_group ? text.has_groups : text.has_own_decimals, true))
      table_.report(line, ProblemKind::dialect,
                    fmt::format("{} is \"{}\": {} is taken for {} in this column{}", table_.names[column], shown(field),
                                sign == '.' ? "a point" : "a comma", is_group ? "thousands" : "the decimal sign",
                                is_group ? " from here on" : ""));
    return true;
  }

  /// A column all of whose values are hexadecimal holds counts; between other numbers they are text.
  void judge_hexadecimal(std::size_t column) {
    Unreadable& text = unreadable_[column];
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
    if (text.count == 0) text.first = text.first_hexadecimal;
    text.count += text.hexadecimal.size() + most_told;  // told as a whole
  }

  /// A column of text is told once, and so is how often another holds text.
  void report_columns() {
    for (std::size_t c = 0; c < table_.names.size(); ++c) {
      judge_hexadecimal(c);
      if (const std::string_view order = unreadable_[c].clock.settle(table_.values[c]); !order.empty())
        table_.report(0, ProblemKind::dialect,
                      fmt::format("dates of {} are read as {}: so the times go on", table_.names[c], order));
      const Unreadable& text = unreadable_[c];
      const std::string what = fmt::format("{} is \"", table_.names[c]);
      const bool is_text = text.count > 1 && std::none_of(table_.values[c].begin(), table_.values[c].end(),
                                                          [](double value) { return std::isfinite(value); });
      if (is_text)
        std::erase_if(table_.problems, [&](const RecordingProblem& problem) {
          return problem.kind == ProblemKind::unreadable_field && problem.sentence.find(what) != std::string::npos;
        });
      if (is_text || text.count > most_told)
        table_.report(0, ProblemKind::dialect,
                      fmt::format("column {} holds {} such as \"{}\", read as no value", table_.names[c],
                                  is_text ? "text" : fmt::format("{} fields of text", text.count), text.first));
    }
  }

  void report_end() {
    keyed_.tell(table_);
    const std::size_t line = input_.line_number() + 1;
    if (input_.end() == TextInput::End::truncated)
      table_.report(line, ProblemKind::truncated, "the file is cut off here; the whole rows before are used");
    else if (input_.end() == TextInput::End::damaged)
      table_.report(
          line, ProblemKind::damaged,
          "the compressed data are damaged near here; the rows before are used, the last of them may be wrong");
  }

  static constexpr std::string_view own_format = "format: pneuservo-recording/";

  TextInput input_;
  const std::set<std::string>& wanted_;
  const std::size_t most_bytes_;
  CsvTable table_;
  LongRows long_rows_;
  KeyedRows keyed_;
  std::string keyless_;  ///< the row that is read, without its names or the quotes around it
  std::map<std::string, std::size_t> times_named_;
  std::set<std::string, std::less<>> known_names_;
  std::size_t names_again_ = 0, sampled_bytes_ = 0;
  std::size_t field_count_ = 0;  ///< of a row, an index left aside
  std::vector<std::size_t> places_;  ///< of the kept columns among the fields
  Dialect dialect_;
  std::vector<std::string_view> fields_;
  std::vector<double> row_;
  Line last_comment_{};
  std::deque<Line> ahead_;  ///< lines that were looked at and given back
  Line taken_{};
  std::string joined_;
  std::size_t line_number_ = 0;
  double last_index_ = no_value;
  std::vector<MissingRows> missing_rows_;  ///< refused ones, and those that the index skips
  bool is_own_ = false;
  bool is_line_quoted_ = false;
  bool shows_other_decimals_ = false;  ///< some column has the other decimal sign: it makes no groups
  bool are_no_groups_ = false;  ///< the row that is read has shown it: what was read as groups before is to be divided
  struct Unreadable {
    std::size_t count = 0;
    ClockColumn clock;
    std::string first;
    bool has_groups = false, has_own_decimals = false;  ///< by the sign that is not the rows' decimal one
    std::vector<std::size_t> hexadecimal;  ///< rows whose field is so
    std::string first_hexadecimal;
    std::vector<std::size_t> grouped;  ///< rows whose number is thousands only if that sign is none of decimals
  };
  std::vector<Unreadable> unreadable_;  ///< of each column
};

}  // namespace

CsvTable read_table(const std::string& path, const std::set<std::string>& wanted, std::size_t most_bytes) {
  return TableReader(path, wanted, most_bytes > 0 ? most_bytes : most_table_bytes()).read();
}

}  // namespace pneuservo
