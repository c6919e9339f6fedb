// Zeros of channels from files.
#include "program/zeros.hpp"

#include <map>

#include <pneuservo/core/field.hpp>

#include "config/number_text.hpp"
#include "config/section_reader.hpp"

namespace pneuservo {
namespace {

struct ZeroFile {
  std::map<std::string, double> zeros;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"zeros", "", -1e7, 1e7, "by channel"}, p.zeros...);
  }
};

}  // namespace

std::vector<std::string> with_zeros(std::vector<std::string> sets, const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    ZeroFile read;
    read_section(read_config_tree(file, "a file that home or zero wrote"), "", read);
    for (const auto& [channel, zero] : read.zeros) sets.push_back("zeros." + channel + "=" + number_text(zero));
  }
  return sets;
}

}  // namespace pneuservo
