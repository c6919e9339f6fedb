// The table of verbs.
#include "program/verbs.hpp"

#include <algorithm>
#include <array>

namespace pneuservo {

using AddsVerb = void(CLI::App&, int& status);
AddsVerb add_run, add_check, add_device, add_guard, add_latency, add_replay, add_simulate, add_design, add_index,
    add_diagnose, add_keys, add_home, add_zero, add_commission, add_stopping, add_import, add_effects, add_serve,
    add_command, add_new_rig;

const std::vector<AddVerb>& all_verbs() {
  static const std::vector<AddVerb> verbs{
      add_run,      add_check,  add_device,   add_guard, add_latency, add_replay,  add_simulate,
      add_design,   add_index,  add_diagnose, add_keys,  add_home,    add_zero,    add_commission,
      add_stopping, add_import, add_effects,  add_serve, add_command, add_new_rig,
  };
  return verbs;
}

bool moves_an_axis(std::string_view verb) {
  constexpr std::array<std::string_view, 7> moving{"run", "home", "zero", "commission", "device", "guard", "serve"};
  return std::find(moving.begin(), moving.end(), verb) != moving.end();
}

}  // namespace pneuservo
