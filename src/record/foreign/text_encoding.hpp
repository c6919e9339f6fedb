// Text that is not UTF-8: in which encoding it is, and what it says in UTF-8.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace pneuservo {

/// What the bytes of a text that is not UTF-8 are taken for.
struct TextEncoding {
  std::string_view name;   ///< as people call it: "Shift-JIS"; empty: the text is UTF-8 or plain
  std::string_view iconv;  ///< as iconv calls it
  bool is_sure = true;     ///< false: another would do nearly as well
};

/// By words of column names that the text holds in it, then by how likely its characters are. Text without a byte
/// beyond ASCII, or most of whose others are valid in UTF-8, has none.
TextEncoding encoding_of(std::string_view text);

/// Converts a text in parts of any length. What is no character becomes "?".
class TextConverter {
 public:
  explicit TextConverter(std::string_view iconv_name);
  ~TextConverter();
  TextConverter(const TextConverter&) = delete;
  TextConverter& operator=(const TextConverter&) = delete;

  void append(std::string_view bytes, std::string& out);
  /// Where characters were none: how many.
  std::size_t errors() const { return errors_; }

 private:
  std::size_t unit_bytes_;  ///< of the smallest part of a character
  void* converter_;
  std::string begun_;  ///< of a character whose end is still to come
  std::size_t errors_ = 0;
};

}  // namespace pneuservo
