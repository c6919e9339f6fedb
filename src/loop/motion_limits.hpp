// Limits of the supervised motion: stated in the config, or derived from its own simulation.
#pragma once
#include <pneuservo/control/reference.hpp>
#include <pneuservo/loop/motion_supervision.hpp>
#include <pneuservo/loop/motion_twin.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// What the simulated machines of one config do along its reference, and the limits that follow from it.
struct MotionPrediction {
  MotionLimits limits;
  MotionTwin twin;               ///< configured; what the limits are measured from
  int machines = 0;              ///< drawn; 0: nothing had to be derived
  double spread_m = 0.0;         ///< largest distance of a drawn machine from the predicted motion
  double speed_spread_mps = 0.0; ///< largest difference of their speeds
  double start_spread_m = 0.0;   ///< the same until the start is proven
  double peak_speed_mps = 0.0;   ///< of any machine
  double standing_force_N = 0.0; ///< largest force of the air on one that stands
  double following_error_m = 0.0;  ///< of the predicted motion from the reference
  /// The machines scatter so much that the deviation's limit is its cap: not every permitted machine stays below.
  bool scattered = false;
};

/// Draws machines within `tolerances` (normal, cut at three standard deviations), payload (0 to limits.payload_max_kg)
/// and dry friction (0 to limits.dry_friction_max_N), runs each in closed loop along the reference, and takes
/// usual_margin times the largest of each quantity. Where the config states all four limits no machine is drawn.
/// Deterministic. Cold: some 0.2 s for 5 s of motion at 1 kHz.
/// `pass`: of the reference, for a law that follows one.
MotionPrediction predict_motion(const Rig& rig, const Reference& reference, std::shared_ptr<const PassTable> pass);
/// Largest dry friction that the config allows; where it says nothing, that of the seals.
double dry_friction_max_N(const Rig& rig);
/// With a pass of its own where the law follows one.
MotionPrediction predict_motion(const Rig& rig, const Reference& reference);

}  // namespace pneuservo
