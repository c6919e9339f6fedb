// The last step of every command: range and rate, and which of them acted.
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

namespace pneuservo {

/// Bits that say which limit the command met; 0: none.
enum CommandLimit : std::uint8_t {
  limit_none = 0,
  limit_upper = 1,      ///< at +command_max_V
  limit_lower = 2,      ///< at -command_max_V
  limit_rate_up = 4,    ///< rises at command_rate_V_per_s
  limit_rate_down = 8,  ///< falls at command_rate_V_per_s
};
inline constexpr std::uint8_t limits_upward = limit_upper | limit_rate_up;
inline constexpr std::uint8_t limits_downward = limit_lower | limit_rate_down;

/// Limits a command to +-command_max_V and, from one call to the next, to command_rate_V_per_s. HOT.
class CommandLimiter {
 public:
  struct Result {
    double command_V;
    std::uint8_t limit;  ///< the CommandLimit that binds, limit_none if the command passes unchanged
  };

  CommandLimiter() noexcept = default;
  /// command_max_V > 0; command_rate_V_per_s > 0, infinity for none; period_s > 0.
  CommandLimiter(double command_max_V, double command_rate_V_per_s, double period_s) noexcept
      : maximum_V_(command_max_V), step_V_(command_rate_V_per_s * period_s) {}

  /// What would come out; nothing is remembered. The command must be finite.
  Result preview(double command_V) const noexcept {
    const double high = std::min(maximum_V_, previous_V_ + step_V_), low = std::max(-maximum_V_, previous_V_ - step_V_);
    if (command_V > high) return {high, high == maximum_V_ ? limit_upper : limit_rate_up};
    if (command_V < low) return {low, low == -maximum_V_ ? limit_lower : limit_rate_down};
    return {command_V, limit_none};
  }
  /// Limits and remembers the output for the rate.
  Result limit(double command_V) noexcept {
    const Result result = preview(command_V);
    previous_V_ = result.command_V;
    return result;
  }
  /// The output from which the rate counts, held to the range.
  void reset(double previous_V) noexcept { previous_V_ = std::clamp(previous_V, -maximum_V_, maximum_V_); }
  double previous_V() const noexcept { return previous_V_; }

 private:
  double maximum_V_ = std::numeric_limits<double>::infinity();
  double step_V_ = std::numeric_limits<double>::infinity();
  double previous_V_ = 0.0;
};

}  // namespace pneuservo
