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
  double timeout_s = 60.0;  ///< for each of both ways
  bool real_time = false;   ///< on the machine's clock; else as fast as it goes
  static constexpr double usual_share = 0.02;
  static constexpr double fastest_mps = 0.2;  ///< or limits.speed_mps where that is less
  static constexpr double ramp_s = 0.5, standing_s = 1.0;
  static constexpr double standing_m = 2e-4;  ///< less way than this in standing_s is standing
  static constexpr double wrong_way_m = 3e-3;  ///< from where it stood, against the push
  /// The way between both stops may differ by this much of the stroke: what drawings and cushions leave open.
  static constexpr double stroke_tolerance = 0.02;
  /// At a stop the air pushes with this share of what the supply can before the end is believed: more than a cylinder's
  /// dry friction, a tenth at the most, and little for what may be in the way.
  static constexpr double pushing_share = 0.2;
};

/// What is to be added to a channel, and from what it follows.
struct ChannelZero {
  std::string channel;
  double zero = 0.0;  ///< in the channel's unit
  std::string what;  ///< e.g. "absolute", "gauge", "low end at 0.1234 m"
};

/// Drives the slider to the end stop with a steady small command, under the supervisor (speed, pressures, emergency
/// stop, devices; position range, frozen encoder and cross-checks mean nothing before the zero is known). An end is
/// believed where the slider stands for standing_s while the air pushes there; then it drives to the other end, and the
/// way between must be cylinder.stroke_m. A limit switch of the config confirms its end instead of the second way. The
/// safe output stands at the end, however it ends. Throws std::runtime_error with what speaks against it: a fault, the
/// wrong direction, a standstill without force (frozen encoder), force to the wrong side, another way than the stroke
/// (obstacle, scale), no rest in time.
ChannelZero find_home(const Rig& rig, Backend& backend, const HomingSettings& settings);

/// Means over `duration_s` of every pressure channel that is there, the lines vented and the supply off: a mean near
/// the atmosphere is an absolute sensor, one near 0 a gauge. The safe output stands all the while. Throws
/// std::runtime_error naming the channel that shows neither, or gives no value.
std::vector<ChannelZero> find_pressure_zeros(const Rig& rig, Backend& backend, double duration_s, bool real_time);

/// A sensor of either kind may be off by so much before it counts as broken.
inline constexpr double sensor_tolerance_Pa = 20e3;

}  // namespace pneuservo
