// Channels of several axes in one table, told apart by their names.
#include "record/foreign/axis_names.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "record/foreign/column_words.hpp"
#include "record/foreign/field_text.hpp"
#include "record/row_text.hpp"

namespace pneuservo {

namespace {

/// Words end at signs; pieces of words also between letters and digits and before a capital letter.
enum class Cut { words, pieces };

struct Place {
  std::size_t begin = 0, end = 0;
};

std::vector<Place> places_in(std::string_view name, Cut cut) {
  std::vector<Place> out;
  unsigned char before = ' ';
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto now = static_cast<unsigned char>(name[i]);
    const bool is_digit = std::isdigit(now) != 0, is_part = is_letter(name[i]) || is_digit;
    const bool is_piece =
        cut == Cut::pieces && ((std::isupper(now) && std::islower(before)) || is_digit != (std::isdigit(before) != 0));
    if (is_part && (out.empty() || out.back().end != i || is_piece)) out.push_back({i, i});
    if (is_part) out.back().end = i + 1;
    before = now;
  }
  return out;
}

/// The name on both sides of a word, without brackets around it and without the signs beside it.
std::pair<std::string, std::string> around(const std::string& name, Place place) {
  constexpr std::string_view signs = "_ ./:\\|-#";
  if (place.begin > 0 && place.end < name.size() &&
      std::string_view("[]()<>{}").find(name.substr(place.begin - 1, 1) + name[place.end]) != std::string_view::npos)
    --place.begin, ++place.end;
  std::string before = name.substr(0, place.begin), behind = name.substr(place.end), sign;
  for (; !before.empty() && signs.find(before.back()) != std::string_view::npos; before.pop_back())
    sign = before.back();
  for (; !behind.empty() && signs.find(behind.front()) != std::string_view::npos; behind.erase(0, 1))
    sign = behind.front();
  return {before, before.empty() || behind.empty() ? behind : sign + behind};
}

/// A word of a name that may be its axis, with the rest of the name.
struct Slot {
  std::string axis, before, behind;
  std::size_t from_start = 0, from_end = 0;  ///< words beside it

  std::string rest() const { return before + behind; }
};

std::vector<Slot> slots_in(const std::string& name, Cut cut) {
  const std::vector<Place> places = places_in(name, cut);
  const auto text = [&](Place at) { return name.substr(at.begin, at.end - at.begin); };
  std::vector<Slot> out;
  for (std::size_t i = 0; i < places.size(); ++i) {
    Place whole = places[i];
    if (!may_name_axis(text(whole))) continue;
    // Of several cylinders the word is the axis', and says nothing of where a pressure is.
    if (i > 0 && is_cylinder_word(text(places[i - 1]))) whole.begin = places[i - 1].begin;
    else if (i + 1 < places.size() && is_cylinder_word(text(places[i + 1]))) whole.end = places[i + 1].end;
    auto [before, behind] = around(name, whole);
    if (!before.empty() || !behind.empty())
      out.push_back({text(whole), std::move(before), std::move(behind), i, places.size() - i - 1});
  }
  return out;
}

/// Columns whose names are equal but for one word.
struct Alike {
  std::map<std::string, std::size_t> columns;  ///< by that word
  const Slot* slot = nullptr;                  ///< of one of them
};

/// Names cut one way.
class CutNames {
 public:
  using Meaning = std::function<std::string(std::size_t, const std::string&)>;

  CutNames(const std::vector<std::string>& names, Cut cut, const Meaning& meaning) : names_(names), meaning_(meaning) {
    const std::vector<std::string> ours = columns_of_the_format();
    for (const std::string& name : names)
      slots_.push_back(std::ranges::count(ours, name) > 0 ? std::vector<Slot>() : slots_in(name, cut));
    for (std::size_t c = 0; c < names.size(); ++c)
      for (const Slot& slot : slots_[c]) add(c, slot);
    add_unnumbered();
    std::erase_if(alike_, [](const auto& entry) { return entry.second.columns.size() < 2; });
    find_family();
  }

  /// Signals of which several axes have one; fewer than two tell no axes.
  std::size_t signals() const { return signals_.size(); }

  /// Whether no name may be of two axes: "p1 2" is p1 of axis 2 or p2 of axis 1.
  bool is_clear() const {
    for (std::size_t c = 0; c < slots_.size(); ++c) {
      std::set<std::string> meanings;
      for (const Slot& slot : slots_[c])
        if (family_.contains(slot.axis) && means(c, slot)) meanings.insert(meaning_of(c, slot.rest()));
      if (meanings.size() > 1) return false;
    }
    return true;
  }

