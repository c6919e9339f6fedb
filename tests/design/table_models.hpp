// The servo table's linear models of the golden numbers, as linear axes.
#pragma once
#include "control/table_axis.hpp"
#include "design/linear_axis.hpp"

namespace pneuservo::test {

inline LinearAxis golden_axis(const TableCase& one) { return linear_axis(nominal_linear_table(one)); }
inline constexpr double table_period_s = 200e-6;

}  // namespace pneuservo::test
