// Triggered buffer of one device of the kernel's Industrial I/O: its newest scan.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

struct iio_buffer;
struct iio_channel;
struct iio_device;

namespace pneuservo {

/// The inputs of one device as its trigger samples them. Cold calls throw std::runtime_error with one sentence.
class IioScan {
 public:
  /// Switches the device's buffer on. `name`: of the device in errors.
  IioScan(iio_device* device, std::string name, const iio_device* trigger, std::vector<const iio_channel*> inputs);
  ~IioScan();
  IioScan(const IioScan&) = delete;
  IioScan& operator=(const IioScan&) = delete;

  /// Hot. Takes all waiting scans, keeps the newest; their number. Does not wait.
  std::int64_t take() noexcept;
  /// Hot. Waits for a scan, or until CLOCK_MONOTONIC is `end_ns`.
  void wait(std::int64_t end_ns) const noexcept;
  /// Of the newest scan, in the order of the inputs.
  double code(std::size_t input) const noexcept { return codes_[input]; }
  /// When it was sampled, CLOCK_MONOTONIC.
  std::int64_t at_ns() const noexcept { return at_ns_; }
  const std::string& name() const noexcept { return name_; }
  /// The device stamps its scans.
  bool is_stamped() const noexcept { return stamp_ != nullptr; }

 private:
  void switch_on(const iio_device* trigger);
  void keep() noexcept;

  iio_device* device_;
  std::string name_;
  std::vector<const iio_channel*> inputs_;
  std::vector<double> codes_;
  const iio_channel* stamp_ = nullptr;
  iio_buffer* buffer_ = nullptr;
  std::int64_t at_ns_ = 0;
};

}  // namespace pneuservo
