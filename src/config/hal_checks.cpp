// What no single field of the section `hal` can say.
#include "config/hal_checks.hpp"

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "config/number_text.hpp"

namespace pneuservo {
namespace {

/// What one channel puts where, collected over all of them.
struct Wiring {
  const HalParameters& hal;
  const RefusePath& refuse;
  std::map<std::string, unsigned> bits;  ///< by node, direction and PDO
  std::set<std::string> taken;           ///< objects by node, channels of the board

  template <class Keys, class Parameters>
  void scale_and_limits(const std::string& path, const Parameters& p, const std::string& scale,
                        const std::string& expected) {
    if (p.scale == 0.0) refuse(path + "." + scale, "0", expected);
    if (!(p.lowest < p.highest))
      refuse(path + "." + std::string(Keys::lowest), number_text(p.lowest),
             fmt::format("less than {} ({})", Keys::highest, number_text(p.highest)));
  }
  void take_board(const std::string& path, const std::string& what) {
    if (!hal.comedi) refuse(path, "a channel on a board without hal.comedi", "the section hal.comedi (it may be {})");
    if (!taken.insert("board " + what).second) refuse(path, what + " a second time", "a channel of its own");
  }
  template <class Keys>
  void add(const std::string& path, const ComediChannelParameters<Keys>& board, bool is_output) {
    take_board(path, fmt::format("{} {}", is_output ? "output" : "input", board.channel));
    scale_and_limits<Keys>(path, board, std::string(Keys::scale_V), "the value of one volt, not 0");
    if (board.readback) take_board(path + ".readback", fmt::format("input {}", board.readback->channel));
  }
  template <class Keys> void add(const std::string& path, const ComediCounterParameters<Keys>& counter) {
    take_board(path, fmt::format("counter {} of subdevice {}", counter.channel, counter.subdevice));
    scale_and_limits<Keys>(path, counter, std::string(Keys::scale), "the value of one count, not 0");
  }
  template <class Keys>
  void add(const std::string& path, const IioChannelParameters<Keys>& iio, bool is_output) {
    if (!hal.iio) refuse(path, "a channel of Industrial I/O without hal.iio", "the section hal.iio (it may be {})");
    take_iio(path, iio.device, iio.channel, is_output);
    scale_and_limits<Keys>(path, iio, std::string(Keys::scale_V), "the value of one volt, not 0");
    if (!iio.readback) return;
    const std::string& device = iio.readback->device.empty() ? iio.device : iio.readback->device;
    take_iio(path + ".readback", device, iio.readback->channel, false);
  }
  void take_iio(const std::string& path, const std::string& device, const std::string& channel, bool is_output) {
    if (device.empty()) refuse(path + ".device", "nothing", "the device's name (iio_info lists them)");
    if (channel.empty()) refuse(path + ".channel", "nothing", "the name of a channel, e.g. voltage0");
    const std::string what = fmt::format("{} {} of {}", is_output ? "output" : "input", channel, device);
    if (!taken.insert("iio " + what).second) refuse(path, what + " a second time", "a channel of its own");
  }
  template <class Keys>
  void add(const std::string& path, const CanChannelParameters<Keys>& can, bool is_output) {
    if (!hal.can) refuse(path, "a channel on CAN without hal.can", "the section hal.can");
    if (!hal.can->nodes.contains(can.node))
      refuse(path + ".node", "'" + can.node + "'", "the name of a node in hal.can.nodes");
    scale_and_limits<Keys>(path, can, std::string(Keys::scale), "the value of one count, not 0");
    if (!taken.insert(fmt::format("{} {:08x}", can.node, can.object.word)).second)
      refuse(path + ".object", fmt::format("0x{:08x} a second time at node {}", can.object.word, can.node),
             "an object of its own for each channel");
    use_pdo(path, can.node, can.pdo, is_output, can.object);
    if (can.readback) add_readback(path, can);
    if (!can.substitute) return;
    if (can.substitute->value.index() == can.object.index() || can.substitute->value == can.substitute->mode)
      refuse(path + ".substitute.value", fmt::format("0x{:08x}", can.substitute->value.word),
             "an object of its own, beside the output and its mode");
  }
  void use_pdo(const std::string& path, const std::string& node, std::uint32_t pdo, bool is_output, CanObject object) {
    unsigned& used = bits[fmt::format("{} {} {}", node, is_output, pdo)];
    used += object.bits();
    if (used > 64) refuse(path + ".pdo", fmt::format("{} bits in this PDO", used), "at most 64: take another PDO");
  }
  template <class Keys> void add_readback(const std::string& path, const CanChannelParameters<Keys>& can) {
    const CanObject object = can.readback->object.word == 0 ? can.object : can.readback->object;
    if (object.bits() != can.object.bits())
      refuse(path + ".readback.object", fmt::format("{} bits", object.bits()),
             fmt::format("as many as the output has ({})", can.object.bits()));
    if (object != can.object && !taken.insert(fmt::format("{} {:08x}", can.node, object.word)).second)
      refuse(path + ".readback.object", fmt::format("0x{:08x} a second time at node {}", object.word, can.node),
             "an object of its own for each channel");
    if (hal.can->nodes.at(can.node).transmission == CanTransmission::event)
      refuse(path + ".readback", "one at a node with transmission: event",
             "it at a node that answers SYNC: only then it is known of which cycle it is");
    use_pdo(path + ".readback", can.node, can.readback->pdo, false, object);
  }
  template <class Keys>
  void channel(const std::string& name, const ChannelParameters<Keys>& c, bool is_output, const std::string& need) {
    const std::string path = "hal.channels." + name;
    if (c.sources() > 1) refuse(path, fmt::format("{} sources", c.sources()), "one source");
    if (c.is_absent() && !need.empty()) refuse(path, "nothing", need);
    if (c.can) add(path + ".can", *c.can, is_output);
    if (c.comedi) add(path + ".comedi", *c.comedi, is_output);
    if (c.comedi_counter) add(path + ".comedi_counter", *c.comedi_counter);
    if (c.iio) add(path + ".iio", *c.iio, is_output);
    if (c.gpio && !hal.gpio) refuse(path, "a digital line without hal.gpio", "the section hal.gpio, with its watchdog");
  }
};

void check_bus(const CanBusParameters& bus, double period_s, const RefusePath& refuse) {
  if (bus.nodes.empty()) refuse("hal.can.nodes", "none", "at least one node");
  std::map<std::uint32_t, std::string> numbers{{bus.node_id, "this program (hal.can.node_id)"}};
  for (const auto& [name, node] : bus.nodes) {
    const std::string path = "hal.can.nodes." + name + ".node_id";
    const auto [other, is_new] = numbers.emplace(node.node_id, name);
    if (!is_new) refuse(path, fmt::format("{}, which {} has", node.node_id, other->second), "a number of its own");
  }
  if (bus.heartbeat_s < period_s)
    refuse("hal.can.heartbeat_s", number_text(bus.heartbeat_s),
           fmt::format("at least period_s ({})", number_text(period_s)));
  if (bus.sync_timeout_s != 0.0 && bus.sync_timeout_s <= period_s)
    refuse("hal.can.sync_timeout_s", number_text(bus.sync_timeout_s),
           fmt::format("more than period_s ({}), or 0", number_text(period_s)));
  if (bus.watchdog_s < 2.0 * bus.heartbeat_s)
    refuse("hal.can.watchdog_s", number_text(bus.watchdog_s),
           fmt::format("at least twice hal.can.heartbeat_s ({})", number_text(bus.heartbeat_s)));
}

void check_valves(const Rig& rig, const RefusePath& refuse) {
  const auto check = [&](const std::string& path, const auto& output, double safe_V) {
    if (!output || (safe_V >= output->lowest && safe_V <= output->highest)) return;
    refuse(path + ".lowest_V", fmt::format("{} to {} V", number_text(output->lowest), number_text(output->highest)),
           fmt::format("a range that holds safe_output.command_V ({})", number_text(safe_V)));
  };
  rig.hal->channels.for_each_command([&](std::string_view name, std::size_t valve, const auto& channel) {
    const double safe_V = safe_outputs_V(rig)[valve];
    check(fmt::format("hal.channels.{}.can", name), channel.can, safe_V);
    check(fmt::format("hal.channels.{}.comedi", name), channel.comedi, safe_V);
    check(fmt::format("hal.channels.{}.iio", name), channel.iio, safe_V);
  });
}

/// Lines that are there, each once.
class LineCheck {
 public:
  explicit LineCheck(const RefusePath& refuse) : refuse_(refuse) {}
  void operator()(const std::string& path, const GpioLineParameters& line) {
    const bool is_number = !line.line.empty() && line.line.find_first_not_of("0123456789") == std::string::npos;
    if (line.line.empty()) refuse_(path + ".line", "nothing", "the name of a line, or its number on the chip");
    if (is_number && line.chip.empty())
      refuse_(path + ".line", "the number " + line.line, "a chip beside it: " + path + ".chip");
    if (!taken_.insert(line.chip + " " + line.line).second)
      refuse_(path + ".line", "'" + line.line + "' a second time", "a line of its own");
  }

