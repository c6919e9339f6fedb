// The narrow interface to digital lines, so that one file speaks to one version of libgpiod.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <pneuservo/rig/hal_parameters.hpp>

namespace pneuservo {

/// One requested line. Released when it is destroyed; what an output's level is then, the chip decides.
class GpioLine {
 public:
  virtual ~GpioLine() = default;

  /// Active or not, after active_low; nothing where the line cannot be read. Hot: one system call that does not block.
  virtual std::optional<bool> read() noexcept = 0;
  /// False: refused. Hot.
  virtual bool write(bool active) noexcept = 0;

  /// What the edges since the last call were.
  struct Edges {
    bool became_active = false;  ///< at least once
    std::int64_t last_ns = 0;  ///< kernel's stamp of the last one, CLOCK_MONOTONIC; 0: none came
  };
  /// Hot: at most 64 edges a call, the rest with the next one; a bouncing switch must not hold the loop.
  virtual Edges take_edges() noexcept = 0;
};

/// Requests a line as an input with edge detection, or as an inactive output. `key` ("emergency_stop") goes into the
/// consumer's name that gpioinfo shows. Throws std::runtime_error: which line, what is wrong, who has it.
std::unique_ptr<GpioLine> request_gpio_line(const std::string& key, const GpioLineParameters& parameters,
                                            bool is_output);

}  // namespace pneuservo
