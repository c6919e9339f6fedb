// Objects of JSON and dictionaries of Python in a line of text.
#include "record/foreign/object_text.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <string>

#include "record/foreign/field_text.hpp"
#include "record/foreign/units.hpp"

namespace pneuservo {

namespace {

constexpr std::size_t deepest_object = 20, most_of_list = 100;

/// One value of an object, with the keys that lead to it.
struct Leaf {
  std::vector<std::string> path;
  std::string value;
  bool is_text = false;
};

/// Reads an object from its text, as strictly as telling it from other text needs.
class ObjectReader {
 public:
  explicit ObjectReader(std::string_view text) : rest_(trimmed(text)) {}

  bool take() { return rest_.starts_with('{') && take_value() && trimmed(rest_).empty(); }
  std::vector<Leaf>& leaves() { return leaves_; }

 private:
  bool take_sign(char sign) {
    rest_ = trimmed(rest_);
    if (!rest_.starts_with(sign)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  /// Between quotes of either kind; signs behind a backslash are taken as they are.
  bool take_text(std::string& text) {
    rest_ = trimmed(rest_);
    if (rest_.empty() || (rest_.front() != '"' && rest_.front() != '\'')) return false;
    const char quote = rest_.front();
    std::size_t i = 1;
    for (; i < rest_.size() && rest_[i] != quote; ++i) {
      if (rest_[i] == '\\' && i + 1 < rest_.size()) ++i;
      text += rest_[i];
    }
    if (i >= rest_.size()) return false;
    rest_.remove_prefix(i + 1);
    return true;
  }

  bool take_value() {
    rest_ = trimmed(rest_);
    if (path_.size() > deepest_object) return false;
    if (take_sign('{')) return take_members('}', true);
    if (take_sign('[')) return take_members(']', false);
    Leaf leaf{path_, "", false};
    leaf.is_text = take_text(leaf.value);
    if (!leaf.is_text && !take_word(leaf.value)) return false;
    leaves_.push_back(std::move(leaf));
    return true;
  }

  /// A number, a truth value as 1 or 0, or nothing.
  bool take_word(std::string& value) {
    const std::string_view word = rest_.substr(0, std::min(rest_.find_first_of(" ,}]\t"), rest_.size()));
    rest_.remove_prefix(word.size());
    const std::string small = in_small_letters(word);
    double number = 0;
    if (small == "true" || small == "false") value = small == "true" ? "1" : "0";
    else if (small != "null" && small != "none") value = word;
    return value.empty() ? !word.empty() : number_in(value, '.', number);
  }

  bool take_members(char end, bool have_keys) {
    for (std::size_t count = 1; !take_sign(end); ++count) {
      if ((count > 1 && !take_sign(',')) || (!have_keys && count > most_of_list)) return false;
      std::string key = have_keys ? "" : std::to_string(count);
      if (have_keys && !(take_text(key) && take_sign(':'))) return false;
      path_.push_back(std::move(key));
      if (!take_value()) return false;
      path_.pop_back();
    }
    return true;
  }

  std::string_view rest_;
  std::vector<std::string> path_;
  std::vector<Leaf> leaves_;
};

bool is_key_of(const std::string& key, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), in_small_letters(key)) != words.end();
}

using ObjectPath = std::vector<std::string>;

/// Units that stand in an object inside the line's, by the path to it.
std::map<ObjectPath, std::string> units_in_objects(const std::vector<Leaf>& leaves) {
  std::map<ObjectPath, std::string> out;
  for (const Leaf& leaf : leaves)
    if (leaf.path.size() > 1 && leaf.is_text && is_unit_word(leaf.path.back()) && unit_in(leaf.value))
      out[{leaf.path.begin(), leaf.path.end() - 1}] = leaf.value;
  return out;
}

}  // namespace

std::optional<std::vector<NamedValue>> values_of_object(std::string_view text) {
  text = trimmed(text);
  if (text.ends_with(',')) text.remove_suffix(1);
  if (text.starts_with("[{")) text.remove_prefix(1);
  if (text.ends_with("}]")) text.remove_suffix(1);
  ObjectReader reader(text);
  if (!reader.take()) return std::nullopt;
  const std::map<ObjectPath, std::string> units = units_in_objects(reader.leaves());
  std::vector<NamedValue> out;
  for (const Leaf& leaf : reader.leaves()) {
    ObjectPath path = leaf.path;
    NamedValue one{"", leaf.value, ""};
    if (const auto at = units.find({path.begin(), path.end() - 1}); at != units.end()) {
      if (leaf.is_text && unit_in(leaf.value)) continue;
      one.unit = at->second;
      if (is_key_of(path.back(), {"value", "val", "v", "wert"})) path.pop_back();
    }
    double number = 0;
    if (const std::size_t unit = unit_start(one.value);
        leaf.is_text && unit < one.value.size() && number_in(trimmed(one.value.substr(0, unit)), '.', number)) {
      one.unit = one.value.substr(unit);
      one.value = trimmed(std::string_view(one.value).substr(0, unit));
    }
    // "$date" and the like tell a database the kind of the value.
    std::erase_if(path, [&](const std::string& key) { return key.starts_with('$') && &key != &path.front(); });
    for (const std::string& key : path) one.name += (one.name.empty() ? "" : ".") + key;
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace pneuservo