 private:
  const RefusePath& refuse_;
  std::set<std::string> taken_;
};

void check_lines(const Rig& rig, const RefusePath& refuse) {
  LineCheck check(refuse);
  GpioParameters::visit(
      [&](const Field& field, const auto& line) {
        if constexpr (std::is_same_v<decltype(line), const std::optional<GpioLineParameters>&>)
          if (line) check(fmt::format("hal.gpio.{}", field.key), *line);
      },
      *rig.hal->gpio);
  rig.hal->channels.for_each_command([&](std::string_view name, std::size_t, const auto& valve) {
    const std::string path = fmt::format("hal.channels.{}.gpio", name);
    if (valve.gpio && !rig.axis.valve.on_off)
      refuse(path, "a digital line", "an analog output: on_off_valves alone take a line each");
    if (valve.gpio) check(path, *valve.gpio);
  });
}

/// What the law cannot do without: the position, and the pressures that its loop is closed over.
std::vector<Signal> inputs_of_law(const Rig& rig) {
  std::vector<Signal> inputs;
  if (!rig.position.is_estimated()) inputs.push_back(Signal::x);
  if (rig.controller.takes_chambers()) inputs.insert(inputs.end(), chamber_signals.begin(), chamber_signals.end());
  if (rig.controller.takes_differences())
    inputs.insert(inputs.end(), difference_signals.begin(), difference_signals.end());
  if (rig.controls_pressure() || rig.controller.feeds_back_ports() ||
      (rig.controller.pressures() && !rig.controller.takes_chambers()))
    inputs.insert(inputs.end(), port_signals.begin(), port_signals.end());
  std::erase_if(inputs, [&](Signal signal) { return !rig.has_sensor(signal); });
  return inputs;
}

/// The commands that this rig has, and in words what they are.
std::pair<std::vector<std::string_view>, std::string_view> commands_of(const Rig& rig) {
  if (!rig.has_two_outputs()) return {{"u"}, "u, the one valve of this rig"};
  if (rig.axis.valve.on_off) return {{"u1", "u2"}, "u1 of the on/off valve that fills and u2 of the one that empties"};
  return {{"u1", "u2"}, "u1 and u2, the two valves of a servo table"};
}

void check_bench(const Rig& rig, const RefusePath& refuse) {
  if (rig.hal->bench) return;
  const std::vector<Signal> needed = inputs_of_law(rig);
  rig.hal->channels.for_each_input([&](Signal signal, const auto& channel) {
    if (channel.simulated && std::ranges::find(needed, signal) != needed.end())
      refuse(fmt::format("hal.channels.{}", info(signal).name), "simulated: true beside a real valve",
             "a sensor: the law would drive the valve by what exists in memory alone (hal.bench: true where no "
             "machine moves)");
  });
}

/// `section`: comedi or iio, whose devices keep their outputs.
void check_watchdog(const HalParameters& hal, const std::string& section, std::optional<BoardWatchdog> watchdog,
                    std::span<const std::string_view> names, const RefusePath& refuse) {
  const std::string key = "hal." + section + ".watchdog";
  if (!watchdog)
    refuse(key, "nothing with an output on such a device",
           fmt::format("what closes the valve when this program is gone, since a board keeps its outputs: one of {}",
                       fmt::join(names, ", ")));
  if (watchdog == BoardWatchdog::enable_line && !(hal.gpio && hal.gpio->enable))
    refuse(key, "enable_line without hal.gpio.enable", "that line, or another watchdog");
  if (watchdog == BoardWatchdog::guard && !hal.guard)
    refuse(key, "guard without hal.guard", "the section hal.guard (it may be {}), or another watchdog");
}

/// One clock alone can pace the loop, and a wait for it is longer than a period.
void check_trigger(const HalParameters& hal, double period_s, const RefusePath& refuse) {
  if (hal.iio->sample_timeout_s != 0.0 && hal.iio->sample_timeout_s <= period_s)
    refuse("hal.iio.sample_timeout_s", number_text(hal.iio->sample_timeout_s),
           fmt::format("more than period_s ({}), or 0", number_text(period_s)));
  if (hal.iio->trigger.empty() && hal.iio->sample_timeout_s != 0.0)
    refuse("hal.iio.sample_timeout_s", number_text(hal.iio->sample_timeout_s) + " without hal.iio.trigger",
           "a trigger, whose scans are waited for, or no such key");
  if (hal.iio->trigger.empty()) return;
  if (hal.can && hal.can->sync == CanSync::foreign)
    refuse("hal.iio.trigger", "a trigger beside hal.can.sync: foreign", "one clock: leave one of both out");
  bool has_input = false;
  hal.channels.for_each_input([&](Signal, const auto& channel) { has_input = has_input || channel.iio; });
  if (!has_input) refuse("hal.iio.trigger", "a trigger without an input", "an input of such a device, or no trigger");
}

}  // namespace

void check_outputs_without_us(const Rig& rig, const RefusePath& refuse) {
  if (!rig.hal) return;
  bool is_real = false, on_board = false, on_iio = false, on_line = false;
  rig.hal->channels.for_each_command([&](std::string_view name, std::size_t, const auto& valve) {
    on_board = on_board || valve.comedi;
    on_iio = on_iio || valve.iio;
    on_line = on_line || valve.gpio;
    is_real = is_real || valve.is_real();
    if (valve.can && !substitute_of(valve.can->object, valve.can->substitute))
      refuse(fmt::format("hal.channels.{}.can.substitute", name),
             fmt::format("nothing for object 0x{:08x}", valve.can->object.word),
             "{value: ..., mode: ...}, the device's objects for the output without master: else the valve keeps its "
             "last command when this program dies");
  });
  if (is_real) check_bench(rig, refuse);
  const HalParameters& hal = *rig.hal;
  // A section that is missing is told by check_hal.
  if (on_board && hal.comedi) check_watchdog(hal, "comedi", hal.comedi->watchdog, board_watchdog_names, refuse);
  if (on_line && hal.gpio) check_watchdog(hal, "gpio", hal.gpio->watchdog, outer_watchdog_names, refuse);
  if (on_line && hal.gpio && hal.gpio->watchdog == BoardWatchdog::guard && hal.guard && !hal.guard->enable)
    refuse("hal.guard.enable", "nothing beside valves on digital lines",
           "a line of the guard's own that takes the coils' power: it cannot have the lines of this program");
  if (on_iio && hal.iio) check_watchdog(hal, "iio", hal.iio->watchdog, outer_watchdog_names, refuse);
}

void check_hal(const Rig& rig, InputErrors& errors, const RefusePath& refuse) {
  if (!rig.hal) return;
  const HalParameters& hal = *rig.hal;
  const bool chambers = rig.controller.takes_chambers();
  const std::string loop = "a source: the loop needs this channel";
  const std::string command = "a source: the loop needs somewhere to send its command";
  const std::string difference =
      rig.controller.takes_differences() ? "a source: controller.pressure_source is differential" : "";
  const std::string chamber = chambers ? "a source: controller.pressure_source is chamber" : "";
  Wiring wiring{hal, refuse, {}, {}};
  hal.channels.for_each_input([&](Signal signal, const auto& channel) {
    const std::string name(info(signal).name);
    const bool always = (signal == Signal::x && !rig.position.is_estimated()) || is_port(signal);
    errors.collect([&] {
      if (rig.has_sensor(signal))
        wiring.channel(name, channel, false,
                       always                  ? loop
                       : is_chamber(signal)    ? chamber
                       : is_difference(signal) ? difference
                                               : std::string());
      else if (!channel.is_absent())
        refuse("hal.channels." + name, "a channel",
               fmt::format("none: a rig of kind {} has no {}", info(rig.kind).name, info(signal).words));
    });
  });
  const auto [names, in_words] = commands_of(rig);
  hal.channels.for_each_command([&](std::string_view name, std::size_t, const auto& valve) {
    const bool has = std::ranges::find(names, name) != names.end();
    errors.collect([&] {
      if (has) wiring.channel(std::string(name), valve, true, command);
      else if (!valve.is_absent())
        refuse("hal.channels." + std::string(name), fmt::format("a command {}", name), std::string(in_words));
    });
  });
  if (rig.position.is_estimated() && hal.has_devices() && !hal.bench &&
      !(hal.gpio && hal.gpio->switch_low && hal.gpio->switch_high))
    errors.collect([&] {
      refuse("hal.gpio.switch_low", "no line of both switches beside position.source: estimated",
             "hal.gpio.switch_low and hal.gpio.switch_high, whose passages say where the slider is");
    });
  if (hal.iio) errors.collect([&] { check_trigger(hal, rig.period_s, refuse); });
  if (hal.can) errors.collect([&] { check_bus(*hal.can, rig.period_s, refuse); });
  errors.collect([&] { check_valves(rig, refuse); });
  if (hal.gpio) errors.collect([&] { check_lines(rig, refuse); });
}

}  // namespace pneuservo
