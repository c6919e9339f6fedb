// EDS and DCF files: what a device's dictionary has, and the values that a DCF wants in it.
#include "can/eds.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>

#include "config/input_error.hpp"

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
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

/// 25, 0x19, 031 (octal, as CiA 306 has it), -1.
std::optional<std::uint32_t> number_of(const std::string& text) {
  if (text.starts_with("0x") || text.starts_with("0X"))
    return whole<std::uint32_t>(std::string_view(text).substr(2), 16);
  if (text.starts_with("-"))
    if (const auto negative = whole<std::int32_t>(text, 10)) return static_cast<std::uint32_t>(*negative);
  if (text.size() > 1 && text.front() == '0') return whole<std::uint32_t>(text, 8);
  return whole<std::uint32_t>(text, 10);
}

/// Index and sub-index of a section "[1A00sub1]"; empty for the others.
std::optional<EdsObject> object_of_section(const std::string& section) {
  const std::size_t sub = section.find("sub");
  const std::string first = section.substr(0, sub);
  const auto index = first.size() == 4 ? whole<std::uint16_t>(first, 16) : std::nullopt;
  if (!index) return {};
  EdsObject object;
  object.index = *index;
  if (sub != std::string::npos) {
    const auto number = whole<std::uint8_t>(section.substr(sub + 3), 16);
    if (!number) return {};
    object.sub = *number;
  }
  return object;
}

[[noreturn]] void refuse_line(const std::string& source, int line, const std::string& what) {
  throw InputError(fmt::format("{}:{}: {}", source, line, what));
}

std::optional<std::uint32_t> value_of(const std::string& text, EdsObject& object, const std::string& source, int line) {
  std::string rest = lowered(text);
  if (rest.empty()) return {};
  if (const std::size_t at = rest.find("$nodeid"); at != std::string::npos) {
    object.adds_node = true;
    rest.erase(at, 7);
    std::erase_if(rest, [](char c) { return c == '+' || c == ' '; });
    if (rest.empty()) return 0;
  }
  const auto number = number_of(rest);
  // Texts and floating-point defaults are of no use here; a wrong number where one must be is an error.
  if (!number && object.bits() > 0 && object.data_type < 0x0008)
    refuse_line(source, line, fmt::format("found '{}', expected a number such as 0x1A or $NODEID+0x180", text));
  return number;
}

void read_key(EdsObject& object, const std::string& key, const std::string& value, const std::string& source,
              int line) {
  if (key == "parametername") object.name = value;
  else if (key == "datatype") {
    const auto type = number_of(value);
    if (!type || *type > 0xFFFF)
      refuse_line(source, line, fmt::format("DataType: found '{}', expected 0x0007 or alike", value));
    object.data_type = static_cast<std::uint16_t>(*type);
  } else if (key == "pdomapping") object.can_map = value == "1" || lowered(value) == "0x1";
  else if (key == "accesstype") object.can_write = lowered(value).find('w') != std::string::npos;
  else if (key == "defaultvalue") object.standard = value_of(value, object, source, line);
  else if (key == "parametervalue") object.configured = value_of(value, object, source, line);
}

bool before(const EdsObject& a, const EdsObject& b) { return a.index != b.index ? a.index < b.index : a.sub < b.sub; }

}  // namespace

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

EdsFile EdsFile::read(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string() + ": cannot be read; expected an EDS or DCF file");
  return parse(std::string{std::istreambuf_iterator<char>(stream), {}}, file.string());
}

EdsFile EdsFile::parse(const std::string& text, const std::string& source_name) {
  EdsFile out;
  out.source_ = source_name;
  std::istringstream lines(text);
  std::optional<EdsObject> object;
  std::vector<std::pair<std::string, int>> keys;  // of the section, with their lines: DataType may stand after a value
  std::vector<std::string> values;
  const auto finish = [&] {
    if (!object) return;
    for (const bool types : {true, false})
      for (std::size_t i = 0; i < keys.size(); ++i)
        if ((keys[i].first == "datatype") == types)
          read_key(*object, keys[i].first, values[i], source_name, keys[i].second);
    out.objects_.push_back(*object);
  };
  int line_number = 0, sections = 0;
  for (std::string line; std::getline(lines, line);) {
    ++line_number;
    const std::string content = trimmed(line);
    if (content.empty() || content.front() == ';' || content.front() == '#') continue;
    if (content.front() == '[') {
      if (content.back() != ']') refuse_line(source_name, line_number, "found '[' without ']', expected a section");
      finish();
      keys.clear();
      values.clear();
      object = object_of_section(lowered(content.substr(1, content.size() - 2)));
      if (object) object->line = line_number;
      ++sections;
      continue;
    }
    const std::size_t equals = content.find('=');
    if (equals == std::string::npos || sections == 0)
      refuse_line(source_name, line_number, "found text outside the form, expected [section] or Key=Value");
    keys.emplace_back(lowered(trimmed(content.substr(0, equals))), line_number);
    values.push_back(trimmed(content.substr(equals + 1)));
  }
  finish();
  if (out.objects_.empty()) refuse_line(source_name, 1, "found no objects, expected sections such as [1000]");
  std::stable_sort(out.objects_.begin(), out.objects_.end(), before);
  return out;
}

const EdsObject* EdsFile::find(std::uint16_t index, std::uint8_t sub) const noexcept {
  const auto found = std::find_if(objects_.begin(), objects_.end(),
                                  [&](const EdsObject& o) { return o.index == index && o.sub == sub; });
  return found == objects_.end() ? nullptr : &*found;
}

std::vector<EdsObject> EdsFile::configured() const {
  std::vector<EdsObject> out;
  for (const EdsObject& o : objects_) {
    const bool of_pdo = o.index >= 0x1400 && o.index < 0x1C00;
    if (o.configured && o.can_write && !of_pdo && o.bits() > 0 && o.bits() <= 32) out.push_back(o);
  }
  return out;
}

}  // namespace pneuservo
