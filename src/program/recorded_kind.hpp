// The kind of rig that a recording was made on.
#pragma once
#include <string>

#include <pneuservo/rig/rig.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// Throws InputError where a recording of this program was made on another kind of rig than that of the file `config`.
/// A foreign recording tells no kind.
void require_same_kind(const Recording& recording, const std::string& config, const Rig& rig);

}  // namespace pneuservo
