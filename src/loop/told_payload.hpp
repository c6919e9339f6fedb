// Which payload that nobody stated the supervision of the motion tells, and after how long.
#pragma once
#include <optional>
#include <vector>

#include "loop/motion_limits.hpp"

namespace pneuservo {

/// A payload on the config's own machine, beside the one that the config knows.
struct ToldPayload {
  double payload_kg = 0.0;
  /// Until the fault, from its first millimetre off the prediction on; the longest of all instants at which it was put
  /// on. None: at one of them no fault came.
  std::optional<double> after_s;
  double off_m = 0.0;  ///< largest distance from the prediction at a fault
};

/// Simulates payloads in steps of 1, 2 and 5, from a tenth of the moving mass and beyond what the config permits to a
/// hundred times the moving mass, put on before the start and at instants of the reference's first half. `prediction`
/// is that of predict_motion. Deterministic. Cold: some 0.3 s for 5 s of motion at 1 kHz.
std::vector<ToldPayload> told_payloads(const Rig& rig, const Reference& reference, const MotionPrediction& prediction);

}  // namespace pneuservo
