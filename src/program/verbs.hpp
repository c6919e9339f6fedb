// The table of verbs: each verb lives in a file of its own and is named once in verbs.cpp.
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

void add_check(CLI::App& app, int& status);
void add_commission(CLI::App& app, int& status);
void add_design(CLI::App& app, int& status);
void add_diagnose(CLI::App& app, int& status);
void add_device(CLI::App& app, int& status);
void add_import(CLI::App& app, int& status);
void add_index(CLI::App& app, int& status);
void add_keys(CLI::App& app, int& status);
void add_guard(CLI::App& app, int& status);
void add_home(CLI::App& app, int& status);
void add_zero(CLI::App& app, int& status);
void add_stopping(CLI::App& app, int& status);
void add_latency(CLI::App& app, int& status);
void add_replay(CLI::App& app, int& status);
void add_run(CLI::App& app, int& status);
void add_simulate(CLI::App& app, int& status);

}  // namespace pneuservo
