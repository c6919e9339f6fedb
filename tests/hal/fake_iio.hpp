// A machine with devices of Industrial I/O in the place of libiio's: its functions, as the board calls them.
#pragma once
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <iio.h>
#include <sys/eventfd.h>
#include <unistd.h>

/// Bits of a sample, those that it is held in, and how many times.
inline iio_data_format format_of(unsigned bits, unsigned length, unsigned repeat) {
  iio_data_format format{};
  format.length = length;
  format.bits = bits;
  format.is_signed = true;
  format.repeat = repeat;
  return format;
}

struct iio_channel {
  std::string id;
  bool is_output = false;
  std::map<std::string, std::string> attributes{{"raw", "0"}, {"scale", "1000"}};
  iio_data_format format = format_of(16, 64, 1);
  std::size_t place = 0;  ///< in a scan
};

/// Its files are in a folder of the test, its scans wait in a queue; 64 of them, as the kernel keeps them.
struct iio_device {
  std::string id, name;
  std::vector<iio_channel> channels{};
  bool is_trigger = false;
  std::function<void()> on_wait{};
  std::deque<std::vector<std::int64_t>> waiting{};
  std::vector<std::int64_t> scan{};

  void push(std::vector<std::int64_t> values) {
    if (waiting.size() < 64) waiting.push_back(std::move(values));
  }
};

struct iio_buffer {
  iio_device* device = nullptr;
  int always = eventfd(1, EFD_CLOEXEC);  // wakes at once
};

struct iio_context {
  std::vector<iio_device> devices;
};

namespace fake_iio {

/// None: a machine without such devices.
inline iio_context* machine = nullptr;
inline iio_context empty;

/// Puts the machine up while it lives.
class Machine : public iio_context {
 public:
  explicit Machine(std::vector<iio_device> all) : iio_context{std::move(all)} {
    for (iio_device& device : devices)
      for (iio_channel& channel : device.channels) {
        channel.place = static_cast<std::size_t>(&channel - device.channels.data());
        for (const auto& [name, text] : channel.attributes) write(device, channel, name, text);
      }
    machine = this;
  }
  ~Machine() {
    machine = nullptr;
    std::filesystem::remove_all(folder_);
  }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  std::string folder() const { return folder_.string() + "/"; }
  std::filesystem::path file(const iio_device& device, const iio_channel& channel, const std::string& name) const {
    return folder_ / device.id / file_name(channel, name);
  }
  static std::string file_name(const iio_channel& channel, const std::string& name) {
    return (channel.is_output ? "out_" : "in_") + channel.id + "_" + name;
  }

 private:
  void write(const iio_device& device, const iio_channel& channel, const std::string& name, const std::string& text) {
    std::filesystem::create_directories(folder_ / device.id);
    std::ofstream(file(device, channel, name)) << text << "\n";
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("pneuservo-fake-iio-" + std::to_string(getpid()));
};

inline const std::string* attribute(const iio_channel* channel, const char* name) {
  const auto found = channel->attributes.find(name);
  return found == channel->attributes.end() ? nullptr : &found->second;
}

}  // namespace fake_iio

extern "C" {
iio_context* iio_create_local_context() { return fake_iio::machine != nullptr ? fake_iio::machine : &fake_iio::empty; }
void iio_context_destroy(iio_context*) {}
unsigned iio_context_get_devices_count(const iio_context* context) {
  return static_cast<unsigned>(context->devices.size());
}
iio_device* iio_context_get_device(const iio_context* context, unsigned i) {
  return const_cast<iio_device*>(&context->devices[i]);
}
const char* iio_device_get_name(const iio_device* device) { return device->name.c_str(); }
const char* iio_device_get_label(const iio_device*) { return nullptr; }
const char* iio_device_get_id(const iio_device* device) { return device->id.c_str(); }
bool iio_device_is_trigger(const iio_device* device) { return device->is_trigger; }
unsigned iio_device_get_channels_count(const iio_device* device) {
  return static_cast<unsigned>(device->channels.size());
}
iio_channel* iio_device_get_channel(const iio_device* device, unsigned i) {
  return const_cast<iio_channel*>(&device->channels[i]);
}
iio_channel* iio_device_find_channel(const iio_device* device, const char* name, bool is_output) {
  for (const iio_channel& channel : device->channels)
    if (channel.id == name && channel.is_output == is_output) return const_cast<iio_channel*>(&channel);
  return nullptr;
}
ssize_t iio_device_attr_write(const iio_device*, const char*, const char* text) {
  return static_cast<ssize_t>(std::strlen(text));
}
int iio_device_set_trigger(const iio_device*, const iio_device*) { return 0; }
int iio_device_set_kernel_buffers_count(const iio_device*, unsigned) { return 0; }
const char* iio_channel_get_id(const iio_channel* channel) { return channel->id.c_str(); }
bool iio_channel_is_output(const iio_channel* channel) { return channel->is_output; }
bool iio_channel_is_scan_element(const iio_channel*) { return true; }
iio_chan_type iio_channel_get_type(const iio_channel* channel) {
  return channel->id == "timestamp" ? IIO_TIMESTAMP : IIO_VOLTAGE;
}
const iio_data_format* iio_channel_get_data_format(const iio_channel* channel) { return &channel->format; }
const char* iio_channel_find_attr(const iio_channel* channel, const char* name) {
  return fake_iio::attribute(channel, name) != nullptr ? name : nullptr;
}
const char* iio_channel_attr_get_filename(const iio_channel* channel, const char* name) {
  static std::string file;
  return (file = fake_iio::Machine::file_name(*channel, name)).c_str();
}
int iio_channel_attr_read_double(const iio_channel* channel, const char* name, double* value) {
  const std::string* text = fake_iio::attribute(channel, name);
  if (text == nullptr) return -ENOENT;
  *value = std::strtod(text->c_str(), nullptr);
  return 0;
}
ssize_t iio_channel_attr_read(const iio_channel* channel, const char* name, char* place, size_t size) {
  const std::string* text = fake_iio::attribute(channel, name);
  if (text == nullptr) return -ENOENT;
  return static_cast<ssize_t>(text->copy(place, size));
}
void iio_channel_enable(iio_channel*) {}
void iio_channel_disable(iio_channel*) {}
void iio_channel_convert(const iio_channel* channel, void* value, const void* place) {
  std::memcpy(value, place, channel->format.length / 8);
}
iio_buffer* iio_device_create_buffer(const iio_device* device, size_t, bool) {
  return new iio_buffer{const_cast<iio_device*>(device)};
}
void iio_buffer_destroy(iio_buffer* buffer) {
  close(buffer->always);
  delete buffer;
}
int iio_buffer_set_blocking_mode(iio_buffer*, bool) { return 0; }
int iio_buffer_get_poll_fd(iio_buffer* buffer) {
  if (buffer->device->on_wait) buffer->device->on_wait();
  return buffer->always;
}
ssize_t iio_buffer_refill(iio_buffer* buffer) {
  if (buffer->device->waiting.empty()) return -EAGAIN;
  buffer->device->scan = std::move(buffer->device->waiting.front());
  buffer->device->waiting.pop_front();
  return 1;
}
void* iio_buffer_first(const iio_buffer* buffer, const iio_channel* channel) {
  return &buffer->device->scan[channel->place];
}
}
