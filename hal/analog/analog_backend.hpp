// What the backends of analog devices share: scaling, limits, readback, safe output.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

#include "analog/analog_board.hpp"
#include "analog/running_count.hpp"

namespace pneuservo {

/// Inputs are sampled at the start of the tick, outputs are set at its end. A sample at the end of the converter's
/// range or outside the channel's limits is invalid. An output whose readback deviates, or cannot be read, for three
/// ticks is a fault.
class AnalogBackend : public Backend {
 public:
  ~AnalogBackend() override { AnalogBackend::deactivate(); }

  /// Opens the board, checks its channels. Throws std::runtime_error.
  void configure() override;
  /// Sets the safe output.
  void activate() override;
  bool read(std::int64_t tick, Measurement& measurement) noexcept override;
  bool write(std::int64_t tick, const Command& command) noexcept override;
  void deactivate() noexcept override;
  bool emergency_write() noexcept override { return !board_ || !active_ || set_outputs(safe_commands()); }
  Origins origins() const override;
  SafeOutput safe_output() const override { return safe_output_; }
  std::vector<std::string> notes() const override;
  std::string name() const override { return name_; }

 protected:
  /// An input or counter.
  struct Input {
    Signal signal = Signal::x;
    std::size_t number = 0;
    double scale = 1.0, zero = 0.0, lowest = 0.0, highest = 0.0;
    bool is_counter = false;
    RunningCount count{};
  };
  /// An output. `command` counts as in Command.
  struct Output {
    std::size_t command = 0, number = 0, readback = 0;
    double scale = 1.0, zero = 0.0, lowest = 0.0, highest = 0.0, tolerance_V = 0.0;
    bool is_read_back = false;
    int deviates = 0;  ///< ticks in a row
    double worst_V = 0.0;
  };

  /// `name`: in front of its notes. `device`: in front of its errors.
  AnalogBackend(const Rig& rig, std::string name, std::string device)
      : rig_(rig), name_(std::move(name)), device_(std::move(device)) {}
  /// Opens the board and fills inputs_ and outputs_ with what the config has on it.
  virtual std::unique_ptr<AnalogBoard> open() = 0;
  /// The part of an output that every kind of channel has.
  template <class Channel> static Output output_of(std::size_t command, std::size_t number, const Channel& channel) {
    Output output{command, number};
    output.scale = channel.scale;
    output.zero = channel.zero;
    output.lowest = channel.lowest;
    output.highest = channel.highest;
    return output;
  }

  Rig rig_;
  std::vector<Input> inputs_;
  std::vector<Output> outputs_;

 private:
  double value_of(Input& input) noexcept;
  /// True: every output was read back as it was set. Not `sampled`: none was.
  bool check_outputs(bool sampled) noexcept;
  Command safe_commands() const noexcept;
  bool set_outputs(const Command& command) noexcept;

  std::string name_, device_;
  std::unique_ptr<AnalogBoard> board_;
  std::vector<std::string> description_;
  std::uint64_t saturated_ = 0, out_of_limits_ = 0, refused_ = 0;
  SafeOutput safe_output_;
  bool active_ = false, written_ = false, output_fails_ = false, ended_ = false;
};

}  // namespace pneuservo
