// Lines of a text file, plain or gzip, whole or damaged.
#include "record/text_input.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <string_view>
#include <unistd.h>
#include <zlib.h>

#include <fmt/format.h>

#include "config/input_error.hpp"

using namespace std::string_view_literals;

namespace pneuservo {

namespace {

struct Format {
  std::string_view begins, name, remedy;
};

constexpr std::size_t longest_line_bytes = 1 << 26;  // a million columns; a device that never ends has no line

constexpr std::string_view as_csv = "write it as CSV";
constexpr std::string_view by_export =
    "write it as CSV, with the Python package: python -m pneuservo.export FILE --csv";
constexpr std::string_view unpack = "unpack it first";
/// Files that are no text, by how they begin.
constexpr std::array<Format, 38> formats{{{"PK\3\4", "a zip archive, as .xlsx, .ods and .npz files are", as_csv},
                                          {"\xd0\xcf\x11\xe0", "an Excel workbook (.xls)", as_csv},
                                          {"TDSm", "a LabVIEW TDMS file", as_csv},
                                          {"MDF     ", "an ASAM MDF file", as_csv},
                                          {"\x89HDF", "an HDF5 file, as MATLAB's .mat files of v7.3 are", as_csv},
                                          {"MATLAB 5.0 MAT-file", "a MATLAB .mat file", by_export},
                                          {"PAR1", "a Parquet file", by_export},
                                          {"ARROW1", "an Arrow (Feather) file", as_csv},
                                          {"\x93NUMPY", "a numpy .npy file", as_csv},
                                          {"\x80\4\x95", "a Python pickle", as_csv},
                                          {"SQLite format 3", "an SQLite database", as_csv},
                                          {"#ROSBAG", "a ROS bag", as_csv},
                                          {"\x89MCAP", "an MCAP file", by_export},
                                          {"RIFF", "a RIFF file, as .wav files are", as_csv},
                                          {"%PDF", "a PDF document", as_csv},
                                          {"{\\rtf", "an RTF document", as_csv},
                                          {"\x89PNG", "a picture (PNG)", as_csv},
                                          {"\x7f"
                                           "ELF",
                                           "a program (ELF)", as_csv},
                                          {"<?xml", "an XML document", as_csv},
                                          {"<html", "an HTML page", as_csv},
                                          {"<HTML", "an HTML page", as_csv},
                                          {"<!DOCTYPE", "an HTML page", as_csv},
                                          {"<!doctype", "an HTML page", as_csv},
                                          {"<table", "an HTML page", as_csv},
                                          {"{", "JSON", as_csv},
                                          {"[{", "JSON", as_csv},
                                          {"[[", "JSON", as_csv},
                                          {"[\"", "JSON", as_csv},
                                          {"[\n", "JSON", as_csv},
                                          {"\xff\xfe\0\0"sv, "text in UTF-32", "write it in UTF-8"},
                                          {"\0\0\xfe\xff"sv, "text in UTF-32", "write it in UTF-8"},
                                          {"\x28\xb5\x2f\xfd", "packed by zstd", unpack},
                                          {"BZh", "packed by bzip2", unpack},
                                          {"\xfd"
                                           "7zXZ",
                                           "packed by xz", unpack},
                                          {"7z\xbc\xaf", "a 7z archive", unpack},
                                          {"Rar!", "a RAR archive", unpack},
                                          {"\x04\x22\x4d\x18", "packed by lz4", unpack},
                                          {"\x1f\x9d", "packed by compress", unpack}}};

/// Lines that are an object of JSON each, which name their values, also those of a list with brackets around it.
bool holds_objects_a_line(std::string_view start) {
  std::size_t whole = 0, lines = 0;
  while (lines < 3) {
    const std::size_t end = start.find('\n');
    if (end == std::string_view::npos) break;
    std::string_view line = start.substr(0, end);
    start.remove_prefix(end + 1);
    if (lines++ == 0 && line.starts_with('[')) line.remove_prefix(1);
    const std::size_t last = line.find_last_not_of(" \r,"), first = line.find_first_not_of(" \t");
    if (last == std::string_view::npos) continue;
    if (line[first] != '{' || line[last] != '}' || line.find(':') >= last) return false;
    ++whole;
  }
  return whole > 1 || (whole == 1 && start.find_first_not_of(" \t") == start.find('{') && !start.empty());
}

/// A line without the sequences that colour a terminal's text and without form feeds.
std::string without_terminal_signs(std::string_view line) {
  std::string out;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\f') continue;
    if (line.substr(i, 2) != "\x1b[") {
      out += line[i];
      continue;
    }
    i += 2;
    while (i < line.size() && line[i] >= ' ' && line[i] < '@') ++i;  // its numbers; the letter behind them ends it
  }
  return out;
}

/// Throws InputError where the data begin as those of another format do.
void refuse_other_formats(const std::string& path, std::string_view start) {
  constexpr std::size_t place_of_tar = 257;  // of "ustar" in the first header
  const auto refuse = [&](std::string_view name, std::string_view remedy) {
    throw InputError(
        fmt::format("{}: is {}; expected a table as text, plain or packed by gzip: {}", path, name, remedy));
  };
  for (const Format& format : formats)
    if (!holds_objects_a_line(start) && start.starts_with(format.begins)) refuse(format.name, format.remedy);
  if (start.size() > place_of_tar && start.substr(place_of_tar).starts_with("ustar")) refuse("a tar archive", unpack);
}

}  // namespace

