// Lines of a text file, plain or gzip, whole or damaged.
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "record/foreign/text_encoding.hpp"

namespace pneuservo {

/// Hands out lines as long as they are whole, and then says how the file ended.
class TextInput {
 public:
  enum class End {
    whole,
    truncated,  ///< the file stops in the middle of a line or of the gzip stream
    damaged,    ///< the gzip data are wrong from some point on (or their check sum is)
  };

  /// Throws InputError: no such file, cannot be read, named .gz but not gzip, empty.
  explicit TextInput(std::string path);
  ~TextInput();
  TextInput(const TextInput&) = delete;
  TextInput& operator=(const TextInput&) = delete;

  /// Next whole line without its LF (and CR); false at the end. The text is valid until the next call.
  bool next_line(std::string_view& line);
  /// Number of the last line handed out, from 1.
  std::size_t line_number() const { return line_number_; }
  /// In words, where the text is not UTF-8: "UTF-16", "text in Shift-JIS". It is handed out as UTF-8.
  std::string encoding() const;
  /// After the last line.
  End end() const { return end_; }
  /// After the last line: what stands behind it without an end of a line, in a file that is not packed.
  std::string_view unended() const {
    return end_ == End::truncated && !gzip_ ? std::string_view(text_).substr(start_) : std::string_view();
  }
  const std::string& path() const { return path_; }

 private:
  struct Stream;
  void fill();
  void inflate_chunk(std::size_t count);
  std::size_t read_chunk(std::size_t from);
  void append(const char* bytes, std::size_t count);
  void end_lines_at_cr();

  std::string path_;
  std::unique_ptr<Stream> stream_;
  int descriptor_ = -1;
  bool gzip_ = false, at_end_ = false, first_ = true;
  bool has_text_ = false;
  TextEncoding encoding_;
  std::unique_ptr<TextConverter> converter_;  ///< none: the text is UTF-8
  std::string text_;
  std::string plain_;  ///< the line that is handed out, where signs of a terminal were left out
  std::size_t start_ = 0, searched_ = 0, judged_ = 0, line_number_ = 0;
  End end_ = End::whole;
};

}  // namespace pneuservo
