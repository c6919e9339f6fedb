// Figures of a run that controls a pressure: steps, settling, errors of the volume's pressure and of its estimate.
#pragma once
#include <limits>
#include <string>
#include <vector>

#include <pneuservo/record/row.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One change of the reference and the rest after it.
struct PressureStep {
  double start_s = 0.0;         ///< where the reference begins to change
  double end_s = 0.0;           ///< where it changes anew, or the run ends
  double from_Pa = 0.0, to_Pa = 0.0;
  double overshoot_share = 0.0; ///< farthest beyond the end value, over the step's height
  double settling_s = 0.0;      ///< from start_s until 5 % of the height are never left again; NaN: it is
  double settled_error_Pa = 0.0;  ///< largest error in the second half from start_s to end_s
};

/// NaN where the rows do not hold what a figure needs. The pressure is the simulated volume's own, else the measured
/// one, else the estimate.
struct PressureMetrics {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  double from_s = none, to_s = none;
  std::string pressure = "estimated";  ///< "true", "measured" or "estimated"
  double max_error_Pa = none, rms_error_Pa = none;
  double max_overshoot_share = none, max_settling_s = none, max_settled_error_Pa = none;
  double max_estimation_error_Pa = none, rms_estimation_error_Pa = none;
  double command_step_rms_V = none;
  std::vector<PressureStep> steps;  ///< whole ones: the reference stood before and after
};

/// Share of a step's height within which it has settled.
inline constexpr double settled_share = 0.05;

/// `start_s`: time in `rows` at which the reference started. Rows from the first fault on do not count.
PressureMetrics evaluate_pressure(const Rig& rig, const std::vector<Row>& rows, double start_s);

}  // namespace pneuservo
