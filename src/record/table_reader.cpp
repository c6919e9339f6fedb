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
#include "record/column_values.hpp"
#include "record/foreign/column_guess.hpp"
#include "record/foreign/dialect.hpp"
#include "record/foreign/edge_rows.hpp"
#include "record/foreign/field_reader.hpp"
#include "record/foreign/head_units.hpp"
#include "record/foreign/keyed_rows.hpp"
#include "record/foreign/line_facts.hpp"
#include "record/foreign/long_rows.hpp"
#include "record/foreign/names_text.hpp"
#include "record/foreign/table_times.hpp"
#include "record/table_bound.hpp"
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
    if (is_last_line_whole()) read_row(std::string(input_.unended()), input_.line_number() + 1);
    refuse_single_fields();
    refuse_missing_fields();
    reader_.finish();
    const std::size_t above = edges_.leave_out(table_);
    for (MissingRows& missing : missing_rows_) missing.before -= std::min(missing.before, above);
    if (!is_own_) take_head_units(table_);
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
    names_line_ = lines[names].number;
    take_names(names_line_);
    if (dialect_.scale_line) refuse_factors(table_.path, lines[places[*dialect_.scale_line]].number);
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
    table_.units = dialect_.units;
    table_.units.resize(table_.names.size());
    table_.is_clock.assign(table_.names.size(), 0);
    is_own_ = is_own();
    field_count_ = table_.names.size();
    for (std::size_t i = 0; i < field_count_; ++i) places_.push_back(i);
    leave_out_unwanted();
    table_.values.resize(table_.names.size());
    row_.resize(table_.names.size());
    reader_.start(is_own_);
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
    if (holds_number()) most_fields_ = std::max(most_fields_, fields_.size() - std::min(index, fields_.size()));
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

  /// Whether the fields are names: two of them known, or the first one where no field is a number.
  bool are_names() const {
    if (is_own_ || fields_.empty() || fields_.front().empty())
      return false;  // a blank line between blanks has no field
    std::size_t known = 0, meant = 0;
    const bool is_first_known = known_names_.contains(fields_.front());
    const std::string_view first = fields_.front();
    if (!is_first_known && std::none_of(first.begin(), first.end(), is_letter)) return false;  // a number begins a row
    for (const std::string_view field : fields_) known += !field.empty() && known_names_.contains(field);
    if (known >= 2) return true;
    if (fields_.size() < 2 || holds_value()) return false;
    if (fields_.size() == field_count_ && !is_first_known)
      for (const std::string_view field : fields_) {
        if (std::count(fields_.begin(), fields_.end(), field) > 1) return false;  // of a head: "X_Dimension,Time,Time"
        meant += !meaning_of(std::string(field)).empty();
      }
    return is_first_known || meant >= 2;
  }

  bool holds_value() const {
    return std::any_of(fields_.begin(), fields_.end(),
                       [&](std::string_view field) { return is_value(field, dialect_.style); });
  }

  /// Names once more are passed over; other names, or the same in another order, begin another table.
  bool is_names_again(std::size_t line) {
    if (!are_names()) return false;
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
    for (std::size_t i = 0; i < row_.size(); ++i) row_[i] = reader_.read(fields_[places_[i] + index], i, number);
    for (std::size_t i = 0; i < row_.size(); ++i) table_.values[i].push_back(row_[i]);
    if (is_written_otherwise()) edges_.add(table_.rows());
    table_.line_numbers.push_back(number);
    reader_.end_row();
  }

  /// Names with more columns than any row has fields: which of them has none must be seen at the end of the names.
  void refuse_missing_fields() const {
    if (dialect_.least_fields == 0 || most_fields_ == 0 || most_fields_ >= field_count_) return;
    for (std::size_t c = most_fields_; c < field_count_; ++c) {
      const std::string& name = dialect_.names[c];
      if (meaning_of(name).empty() && stated_unit(table_, c).empty()) continue;
      throw InputError(
          fmt::format("{}, line {}: found {} names, {}, and at most {} fields in the rows below; nothing says which "
                      "column has no fields: take its name out of this line",
                      table_.path, names_line_, field_count_, names_text(dialect_.names), most_fields_));
    }
  }

  void refuse_single_fields() const {
    if (is_own_ || table_.names.size() != 1 || table_.rows() == 0) return;
    if (table_.names[0].find_first_of(",;|\t ") != std::string::npos) return;
    const std::vector<double>& values = table_.values[0];
    if (has_value(values)) return;
    throw InputError(fmt::format("{}, line {}: found one field in each line, the first being \"{}\"; expected fields "
                                 "between commas, semicolons, tabs, blanks or |",
                                 table_.path, names_line_, shown(table_.names[0])));
  }

  /// A last line without an end is whole where it has every field, the last with as many decimals as in all rows.
  bool is_last_line_whole() {
    const std::string line(input_.unended());
    if (is_own_ || line.empty() || !keyed_.names.empty() || is_line_quoted_) return false;
    split_fields(line, dialect_.style, fields_);
    const std::size_t index = dialect_.has_index ? 1 : 0;
    if (fields_.size() != field_count_ + index || dialect_.decimals.empty()) return false;
    const int decimals = dialect_.decimals.back();
    const bool ends_in_digit = std::isdigit(static_cast<unsigned char>(line.back())) != 0;
    is_last_whole_ = decimals > 0 && ends_in_digit && decimals_of(fields_.back(), dialect_.style.decimal) == decimals &&
                     fields_.back().find_first_of("eE") == std::string_view::npos;
    return is_last_whole_;
  }

  /// No field has the decimals that its column has in nearly all rows.
  bool is_written_otherwise() const {
    constexpr std::size_t least_compared = 3;
    if (is_own_) return false;
    const std::size_t index = dialect_.has_index ? 1 : 0;
    std::size_t compared = 0;
    for (std::size_t c = 0; c < dialect_.decimals.size(); ++c) {
      const std::string_view field = fields_[c + index];
      if (dialect_.decimals[c] < 0 || field.empty()) continue;
      if (decimals_of(field, dialect_.style.decimal) == dialect_.decimals[c]) return false;
      ++compared;
    }
    return compared >= least_compared;
  }

  void report_end() {
    keyed_.tell(table_);
    if (is_last_whole_) return;
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
  EdgeRows edges_;
  std::size_t most_fields_ = 0, names_line_ = 0;
  bool is_last_whole_ = false;  ///< the last line lacks its end only
  bool is_own_ = false;
  bool is_line_quoted_ = false;
  FieldReader reader_{table_, dialect_};
};

}  // namespace

CsvTable read_table(const std::string& path, const std::set<std::string>& wanted, std::size_t most_bytes) {
  return TableReader(path, wanted, most_bytes > 0 ? most_bytes : most_table_bytes()).read();
}

}  // namespace pneuservo
