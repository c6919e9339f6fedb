// The gain and offset that the config knows of its sensors, taken out of what they show.
#pragma once
#include <algorithm>
#include <cmath>

#include <pneuservo/elements/sensor.hpp>
#include <pneuservo/hal/channel.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Effects `sensor_gain:CHANNEL` and `sensor_offset:CHANNEL` of the section `effects`; lags stay. All of it but
/// configure is HOT.
class SensorCorrection {
 public:
  void configure(const Rig& rig) noexcept {
    sensors_ = rig.sensor_effects;
    corrects_ = std::ranges::any_of(sensors_.all, [](const SensorEffects<double>& sensor) {
      return sensor.sensor_gain.gain != 1.0 || sensor.sensor_offset.offset != 0.0;
    });
  }
  /// Whether any reading is corrected.
  bool corrects() const noexcept { return corrects_; }
  /// In the channel's unit, as `reading` is.
  double of(Signal signal, double reading) const noexcept { return corrected(sensors_[signal], reading); }
  /// Noise and quantum of a corrected reading over those of the sensor.
  double noise_factor(Signal signal) const noexcept {
    const double gain = std::fabs(sensors_[signal].sensor_gain.gain);
    return gain > 0.0 ? 1.0 / gain : 1.0;
  }
  void correct(PerSignal<double>& readings) const noexcept {
    for (const Signal signal : all_signals) readings[signal] = of(signal, readings[signal]);
  }
  /// All but differences, whose sensors end at a range of their own: it is judged before.
  void correct_absolute(PerSignal<Channel>& channels) const noexcept {
    for (const Signal signal : all_signals)
      if (!is_difference(signal)) channels[signal].value = of(signal, channels[signal].value);
  }

 private:
  PerSignal<SensorEffects<double>> sensors_;
  bool corrects_ = false;
};

}  // namespace pneuservo
