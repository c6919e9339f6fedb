// Writing a result that can be made again: an older one stays until the new one is whole.
#include "record/result_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "config/input_error.hpp"

namespace pneuservo {
namespace {

void write_text(const std::string& path, const std::string& told, const std::string& text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  if (!(file << text) || !file.flush())
    throw InputError(fmt::format("{}: cannot be written: {}; expected a file that can be, and room for {} bytes", told,
                                 std::strerror(errno), text.size()));
}

/// The place of a file that another may take: of one name, and no descriptor of a process; empty: it may not.
std::string replaceable(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code failed;
  const std::string asked = fs::absolute(path, failed).lexically_normal().string();
  struct stat found{};
  if (failed || asked.starts_with("/dev/") || asked.starts_with("/proc/") || stat(path.c_str(), &found) != 0 ||
      !S_ISREG(found.st_mode) || found.st_nlink > 1)
    return "";
  return fs::canonical(path, failed).string();
}

}  // namespace

void write_result(const std::string& path, const std::string& text) {
  const std::string place = replaceable(path);
  std::string beside = place + ".XXXXXX";
  const int file = place.empty() ? -1 : mkstemp(beside.data());
  if (file < 0) return write_text(path, path, text);
  struct stat older{};
  const bool is_alike = stat(place.c_str(), &older) == 0 && fchown(file, older.st_uid, older.st_gid) == 0 &&
                        fchmod(file, older.st_mode & 07777) == 0;
  close(file);
  try {  // the older result stays until the new one is whole
    write_text(beside, path, text);
  } catch (...) {
    unlink(beside.c_str());
    throw;
  }
  if (is_alike && std::rename(beside.c_str(), place.c_str()) == 0) return;
  unlink(beside.c_str());
  write_text(path, path, text);
}

}  // namespace pneuservo
