// Triggered buffer of one device of the kernel's Industrial I/O.
#if defined(PNEUSERVO_HAS_IIO)
#include "iio/iio_scan.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <iio.h>

#include <pneuservo/core/rt.hpp>

#include "input_wait.hpp"

namespace pneuservo {
namespace {

// What the kernel keeps while the loop is late; when it is full, the newest scans are lost.
constexpr unsigned kept_scans = 64;
// Of one take: a trigger that is faster than the reading would hold the loop.
constexpr unsigned most_taken = 2 * kept_scans;

std::int64_t value_of(const iio_channel* channel, const void* place) noexcept {
  const iio_data_format* format = iio_channel_get_data_format(channel);
  const unsigned bytes = format->length / 8;
  std::int64_t value = 0;
  iio_channel_convert(channel, &value, place);  // byte order, shift, and the sign within `bytes`
  if (!format->is_signed || bytes == sizeof value) return value;
  const unsigned unused = 64 - 8 * bytes;
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(value) << unused) >> unused;
}

}  // namespace

bool is_one_number(const iio_channel* channel) {
  const iio_data_format* format = iio_channel_get_data_format(channel);
  return format->repeat <= 1 && format->length <= 64;
}

IioScan::IioScan(iio_device* device, std::string name, const iio_device* trigger,
                 std::vector<const iio_channel*> inputs)
    : device_(device), name_(std::move(name)), inputs_(std::move(inputs)), codes_(inputs_.size()) {
  for (unsigned i = 0; i < iio_device_get_channels_count(device); ++i)
    iio_channel_disable(iio_device_get_channel(device, i));
  for (const iio_channel* input : inputs_) iio_channel_enable(const_cast<iio_channel*>(input));
  iio_channel* stamp = iio_device_find_channel(device, "timestamp", false);
  if (stamp != nullptr && is_one_number(stamp) &&
      iio_device_attr_write(device, "current_timestamp_clock", "monotonic") >= 0) {
    iio_channel_enable(stamp);
    stamp_ = stamp;
  }
  switch_on(trigger);
}

void IioScan::switch_on(const iio_device* trigger) {
  const char* wanted = iio_device_get_name(trigger);
  const auto refuse = [&](const std::string& what, int error, const std::string& remedy) {
    throw std::runtime_error(fmt::format("{}: hal.iio.trigger: found {}: {}; expected scans by trigger '{}': {}", name_,
                                         what, std::strerror(-error), wanted, remedy));
  };
  const std::string other = "end the program that has its buffer, or leave hal.iio.trigger out";
  if (const int error = iio_device_set_trigger(device_, trigger); error < 0)
    refuse("a device that refuses the trigger", error, other);
  // One scan a reading, since libiio wakes by whole readings; the kernel keeps so many of them.
  if (const int error = iio_device_set_kernel_buffers_count(device_, kept_scans); error < 0)
    refuse("a buffer whose length cannot be set", error, other);
  buffer_ = iio_device_create_buffer(device_, 1, false);
  if (buffer_ == nullptr) refuse("a buffer that cannot be switched on", -errno, other);
  if (const int error = iio_buffer_set_blocking_mode(buffer_, false); error < 0) {
    iio_buffer_destroy(buffer_);
    refuse("a buffer that cannot be read without waiting", error, "leave hal.iio.trigger out");
  }
}

IioScan::~IioScan() { iio_buffer_destroy(buffer_); }

void IioScan::keep() noexcept {
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    codes_[i] = static_cast<double>(value_of(inputs_[i], iio_buffer_first(buffer_, inputs_[i])));
  at_ns_ = stamp_ != nullptr ? value_of(stamp_, iio_buffer_first(buffer_, stamp_)) : monotonic_ns();
}

std::int64_t IioScan::take() noexcept {
  const RtAllow reviewed;  // non-blocking reads of the buffer's file
  std::int64_t scans = 0;
  for (; scans < most_taken && iio_buffer_refill(buffer_) > 0; ++scans) keep();
  was_full_ = scans >= kept_scans;
  return scans;
}

void IioScan::wait(std::int64_t end_ns) const noexcept {
  const RtAllow reviewed;
  wait_for_input(iio_buffer_get_poll_fd(buffer_), std::max<std::int64_t>(end_ns - monotonic_ns(), 0));
}

}  // namespace pneuservo

#endif
