// The inverse of the nonlinear servo table for one reference: what each valve has to pass, tick by tick
// (docs/physics/flatness.md).
#pragma once
#include <cstdint>
#include <vector>

#include <pneuservo/control/reference.hpp>

namespace pneuservo {

template <class S> struct AxisParameters;

/// What one valve does in one tick, as of the middle of the period for which the command is held.
struct FlatnessValve {
  double flow_kgps = 0.0;                  ///< feedforward, into the line
  double charge_kgps_per_V = 1.0;          ///< flow per volt of spool from the supply, at the port pressure then
  double discharge_kgps_per_V = 1.0;       ///< flow per volt of spool to atmosphere
  double correction_V = 0.0;               ///< what hold and spool dynamics need beyond the spool position itself
  double volume_share = 1.0;               ///< chamber volume over its value at mid-stroke

  /// Spool that passes the flow [V].
  double spool_V(double flow) const noexcept {
    return flow >= 0.0 ? flow / charge_kgps_per_V : flow / discharge_kgps_per_V;
  }
  /// Command for the feedforward flow and `extra` kg/s beside it [V]. HOT.
  double command_V(double extra_kgps) const noexcept { return spool_V(flow_kgps + extra_kgps) + correction_V; }
};

struct FlatnessTick {
  FlatnessValve valve_1, valve_2;
  double mean_port_pressure_Pa = 0.0;
};

/// How the plan is made.
struct FlatnessSettings {
  double period_s = 2e-4;
  double command_delay_s = 0.0;
  double mean_pressure_Pa = 140e3;  ///< mean of both chamber pressures, constant
  int cells = 4;                    ///< of each line
  int passes = 5;                   ///< over each line; a pass carries a temperature one cell further
};

/// Commands of both valves for a reference and a constant mean pressure, from the true model of the rig: chambers with
/// energy equation, distributed lines with friction and wall heat, orifices, spools, hold. Effects beside the nominal
/// model are not known to it. Cold to make, HOT to read.
class FlatnessPlan {
 public:
  FlatnessPlan() = default;
  /// Ticks from t = 0 to duration_s [s]; about 0.3 s of work and 10 MB a second of reference. Throws
  /// std::invalid_argument with one sentence if the mean pressure does not suffice for the reference; it names the
  /// pressure that does.
  FlatnessPlan(const AxisParameters<double>& axis, const Reference& reference, double duration_s,
               const FlatnessSettings& settings);

  /// Tick k of the reference; before the first and after the last it rests. HOT.
  const FlatnessTick& at(std::int64_t tick) const noexcept {
    const auto last = static_cast<std::int64_t>(ticks_.size()) - 1;
    return ticks_[static_cast<std::size_t>(tick < 0 ? 0 : tick > last ? last : tick)];
  }
  std::size_t ticks() const noexcept { return ticks_.size(); }
  /// Largest magnitude of a feedforward command [V].
  double peak_command_V() const noexcept { return peak_command_V_; }
  /// Standard deviation of the Gaussian that smooths a deviation: beyond it, near the lines' resonances, the model
  /// knows too little.
  static constexpr double deviation_smoothing_s = 3e-3;
  /// The flow, at the commands, by which valve 1 has to pass more and valve 2 less to deviate from the reference by
  /// error_m: x - x_ref at each tick, smoothed by a Gaussian. As much work as the plan itself. Cold.
  std::vector<double> flow_of_deviation(const AxisParameters<double>& axis, const std::vector<double>& error_m) const;

 private:
  Reference reference_;
  double duration_s_ = 0.0;
  FlatnessSettings settings_;
  std::vector<FlatnessTick> ticks_ = std::vector<FlatnessTick>(1);
  double peak_command_V_ = 0.0;
};

/// Smallest mean pressure, to 0.5 kPa, at which the feedforward of the reference stays in the valves' range [Pa];
/// 0 if there is none below the supply. Cold.
double mean_pressure_needed_Pa(const AxisParameters<double>& axis, const Reference& reference, double duration_s,
                               const FlatnessSettings& settings);

}  // namespace pneuservo
