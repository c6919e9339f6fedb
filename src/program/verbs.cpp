// The table of verbs.
#include "program/verbs.hpp"

namespace pneuservo {

void add_check(CLI::App&, int&);
void add_keys(CLI::App&, int&);
void add_latency(CLI::App&, int&);

const std::vector<AddVerb>& all_verbs() {
  static const std::vector<AddVerb> verbs{
      add_keys,
      add_check,
      add_latency,
  };
  return verbs;
}

}  // namespace pneuservo
