// The table of verbs: each verb lives in a file of its own and is named in verbs.cpp.
#pragma once
#include <functional>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace pneuservo {

/// Adds one subcommand to the program; its callback sets the exit status.
using AddVerb = std::function<void(CLI::App&, int& status)>;

const std::vector<AddVerb>& all_verbs();

/// Verbs that command a valve, or stand in for one that is commanded: no signal may end them before the safe output.
bool moves_an_axis(std::string_view verb);

}  // namespace pneuservo
