// Any text as a config: one clear sentence, or a rig that its own dump reads back to.
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "config/same_rig.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pneuservo;
  Rig rig;
  try {
    rig = parse_rig(std::string(reinterpret_cast<const char*>(data), size), "fuzz.yaml");
  } catch (const InputError& error) {
    if (std::string(error.what()).empty()) std::abort();
    return 0;
  }
  const std::string dumped = dump_rig(rig);
  try {
    if (same_rig(rig, parse_rig(dumped, "dump.yaml"))) return 0;
    std::cerr << "the dump reads back to another rig:\n" << dumped;
  } catch (const InputError& error) { std::cerr << "the dump is refused: " << error.what() << "\n" << dumped; }
  std::abort();
}
