// A gzip file being written: readable up to the last flush whatever happens to the program.
#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace pneuservo {

/// Creates (or empties) a file and compresses into it. Not for the loop's thread: writes and syncs block.
class GzipFile {
 public:
  /// Throws InputError naming the path and the reason (no such folder, no permission, disk full, ...).
  explicit GzipFile(std::string path);
  ~GzipFile();
  GzipFile(const GzipFile&) = delete;
  GzipFile& operator=(const GzipFile&) = delete;

  void write(std::string_view text) noexcept;
  /// All text so far can be read from the file; with `to_disk` it also survives a loss of power.
  void flush(bool to_disk) noexcept;
  /// Ends the gzip stream. Further calls do nothing.
  void close() noexcept;
  /// Empty, or one sentence on the first failure; nothing is written after it.
  const std::string& error() const noexcept { return error_; }
  const std::string& path() const noexcept { return path_; }

 private:
  struct Stream;
  void deflate_all(int mode) noexcept;
  void put(const char* bytes, std::size_t count) noexcept;
  void fail(const char* action, int number) noexcept;

  std::string path_, error_;
  std::unique_ptr<Stream> stream_;
  int descriptor_ = -1;
};

}  // namespace pneuservo
