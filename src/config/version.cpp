// The version of this build, for recordings and reports.
#include "config/version.hpp"

namespace pneuservo {

std::string_view version() { return PNEUSERVO_VERSION; }
std::string_view code_path() {
#if defined(__AVX2__)
  return "x86-64-v3";
#else
  return "x86-64";
#endif
}

}  // namespace pneuservo
