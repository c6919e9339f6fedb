// EDS and DCF files: what a device's dictionary has, and the values that a DCF wants in it.
#include "can/eds.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <sstream>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/input_text.hpp"

namespace pneuservo {
namespace {

std::string trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
  return text;
}

template <class T> std::optional<T> whole(std::string_view text, int base) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

/// A number as files have it: 25, 0x19, 19h, 031 (octal, as CiA 306 has it), 08, TRUE, -1, -0x80.
struct Whole {
  std::uint64_t magnitude = 0;
  bool negative = false;
};
std::optional<Whole> whole_of(std::string_view text) {
  if (text == "true") return Whole{1};
  if (text == "false") return Whole{0};
  Whole out;
  if (text.starts_with("-") || text.starts_with("+")) {
    out.negative = text.front() == '-';
    text.remove_prefix(1);
  }
  std::optional<std::uint64_t> value;
  if (text.starts_with("0x")) value = whole<std::uint64_t>(text.substr(2), 16);
  else if (text.ends_with("h")) value = whole<std::uint64_t>(text.substr(0, text.size() - 1), 16);
  else if (text.size() > 1 && text.front() == '0') value = whole<std::uint64_t>(text, 8);
  if (!value) value = whole<std::uint64_t>(text, 10);
  if (!value) return {};
  out.magnitude = *value;
  return out;
}

/// A number of a key that is no value of an object; 0: none stands there.
std::uint32_t number_of(const std::string& text) {
  const auto number = whole_of(lowered(text));
  return number && !number->negative && number->magnitude <= 0xFFFFFFFFu ? static_cast<std::uint32_t>(number->magnitude)
                                                                         : 0;
}

std::vector<std::uint8_t> little_endian(std::uint64_t value, unsigned bits) {
  std::vector<std::uint8_t> bytes((bits + 7) / 8);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  return bytes;
}

constexpr std::uint16_t real32 = 0x0008, visible_string = 0x0009, octet_string = 0x000A, real64 = 0x0011;

/// Takes "$NODEID" and the plus beside it away; how much it adds.
std::uint64_t take_node(std::string& text, std::uint8_t node) {
  const std::size_t at = text.find("$nodeid");
  if (at == std::string::npos) return 0;
  text.erase(at, 7);
  std::erase_if(text, [](char c) { return c == '+' || c == ' '; });
  if (text.empty()) text = "0";
  return node;
}

EdsBytes real_bytes(const EdsObject& object, const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size())
    return {{}, fmt::format("found '{}', expected a number such as 1.5", text)};
  return {object.data_type == real32 ? little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 32)
                                     : little_endian(std::bit_cast<std::uint64_t>(value), 64),
          ""};
}

EdsBytes whole_bytes(const EdsObject& object, std::string text, std::uint8_t node) {
  const std::uint64_t added = take_node(text, node);
  const auto number = whole_of(text);
  if (!number) return {{}, fmt::format("found '{}', expected a number such as 0x1A or $NODEID+0x180", text)};
  const std::uint64_t magnitude = number->magnitude + added;
  const unsigned bits = object.bits();
  const std::uint64_t most = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  // A signed object's value may stand as its bits, 0xFF80.
  const std::uint64_t lowest = std::uint64_t{1} << (bits - 1);
  if (number->negative ? !object.is_signed() || magnitude > lowest : magnitude > most)
    return {{}, fmt::format("found {}, which does not fit its type of {} bits", text, bits)};
  return {little_endian(number->negative ? ~magnitude + 1 : magnitude, bits), ""};
}

EdsBytes octet_bytes(const std::string& text) {
  std::string digits = lowered(text);
  std::erase_if(digits, [](char c) { return c == ' '; });
  EdsBytes out;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const auto byte = whole<std::uint8_t>(digits.substr(i, 2), 16);
    if (!byte) return {{}, fmt::format("found '{}', expected bytes such as 01 A0", text)};
    out.bytes.push_back(*byte);
  }
  return out;
}

