// The object dictionary of a CANopen device that this program is: numbers of up to 32 bits and short texts.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <pneuservo/hal/can_object.hpp>

namespace pneuservo {

/// One entry. A text has no number.
struct DictionaryEntry {
  unsigned bits = 32;  ///< 8, 16 or 32; others for mapped fields, which are transferred in whole bytes
  std::uint32_t value = 0;
  bool can_read = true, can_write = true, can_map = false;
  bool is_text = false;
  std::string text{};
  std::string name{};
  bool is_signed = false;
  bool is_constant = false;  ///< never changes (an EDS says const)
  bool adds_node = false;    ///< the default contains the node's number (an EDS has $NODEID there)
  std::uint32_t writes = 0;  ///< how often a master has written it, by SDO or PDO

  std::size_t bytes() const noexcept { return is_text ? text.size() : (bits + 7) / 8; }
};

/// Entries by index and sub-index.
class ObjectDictionary {
 public:
  /// Adds an entry, or replaces the one that was there.
  void add(std::uint16_t index, std::uint8_t sub, const DictionaryEntry& entry) { entries_[key(index, sub)] = entry; }
  void add_number(std::uint16_t index, std::uint8_t sub, unsigned bits, std::uint32_t value, bool can_write,
                  const std::string& name = {}) {
    add(index, sub, {.bits = bits, .value = value, .can_write = can_write, .name = name});
  }
  void add_text(std::uint16_t index, const std::string& text, const std::string& name = {}) {
    add(index, 0, {.can_write = false, .is_text = true, .text = text, .name = name});
  }
  /// Of an object with sub-indices; the others have the name of their one entry.
  void name_object(std::uint16_t index, const std::string& name) { names_[index] = name; }
  std::string object_name(std::uint16_t index) const {
    const auto found = names_.find(index);
    return found == names_.end() ? std::string() : found->second;
  }
  DictionaryEntry* find(std::uint16_t index, std::uint8_t sub) noexcept {
    const auto found = entries_.find(key(index, sub));
    return found == entries_.end() ? nullptr : &found->second;
  }
  const DictionaryEntry* find(std::uint16_t index, std::uint8_t sub) const noexcept {
    return const_cast<ObjectDictionary*>(this)->find(index, sub);
  }
  bool has_index(std::uint16_t index) const noexcept {
    const auto found = entries_.lower_bound(key(index, 0));
    return found != entries_.end() && found->first >> 8 == index;
  }
  /// The number of an entry, 0 where there is none.
  std::uint32_t number(std::uint16_t index, std::uint8_t sub) const noexcept {
    const DictionaryEntry* entry = find(index, sub);
    return entry == nullptr ? 0 : entry->value;
  }
  void set_number(std::uint16_t index, std::uint8_t sub, std::uint32_t value) noexcept {
    if (DictionaryEntry* entry = find(index, sub)) entry->value = value;
  }
  /// Calls visit(index, sub, entry) in the order of the keys.
  template <class Visit> void each(Visit&& visit) const {
    for (const auto& [k, entry] : entries_)
      visit(static_cast<std::uint16_t>(k >> 8), static_cast<std::uint8_t>(k), entry);
  }

 private:
  static constexpr std::uint32_t key(std::uint16_t index, std::uint8_t sub) noexcept {
    return static_cast<std::uint32_t>(index) << 8 | sub;
  }
  std::map<std::uint32_t, DictionaryEntry> entries_;
  std::map<std::uint16_t, std::string> names_;
};

}  // namespace pneuservo