struct TextInput::Stream {
  z_stream z{};
  bool in_member = false;  // between the first byte of a gzip member and its check sum
  std::array<unsigned char, 1 << 16> in;
};

TextInput::TextInput(std::string path) : path_(std::move(path)), stream_(std::make_unique<Stream>()) {
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0 && errno == EINTR)
    throw InputError(path_ +
                     ": is a pipe that nothing writes to, and waiting for it was interrupted; expected a program "
                     "that writes a recording into it");
  if (descriptor_ < 0) throw InputError(path_ + ": cannot be opened: " + std::strerror(errno));
  try {
    fill();
    if (text_.empty() && at_end_ && end_ == End::whole)
      throw InputError(path_ + ": the file is empty; expected a recording");
  } catch (...) {
    ::close(descriptor_);
    if (gzip_) inflateEnd(&stream_->z);
    throw;
  }
}

TextInput::~TextInput() {
  ::close(descriptor_);
  if (gzip_) inflateEnd(&stream_->z);
}

bool TextInput::next_line(std::string_view& line) {
  for (;;) {
    const std::size_t end = text_.find('\n', searched_);
    if (end != std::string::npos) {
      line = std::string_view(text_).substr(start_, end - start_);
      start_ = searched_ = end + 1;
      break;
    }
    searched_ = text_.size();
    if (at_end_) {
      if (start_ == text_.size()) return false;
      // A last line without LF is known to be whole only where the check sum of the gzip data says so.
      if (!gzip_) end_ = End::truncated;
      if (end_ != End::whole) return false;
      line = std::string_view(text_).substr(start_);
      start_ = text_.size();
      break;
    }
    if (text_.size() - start_ > longest_line_bytes)
      throw InputError(fmt::format("{}:{}: found no end of a line within {} bytes, expected a table as text", path_,
                                   line_number_ + 1, longest_line_bytes));
    fill();
  }
  ++line_number_;
  while (line.ends_with('\r')) line.remove_suffix(1);
  if (line.find_first_of("\x1b\f") != std::string_view::npos) line = plain_ = without_terminal_signs(line);
  return true;
}

