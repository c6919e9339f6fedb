// A serial line with a LAWICEL adapter behind it.
#include "can/slcan_line.hpp"

#include <array>
#include <cerrno>
#include <cmath>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <pneuservo/core/rt.hpp>

#include "can/canopen.hpp"
#include "can/socket_frames.hpp"
#include "device_lock.hpp"
#include "input_wait.hpp"

namespace pneuservo {
namespace {

/// The adapter's command S0 to S8.
constexpr std::array<double, 9> bit_rates{10e3, 20e3, 50e3, 100e3, 125e3, 250e3, 500e3, 800e3, 1e6};

std::size_t rate_number(const std::string& device, double bit_rate_bps) {
  for (std::size_t i = 0; i < bit_rates.size(); ++i)
    if (bit_rates[i] == bit_rate_bps) return i;
  throw std::runtime_error(fmt::format("slcan:{}: bit rate {:g}: expected 10000, 20000, 50000, 100000, 125000, 250000, "
                                       "500000, 800000 or 1000000",
                                       device, bit_rate_bps));
}

void make_raw(int file, const std::string& name) {
  termios settings{};
  if (tcgetattr(file, &settings) != 0) fail_with_errno(name, "no serial line");
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  cfsetspeed(&settings, B3000000);  // USB adapters ignore it; serial ones are at their highest
  if (tcsetattr(file, TCSANOW, &settings) != 0) fail_with_errno(name, "the line cannot be set up");
}

}  // namespace

SlcanLine::SlcanLine(const std::string& device, double bit_rate_bps) : device_(device) {
  const std::size_t rate = rate_number(device, bit_rate_bps);
  file_ = open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0) fail_with_errno(name(), "cannot be opened");
  try {
    lock_device(file_, name());
    ioctl(file_, TIOCEXCL);  // against programs that do not ask for the lock; where it is refused the lock stands
    make_raw(file_, name());
    const std::string commands = fmt::format("\rC\rS{}\rO\r", rate);
    if (!put(commands.data(), commands.size())) throw std::runtime_error(name() + ": the line takes no characters");
  } catch (...) {
    close(file_);
    throw;
  }
}

SlcanLine::~SlcanLine() {
  put("C\r", 2);
  close(file_);
}

void SlcanLine::wait(std::int64_t timeout_ns) {
  if (next_ == end_) wait_for_input(file_, timeout_ns);
}

bool SlcanLine::put(const char* text, std::size_t length) noexcept {
  const RtAllow reviewed;  // does not block
  return write(file_, text, length) == static_cast<ssize_t>(length);
}

bool SlcanLine::finish_started() noexcept {
  while (started_done_ < started_.length) {
    ssize_t put = 0;
    {
      const RtAllow reviewed;  // does not block
      put = write(file_, started_.text.data() + started_done_, started_.length - started_done_);
    }
    if (put <= 0) {
      if (put < 0 && errno != EAGAIN && errno != EINTR) up_ = false;
      return false;
    }
    started_done_ += static_cast<std::size_t>(put);
  }
  return true;
}

// A line that took half a frame gets the other half before anything else; a frame that was not begun is never kept.
Sent SlcanLine::send(const CanFrame& frame) noexcept {
  if (!up_) return Sent::down;
  if (!finish_started()) return up_ ? Sent::queue_full : Sent::down;
  started_ = slcan_text(frame);
  started_done_ = 0;
  if (finish_started()) return Sent::sent;
  if (started_done_ > 0) return Sent::sent;
  started_.length = 0;
  return up_ ? Sent::queue_full : Sent::down;
}

bool SlcanLine::fill() noexcept {
  ssize_t got = 0;
  {
    const RtAllow reviewed;  // does not block
    got = read(file_, input_.data(), input_.size());
  }
  if (got < 0 && errno != EAGAIN && errno != EINTR) up_ = false;
  next_ = 0;
  end_ = got > 0 ? static_cast<std::size_t>(got) : 0;
  return end_ > 0;
}

// One reading a call at most, and foreign frames count: text without frames must not hold the loop.
bool SlcanLine::receive(ReceivedFrame& received) noexcept {
  if (next_ == end_) fill();
  while (next_ < end_) {
    const auto line = lines_.add(input_[next_++]);
    if (!line || line->empty()) continue;
    // The adapter answers 'z' to each frame that it sent.
    const auto frame = slcan_frame(*line);
    if (!frame && *line != "z" && *line != "Z") ++garbled_;
    if (!frame) continue;
    received = {*frame, monotonic_ns()};
    return true;
  }
  return false;
}

std::int64_t SlcanLine::now_ns() noexcept { return monotonic_ns(); }

}  // namespace pneuservo
