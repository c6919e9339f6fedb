// Text that is not UTF-8.
#include "record/foreign/text_encoding.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <iconv.h>
#include <limits>
#include <system_error>
#include <utility>
#include <vector>

#include "record/foreign/column_words.hpp"
#include "record/foreign/field_text.hpp"

namespace pneuservo {

namespace {

using Byte = unsigned char;

/// Of a character among those in common use, and of any other one.
constexpr double common_share = 0.95, rare_share = 0.05;
constexpr double row_size = 94;        ///< characters of a row of the double-byte sets
constexpr double row_size_of_big5 = 157;
constexpr double letters_of_ascii = 64;
constexpr double rare_characters = 8000;
/// Log of how much more likely one encoding must be for the other to be ruled out: 20 to 1.
const double surely = std::log(20.0);

bool is_letter(Byte c) { return std::isalpha(c) != 0; }

/// Characters of two bytes: rows of those in common use as their standards set them apart, by the first byte.
struct DoubleByte {
  std::string_view name, iconv;
  double prior;  ///< share of the files that are so
  Byte first_common, last_common;  ///< rows of the syllables or of the ideographs of level 1
  Byte first_kana, last_kana;      ///< rows of signs and kana
};
constexpr std::array<DoubleByte, 5> double_bytes{{{"Shift-JIS", "CP932", 0.1, 0x88, 0x97, 0x81, 0x83},
                                                  {"GBK", "GB18030", 0.1, 0xb0, 0xd7, 0xa1, 0xa3},
                                                  {"EUC-KR", "CP949", 0.05, 0xb0, 0xc8, 0xa1, 0xa3},
                                                  {"EUC-JP", "EUC-JP", 0.01, 0xb0, 0xcf, 0xa1, 0xa5},
                                                  {"Big5", "BIG5", 0.01, 0xa4, 0xc6, 0xa1, 0xa3}}};

/// Log likelihood of a text whose characters are all valid, each alike among those in common use.
double likelihood(const DoubleByte& set, std::string_view text) {
  const double size = set.first_common == 0xa4 ? row_size_of_big5 : row_size;
  const double common = size * (set.last_common - set.first_common + 1 + set.last_kana - set.first_kana + 1);
  double sum = std::log(set.prior);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto lead = static_cast<Byte>(text[i]);
    if (lead < 0x80) {
      sum -= std::log(letters_of_ascii);
      continue;
    }
    const bool is_single = set.first_kana == 0x81 && lead >= 0xa1 && lead <= 0xdf;  // a kana of half width
    if (i + 1 >= text.size() && !is_single) break;
    const Byte trail = is_single ? Byte{0} : static_cast<Byte>(text[i + 1]);
    const bool is_within =
        (lead >= set.first_common && lead <= set.last_common) || (lead >= set.first_kana && lead <= set.last_kana);
    const bool is_common =
        !is_single && is_within && (set.first_kana == 0x81 || set.first_common == 0xa4 || trail >= 0xa1);
    sum += is_common ? std::log(common_share / common) : std::log(rare_share / rare_characters);
    i += is_single ? 0 : 1;
  }
  return sum;
}

/// Letters of one byte beyond ASCII: those of another script make words of their own, Latin ones stand among ASCII.
enum class Script { latin, cyrillic, greek };
struct SingleByte {
  std::string_view name, iconv;
  Script script;
  double prior;  ///< share of the files that are so
};
constexpr std::array<SingleByte, 6> single_bytes{{{"Windows-1252 (Latin-1)", "CP1252", Script::latin, 0.6},
                                                  {"Windows-1250", "CP1250", Script::latin, 0.03},
                                                  {"IBM850", "CP850", Script::latin, 0.02},
                                                  {"Windows-1251", "CP1251", Script::cyrillic, 0.06},
                                                  {"KOI8-R", "KOI8-R", Script::cyrillic, 0.02},
                                                  {"Windows-1253", "CP1253", Script::greek, 0.01}}};

struct Character {
  unsigned code;
  bool is_ascii() const { return code < 0x80; }
};

std::vector<Character> characters_of(std::string_view utf8) {
  std::vector<Character> out;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto lead = static_cast<Byte>(utf8[i]);
    const std::size_t size = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
    unsigned code = size == 1 ? lead : lead & (0xffu >> (size + 1));
    for (std::size_t k = 1; k < size && i + k < utf8.size(); ++k)
      code = code << 6 | (static_cast<Byte>(utf8[i + k]) & 0x3fu);
    out.push_back({code});
    i += size;
  }
  return out;
}

