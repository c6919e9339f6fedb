// Cross-checks of the sensors against the model: air through the valves against air in the lines, measured against
// estimated chamber pressure. What no channel shows by itself: stuck valve, lost supply, leak, biased or slow sensors.
#pragma once
#include <array>
#include <cstdint>

#include <pneuservo/elements/valve_inflow.hpp>
#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One tick's view of both sides. Pressures absolute [Pa]; NaN where there is no sensor.
struct CrossCheckInput {
  std::array<double, 2> command_V{};   ///< in force over the period that ends now
  std::array<double, 2> port_Pa{};
  std::array<double, 2> chamber_Pa{};
  double supply_Pa = 0.0;
};

/// Per side, over about the last window_s:
///   air   |sum (G_valve - G_port) dt| > share * sum (|G_valve| + |G_port|)/2 dt + floor,
/// G_valve by the valve's own law from command, supply and port pressure, G_port by the line model from port pressure
/// and position, both with the effects that the config knows. And, smoothed over smoothing_s,
///   |p_measured - p_estimated| > limit + the estimate's stated bound.
/// Both rest for settle_s after a start, for the estimator begins at rest and the axis may not, and for
/// rest_per_skipped slots for each one that the loop skipped, at most as long.
class CrossCheck {
 public:
  static constexpr double window_s = 0.3, smoothing_s = 0.02, settle_s = 0.5;
  static constexpr std::int64_t rest_per_skipped = 10;
  /// Part of the air that a side holds at mid-stroke and supply pressure: what noise and grid make.
  static constexpr double floor_share = 0.02;

  /// Allocates the valves' delay lines.
  void configure(const Rig& rig);
  void reset() noexcept;
  /// Bits of Fault (flow_mismatch_*, chamber_mismatch_*); 0 while it settles. `skipped`: slots before this tick. HOT.
  std::uint64_t check(const CrossCheckInput& in, const EstimatorOutput& estimate, std::int64_t skipped) noexcept;

  /// The last check judged its tick: it neither settled nor rested.
  bool watching() const noexcept { return watching_; }
  /// Air that is not explained, as a share of what would be a fault; of the last check, by side.
  std::array<double, 2> flow_share() const noexcept { return shares(missing_kg_, air_limit_kg_); }
  /// Difference of the chamber pressures as a share of what would be a fault; 0 without a sensor.
  std::array<double, 2> chamber_share() const noexcept { return shares(difference_Pa_, difference_limit_Pa_); }

 private:
  using Two = Pack<double, 2>;
  static std::array<double, 2> shares(const Two& found, const Two& limit) noexcept {
    const Two share = absolute(found) / limit;
    return {low(share), high(share)};
  }
  std::uint64_t judge_air() noexcept;
  std::uint64_t judge_chambers(const Two& measured_Pa, const EstimatorOutput& estimate) noexcept;

  ValveInflow valves_;
  double period_s_ = 1e-3, flow_limit_share_ = 0.0, chamber_limit_Pa_ = 0.0;
  Two missing_kg_{}, through_kg_{}, difference_Pa_{}, floor_kg_{};
  Two air_limit_kg_{1.0}, difference_limit_Pa_{1.0};  // beyond these the last check found a fault
  double decay_ = 0.0, smoothing_ = 1.0;
  std::int64_t settled_after_ = 0, ticks_ = 0;
  bool watching_ = false;
};

}  // namespace pneuservo
