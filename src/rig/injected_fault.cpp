// Faults injected on purpose.
#include "rig/injected_fault.hpp"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/number_text.hpp"
#include "config/section_reader.hpp"
#include "rig/can_channels.hpp"

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

std::string_view word(InjectedTarget target) {
  switch (target) {
    case InjectedTarget::channel: return "channel";
    case InjectedTarget::side: return "side";
    case InjectedTarget::node: return "node";
    case InjectedTarget::none: break;
  }
  return "";
}

/// Names that a target may have in this rig.
std::vector<std::string> known_targets(InjectedTarget target, InjectionPlace place, const Rig& rig) {
  if (target == InjectedTarget::side) return {"1", "2"};
  std::vector<std::string> names;
  if (target == InjectedTarget::node && rig.hal && rig.hal->can)
    for (const auto& [name, node] : rig.hal->can->nodes) names.push_back(name);
  if (target == InjectedTarget::channel && place == InjectionPlace::sim)
    for (const Signal signal : channel_signals) names.emplace_back(info(signal).name);
  if (target == InjectedTarget::channel && place == InjectionPlace::device && rig.hal)
    for (const CanChannel& channel : can_channels(*rig.hal))
      if (!channel.is_output) names.push_back(channel.name);
  return names;
}

/// A loop that misses every slot runs no more.
double largest_injected_share(InjectedKind kind) { return kind == InjectedKind::late_share ? 0.9 : 1.0; }

}  // namespace

InjectedFault parse_fault_order(const std::string& text, double now_s) {
  InjectedFault fault;
  fault.start_s = now_s;
  std::string what = text;
  if (const std::size_t at = text.find('@'); at != std::string::npos) {
    what = text.substr(0, at);
    std::string when = text.substr(at + 1);
    if (const std::size_t plus = when.find('+'); plus != std::string::npos) {
      fault.duration_s = time_in(text, when.substr(plus + 1));
      when.resize(plus);
    }
    fault.start_s = time_in(text, when);
  }
  const std::size_t first = what.find(':');
  const std::string name = what.substr(0, first);
  const auto kind = std::find(injected_kind_names.begin(), injected_kind_names.end(), name);
  if (kind == injected_kind_names.end())
    refuse_order(text, "'" + name + "'", fmt::format("one of {}", fmt::join(injected_kind_names, ", ")));
  fault.kind = static_cast<InjectedKind>(kind - injected_kind_names.begin());
  if (first == std::string::npos) return fault;
  const std::size_t second = what.find(':', first + 1);
  const bool takes_target = text_of(fault.kind).sim != InjectedTarget::none;
  if (takes_target) {
    fault.target = what.substr(first + 1, second == std::string::npos ? second : second - first - 1);
    if (second != std::string::npos) fault.value = value_in(text, what.substr(second + 1));
  } else {
    fault.value = value_in(text, what.substr(first + 1));
  }
  return fault;
}

Scenario read_scenario(const std::filesystem::path& file) {
  Scenario scenario;
  read_document(read_config_tree(file, "a scenario file (docs/faults.md)"), scenario);
  return scenario;
}

void require_injectable(const InjectedFault& fault, InjectionPlace place, const Rig& rig, const std::string& origin) {
  const InjectedKindText& kind = text_of(fault.kind);
  const bool device = place == InjectionPlace::device;
  const auto refuse = [&](const std::string& found, const std::string& expected) {
    throw InputError(fmt::format("{}: {}: found {}, expected {}", origin, kind.name, found, expected));
  };
  if (device && !kind.in_device) refuse("on a simulated device", std::string(kind.instead_of_device));
  if (!device && !kind.in_sim) refuse("in the backend sim", "it with the verb device, on a bus");
  const InjectedTarget target = device ? kind.device : kind.sim;
  if (target == InjectedTarget::none && !fault.target.empty()) refuse("the target '" + fault.target + "'", "none");
  if (target != InjectedTarget::none) {
    const std::vector<std::string> known = known_targets(target, place, rig);
    if (std::find(known.begin(), known.end(), fault.target) == known.end())
      refuse(fault.target.empty() ? std::string("no target") : "'" + fault.target + "'",
             fmt::format("a {}, one of {}", word(target), fmt::join(known, ", ")));
  }
  if (kind.needs_value && !fault.value) refuse("no value", "a value: " + std::string(kind.meaning));
  if (fault.kind == InjectedKind::delay && !(*fault.value >= 0.0 && *fault.value <= longest_injected_delay_s))
    refuse(fmt::format("{:g} s", *fault.value), fmt::format("0 to {:g} s", longest_injected_delay_s));
  const bool is_share = fault.kind == InjectedKind::drop || fault.kind == InjectedKind::late_share;
  if (is_share && fault.value && !(*fault.value > 0.0 && *fault.value <= largest_injected_share(fault.kind)))
    refuse(fmt::format("a share of {:g}", *fault.value),
           fmt::format("above 0 to {:g}", largest_injected_share(fault.kind)));
  constexpr std::array above_0{InjectedKind::suspend,     InjectedKind::late_tick, InjectedKind::leak,
                               InjectedKind::payload,     InjectedKind::jam,       InjectedKind::obstacle,
                               InjectedKind::dry_friction};
  if (std::ranges::find(above_0, fault.kind) != above_0.end() && !(*fault.value > 0.0))
    refuse(fmt::format("{:g}", *fault.value), "a value above 0: " + std::string(kind.meaning));
  if (fault.kind == InjectedKind::supply_loss && !(*fault.value >= 0.0))
    refuse(fmt::format("{:g} Pa", *fault.value), "an absolute pressure, 0 Pa or more");
}

std::string fault_order_help(InjectionPlace place) {
  std::string help = "Faults, KIND[:TARGET[:VALUE]][@START_S[+DURATION_S]] or KIND[:VALUE]...:\n";
  for (const InjectedKindText& kind : injected_kinds) {
    const bool device = place == InjectionPlace::device;
    if (!(device ? kind.in_device : kind.in_sim)) continue;
    const std::string_view target = word(device ? kind.device : kind.sim);
    help +=
        fmt::format("  {:<24} {}\n", target.empty() ? std::string(kind.name) : fmt::format("{}:{}", kind.name, target),
                    kind.meaning);
  }
  return help;
}

}  // namespace pneuservo
