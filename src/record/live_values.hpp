// Live values of a run as JSON over UDP, for plot programs such as PlotJuggler: sent by the recording's thread, never
// read.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/record/row.hpp>

namespace pneuservo {

/// One datagram a send interval, `{"t_s": 1.25, "x_m": 0.0123, ...}`: the columns of the recording that have a value.
/// The socket is connected and never read: there is no way in. Nobody listening, or a full network, loses datagrams and
/// nothing else.
class LiveValues {
 public:
  static constexpr double send_interval_s = 0.01;

  /// `address`: PORT on the loopback, or HOST:PORT with the host as a number. Throws InputError.
  LiveValues(const std::string& address, const std::vector<std::string>& columns,
             std::span<const std::string_view> terms = {});
  ~LiveValues();
  LiveValues(const LiveValues&) = delete;
  LiveValues& operator=(const LiveValues&) = delete;

  /// Sends the row unless one was sent less than an interval of the run before; rows with a new fault always.
  void send(const Row& row);

 private:
  int socket_ = -1;
  std::vector<std::string> columns_;
  std::span<const std::string_view> terms_;
  std::string text_;
  double next_s_ = 0.0;
  std::uint64_t fault_ = 0;
};

}  // namespace pneuservo
