// Devices of the kernel's Industrial I/O, found through libiio.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>

#include "analog/analog_board.hpp"

namespace pneuservo {

/// Where a channel is, as the config says. `V_per_count` is 0 where the driver states the scale.
struct IioPlace {
  std::string device, channel;
  double V_per_count = 0.0;
};

/// All channels of a config that are on such devices. Without a trigger each input is one reading of its file, in
/// order; with one, all inputs are those of the newest scan. Cold calls throw std::runtime_error with one sentence.
class IioBoard final : public AnalogBoard {
 public:
  /// Throws where the program was built without libiio or the kernel has no such device, too. `shared`: other programs
  /// may have the devices (pneuservo guard). `folder`: of the devices' files.
  explicit IioBoard(bool shared = false, std::string folder = "/sys/bus/iio/devices/");
  ~IioBoard() override;

  /// Each returns its number in the order of its kind. `key`: of the channel below hal.channels.
  std::size_t add_input(const std::string& key, const IioPlace& place);
  std::size_t add_output(const std::string& key, const IioPlace& place);
  /// After the last input: scans by this trigger, which shall come every `period_s`.
  void start_scans(const std::string& trigger, double period_s);
  /// After the last input: refuses inputs whose reading takes longer than a period.
  void time_readings(double period_s);

  /// Hot. Waits for the next scan of every device, at most `timeout_ns`; 0 samples: it did not come. Scans that were
  /// lost are counted by the trigger's period.
  Pace await_scan(std::int64_t timeout_ns) noexcept;
  /// With a trigger: of the scan that was awaited; without a wait since the last reading, of what has come since then.
  bool read() noexcept override;
  bool write() noexcept override;
  double volts(std::size_t input) const noexcept override;
  bool is_saturated(std::size_t input) const noexcept override;
  double age_s() const noexcept override;
  void set_volts(std::size_t output, double volts) noexcept override;
  double set_volts_of(std::size_t output) const noexcept override;

  std::vector<std::string> description() const override;

 private:
  struct Devices;
  std::unique_ptr<Devices> devices_;
};

/// "iio:device0 ad7606-8: inputs voltage0, voltage1; no outputs", a line for each device of this machine.
std::vector<std::string> iio_devices();

}  // namespace pneuservo
