// Which kinds of rig a verb or a call works on.
#include "config/rig_kinds.hpp"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/input_error.hpp"

namespace pneuservo {
namespace {

template <class Fits>
void refuse_other_kinds(std::string_view verb, const std::string& config, const Rig& rig, Fits&& fits) {
  if (fits(info(rig.kind))) return;
  std::vector<std::string_view> names;
  for (const RigKindInfo& kind : rig_kind_table)
    if (fits(kind)) names.push_back(kind.name);
  throw InputError(fmt::format("{}: rig: found {}, expected {}: {} works on no other rig", config, info(rig.kind).name,
                               fmt::join(names, " or "), verb));
}

}  // namespace

void require_valves(std::string_view verb, const std::string& config, const Rig& rig, std::size_t most) {
  refuse_other_kinds(verb, config, rig, [most](const RigKindInfo& kind) {
    return kind.has_slider && kind.valves > 0 && kind.valves <= most;
  });
}

void require_loop(std::string_view verb, const std::string& config, const Rig& rig) {
  refuse_other_kinds(verb, config, rig, [](const RigKindInfo& kind) { return kind.valves > 0; });
}

}  // namespace pneuservo