bool is_latin_letter(unsigned code) { return (code >= 0xc0 && code < 0x180 && code != 0xd7 && code != 0xf7); }
bool is_capital(unsigned code, Script script) {
  if (script == Script::greek) return (code >= 0x391 && code <= 0x3a9) || (code >= 0x386 && code <= 0x38f);
  return code >= 0x410 && code <= 0x42f;
}
bool is_small(unsigned code, Script script) {
  if (script == Script::greek) return (code >= 0x3b1 && code <= 0x3ce) || (code >= 0x3ac && code <= 0x3af);
  return (code >= 0x430 && code <= 0x44f) || code == 0x451;
}

/// Signs of units and of text: degree, micro, square, cube, plus-minus, middle dot, no-break space, sections, delta.
bool is_sign(unsigned code) {
  constexpr std::array<unsigned, 13> signs{0xb0, 0xb5, 0xb2,   0xb3,   0xb1,   0xb7,  0xa0,
                                           0xa7, 0xd8, 0x2116, 0x2126, 0x2013, 0x2030};
  return std::find(signs.begin(), signs.end(), code) != signs.end();
}

double likelihood(const SingleByte& set, std::string_view utf8) {
  // In each of the languages about ten letters, small or large, and five signs of units make nearly all.
  constexpr double latin_letters = 20, letters_of_script = 33, signs = 5;
  const std::vector<Character> text = characters_of(utf8);
  double sum = std::log(set.prior);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const unsigned code = text[i].code, before = i > 0 ? text[i - 1].code : ' ';
    const unsigned behind = i + 1 < text.size() ? text[i + 1].code : ' ';
    const auto is_plain = [](unsigned c) { return c < 0x80 && is_letter(static_cast<Byte>(c)); };
    bool is_common = false;
    double kinds = latin_letters;
    if (code < 0x80) {
      sum -= std::log(letters_of_ascii);
      continue;
    }
    if (is_sign(code)) {
      is_common = !is_plain(before);
      kinds = signs;
    } else if (set.script == Script::latin) {
      is_common = is_latin_letter(code) && (is_plain(before) || is_plain(behind));
    } else {
      kinds = letters_of_script;
      const bool is_in_word = !is_plain(before) && !is_plain(behind);
      is_common =
          is_in_word && (is_capital(code, set.script) ? !is_small(before, set.script) : is_small(code, set.script));
    }
    sum += is_common ? std::log(common_share / kinds) : std::log(rare_share / 128);
  }
  return sum;
}

/// Words of column names, with letters beyond ASCII, that the text holds.
std::size_t known_words(std::string_view utf8) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto is_part = [&](std::size_t at) {
      return static_cast<Byte>(utf8[at]) >= 0x80 || is_letter(static_cast<Byte>(utf8[at]));
    };
    std::size_t end = i;
    bool is_beyond = false;
    for (; end < utf8.size() && is_part(end); ++end) is_beyond = is_beyond || static_cast<Byte>(utf8[end]) >= 0x80;
    if (is_beyond) count += holds_known_word(utf8.substr(i, end - i));
    i = end + 1;
  }
  return count;
}

/// What the text is in one encoding; errors: of characters that are none.
std::string converted(std::string_view iconv, std::string_view text, std::size_t& errors) {
  TextConverter converter(iconv);
  std::string out;
  converter.append(text, out);
  errors = converter.errors();
  return out;
}

struct Candidate {
  std::string_view name, iconv;
  std::string utf8;
  std::size_t words;
  double likelihood;
};

