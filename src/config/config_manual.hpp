// The manual page of the config format, made from the declarations that the reader uses.
#pragma once
#include <string>

namespace pneuservo {

/// A short commented config; it reads as it stands.
std::string config_example();

/// All keys with unit, range, default and help, as a markdown page that opens with the example (docs/config-keys.md).
std::string config_manual();

/// The same keys as plain text for a terminal.
std::string config_manual_text();

}  // namespace pneuservo
