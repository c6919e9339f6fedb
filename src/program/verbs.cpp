// The table of verbs.
#include "program/verbs.hpp"

namespace pneuservo {

const std::vector<AddVerb>& all_verbs() {
  static const std::vector<AddVerb> verbs{add_index};
  return verbs;
}

}  // namespace pneuservo
