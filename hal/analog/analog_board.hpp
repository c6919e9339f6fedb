// Analog inputs and outputs of a device in volts, as the backend of every such device sees them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pneuservo {

/// Inputs, outputs and counters are numbered in the order in which a derived class was given them. Hot but for what
/// throws and for the description.
class AnalogBoard {
 public:
  AnalogBoard() = default;
  virtual ~AnalogBoard() = default;
  AnalogBoard(const AnalogBoard&) = delete;
  AnalogBoard& operator=(const AnalogBoard&) = delete;

  /// Samples all inputs and counters. False: the driver refused.
  virtual bool read() noexcept = 0;
  /// Sets all outputs to what set_volts was given. False: the driver refused.
  virtual bool write() noexcept = 0;

  virtual double volts(std::size_t input) const noexcept = 0;
  /// The converter stands at its end: the voltage is that or any beyond.
  virtual bool is_saturated(std::size_t input) const noexcept = 0;
  /// From the sample to now.
  virtual double age_s() const noexcept { return 0.0; }
  /// Held within the output's range.
  virtual void set_volts(std::size_t output, double volts) noexcept = 0;
  /// What the output's code stands for.
  virtual double set_volts_of(std::size_t output) const noexcept = 0;
  virtual std::uint32_t counts(std::size_t) const noexcept { return 0; }
  /// Largest count, after which 0 comes.
  virtual std::uint32_t last_count(std::size_t) const noexcept { return 0; }

  /// The device's own watchdog, where it has one that is wanted. Arming throws.
  virtual void arm_watchdog() {}
  virtual void disarm_watchdog() noexcept {}
  /// False: the driver refused.
  virtual bool feed_watchdog() noexcept { return true; }

  /// What stands behind each input and output, a line each.
  virtual std::vector<std::string> description() const = 0;
};

}  // namespace pneuservo
