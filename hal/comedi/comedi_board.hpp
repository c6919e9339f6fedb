// A DA/AD board through comedilib: all inputs in one call to the driver, all outputs in another.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/rig/hal_parameters.hpp>

namespace pneuservo {

/// The board of hal.comedi. Cold calls throw std::runtime_error; read and write are hot.
class ComediBoard {
 public:
  /// Opens the device and reads its calibration. Throws where the program was built without comedilib, too, and where
  /// another process has the board, unless it is `shared` (pneuservo guard).
  explicit ComediBoard(const ComediParameters& parameters, bool shared = false);
  ~ComediBoard();
  ComediBoard(const ComediBoard&) = delete;
  ComediBoard& operator=(const ComediBoard&) = delete;

  /// Each returns its number in the order of its kind; the board's limits are checked.
  std::size_t add_input(const std::string& key, std::uint32_t channel, std::uint32_t range, ComediReference reference);
  std::size_t add_output(const std::string& key, std::uint32_t channel, std::uint32_t range, ComediReference reference);
  std::size_t add_counter(const std::string& key, std::uint32_t subdevice, std::uint32_t channel);

  /// The board's own watchdog, where hal.comedi.watchdog is `board`; else they do nothing. Arming throws.
  void arm_watchdog();
  void disarm_watchdog() noexcept;
  /// Hot. False: the driver refused.
  bool feed_watchdog() noexcept;

  /// Samples all inputs and counters. False: the driver refused.
  bool read() noexcept;
  /// Sets all outputs to what set_volts was given. False: the driver refused.
  bool write() noexcept;

  double volts(std::size_t input) const noexcept;
  /// The converter stands at its end: the voltage is that or any beyond.
  bool is_saturated(std::size_t input) const noexcept;
  /// Held within the output's range.
  void set_volts(std::size_t output, double volts) noexcept;
  /// What the output's code stands for.
  double set_volts_of(std::size_t output) const noexcept;
  std::uint32_t counts(std::size_t counter) const noexcept;
  /// Largest count, after which 0 comes.
  std::uint32_t last_count(std::size_t counter) const noexcept;

  /// "ni6221, PCI-6221; input 3: calibrated by ..., -10 to 10 V", a line each.
  std::vector<std::string> description() const;

 private:
  struct Device;
  std::unique_ptr<Device> device_;
};

}  // namespace pneuservo