/// Index and sub-index of a section "[1A00sub1]", and what it is.
enum class Kind { object, values, names };
struct ObjectSection {
  Kind kind = Kind::object;
  EdsObject object;
};
std::optional<ObjectSection> object_of_section(const std::string& section) {
  const auto index = section.size() >= 4 ? whole<std::uint16_t>(section.substr(0, 4), 16) : std::nullopt;
  if (!index) return {};
  ObjectSection out;
  out.object.index = *index;
  const std::string rest = section.substr(4);
  if (rest == "value") out.kind = Kind::values;
  else if (rest == "name") out.kind = Kind::names;
  else if (rest.starts_with("sub")) {
    const auto number = whole<std::uint8_t>(rest.substr(3), 16);
    if (!number) return {};
    out.object.sub = *number;
  } else if (!rest.empty()) return {};
  return out;
}

[[noreturn]] void refuse_line(const std::string& source, int line, const std::string& what) {
  throw InputError(fmt::format("{}:{}: {}", source, line, what));
}

bool before(const EdsObject& a, const EdsObject& b) { return a.index != b.index ? a.index < b.index : a.sub < b.sub; }

/// A text may hold a semicolon, a number may not: what follows it is a comment.
std::string without_comment(const std::string& value) { return trimmed(value.substr(0, value.find(';'))); }

}  // namespace

EdsBytes eds_bytes(const EdsObject& object, std::string_view text, std::uint8_t node) {
  if (object.data_type == visible_string) return {{text.begin(), text.end()}, ""};
  if (object.data_type == octet_string) return octet_bytes(std::string(text));
  if (object.data_type == real32 || object.data_type == real64) return real_bytes(object, lowered(std::string(text)));
  if (object.bits() == 0) return {{}, fmt::format("is of data type 0x{:04x}, which is not written", object.data_type)};
  return whole_bytes(object, lowered(std::string(text)), node);
}

unsigned EdsObject::bits() const noexcept {
  switch (data_type) {
    case 0x0001: return 1;
    case 0x0002:
    case 0x0005: return 8;
    case 0x0003:
    case 0x0006: return 16;
    case 0x0010:
    case 0x0016: return 24;
    case 0x0004:
    case 0x0007:
    case 0x0008: return 32;
    case 0x0011:
    case 0x0015:
    case 0x001B: return 64;
    default: return 0;
  }
}

bool EdsObject::is_signed() const noexcept {
  return (data_type >= 0x0002 && data_type <= 0x0004) || data_type == 0x0010 || data_type == 0x0015;
}

/// A section with its keys in lower case.
struct EdsFile::Section {
  struct Key {
    std::string name, value;
    int line = 0;
  };
  std::string name;
  int line = 0;
  std::vector<Key> keys;

  std::string text(std::string_view key) const {
    const auto found = std::ranges::find(keys, key, &Key::name);
    return found == keys.end() ? std::string() : found->value;
  }
  std::string plain(std::string_view key) const { return without_comment(text(key)); }
  std::uint32_t number(std::string_view key) const { return number_of(plain(key)); }
};

EdsFile EdsFile::read(const std::filesystem::path& file) {
  return parse(read_input_text(file, "an EDS or DCF file"), file.string());
}

EdsFile EdsFile::parse(const std::string& text, const std::string& source_name) {
  EdsFile out;
  out.source_ = source_name;
  std::istringstream lines(text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text);
  std::vector<Section> sections;
  int line_number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++line_number;
    const std::string content = trimmed(line);
    if (content.empty() || content.front() == ';' || content.front() == '#') continue;
    if (content.front() == '<' && sections.empty())
      refuse_line(source_name, line_number, "found XML, an XDD or XDC file, expected the device's EDS or DCF file");
    if (content.front() == '[') {
      const std::size_t end = content.find(']');
      if (end == std::string::npos) refuse_line(source_name, line_number, "found '[' without ']', expected a section");
      sections.push_back({lowered(trimmed(content.substr(1, end - 1))), line_number, {}});
      continue;
    }
    // Text without a key, or before the first section, says nothing that is asked for here.
    const std::size_t equals = content.find('=');
    if (equals != std::string::npos && !sections.empty())
      sections.back().keys.push_back(
          {lowered(trimmed(content.substr(0, equals))), trimmed(content.substr(equals + 1)), line_number});
  }
  for (const Section& section : sections) out.take(section);
  for (const Section& section : sections) out.take_list(section);
  if (out.objects_.empty()) refuse_line(source_name, 1, "found no objects, expected sections such as [1000]");
  return out;
}

