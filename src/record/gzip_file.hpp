// A gzip file being written: readable up to the last flush whatever happens to the program.
#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace pneuservo {

/// What becomes of a regular file that is there already. A pipe or device holds nothing that could be lost.
enum class ExistingFile { refuse, replace };

/// Why a recording is not written where one is.
inline constexpr std::string_view existing_recording_words =
    "found a file that is there already, expected a new name: a recording is never overwritten unless --force says so";

/// Creates a file and compresses into it. Not for the loop's thread: writes and syncs block.
class GzipFile {
 public:
  /// Throws InputError naming the path and the reason (it is there, no such folder, no permission, disk full, ...).
  explicit GzipFile(std::string path, ExistingFile existing = ExistingFile::refuse);
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
