// A backend for tests: the simulated plant behind channels that fail on demand; it keeps what the valve got.
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <pneuservo/hal/backend.hpp>

#include "sim/sim_backend.hpp"

namespace pneuservo {

enum class FailureMode { dropped_out, not_a_number, frozen, jumped, out_of_range };

/// From tick `first` on for `ticks` ticks the channel fails.
struct Failure {
  Signal signal = Signal::x;
  FailureMode mode = FailureMode::dropped_out;
  std::int64_t first = std::numeric_limits<std::int64_t>::max(), ticks = 0;
  double jump = 0.0;  ///< FailureMode::jumped adds it
};

class FaultyBackend final : public Backend {
 public:
  explicit FaultyBackend(const Rig& rig) : plant_(rig) {}
  Failure failure;
  std::int64_t fails_to_write_at = -1;
  std::vector<double> commands_V;  ///< of every write, in order
  bool active = false;

  void configure() override { plant_.configure(); }
  void activate() override {
    plant_.activate();
    active = true;
  }
  bool read(std::int64_t tick, Measurement& measurement) noexcept override {
    plant_.read(tick, measurement);
    Channel& channel = measurement.channel[failure.signal];
    if (tick >= failure.first && tick - failure.first < failure.ticks) spoil(channel);
    else kept_ = channel.value;
    return true;
  }
  bool write(std::int64_t tick, const Command& command) noexcept override {
    if (tick == fails_to_write_at) return false;
    commands_V.push_back(command.valve_V);
    return plant_.write(tick, command);
  }
  void deactivate() noexcept override {
    plant_.deactivate();
    active = false;
  }
  Truth truth() const noexcept override { return plant_.truth(); }
  Origins origins() const override { return plant_.origins(); }
  std::string name() const override { return "sim"; }

 private:
  void spoil(Channel& channel) const noexcept {
    const bool position = failure.signal == Signal::x;
    switch (failure.mode) {
      case FailureMode::dropped_out: channel.valid = false; break;
      case FailureMode::not_a_number: channel.value = std::nan(""); break;
      case FailureMode::frozen: channel.value = kept_; break;
      case FailureMode::jumped: channel.value += failure.jump; break;
      case FailureMode::out_of_range: channel.value = position ? 1.0 : 2e6; break;
    }
  }
  SimBackend plant_;
  double kept_ = 0.0;
};

}  // namespace pneuservo
