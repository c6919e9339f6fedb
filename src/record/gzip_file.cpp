// A gzip file being written: readable up to the last flush whatever happens to the program.
#include "record/gzip_file.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "config/input_error.hpp"

namespace pneuservo {

namespace {
// A recording must not hold up the simulation. Measured digits hardly repeat: searching for repeats costs as much time
// again as all the rest and saves little, so only the characters' frequencies are used.
constexpr int compression_level = 1, strategy = Z_HUFFMAN_ONLY;
constexpr int gzip_window_bits = 15 + 16;  // zlib: + 16 asks for a gzip wrapper
constexpr int memory_level = 9;

/// A file of another process that comes between the look and the opening is refused, too: O_EXCL. A link that points
/// to nothing is no file of ours and is not followed.
int create(const std::string& path, ExistingFile existing) {
  struct stat found{};
  const bool is_there = ::stat(path.c_str(), &found) == 0, holds_data = is_there && S_ISREG(found.st_mode);
  if (is_there && !holds_data) return ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  const int how = existing == ExistingFile::replace ? O_TRUNC : O_EXCL;
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | how, 0644);
}
}  // namespace

struct GzipFile::Stream {
  z_stream z{};
  std::array<unsigned char, 1 << 16> out;
};

GzipFile::GzipFile(std::string path, ExistingFile existing)
    : path_(std::move(path)), stream_(std::make_unique<Stream>()) {
  descriptor_ = create(path_, existing);
  if (descriptor_ < 0 && errno == EEXIST) throw InputError(path_ + ": " + std::string(existing_recording_words));
  if (descriptor_ < 0)
    throw InputError(path_ + ": the recording cannot be created: " + std::strerror(errno) +
                     "; expected a path that can be written");
  if (deflateInit2(&stream_->z, compression_level, Z_DEFLATED, gzip_window_bits, memory_level, strategy) != Z_OK) {
    ::close(descriptor_);
    throw std::bad_alloc();
  }
}

GzipFile::~GzipFile() { close(); }

void GzipFile::write(std::string_view text) noexcept {
  if (descriptor_ < 0) return;
  stream_->z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream_->z.avail_in = static_cast<uInt>(text.size());
  deflate_all(Z_NO_FLUSH);
}

void GzipFile::flush(bool to_disk) noexcept {
  if (descriptor_ < 0) return;
  stream_->z.avail_in = 0;
  deflate_all(Z_SYNC_FLUSH);
  // EINVAL: a pipe or device, which has nothing to sync.
  if (to_disk && error_.empty() && ::fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS)
    fail("cannot be brought to disk", errno);
}

void GzipFile::close() noexcept {
  if (descriptor_ < 0) return;
  stream_->z.avail_in = 0;
  deflate_all(Z_FINISH);
  deflateEnd(&stream_->z);
  if (::close(descriptor_) != 0 && error_.empty()) fail("cannot be closed", errno);
  descriptor_ = -1;
}

void GzipFile::deflate_all(int mode) noexcept {
  z_stream& z = stream_->z;
  do {
    z.next_out = stream_->out.data();
    z.avail_out = static_cast<uInt>(stream_->out.size());
    deflate(&z, mode);
    put(reinterpret_cast<const char*>(stream_->out.data()), stream_->out.size() - z.avail_out);
  } while (z.avail_out == 0);
}

void GzipFile::put(const char* bytes, std::size_t count) noexcept {
  while (count > 0 && error_.empty()) {
    const ssize_t written = ::write(descriptor_, bytes, count);
    if (written > 0) {
      bytes += written;
      count -= static_cast<std::size_t>(written);
    } else if (errno != EINTR) {
      fail("cannot be written", errno);
    }
  }
}

void GzipFile::fail(const char* action, int number) noexcept {
  error_ =
      path_ + ": the recording " + action + ": " + std::strerror(number) + "; rows after the last flush are missing";
}

}  // namespace pneuservo
