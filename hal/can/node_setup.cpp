// Brings one CANopen node to pre-operational with the config's PDOs, watchdog and substitute outputs.
#include "can/node_setup.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "can/eds.hpp"
#include "can/process_data.hpp"

namespace pneuservo {
namespace {

constexpr std::uint32_t pdo_off = 0x80000000u;
constexpr std::uint16_t input_interrupts = 0x6423;
constexpr std::uint8_t on_every_sync = 1, on_event = 254;

std::uint16_t parameters_of(bool is_output, std::uint32_t pdo) {
  return static_cast<std::uint16_t>((is_output ? 0x1400 : 0x1800) + pdo - 1);
}

std::uint32_t milliseconds(double time_s) { return static_cast<std::uint32_t>(std::ceil(time_s * 1e3 - 1e-9)); }

}  // namespace

// After a fault our heartbeat stops: nodes with outputs give their substitute, a sensor that only answers SYNC goes on
// and shows what the axis does. One that sends by its own timer would never stop.
bool watches_us(const NodeSetup& setup) {
  const bool has_output = std::any_of(setup.channels.begin(), setup.channels.end(),
                                      [&](const CanChannel& c) { return c.is_output && c.node == setup.name; });
  return has_output || setup.rig.hal->can->nodes.at(setup.name).transmission == CanTransmission::event;
}

std::optional<unsigned> SetUpPdo::place_of(CanObject object) const noexcept {
  unsigned offset = 0;
  for (const CanObject& mapped : objects) {
    if (mapped == object) return offset;
    offset += mapped.bits();
  }
  return {};
}

unsigned SetUpPdo::bits() const noexcept {
  unsigned sum = 0;
  for (const CanObject& mapped : objects) sum += mapped.bits();
  return sum;
}

NodeConfigurator::NodeConfigurator(SdoClient& sdo, const NodeSetup& setup)
    : sdo_(sdo), setup_(setup), node_(setup.rig.hal->can->nodes.at(setup.name)), bus_(*setup.rig.hal->can) {}

void NodeConfigurator::check_profile() {
  const std::uint32_t type = sdo_.read_number(0x1000, 0);
  if (node_.profile != 0 && (type & 0xFFFF) != node_.profile)
    throw std::runtime_error(fmt::format("node {} ({}): its device type 0x1000 states profile {}, expected {} "
                                         "(hal.can.nodes.{}.profile)",
                                         setup_.name, node_.node_id, type & 0xFFFF, node_.profile, setup_.name));
}

void NodeConfigurator::write_dcf() {
  if (setup_.eds == nullptr) return;
  for (const EdsObject& object : setup_.eds->configured())
    sdo_.write_checked(object.index, object.sub, object.value(static_cast<std::uint8_t>(node_.node_id)));
}

void NodeConfigurator::write_parameters() {
  check_profile();
  write_dcf();
  sdo_.write_checked(0x1016, 1, bus_.node_id << 16 | (watches_us(setup_) ? milliseconds(bus_.watchdog_s) : 0));
  sdo_.write_checked(0x1017, 0, milliseconds(node_.heartbeat_s));
  // 1 would let it go on in operational when we are gone.
  if (const auto behaviour = sdo_.find_number(0x1029, 1); behaviour && *behaviour == 1)
    sdo_.write_checked(0x1029, 1, 0);
  for (const CanChannel& channel : setup_.channels)
    if (channel.is_output && channel.node == setup_.name) write_substitute(channel);
}

// Without it the valve would keep its last command when we die: some devices' default is just that.
void NodeConfigurator::write_substitute(const CanChannel& output) {
  if (!output.substitute)
    throw std::runtime_error(fmt::format("node {} ({}): hal.channels.{}.can.substitute: found nothing for object "
                                         "0x{:08x}, expected the device's objects for the output without master",
                                         setup_.name, node_.node_id, output.name, output.object.word));
  const CanSubstitute& substitute = *output.substitute;
  const CountScale counts{output.scale, output.zero, output.is_signed, output.object.bits()};
  const std::uint64_t raw = counts.raw_of(safe_commands_V(setup_.rig)[output.command]);
  const std::int64_t value =
      output.is_signed ? sign_extended(raw, output.object.bits()) : static_cast<std::int64_t>(raw);
  sdo_.write_checked(substitute.value.index(), substitute.value.sub(), static_cast<std::uint32_t>(value));
  if (substitute.mode.word != 0)
    sdo_.write_checked(substitute.mode.index(), substitute.mode.sub(), substitute.mode_value);
}

void NodeConfigurator::write_mapping(std::uint16_t mapping, const std::vector<CanObject>& objects) {
  sdo_.write(mapping, 0, 0, 1);
  for (std::size_t i = 0; i < objects.size(); ++i)
    sdo_.write(mapping, static_cast<std::uint8_t>(i + 1), objects[i].word, 4);
  sdo_.write(mapping, 0, static_cast<std::uint32_t>(objects.size()), 1);
}

std::vector<CanObject> NodeConfigurator::read_mapping(std::uint16_t mapping) {
  std::vector<CanObject> objects;
  const std::uint32_t count = std::min<std::uint32_t>(sdo_.read_number(mapping, 0), 64);
  for (std::uint32_t i = 1; i <= count; ++i)
    objects.push_back({sdo_.read_number(mapping, static_cast<std::uint8_t>(i))});
  return objects;
}

SetUpPdo NodeConfigurator::set_up_pdo(const CanPdo& pdo) {
  const std::uint16_t parameters = parameters_of(pdo.is_output, pdo.pdo);
  const auto mapping = static_cast<std::uint16_t>(parameters + 0x200);
  const std::uint32_t id =
      pdo.is_output ? cob_receive_pdo(pdo.pdo, node_.node_id) : cob_transmit_pdo(pdo.pdo, node_.node_id);
  const bool by_event = !pdo.is_output && node_.transmission == CanTransmission::event;
  // Bit 30: no remote requests. Devices that know it for a transmit PDO keep it, others ignore it.
  const std::uint32_t kept = sdo_.read_number(parameters, 1) & 0x40000000u;
  sdo_.write(parameters, 1, id | pdo_off | kept, 4);
  if (node_.mapping == CanMapping::write) {
    std::vector<CanObject> objects;
    objects.reserve(pdo.signals.size());
    for (const std::size_t i : pdo.signals) objects.push_back(setup_.channels[i].object);
    write_mapping(mapping, objects);
  }
  sdo_.write_checked(parameters, 2, by_event ? on_event : on_every_sync);
  if (!pdo.is_output) {
    if (sdo_.find_number(parameters, 3)) sdo_.write_checked(parameters, 3, 0);  // inhibit time, often 10 ms
    const std::uint32_t timer_ms = by_event ? milliseconds(setup_.rig.period_s) : 0;
    if (sdo_.find_number(parameters, 5)) sdo_.write_checked(parameters, 5, timer_ms);
    if (by_event && sdo_.find_number(input_interrupts, 0)) sdo_.write_checked(input_interrupts, 0, 1);
  }
  SetUpPdo done{id, read_mapping(mapping)};
  for (const std::size_t i : pdo.signals)
    if (!done.place_of(setup_.channels[i].object))
      throw std::runtime_error(fmt::format("node {} ({}): object 0x{:08x} of channel {} is not in the mapping 0x{:04x}",
                                           setup_.name, node_.node_id, setup_.channels[i].object.word,
                                           setup_.channels[i].name, mapping));
  if (done.bits() > 64)
    throw std::runtime_error(fmt::format("node {} ({}): mapping 0x{:04x} has {} bits, expected at most 64", setup_.name,
                                         node_.node_id, mapping, done.bits()));
  sdo_.write_checked(parameters, 1, id | kept);
  return done;
}

void NodeConfigurator::turn_off_others(const std::vector<CanPdo>& used) {
  for (std::uint32_t number = 1; number <= 4; ++number)
    for (const bool is_output : {false, true}) {
      const bool is_used = std::any_of(used.begin(), used.end(), [&](const CanPdo& pdo) {
        return pdo.node == setup_.name && pdo.pdo == number && pdo.is_output == is_output;
      });
      if (is_used) continue;
      const std::uint16_t parameters = parameters_of(is_output, number);
      const auto id = sdo_.find_number(parameters, 1);
      if (id && (*id & pdo_off) == 0) sdo_.write_checked(parameters, 1, *id | pdo_off);
    }
}

}  // namespace pneuservo
