// What repeated moves taught, kept between runs of the same move on the same machine.
#pragma once
#include <string>
#include <vector>

#include <pneuservo/control/repeated_move.hpp>

namespace pneuservo {

/// First line of such a file.
inline constexpr std::string_view learned_move_mark = "# pneuservo-learned-move/1";

/// The learned command [V] of a file, a tick each. Throws InputError where it cannot be read, or was learned with
/// another period or beside another pass (`identity` of RepeatedMove).
std::vector<double> read_learned_move(const std::string& path, const RepeatedMove& move);

/// Its text: the command, with the errors of the moves that taught it.
std::string learned_move_text(const std::string& rig_name, const RepeatedMove& move);

/// How the learning went, in sentences with their line ends; empty where there was none.
std::string learning_words(const LearningProgress& progress);

}  // namespace pneuservo
