// What the program reads of an EDS or DCF file, a line an entry: for comparison with another reader.
#include <cstdlib>
#include <iostream>
#include <string>

#include <fmt/format.h>

#include "can/eds.hpp"

using namespace pneuservo;

namespace {

std::string hex(const EdsBytes& value) {
  if (!value.why.empty()) return "?";
  std::string out;
  for (const std::uint8_t byte : value.bytes) out += fmt::format("{:02x}", byte);
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: eds_entries FILE NODE\n"
                 "index,sub,data_type,can_map,can_read,can_write,standard,configured of each entry; values as the "
                 "bytes of their type, ? where they do not fit it\n";
    return 2;
  }
  try {
    const EdsFile file = EdsFile::read(argv[1]);
    const auto node = static_cast<std::uint8_t>(std::atoi(argv[2]));
    for (const EdsObject& o : file.objects()) {
      const auto value = [&](const std::string& text) { return text.empty() ? "" : hex(eds_bytes(o, text, node)); };
      std::cout << fmt::format("{:04x},{},{},{:d},{:d},{:d},{},{}\n", o.index, o.sub, o.data_type, o.can_map,
                               o.can_read, o.can_write, value(o.standard), value(o.configured));
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
