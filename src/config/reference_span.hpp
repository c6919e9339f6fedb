// Where a reference goes and how long it lasts: what a config is checked against before anything moves.
#pragma once
#include <pneuservo/control/reference.hpp>

namespace pneuservo {

/// Position at time t [m], without derivatives; not a number where it is in a file.
double reference_position_m(const ReferenceSpec& reference, double t_s);

/// End of the move; a periodic reference: ramp and ten periods (of the slowest component); a file: not a number.
double reference_end_s(const ReferenceSpec& reference);

/// Whether it goes on for ever (sine, multisine, or a sum that has one).
bool is_periodic(const ReferenceSpec& reference);

}  // namespace pneuservo
