// How much of a recording is held in memory.
#include "record/table_bound.hpp"

#include <algorithm>
#include <fstream>

#include <sys/resource.h>
#include <unistd.h>

#include <fmt/format.h>

#include "config/input_error.hpp"

namespace pneuservo {

std::size_t most_table_bytes() {
  constexpr std::size_t share = 4;
  auto most = static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  std::size_t container = 0;
  if (std::ifstream("/sys/fs/cgroup/memory.max") >> container) most = std::min(most, container);
  rlimit own{};
  if (getrlimit(RLIMIT_AS, &own) == 0 && own.rlim_cur != RLIM_INFINITY)
    most = std::min(most, static_cast<std::size_t>(own.rlim_cur));
  return most / share;
}

void refuse_beyond(std::size_t most_bytes, std::size_t bytes, const std::string& path, std::size_t line) {
  if (bytes <= most_bytes) return;
  constexpr double bytes_per_MB = 1e6;
  throw InputError(fmt::format(
      "{}, line {}: found {:.0f} MB of rows up to here and more behind, expected {:.0f} MB at most, a quarter of the "
      "memory; cut the recording, log fewer columns, or end the pipe: head -n",
      path, line, static_cast<double>(bytes) / bytes_per_MB, static_cast<double>(most_bytes) / bytes_per_MB));
}

}  // namespace pneuservo
