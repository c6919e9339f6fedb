// Figures of a run: position error, estimation error, ripple and calm of the command over the evaluation window.
#pragma once
#include <vector>

#include <pneuservo/rig/rig.hpp>
#include <report/run_result.hpp>

namespace pneuservo {

/// Corner of the high-pass that separates ripple from motion.
inline constexpr double ripple_corner_Hz = 3.5;
/// Time after a move's end that still belongs to it.
inline constexpr double settling_s = 0.6;
/// Length of the stretch over which the end error is averaged.
inline constexpr double end_stretch_s = 0.1;

/// Part of a run, in seconds from its start; both ends belong to it.
struct EvaluationWindow {
  double from_s = 0.0, to_s = 0.0;
};

/// Start and end of the motion that a reference asks for; `periodic` where it does not end (sine, multisine and sums
/// with one of them) and for a file, whose end its text alone does not tell: `to_s` is then infinite.
struct ReferenceSpan {
  double from_s = 0.0, to_s = 0.0;
  bool periodic = false;
};
ReferenceSpan reference_span(const ReferenceSpec& reference);

/// The config's `evaluation` if it has one; else the second half of the run (`run_duration_s`) for references that do
/// not end, the whole run for a file, and from a move's start to 0.6 s after its end.
EvaluationWindow evaluation_window(const Rig& rig, double run_duration_s);

/// Figures of one run. `rows` in the order of time, evenly sampled but for single lost rows; `start_s` is the time in
/// `rows` at which the reference started. The run's duration is that of its rows, so a run that a fault or a signal
/// ended is judged over what there is of it; figures without any row are NaN.
/// Error = x_ref - x_true (x_m where there is no truth); estimation error = p_estimated - p_chamber_true (NaN without
/// truth); ripple: of the true chamber pressure, of the measured one where there is no truth, without the first and last
/// 1/3.5 s of the rows.
Metrics evaluate(const Rig& rig, const std::vector<Row>& rows, double start_s = 0.0);

}  // namespace pneuservo
