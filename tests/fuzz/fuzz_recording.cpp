// Any bytes as a recording, plain or gzip: one clear sentence, or rows with strictly increasing times.
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include <unistd.h>

#include "config/input_error.hpp"
#include "record/reader.hpp"

namespace {

void read_as(const std::string& path, const std::uint8_t* data, std::size_t size) {
  using namespace pneuservo;
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const Recording recording = read_recording(path);
    const std::vector<double>& t_s = recording.t_s();
    for (std::size_t i = 1; i < t_s.size(); ++i)
      if (!(t_s[i] > t_s[i - 1])) std::abort();
  } catch (const InputError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  // In memory, one file a process: libFuzzer may run several.
  static const std::string name = "/dev/shm/pneuservo-fuzz-" + std::to_string(getpid());
  static const struct Remover {
    ~Remover() {
      unlink((name + ".csv").c_str());
      unlink((name + ".csv.gz").c_str());
    }
  } remover;
  read_as(name + (data[0] == 0x1F ? ".csv.gz" : ".csv"), data, size);
  return 0;
}
