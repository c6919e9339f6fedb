// Digital lines through libgpiod 2 (Debian 13); libgpiod_1.cpp speaks to version 1.
#if defined(PNEUSERVO_HAS_GPIO) && defined(PNEUSERVO_HAS_GPIOD_2)
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include <gpiod.h>
#include <poll.h>

#include <pneuservo/core/rt.hpp>

#include "gpio/chip_name.hpp"
#include "gpio/gpio_lines.hpp"
#include "gpio/line_refusal.hpp"

namespace pneuservo {
namespace {

constexpr std::size_t events_a_read = 16;
constexpr unsigned reads_a_call = 4;

/// One of the library's objects, freed by its own call.
template <auto Free> struct Freed {
  template <class T> void operator()(T* object) const noexcept { Free(object); }
};
using Chip = std::unique_ptr<gpiod_chip, Freed<gpiod_chip_close>>;
using ChipInfo = std::unique_ptr<gpiod_chip_info, Freed<gpiod_chip_info_free>>;
using Settings = std::unique_ptr<gpiod_line_settings, Freed<gpiod_line_settings_free>>;
using LineConfig = std::unique_ptr<gpiod_line_config, Freed<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, Freed<gpiod_request_config_free>>;
using Request = std::unique_ptr<gpiod_line_request, Freed<gpiod_line_request_release>>;
using Events = std::unique_ptr<gpiod_edge_event_buffer, Freed<gpiod_edge_event_buffer_free>>;
using LineInfo = std::unique_ptr<gpiod_line_info, Freed<gpiod_line_info_free>>;

class Libgpiod2Line final : public GpioLine {
 public:
  Libgpiod2Line(Request request, unsigned offset, Events events)
      : request_(std::move(request)), events_(std::move(events)), offset_(offset) {}

  std::optional<bool> read() noexcept override {
    const RtAllow reviewed;  // one ioctl
    const gpiod_line_value value = gpiod_line_request_get_value(request_.get(), offset_);
    if (value == GPIOD_LINE_VALUE_ERROR) return {};
    return value == GPIOD_LINE_VALUE_ACTIVE;
  }

  bool write(bool active) noexcept override {
    const RtAllow reviewed;  // one ioctl
    return gpiod_line_request_set_value(request_.get(), offset_,
                                        active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE) == 0;
  }

  Edges take_edges() noexcept override {
    Edges edges;
    if (!events_) return edges;
    const RtAllow reviewed;  // poll without waiting; the buffer was made with the request
    for (unsigned i = 0; i < reads_a_call; ++i) {
      pollfd waited{gpiod_line_request_get_fd(request_.get()), POLLIN, 0};
      if (poll(&waited, 1, 0) <= 0 || (waited.revents & POLLIN) == 0) break;
      const int got = gpiod_line_request_read_edge_events(request_.get(), events_.get(), events_a_read);
      for (int k = 0; k < got; ++k) {
        gpiod_edge_event* event = gpiod_edge_event_buffer_get_event(events_.get(), static_cast<unsigned long>(k));
        // The kernel turns edges round with active_low: rising is becoming active.
        edges.became_active =
            edges.became_active || gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE;
        edges.last_ns = static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event));
      }
      if (got < static_cast<int>(events_a_read)) break;
    }
    return edges;
  }

 private:
  Request request_;
  Events events_;
  unsigned offset_;
};

std::vector<std::filesystem::path> chip_paths(const std::string& chip) {
  if (is_chip_path(chip)) return {chip};
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator("/dev"))
    if (gpiod_is_gpiochip_device(entry.path().c_str())) paths.push_back(entry.path());
  std::ranges::sort(paths);
  return paths;
}

/// The chip of this path, name, number or label; without one the chip that has a line of this name.
Chip open_chip(const std::string& key, const GpioLineParameters& p) {
  int reason = ENOENT;
  for (const std::filesystem::path& path : chip_paths(p.chip)) {
    Chip chip(gpiod_chip_open(path.c_str()));
    const ChipInfo info(chip ? gpiod_chip_get_info(chip.get()) : nullptr);
    if (!info) {
      reason = errno;
      continue;
    }
    const bool is_meant = p.chip.empty()
                              ? gpiod_chip_get_line_offset_from_name(chip.get(), p.line.c_str()) >= 0
                              : is_chip_path(p.chip) || is_chip_named(p.chip, gpiod_chip_info_get_name(info.get()),
                                                                      gpiod_chip_info_get_label(info.get()));
    if (is_meant) return chip;
  }
  refuse_chip(key, p, reason);
}

unsigned offset_of(const std::string& key, const GpioLineParameters& p, gpiod_chip* chip) {
  const ChipInfo info(gpiod_chip_get_info(chip));
  const std::size_t lines = info ? gpiod_chip_info_get_num_lines(info.get()) : 0;
  const unsigned long offset =
      is_line_number(p) ? std::stoul(p.line)
                        : static_cast<unsigned long>(gpiod_chip_get_line_offset_from_name(chip, p.line.c_str()));
  if (offset >= lines) refuse_line(key, p, "the chip has no such line (see gpioinfo)");
  return static_cast<unsigned>(offset);
}

Settings settings_of(const GpioLineParameters& p, bool is_output) {
  Settings settings(gpiod_line_settings_new());
  if (!settings) throw std::bad_alloc();
  gpiod_line_settings_set_active_low(settings.get(), p.active_low);
  gpiod_line_settings_set_direction(settings.get(),
                                    is_output ? GPIOD_LINE_DIRECTION_OUTPUT : GPIOD_LINE_DIRECTION_INPUT);
  if (is_output) return settings;
  gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
  switch (p.bias) {
    case GpioBias::as_is: break;
    case GpioBias::none: gpiod_line_settings_set_bias(settings.get(), GPIOD_LINE_BIAS_DISABLED); break;
    case GpioBias::pull_up: gpiod_line_settings_set_bias(settings.get(), GPIOD_LINE_BIAS_PULL_UP); break;
    case GpioBias::pull_down: gpiod_line_settings_set_bias(settings.get(), GPIOD_LINE_BIAS_PULL_DOWN); break;
  }
  return settings;
}

}  // namespace

std::unique_ptr<GpioLine> request_gpio_line(const std::string& key, const GpioLineParameters& p, bool is_output) {
  const Chip chip = open_chip(key, p);
  const unsigned offset = offset_of(key, p, chip.get());
  const Settings settings = settings_of(p, is_output);
  const LineConfig lines(gpiod_line_config_new());
  const RequestConfig config(gpiod_request_config_new());
  Events events(is_output ? nullptr : gpiod_edge_event_buffer_new(events_a_read));
  if (!lines || !config || (!is_output && !events)) throw std::bad_alloc();
  gpiod_request_config_set_consumer(config.get(), ("pneuservo " + key).c_str());
  const bool is_described = gpiod_line_config_add_line_settings(lines.get(), &offset, 1, settings.get()) == 0;
  Request request(is_described ? gpiod_chip_request_lines(chip.get(), config.get(), lines.get()) : nullptr);
  if (!request) {
    const int reason = errno;
    const LineInfo info(gpiod_chip_get_line_info(chip.get(), offset));
    refuse_request(key, p, is_output, reason, info ? gpiod_line_info_get_consumer(info.get()) : nullptr);
  }
  return std::make_unique<Libgpiod2Line>(std::move(request), offset, std::move(events));
}

}  // namespace pneuservo

#endif
