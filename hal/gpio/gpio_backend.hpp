// Backend `gpio`: a rig's digital lines.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

#include "gpio/gpio_lines.hpp"

namespace pneuservo {

/// Inputs are read at the start of a tick, with the kernel's stamp of their last edge. An emergency stop that was
/// pressed and let go between two ticks counts as pressed in the second. The enable output is off until the axis is
/// active, and off again with the first fault and at the end. Coils of on/off valves that the config puts on lines have
/// power while their output is above half of it.
class GpioBackend final : public Backend {
 public:
  using Requester =
      std::function<std::unique_ptr<GpioLine>(const std::string& key, const GpioLineParameters& line, bool is_output)>;
  /// The rig must have hal.gpio. `request`: what gives the lines.
  explicit GpioBackend(const Rig& rig, Requester request = request_gpio_line);
  ~GpioBackend() override { deactivate(); }

  /// Requests every line once. Throws std::runtime_error.
  void configure() override;
  /// The safe output.
  void activate() override;
  bool read(std::int64_t tick, Measurement& measurement) noexcept override;
  bool write(std::int64_t tick, const Command& command) noexcept override;
  /// Enable off; all lines released.
  void deactivate() noexcept override;
  bool emergency_write() noexcept override;
  Origins origins() const override;
  SafeOutput safe_output() const override { return safe_output_; }
  std::vector<std::string> notes() const override;
  std::string name() const override { return "gpio"; }

 private:
  struct Input {
    std::unique_ptr<GpioLine> line;
    std::int64_t edge_ns = 0;
    std::uint64_t edges = 0;  // ticks that found one
    bool is_unreadable = false;
  };

  struct Coil {
    std::size_t output = 0;  // in the order of outputs_V
    std::unique_ptr<GpioLine> line;
    bool has_power = false;
  };

  bool set_enable(bool active) noexcept;
  bool gives_power(double output_V) const noexcept;
  bool set_coils(const std::array<double, 2>& outputs_V) noexcept;

  Rig rig_;
  GpioParameters parameters_;
  Requester request_;
  std::array<Input, digital_line_count> inputs_;  // in the order of lines_of
  std::unique_ptr<GpioLine> enable_;
  bool enabled_ = false;
  std::vector<Coil> coils_;
  SafeOutput safe_output_;
};

}  // namespace pneuservo