void TextInput::fill() {
  text_.erase(0, start_);
  searched_ -= start_;
  judged_ -= start_;
  start_ = 0;
  std::size_t count = read_chunk(0);
  // The first chunk tells the encoding: a pipe hands it out in parts.
  for (std::size_t more = count; first_ && more > 0 && count < stream_->in.size(); count += more)
    more = read_chunk(count);
  const auto& in = stream_->in;
  if (first_) {
    first_ = false;
    gzip_ = count >= 2 && in[0] == 0x1f && in[1] == 0x8b;
    if (!gzip_ && count > 0 && path_.ends_with(".gz"))
      throw InputError(path_ + ": is not gzip data, although its name says so");
    refuse_other_formats(path_, {reinterpret_cast<const char*>(in.data()), count});
    constexpr int gzip_window_bits = 15 + 16;
    if (gzip_ && inflateInit2(&stream_->z, gzip_window_bits) != Z_OK) throw std::bad_alloc();
  }
  if (count == 0) {
    at_end_ = true;
    end_lines_at_cr();
    if (gzip_ && stream_->in_member) end_ = End::truncated;
  } else if (gzip_) {
    inflate_chunk(count);
  } else {
    append(reinterpret_cast<const char*>(in.data()), count);
  }
}

void TextInput::inflate_chunk(std::size_t count) {
  z_stream& z = stream_->z;
  z.next_in = stream_->in.data();
  z.avail_in = static_cast<uInt>(count);
  std::array<char, 1 << 16> out;
  do {
    stream_->in_member = true;
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    const int result = inflate(&z, Z_NO_FLUSH);
    append(out.data(), out.size() - z.avail_out);
    if (result == Z_STREAM_END) {
      stream_->in_member = false;
      inflateReset(&z);  // gzip files may be joined end to end
    } else if (result != Z_OK && result != Z_BUF_ERROR) {
      end_ = End::damaged;
      at_end_ = true;
      return;
    }
  } while (z.avail_in > 0 || (z.avail_out == 0 && stream_->in_member));
}

/// UTF-16 is known by its byte order mark, or by a zero beside the first two letters; others by what they hold.
void TextInput::append(const char* bytes, std::size_t count) {
  if (count == 0) return;
  if (!has_text_) {
    has_text_ = true;
    if (gzip_) refuse_other_formats(path_, {bytes, count});
    const std::string_view start(bytes, std::min<std::size_t>(count, 4));
    const bool is_long = start.size() == 4;
    const bool is_big_endian =
        start.starts_with("\xfe\xff") || (is_long && start[0] == 0 && start[1] != 0 && start[2] == 0);
    const bool is_wide = is_big_endian || start.starts_with("\xff\xfe") ||
                         (is_long && start[0] != 0 && start[1] == 0 && start[2] != 0 && start[3] == 0);
    encoding_ = is_wide ? TextEncoding{"UTF-16", is_big_endian ? "UTF-16BE" : "UTF-16LE"} : encoding_of({bytes, count});
    if (!encoding_.iconv.empty()) converter_ = std::make_unique<TextConverter>(encoding_.iconv);
  }
  if (converter_) converter_->append({bytes, count}, text_);
  else text_.append(bytes, count);
  end_lines_at_cr();
}

std::string TextInput::encoding() const {
  if (encoding_.name.empty() || encoding_.name == "UTF-16") return std::string(encoding_.name);
  return fmt::format("text {} {}", encoding_.is_sure ? "in" : "that may be in", encoding_.name);
}

/// A CR that no LF and no other CR follows ends a line, in whichever part of the file it stands.
void TextInput::end_lines_at_cr() {
  for (std::size_t at = judged_; (at = text_.find('\r', at)) != std::string::npos; ++at) {
    if (at + 1 == text_.size() && !at_end_) break;
    if (at + 1 < text_.size() && (text_[at + 1] == '\n' || text_[at + 1] == '\r')) continue;
    text_[at] = '\n';
    searched_ = std::min(searched_, at);
  }
  judged_ = text_.ends_with('\r') ? text_.size() - 1 : text_.size();
}

std::size_t TextInput::read_chunk(std::size_t from) {
  for (;;) {
    const ssize_t count = ::read(descriptor_, stream_->in.data() + from, stream_->in.size() - from);
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EINTR) throw InputError(path_ + ": cannot be read: " + std::strerror(errno));
  }
}

}  // namespace pneuservo
