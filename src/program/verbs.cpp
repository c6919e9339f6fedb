// The table of verbs.
#include "program/verbs.hpp"

namespace pneuservo {

const std::vector<AddVerb>& all_verbs() {
  static const std::vector<AddVerb> verbs{
      add_run,    add_check, add_device,   add_latency, add_replay, add_simulate, add_import,
      add_design, add_index, add_diagnose, add_keys,    add_home,   add_zero,
  };
  return verbs;
}

}  // namespace pneuservo
