// What a diagnosis says, in a machine builder's words: effects, elements, sizes.
#pragma once
#include <string>
#include <string_view>

#include "diagnosis/diagnosis.hpp"
#include "diagnosis/result_text.hpp"

namespace pneuservo {

/// "a leak from chamber 1 to the room" for chamber_leak_1; a path of the config for `parameter:PATH`; the name itself
/// where there are no words for it.
std::string effect_words(std::string_view effect);

/// A value in a unit that is at hand, from its key: area_m2 = 2e-8 is "0.02 mm², as a hole of 0.16 mm". Empty where the
/// key's own unit serves.
std::string size_words(std::string_view key, double value);

/// The verdict in one sentence for who built the machine: what, how large, how sure, what would look the same.
std::string verdict_words(const Diagnosis& diagnosis);

/// Two significant digits of a standard error.
std::string error_text(double error);

}  // namespace pneuservo
