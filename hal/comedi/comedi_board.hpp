// A DA/AD board through comedilib: all inputs in one call to the driver, all outputs in another.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/rig/hal_parameters.hpp>

#include "analog/analog_board.hpp"

namespace pneuservo {

/// The board of hal.comedi. Cold calls throw std::runtime_error.
class ComediBoard final : public AnalogBoard {
 public:
  /// Opens the device and reads its calibration. Throws where the program was built without comedilib, too, and where
  /// another process has the board, unless it is `shared` (pneuservo guard).
  explicit ComediBoard(const ComediParameters& parameters, bool shared = false);
  ~ComediBoard() override;

  /// Each returns its number in the order of its kind; the board's limits are checked.
  std::size_t add_input(const std::string& key, std::uint32_t channel, std::uint32_t range, ComediReference reference);
  std::size_t add_output(const std::string& key, std::uint32_t channel, std::uint32_t range, ComediReference reference);
  std::size_t add_counter(const std::string& key, std::uint32_t subdevice, std::uint32_t channel);

  /// The board's own watchdog, where hal.comedi.watchdog is `board`; else they do nothing.
  void arm_watchdog() override;
  void disarm_watchdog() noexcept override;
  bool feed_watchdog() noexcept override;

  bool read() noexcept override;
  bool write() noexcept override;
  double volts(std::size_t input) const noexcept override;
  bool is_saturated(std::size_t input) const noexcept override;
  void set_volts(std::size_t output, double volts) noexcept override;
  double set_volts_of(std::size_t output) const noexcept override;
  std::uint32_t counts(std::size_t counter) const noexcept override;
  std::uint32_t last_count(std::size_t counter) const noexcept override;

  /// "ni6221, PCI-6221; input 3: calibrated by ..., -10 to 10 V", a line each.
  std::vector<std::string> description() const override;

 private:
  struct Device;
  std::unique_ptr<Device> device_;
};

}  // namespace pneuservo
