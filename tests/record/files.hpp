// Files for the tests of recordings: a folder that goes away, and plain or gzip files with given content.
#pragma once
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/record/row.hpp>

#include "record/gzip_file.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// A folder of its own below the system's folder for temporary files.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "pneuservo-test-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string file(std::string_view name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline std::string put_plain(const std::string& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

inline std::string put_gzip(const std::string& path, std::string_view text) {
  GzipFile file(path);
  file.write(text);
  file.close();
  return path;
}

/// Kinds and lines of all problems, e.g. "gap@7 truncated@12".
inline std::string problems_of(const CsvTable& table) {
  std::string result;
  for (const RecordingProblem& problem : table.problems)
    result.append(result.empty() ? "" : " ")
        .append(name_of(problem.kind))
        .append("@")
        .append(std::to_string(problem.line));
  return result;
}

/// A row whose values all follow from its number; the period is 1 ms.
inline Row numbered_row(int number) {
  Row row;
  row.t_s = number * 1e-3;
  row.measured[Signal::x] = std::sin(number * 0.01);
  row.u_V = number / 3.0;
  return row;
}

}  // namespace pneuservo