void EdsFile::take(const Section& section) {
  if (section.name == "deviceinfo") {
    vendor = section.number("vendornumber");
    product = section.number("productnumber");
  } else if (section.name == "devicecomissioning" || section.name == "devicecommissioning") {
    node = section.number("nodeid");
  } else if (section.name.find("subext") != std::string::npos ||
             section.name.find("fixedobjects") != std::string::npos) {
    describes_modules = true;
  } else if (const auto object = object_of_section(section.name); object && object->kind == Kind::object) {
    take_object(section, object->object);
  }
}

void EdsFile::take_object(const Section& section, EdsObject object) {
  object.line = section.line;
  object.name = section.text("parametername");
  object.data_type = static_cast<std::uint16_t>(section.number("datatype"));
  object.can_map = section.number("pdomapping") == 1;
  const std::string access = lowered(section.plain("accesstype"));
  object.can_write = access.find('w') != std::string::npos;
  object.can_read = access != "wo";
  const bool is_text = object.data_type == visible_string;
  object.standard = is_text ? section.text("defaultvalue") : section.plain("defaultvalue");
  object.configured = is_text ? section.text("parametervalue") : section.plain("parametervalue");
  if (section.number("compactsubobj") > 0) return take_compact(section, object);
  // What stands twice: the last one is the file's word.
  const auto at = std::lower_bound(objects_.begin(), objects_.end(), object, before);
  if (at != objects_.end() && at->index == object.index && at->sub == object.sub) *at = object;
  else objects_.insert(at, object);
}

// An array in one section: sub-index 0 counts, the others are alike.
void EdsFile::take_compact(const Section& section, const EdsObject& array) {
  const std::uint32_t count = std::min<std::uint32_t>(section.number("compactsubobj"), 254);
  for (std::uint32_t sub = 0; sub <= count; ++sub) {
    EdsObject one = array;
    one.sub = static_cast<std::uint8_t>(sub);
    if (sub == 0) {
      one.data_type = 0x0005;
      one.can_map = one.can_write = false;
      one.can_read = true;
      one.standard = fmt::format("{}", count);
      one.configured.clear();
    }
    const auto at = std::lower_bound(objects_.begin(), objects_.end(), one, before);
    if (at == objects_.end() || at->index != one.index || at->sub != one.sub) objects_.insert(at, one);
  }
}

// [6444Value] and [6444Name]: "3=0x10" is of sub-index 3.
void EdsFile::take_list(const Section& section) {
  const auto list = object_of_section(section.name);
  if (!list || list->kind == Kind::object) return;
  for (const Section::Key& key : section.keys) {
    const auto sub = whole_of(key.name);
    if (!sub || sub->negative || sub->magnitude > 254) continue;
    const auto at = std::ranges::find_if(
        objects_, [&](const EdsObject& o) { return o.index == list->object.index && o.sub == sub->magnitude; });
    if (at == objects_.end()) continue;
    if (list->kind == Kind::names) at->name = key.value;
    else at->configured = at->data_type == visible_string ? key.value : without_comment(key.value);
  }
}

const EdsObject* EdsFile::find(std::uint16_t index, std::uint8_t sub) const noexcept {
  const auto found = std::find_if(objects_.begin(), objects_.end(),
                                  [&](const EdsObject& o) { return o.index == index && o.sub == sub; });
  return found == objects_.end() ? nullptr : &*found;
}

std::string EdsFile::why_left_out(const EdsObject& object, std::uint8_t number) const {
  if (object.index == 0x1010 || object.index == 0x1011) return "stores or restores, which happens on purpose alone";
  if (!object.can_write) {
    // The file states what the device holds anyhow.
    return object.configured == object.standard ? "" : "can only be read";
  }
  return eds_bytes(object, object.configured, number).why;
}

namespace {
/// Objects of PDOs follow from the config.
bool is_asked(const EdsObject& o) { return !o.configured.empty() && !(o.index >= 0x1400 && o.index < 0x1C00); }
}  // namespace

std::vector<EdsObject> EdsFile::configured(std::uint8_t number) const {
  std::vector<EdsObject> out;
  for (const EdsObject& o : objects_)
    if (is_asked(o) && o.can_write && why_left_out(o, number).empty()) out.push_back(o);
  return out;
}

std::vector<LeftOutValue> EdsFile::left_out(std::uint8_t number) const {
  std::vector<LeftOutValue> out;
  for (const EdsObject& o : objects_)
    if (is_asked(o))
      if (const std::string why = why_left_out(o, number); !why.empty()) out.push_back({o.index, o.sub, why});
  return out;
}

}  // namespace pneuservo
