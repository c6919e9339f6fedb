// Writes the EDS (CiA 306) of a node that this program is, from its object dictionary.
#pragma once
#include <string>

#include "can/canopen_node.hpp"

namespace pneuservo {

/// All objects with type, access, mapping and default; what contains the node's number says $NODEID.
std::string eds_text(const CanopenNode& node);

}  // namespace pneuservo
