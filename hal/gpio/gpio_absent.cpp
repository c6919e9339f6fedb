// What stands in for digital lines where the program was built without libgpiod: a refusal that says so.
#if !defined(PNEUSERVO_HAS_GPIO)
#include "gpio/gpio_lines.hpp"

#include <stdexcept>

namespace pneuservo {

std::unique_ptr<GpioLine> request_gpio_line(const std::string& key, const GpioLineParameters& parameters, bool) {
  throw std::runtime_error("hal.gpio." + key + ": line '" + parameters.line +
                           "': this program was built without libgpiod: install libgpiod-dev and build it again");
}

}  // namespace pneuservo

#endif
