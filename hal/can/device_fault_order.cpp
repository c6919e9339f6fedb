// Faults that the simulated device shows on command.
#include "can/device_fault_order.hpp"

#include <cstdlib>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/number_text.hpp"

namespace pneuservo {
namespace {

[[noreturn]] void refuse_order(const std::string& text, const std::string& found, const std::string& expected) {
  throw InputError(fmt::format("fault '{}': found {}, expected {}", text, found, expected));
}

double time_in(const std::string& text, const std::string& number) {
  const auto value = number_from_text(number);
  if (!value || !(*value >= 0.0)) refuse_order(text, "'" + number + "'", "a time in s, 0 or more");
  return *value;
}

/// A number, or an emergency code 0x5000.
double value_in(const std::string& text, const std::string& number) {
  if (number.starts_with("0x")) {
    char* end = nullptr;
    const unsigned long code = std::strtoul(number.c_str(), &end, 16);
    if (*end == '\0' && code <= 0xFFFF) return static_cast<double>(code);
  } else if (const auto value = number_from_text(number)) {
    return *value;
  }
  refuse_order(text, "'" + number + "'", "a number");
}

}  // namespace

DeviceFaultOrder parse_fault_order(const std::string& text, double now_s) {
  DeviceFaultOrder order;
  order.start_s = now_s;
  std::string what = text;
  if (const std::size_t at = text.find('@'); at != std::string::npos) {
    what = text.substr(0, at);
    std::string when = text.substr(at + 1);
    if (const std::size_t plus = when.find('+'); plus != std::string::npos) {
      order.duration_s = time_in(text, when.substr(plus + 1));
      when.resize(plus);
    }
    order.start_s = time_in(text, when);
  }
  const std::size_t first = what.find(':');
  const std::string name = what.substr(0, first);
  if (first != std::string::npos) {
    const std::size_t second = what.find(':', first + 1);
    order.target = what.substr(first + 1, second == std::string::npos ? second : second - first - 1);
    order.has_value = second != std::string::npos;
    if (order.has_value) order.value = value_in(text, what.substr(second + 1));
  }
  std::string known;
  for (std::size_t i = 0; i < device_fault_names.size(); ++i) {
    known += fmt::format("{}{}", known.empty() ? "" : ", ", device_fault_names[i].name);
    if (device_fault_names[i].name != name) continue;
    order.kind = static_cast<DeviceFaultKind>(i);
    const std::string_view target = device_fault_names[i].target;
    if (target.empty() != order.target.empty())
      refuse_order(text, order.target.empty() ? "no target" : "'" + order.target + "'",
                   target.empty() ? "no target" : fmt::format("the name of a {} after the colon", target));
    const bool needs_value = order.kind == DeviceFaultKind::bias || order.kind == DeviceFaultKind::spike;
    if (needs_value && !order.has_value) refuse_order(text, "no value", "KIND:CHANNEL:VALUE");
    return order;
  }
  refuse_order(text, "'" + name + "'", "one of " + known);
}

std::string fault_order_help() {
  std::string help = "Faults, KIND[:TARGET[:VALUE]][@START_S[+DURATION_S]]:\n";
  for (const DeviceFaultName& fault : device_fault_names)
    help += fmt::format("  {:<24} {}\n",
                        fault.target.empty() ? std::string(fault.name) : fmt::format("{}:{}", fault.name, fault.target),
                        fault.meaning);
  return help;
}

}  // namespace pneuservo
