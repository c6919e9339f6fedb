// A sensor: y = quantise(gain * lag(x) + offset + noise), the nearest multiple of the quantum, within its range.
#pragma once
#include <algorithm>
#include <cmath>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/effects.hpp>

namespace pneuservo {

/// Nearest multiple of the quantum; quantum 0: the value itself.
inline double quantise(double value, double quantum) noexcept {
  return quantum > 0.0 ? std::nearbyint(value / quantum) * quantum : value;
}

/// What the sensor has seen where it shows `reading`, but for its lag. One of gain 0 shows nothing of it: the reading.
inline double corrected(const SensorEffects<double>& sensor, double reading) noexcept {
  const double gain = sensor.sensor_gain.gain;
  return gain != 0.0 ? (reading - sensor.sensor_offset.offset) / gain : reading;
}

/// The effects that are left behind `corrected`.
inline SensorEffects<double> behind_correction(const SensorEffects<double>& sensor) noexcept {
  SensorEffects<double> left;
  left.sensor_lag = sensor.sensor_lag;
  if (sensor.sensor_gain.gain == 0.0) left = sensor;
  return left;
}

/// First-order lag, exact for an input that is linear between samples.
class SensorLagFilter {
 public:
  void configure(double time_constant_s, double period_s) noexcept {
    active_ = time_constant_s > 0.0;
    if (!active_) return;
    const double ratio = period_s / time_constant_s;
    decay_ = std::exp(-ratio);
    new_share_ = 1.0 - (1.0 - decay_) / ratio;       // weight of the new sample
    old_share_ = (1.0 - decay_) / ratio - decay_;    // weight of the old sample
  }
  void reset(double value) noexcept { state_ = last_ = value; }
  /// Output `state` now while the input has just jumped to `input`.
  void reset(double state, double input) noexcept {
    state_ = state;
    last_ = input;
  }
  double step(double value) noexcept {
    if (!active_) return value;
    state_ = decay_ * state_ + old_share_ * last_ + new_share_ * value;
    last_ = value;
    return state_;
  }

 private:
  bool active_ = false;
  double decay_ = 0.0, new_share_ = 1.0, old_share_ = 0.0;
  double state_ = 0.0, last_ = 0.0;
};

/// One channel; noise is white and normal, in the channel's unit.
class Sensor {
 public:
  /// `range`: it shows this much at most, to both sides.
  void configure(const SensorEffects<double>& effects, double quantum, double noise, double period_s,
                 const Random& random, double range = infinite) noexcept {
    effects_ = effects;
    quantum_ = quantum;
    noise_ = noise;
    range_ = range;
    random_ = random;
    lag_.configure(effects.sensor_lag.time_constant_s, period_s);
  }
  /// The sensor has seen `value` for ever.
  void reset(double value) noexcept { lag_.reset(value); }
  /// Reading of the true value; call once a sample.
  double read(double value) noexcept {
    const double noise = noise_ > 0.0 ? noise_ * random_.normal() : 0.0;
    const double shown = effects_.sensor_gain.gain * lag_.step(value) + effects_.sensor_offset.offset + noise;
    return std::clamp(quantise(shown, quantum_), -range_, range_);
  }

 private:
  SensorEffects<double> effects_;
  double quantum_ = 0.0, noise_ = 0.0, range_ = infinite;
  Random random_;
  SensorLagFilter lag_;
};

}  // namespace pneuservo
