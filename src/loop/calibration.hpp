// Named steps before the first motion: homing an incremental encoder at an end stop, zeroing vented pressure sensors.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Which end stop the slider is driven to.
enum class HomingEnd { low, high };

struct HomingSettings {
  HomingEnd end = HomingEnd::low;
  double command_V = 0.0;   ///< pushes to that end; 0: usual_share of the valve's range
  double timeout_s = 30.0;
  bool real_time = false;   ///< on the machine's clock; else as fast as it goes
  static constexpr double usual_share = 0.02;
  static constexpr double fastest_mps = 5.0;  ///< where limits.speed_mps says nothing
  static constexpr double ramp_s = 0.5, standing_s = 1.0;
  static constexpr double standing_m = 2e-4;  ///< less way than this in standing_s is standing
};

/// What is to be added to a channel, and from what it follows.
struct ChannelZero {
  std::string channel;
  double zero = 0.0;        ///< in the channel's unit
  std::string what;         ///< e.g. "absolute", "gauge", "low end at 0.1234 m"
};

/// Drives the slider to the end stop with a steady small command, under the supervisor (speed, pressures, emergency
/// stop, devices; position range, frozen encoder and cross-checks mean nothing before the zero is known), until it
/// stands for standing_s; the safe output stands at the end, however it ends. Throws std::runtime_error saying the
/// fault, or that the slider did not come to rest in time, or hardly moved at all towards the end.
ChannelZero find_home(const Rig& rig, Backend& backend, const HomingSettings& settings);

/// Means over `duration_s` of every pressure channel that is there, the lines vented and the supply off: a mean near
/// the atmosphere is an absolute sensor, one near 0 a gauge. The safe output stands all the while. Throws
/// std::runtime_error naming the channel that shows neither, or gives no value.
std::vector<ChannelZero> find_pressure_zeros(const Rig& rig, Backend& backend, double duration_s, bool real_time);

}  // namespace pneuservo
