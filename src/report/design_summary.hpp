// What the verb design says, as tables for screen and page.
#pragma once
#include <string>

#include <design/axis_design.hpp>
#include <report/table.hpp>

namespace pneuservo {

/// Constants of the model: gain, air spring, lags of valve and lines with where they come from.
Table model_table(const Rig& rig, const AxisDesign& design);
/// Gains of the config beside the design's.
Table gain_table(const Rig& rig, const AxisDesign& design);
/// Poles of each order with ideal derivatives, and of the sampled loop.
Table pole_table(const AxisDesign& design);
/// c_i of each order.
Table feedforward_table(const AxisDesign& design);
/// Margins of the linear model and with distributed lines.
Table margin_table(const AxisDesign& design);
/// Step, ITAE, noise, mean pressure.
Table loop_table(const Rig& rig, const AxisDesign& design);
/// Gains of the valve's inner loop; without rows where it has none.
Table spool_table(const Rig& rig, const AxisDesign& design);
/// Normalised coefficients of each order's loop beside those of least ITAE and the classic ones.
Table coefficient_table(const AxisDesign& design);

/// One line: rig, law, operating point, period.
std::string circumstances(const Rig& rig, const AxisDesign& design);
/// The whole text of the verb; `coefficients` adds the table that takes seconds.
std::string design_text(const Rig& rig, const AxisDesign& design, bool coefficients);

/// "-13.7 ± 40.6j"
std::string pole_text(std::complex<double> pole);

}  // namespace pneuservo
