// Which kinds of rig a verb or a call works on.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Throws InputError where commands drive no valve of this rig, or more than the verb works on.
void require_valves(std::string_view verb, const std::string& config, const Rig& rig, std::size_t most = 2);
/// The same for a rig that the loop runs, a pressure rig among them.
void require_loop(std::string_view verb, const std::string& config, const Rig& rig);

}  // namespace pneuservo