/// A first byte of UTF-8 with further ones, but not all.
bool is_cut_character(std::string_view text) {
  constexpr std::size_t longest = 4;
  return text.size() < longest && static_cast<Byte>(text.front()) >= 0xc2 &&
         std::all_of(text.begin() + 1, text.end(), [](char c) { return (static_cast<Byte>(c) & 0xc0) == 0x80; });
}

/// Whether most characters beyond ASCII are valid in UTF-8: some lines of it are written otherwise.
bool is_mostly_utf8(std::string_view text) {
  std::size_t valid = 0, wrong = 0;
  while (!text.empty()) {
    const std::size_t size = utf8_size(text);
    if (size == 0 && is_cut_character(text)) break;
    valid += size > 1, wrong += size == 0;
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return valid >= wrong;
}

/// Lines with a byte beyond ASCII, up to so many.
std::string telling_lines(std::string_view text) {
  constexpr std::size_t most_bytes = 1 << 14;
  std::string out;
  while (!text.empty() && out.size() < most_bytes) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (std::any_of(line.begin(), line.end(), [](char c) { return static_cast<Byte>(c) >= 0x80; }))
      (out += line) += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

}  // namespace

TextEncoding encoding_of(std::string_view text) {
  if (is_mostly_utf8(text)) return {};
  const std::string telling = telling_lines(text);
  std::vector<Candidate> found;
  std::size_t errors = 0;
  for (const DoubleByte& set : double_bytes) {
    std::string utf8 = converted(set.iconv, telling, errors);
    const std::size_t words = known_words(utf8);
    if (errors == 0) found.push_back({set.name, set.iconv, std::move(utf8), words, likelihood(set, telling)});
  }
  for (const SingleByte& set : single_bytes) {
    std::string utf8 = converted(set.iconv, telling, errors);
    const double likely = likelihood(set, utf8);
    const std::size_t words = known_words(utf8);
    if (errors == 0) found.push_back({set.name, set.iconv, std::move(utf8), words, likely});
  }
  if (found.empty()) return {"Latin-1", "ISO-8859-1", false};
  std::stable_sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    return a.words != b.words ? a.words > b.words : a.likelihood > b.likelihood;
  });
  // An encoding that reads the same is no rival.
  const bool is_sure = std::all_of(found.begin() + 1, found.end(), [&](const Candidate& rival) {
    return rival.utf8 == found[0].utf8 || rival.words < found[0].words ||
           found[0].likelihood - rival.likelihood > surely;
  });
  return {found[0].name, found[0].iconv, is_sure};
}

TextConverter::TextConverter(std::string_view iconv_name)
    : unit_bytes_(iconv_name.starts_with("UTF-16") ? 2 : 1),
      converter_(iconv_open("UTF-8", std::string(iconv_name).c_str())) {
  if (converter_ == reinterpret_cast<void*>(-1))  // a system without its tables
    converter_ = iconv_open("UTF-8", "ISO-8859-1");
  if (converter_ == reinterpret_cast<void*>(-1)) throw std::system_error(errno, std::generic_category(), "iconv");
}

TextConverter::~TextConverter() { iconv_close(converter_); }

void TextConverter::append(std::string_view bytes, std::string& out) {
  begun_ += bytes;
  char* from = begun_.data();
  std::size_t left = begun_.size();
  std::array<char, 1 << 12> part;
  while (left > 0) {
    char* to = part.data();
    std::size_t room = part.size();
    const std::size_t result = iconv(converter_, &from, &left, &to, &room);
    const int reason = result == static_cast<std::size_t>(-1) ? errno : 0;
    out.append(part.data(), part.size() - room);
    if (reason == EINVAL) break;  // a character that goes on in the next part
    if (reason != EILSEQ) continue;
    out += '?';
    ++errors_;
    const std::size_t skipped = std::min(unit_bytes_, left);
    from += skipped, left -= skipped;
  }
  begun_.erase(0, begun_.size() - left);
}

}  // namespace pneuservo
