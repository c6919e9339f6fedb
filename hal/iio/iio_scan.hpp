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

/// Scans of it are numbers that fit one word: neither vectors nor more than 64 bits.
bool is_one_number(const iio_channel* channel);

/// The inputs of one device as its trigger samples them. Cold calls throw std::runtime_error with one sentence.
class IioScan {
 public:
  /// Switches the device's buffer on. `name`: of the device in errors. Each input is one number.
  IioScan(iio_device* device, std::string name, const iio_device* trigger, std::vector<const iio_channel*> inputs);
  ~IioScan();
  IioScan(const IioScan&) = delete;
  IioScan& operator=(const IioScan&) = delete;

  /// Hot. Takes all waiting scans, keeps the newest; their number. Does not wait.
  std::int64_t take() noexcept;
  /// What the last take found was a full buffer: the kernel has dropped what came after it.
  bool was_full() const noexcept { return was_full_; }
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
  bool was_full_ = false;
};

}  // namespace pneuservo
