// The table of verbs: each verb lives in a file of its own and is named in verbs.cpp.
#pragma once
#include <string_view>

#include "program/command_line.hpp"

namespace pneuservo {

/// Adds every verb to the program; the callback of the one that runs sets the exit status.
void add_verbs(CLI::App& app, int& status);

/// Verbs that command a valve, or stand in for one that is commanded: no signal may end them before the safe output.
bool moves_an_axis(std::string_view verb);

}  // namespace pneuservo
