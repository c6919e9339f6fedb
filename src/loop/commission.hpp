// Commissioning: small limited motions each way that prove signs, hoses, sensors, neutral and scale before the first
// run.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// What a step may do. Speeds and ways are those of a slider without friction by the valve's law.
struct ProbeLimits {
  static constexpr double acceleration_mps2 = 0.05;  ///< of the command's ramp: 20 mm/s after 4 mm
  static constexpr double way_m = 2.5e-3;              ///< measured: the probe ends
  static constexpr double unseen_way_m = 3.2e-3;       ///< that the air should have moved it: the probe ends
  static constexpr double drift_m = 5e-3;            ///< with the valve closed: the rest ends
  static constexpr double fastest_mps = 0.1;         ///< measured: the probe ends
  static constexpr double largest_share = 0.1;       ///< of the valve's range
  static constexpr double push_Pa = 50e3;  ///< on the larger piston: more is not tried on a slider that stands
};

enum class CommissionVerdict { good, unclear, wrong };

/// One thing that was looked at.
struct CommissionCheck {
  std::string name;
  CommissionVerdict verdict = CommissionVerdict::good;
  std::string what;  ///< what was found, with numbers
  std::string remedy;  ///< empty where nothing is to be done
};

struct CommissionResult {
  std::vector<CommissionCheck> checks;
  std::optional<double> neutral_V, neutral_error_V;  ///< command at which nothing drifts, +- what is not known
  std::optional<double> dead_band_V;  ///< to either side of it, where it is more than the error
  std::optional<double> encoder_scale;  ///< measured way over the way that the air gives
  double farthest_m = 0.0, fastest_mps = 0.0;  ///< measured, of all probes
  bool passed() const noexcept;
};

/// Rests for a second, moves some millimetres to either side, and judges what position and pressures did against the
/// model of `rig` under the same commands. A sign that is wrong ends the motion at once. The safe output stands at the
/// end. Faults of devices, emergency stop and supervision become a wrong check; throws only what backends throw.
CommissionResult commission_axis(const Rig& rig, Backend& backend, bool real_time);

}  // namespace pneuservo
