// Writes a rig as a complete, commented config that reads back to the same rig.
#pragma once
#include <string>
#include <string_view>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Ends the first line of every dump.
inline constexpr std::string_view dumped_rig_mark = ": all keys, with unit, range and meaning.";

/// Every key with its value, unit, range and meaning beside it; numbers in their shortest form that reads back to the
/// same bits. Effects that change nothing are left out.
std::string dump_rig(const Rig& rig);

/// A reference on one line, `{kind: sine, ...}`, as recordings state it in their header.
std::string dump_reference(const ReferenceSpec& reference);

}  // namespace pneuservo
