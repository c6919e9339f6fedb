// Digital lines through libgpiod 1.x (Debian 12); libgpiod_2.cpp speaks to version 2.
#if defined(PNEUSERVO_HAS_GPIO) && !defined(PNEUSERVO_HAS_GPIOD_2)
#include "gpio/gpio_lines.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <gpiod.h>
#include <poll.h>

#include <pneuservo/core/rt.hpp>

#include "gpio/line_refusal.hpp"

namespace pneuservo {
namespace {

constexpr unsigned events_a_read = 16, reads_a_call = 4;

struct ChipCloser {
  void operator()(gpiod_chip* chip) const noexcept { gpiod_chip_close(chip); }
};
using Chip = std::unique_ptr<gpiod_chip, ChipCloser>;

class LibgpiodLine final : public GpioLine {
 public:
  LibgpiodLine(Chip chip, gpiod_line* line, int events) : chip_(std::move(chip)), line_(line), events_(events) {}
  ~LibgpiodLine() override { gpiod_line_release(line_); }
  LibgpiodLine(const LibgpiodLine&) = delete;
  LibgpiodLine& operator=(const LibgpiodLine&) = delete;

  std::optional<bool> read() noexcept override {
    const RtAllow reviewed;  // one ioctl
    const int value = gpiod_line_get_value(line_);
    if (value < 0) return {};
    return value == 1;
  }

  bool write(bool active) noexcept override {
    const RtAllow reviewed;  // one ioctl
    return gpiod_line_set_value(line_, active ? 1 : 0) == 0;
  }

  Edges take_edges() noexcept override {
    Edges edges;
    if (events_ < 0) return edges;
    const RtAllow reviewed;  // poll without waiting; read only where something is there
    for (unsigned i = 0; i < reads_a_call; ++i) {
      pollfd waited{events_, POLLIN, 0};
      if (poll(&waited, 1, 0) <= 0 || (waited.revents & POLLIN) == 0) break;
      gpiod_line_event events[events_a_read];
      const int got = gpiod_line_event_read_fd_multiple(events_, events, events_a_read);
      for (int k = 0; k < got; ++k) {
        // The kernel turns edges round with active_low: rising is becoming active.
        edges.became_active = edges.became_active || events[k].event_type == GPIOD_LINE_EVENT_RISING_EDGE;
        edges.last_ns = static_cast<std::int64_t>(events[k].ts.tv_sec) * 1'000'000'000 + events[k].ts.tv_nsec;
      }
      if (got < static_cast<int>(events_a_read)) break;
    }
    return edges;
  }

 private:
  Chip chip_;
  gpiod_line* line_;
  int events_;
};

Chip open_chip(const std::string& key, const GpioLineParameters& p) {
  if (!p.chip.empty()) {
    Chip chip(gpiod_chip_open_lookup(p.chip.c_str()));
    if (!chip) refuse_chip(key, p, errno);
    return chip;
  }
  char name[64];
  unsigned offset = 0;
  if (gpiod_ctxless_find_line(p.line.c_str(), name, sizeof name, &offset) != 1) refuse_chip(key, p, errno);
  Chip chip(gpiod_chip_open_lookup(name));
  if (!chip) refuse_line(key, p, std::string("its chip cannot be opened: ") + std::strerror(errno));
  return chip;
}

int flags_of(const GpioLineParameters& p, bool is_output) {
  int flags = p.active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
  if (is_output) return flags;
  switch (p.bias) {
    case GpioBias::as_is: break;
    case GpioBias::none: flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE; break;
    case GpioBias::pull_up: flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP; break;
    case GpioBias::pull_down: flags |= GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN; break;
  }
  return flags;
}

}  // namespace

std::unique_ptr<GpioLine> request_gpio_line(const std::string& key, const GpioLineParameters& p, bool is_output) {
  Chip chip = open_chip(key, p);
  gpiod_line* line = is_line_number(p) ? gpiod_chip_get_line(chip.get(), static_cast<unsigned>(std::stoul(p.line)))
                                       : gpiod_chip_find_line(chip.get(), p.line.c_str());
  if (line == nullptr) refuse_line(key, p, "the chip has no such line (see gpioinfo)");
  const std::string consumer = "pneuservo " + key;
  const gpiod_line_request_config request{.consumer = consumer.c_str(),
                                          .request_type = is_output ? GPIOD_LINE_REQUEST_DIRECTION_OUTPUT
                                                                    : GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES,
                                          .flags = flags_of(p, is_output)};
  if (gpiod_line_request(line, &request, 0) != 0) {
    const int reason = errno;
    const char* user = reason == EBUSY && gpiod_line_update(line) == 0 ? gpiod_line_consumer(line) : nullptr;
    refuse_request(key, p, is_output, reason, user);
  }
  return std::make_unique<LibgpiodLine>(std::move(chip), line, is_output ? -1 : gpiod_line_event_get_fd(line));
}

}  // namespace pneuservo

#endif