  AxisOfColumn axis_of(std::size_t column) const {
    const Slot* best = nullptr;
    int most = 0;
    for (const Slot& slot : slots_[column]) {
      if (!family_.contains(slot.axis)) continue;
      const int likeness = (is_shared(slot) ? 4 : 0) + (means(column, slot) ? 8 : 0) +
                           (slot.from_start == from_start_ ? 2
                            : slot.from_end == from_end_   ? 1
                                                           : 0);
      if (likeness > most && likeness >= 4) best = &slot, most = likeness;
    }
    if (best != nullptr) return {true, best->axis, best->rest()};
    const bool is_unnumbered = family_.contains("") && std::ranges::any_of(alike_, [&](const auto& entry) {
                                 const auto at = entry.second.columns.find("");
                                 return at != entry.second.columns.end() && at->second == column;
                               });
    return {is_unnumbered, "", names_[column]};
  }

 private:
  static std::pair<std::string, std::string> key_of(const Slot& slot) { return {slot.before, slot.behind}; }

  void add(std::size_t column, const Slot& slot) {
    Alike& alike = alike_[key_of(slot)];
    alike.columns.try_emplace(slot.axis, column);
    alike.slot = &slot;
  }

  /// "Position" beside "Position 2" is of an axis without a number.
  void add_unnumbered() {
    std::map<std::string, std::size_t> column_of;
    for (std::size_t c = 0; c < names_.size(); ++c) column_of.try_emplace(names_[c], c);
    for (auto& [key, alike] : alike_) {
      const auto at = column_of.find(alike.slot->rest());
      if (at != column_of.end() && are_digits(alike.slot->axis)) alike.columns.try_emplace("", at->second);
    }
  }

  std::string meaning_of(std::size_t column, const std::string& rest) const {
    const auto [at, is_new] = meanings_.try_emplace({column, rest});
    if (is_new) at->second = meaning_(column, rest);
    return at->second;
  }
  bool means(std::size_t column, const Slot& slot) const { return !meaning_of(column, slot.rest()).empty(); }

  bool is_shared(const Slot& slot) const {
    const auto at = alike_.find(key_of(slot));
    return at != alike_.end() && std::ranges::count_if(at->second.columns, [&](const auto& entry) {
                                   return family_.contains(entry.first);
                                 }) > 1;
  }

  /// Words that stand for each other in names that mean the same; those that part the most signals.
  void find_family() {
    for (const auto& [key, alike] : alike_) {
      std::set<std::string> words = words_of(alike, "x_m");
      if (words.size() < 2) words = words_of(alike, "u_V");
      if (words.size() < 2) continue;
      std::set<std::string> signals;
      for (const auto& [other_key, other] : alike_)
        for (const std::string& ours : meanings_in(other))
          if (ours != "x_ref_m" && ours != "t_s" && count_in(words, words_of(other, ours)) > 1) signals.insert(ours);
      if (signals.size() < 2 || signals.size() <= signals_.size()) continue;
      family_ = std::move(words), signals_ = std::move(signals);
      from_start_ = alike.slot->from_start, from_end_ = alike.slot->from_end;
    }
  }

  static std::size_t count_in(const std::set<std::string>& words, const std::set<std::string>& some) {
    return static_cast<std::size_t>(
        std::ranges::count_if(some, [&](const auto& word) { return words.contains(word); }));
  }

  std::set<std::string> meanings_in(const Alike& alike) const {
    std::set<std::string> out;
    for (const auto& [word, column] : alike.columns) out.insert(meaning_of(column, alike.slot->rest()));
    out.erase("");
    return out;
  }

  std::set<std::string> words_of(const Alike& alike, const std::string& ours) const {
    std::set<std::string> out;
    for (const auto& [word, column] : alike.columns)
      if (meaning_of(column, alike.slot->rest()) == ours) out.insert(word);
    return out;
  }

  const std::vector<std::string>& names_;
  const Meaning& meaning_;
  std::vector<std::vector<Slot>> slots_;
  std::map<std::pair<std::string, std::string>, Alike> alike_;
  mutable std::map<std::pair<std::size_t, std::string>, std::string> meanings_;
  std::set<std::string> family_;   ///< words that stand for the axes
  std::set<std::string> signals_;  ///< which several of them have
  std::size_t from_start_ = 0, from_end_ = 0;
};

}  // namespace

std::vector<AxisOfColumn> axes_in(const std::vector<std::string>& names, const CutNames::Meaning& meaning) {
  const CutNames words(names, Cut::words, meaning), pieces(names, Cut::pieces, meaning);
  const bool tell_more = pieces.signals() > words.signals() && (pieces.is_clear() || words.signals() < 2);
  const CutNames& best = tell_more ? pieces : words;
  std::vector<AxisOfColumn> out(names.size());
  if (best.signals() > 1)
    for (std::size_t c = 0; c < names.size(); ++c) out[c] = best.axis_of(c);
  return out;
}

}  // namespace pneuservo
