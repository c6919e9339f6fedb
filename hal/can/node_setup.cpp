// Brings one CANopen node to pre-operational with the config's PDOs, watchdog and substitute outputs.
#include "can/node_setup.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "can/eds.hpp"
#include "can/fluid_valve.hpp"
#include "can/process_data.hpp"

namespace pneuservo {
namespace {

constexpr std::uint16_t input_interrupts = 0x6423;
constexpr std::uint16_t total_measuring_range = 0x6002;
constexpr std::uint32_t encoder_profile = 406;
constexpr std::uint8_t on_every_sync = 1, on_event = 254;

/// Units of pressure as CiA 303-2 numbers them.
struct PressureUnit {
  std::uint32_t code;
  const char* name;
  double unit_Pa;
};
constexpr PressureUnit pressure_units[] = {{0x22, "Pa", 1.0}, {0x4E, "bar", 1e5}, {0xAB, "psi", 6894.757293168}};

std::uint16_t parameters_of(bool is_output, std::uint32_t pdo) {
  return static_cast<std::uint16_t>((is_output ? 0x1400 : 0x1800) + pdo - 1);
}

std::uint32_t milliseconds(double time_s) { return static_cast<std::uint32_t>(std::ceil(time_s * 1e3 - 1e-9)); }

}  // namespace

bool NodeSetup::has_output() const {
  return std::any_of(channels.begin(), channels.end(),
                     [&](const CanChannel& c) { return c.is_output && c.node == name; });
}

// After a fault our heartbeat stops: nodes with outputs give their substitute, a sensor that only answers SYNC goes on
// and shows what the axis does. One that sends by its own timer would never stop.
bool watches_us(const NodeSetup& setup) {
  return setup.has_output() || setup.rig.hal->can->nodes.at(setup.name).transmission == CanTransmission::event;
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

void NodeConfigurator::refuse(const std::string& what) const {
  throw std::runtime_error(fmt::format("node {} ({}): {}", setup_.name, node_.node_id, what));
}

void NodeConfigurator::note(const std::string& what) {
  notes_.push_back(fmt::format("node {} ({}): {}", setup_.name, node_.node_id, what));
}

void NodeConfigurator::check_profile() {
  profile_ = sdo_.read_number(0x1000, 0) & 0xFFFF;
  if (node_.profile != 0 && profile_ != node_.profile)
    refuse(fmt::format("its device type 0x1000 states profile {}, expected {} (hal.can.nodes.{}.profile)", profile_,
                       node_.profile, setup_.name));
}

bool NodeConfigurator::is_valve() const noexcept { return profile_ == valve_profile && setup_.has_output(); }

// CiA 404 states what a count is: unit (0x6131, as in CiA 303-2: prefix, then the unit) and decimal digits (0x6132).
void NodeConfigurator::check_pressure_unit(const CanChannel& input) {
  const std::uint16_t index = input.object.index();
  if (input.unit != "Pa" || (index != 0x7130 && index != 0x9130)) return;
  const auto unit = sdo_.find_number(0x6131, input.object.sub());
  const auto digits = sdo_.find_number(0x6132, input.object.sub());
  if (!unit || !digits) return;
  const auto known = std::ranges::find(pressure_units, *unit >> 16 & 0xFF, &PressureUnit::code);
  if (known == std::end(pressure_units) || (*unit & 0xFFFF) != 0) {
    note(fmt::format("0x6131:{} is 0x{:08x}, a unit that is not known here: scale_Pa_per_count of {} is not checked",
                     input.object.sub(), *unit, input.name));
    return;
  }
  const auto prefix = static_cast<std::int8_t>(*unit >> 24);
  const double per_count_Pa = known->unit_Pa * std::pow(10.0, prefix - static_cast<int>(*digits & 0xFF));
  // The digits of a config's number, not of the sensor.
  if (std::abs(input.scale / per_count_Pa - 1.0) > 1e-3)
    refuse(fmt::format("it states {:g} Pa a count (0x6131:{} is 10^{} {}, 0x6132 {} decimal digits), found {:g} in "
                       "hal.channels.{}.can.scale_Pa_per_count: one of the two is wrong",
                       per_count_Pa, input.object.sub(), int{prefix}, known->name, *digits & 0xFF, input.scale,
                       input.name));
}

// CiA 406: 0x6002 counts only where 0x6000 scales; else the encoder's own steps (0x6501) and turns (0x6502) do.
std::uint64_t NodeConfigurator::measuring_range() {
  const std::uint32_t scales = 1u << 2;
  if ((sdo_.find_number(0x6000, 0).value_or(scales) & scales) != 0)
    return sdo_.find_number(total_measuring_range, 0).value_or(0);
  return std::uint64_t{sdo_.find_number(0x6501, 0).value_or(0)} * sdo_.find_number(0x6502, 0).value_or(0);
}

// A multi-turn encoder counts up to its measuring range and goes on at 0. Within the limits each reading has one place,
// so that none has to be remembered.
double NodeConfigurator::wrap_counts(const CanChannel& input) {
  if (input.unit != "m" || input.is_output) return 0.0;
  double wrap = input.wrap_counts;
  const std::uint16_t index = input.object.index();
  const bool is_position = profile_ == encoder_profile && (index == 0x6004 || index == 0x6020);
  if (const auto range = static_cast<double>(is_position ? measuring_range() : 0); range != 0.0) {
    if (wrap != 0.0 && wrap != range)
      refuse(fmt::format("its measuring range (0x6002, or 0x6501 times 0x6502) is {:.0f} counts, found {:.0f} in "
                         "hal.channels.{}.can.wrap_counts: one of the two is wrong",
                         range, wrap, input.name));
    wrap = range;
  }
  const double travel_counts = (input.highest - input.lowest) / std::abs(input.scale);
  if (wrap != 0.0 && travel_counts >= wrap)
    refuse(fmt::format("after {:.0f} counts (0x6002, or wrap_counts) the encoder begins at 0 again, found {:.0f} "
                       "counts from lowest_m to "
                       "highest_m of hal.channels.{}.can, expected fewer: the same count would be two positions",
                       wrap, travel_counts, input.name));
  return wrap;
}

void NodeConfigurator::check_identity() {
  const auto check = [&](std::uint8_t sub, const char* what, std::uint32_t of_config, std::uint32_t of_eds) {
    const std::uint32_t wanted = of_config != 0 ? of_config : of_eds;
    if (wanted == 0) return;
    const auto found = sdo_.find_number(0x1018, sub);
    if (!found || *found == wanted) return;
    const std::string stated =
        of_config != 0 ? fmt::format("hal.can.nodes.{}.{}", setup_.name, what) : setup_.eds->source();
    refuse(fmt::format("0x1018:{} states {} 0x{:x}, expected 0x{:x} ({}): is another device there?", sub, what, *found,
                       wanted, stated));
  };
  check(1, "vendor", node_.vendor, setup_.eds == nullptr ? 0 : setup_.eds->vendor);
  check(2, "product", node_.product, setup_.eds == nullptr ? 0 : setup_.eds->product);
}

void NodeConfigurator::write_dcf() {
  if (setup_.eds == nullptr) return;
  const auto number = static_cast<std::uint8_t>(node_.node_id);
  for (const LeftOutValue& left : setup_.eds->left_out(number))
    note(fmt::format("{}: the value of 0x{:04x}:{} is left out: {}", setup_.eds->source(), left.index, left.sub,
                     left.why));
  for (const EdsObject& object : setup_.eds->configured(number)) {
    const std::vector<std::uint8_t> bytes = eds_bytes(object, object.configured, number).bytes;
    if (object.can_read && sdo_.read(object.index, object.sub) == bytes) continue;
    sdo_.write_any(object.index, object.sub, bytes);
    if (object.can_read && sdo_.read(object.index, object.sub) != bytes)
      refuse(fmt::format("object 0x{:04x}:{} does not hold what was written ({}:{})", object.index, object.sub,
                         setup_.eds->source(), object.line));
  }
}

// Heartbeats, or node guarding where the device lacks one that it needs: it does both ways at once.
void NodeConfigurator::write_supervision() {
  const bool lacks = !sdo_.find_number(0x1017, 0) || (watches_us(setup_) && !sdo_.find_number(0x1016, 1));
  if (lacks && sdo_.find_number(guard_time, 0) && sdo_.find_number(life_time_factor, 0)) return write_guarding();
  write_watchdog();
  write_heartbeat();
}

void NodeConfigurator::write_guarding() {
  const std::uint32_t life =
      watches_us(setup_) ? static_cast<std::uint32_t>(std::ceil(bus_.watchdog_s / node_.heartbeat_s - 1e-9)) : 0;
  if (life > 255)
    refuse(fmt::format("it has node guarding alone, and 0x100d takes 255 at most: found hal.can.watchdog_s of {} times "
                       "hal.can.nodes.{}.heartbeat_s, expected at most 255 times",
                       life, setup_.name));
  sdo_.write_found(0x1017, 0, 0);  // CiA 301: a device with a heartbeat does no node guarding
  sdo_.write_checked(guard_time, 0, milliseconds(node_.heartbeat_s));
  sdo_.write_checked(life_time_factor, 0, life);
  is_guarded_ = true;
  note(fmt::format("it lacks a heartbeat: asked for its state every {:g} s (node guarding)", node_.heartbeat_s));
}

void NodeConfigurator::write_watchdog() {
  const std::uint32_t ms = watches_us(setup_) ? milliseconds(bus_.watchdog_s) : 0;
  if (sdo_.write_found(0x1016, 1, bus_.node_id << 16 | ms)) return;
  if (setup_.has_output())
    refuse("it has no 0x1016 and cannot watch this program's heartbeat, nor 0x100c and 0x100d for node guarding: its "
           "output would stay when this program dies; a node that can is needed for the valve");
  note("it has no 0x1016 and does not watch this program; it has no output to make safe");
}

void NodeConfigurator::write_heartbeat() {
  has_heartbeat_ = sdo_.write_found(0x1017, 0, milliseconds(node_.heartbeat_s));
  if (has_heartbeat_) return;
  if (setup_.has_output() || node_.transmission == CanTransmission::event)
    refuse("it has no 0x1017 and sends no heartbeat, nor 0x100c and 0x100d for node guarding: its loss would not be "
           "seen; possible only for a node without outputs that answers SYNC (transmission: sync)");
  note("it has no 0x1017 and sends no heartbeat: its loss is seen by its missing answers to SYNC");
}

// Where it went by another identifier, or was switched off, an emergency would never be seen.
void NodeConfigurator::write_emergency() {
  const auto held = sdo_.find_number(0x1014, 0);
  const std::uint32_t wanted = cob_emergency + node_.node_id;
  if (!held || *held == wanted) return;
  try {
    write_identifier(0x1014, 0, wanted);
  } catch (const SdoError&) {
    note(fmt::format("its 0x1014 is 0x{:08x} and cannot be written: its emergencies are not seen", *held));
  }
}

// SYNC is 0x080 without a counter.
void NodeConfigurator::write_sync() {
  if (bus_.sync == CanSync::foreign) return;  // its master decides, which may be this node
  const std::uint32_t generates = 0x40000000u;
  if (const auto held = sdo_.find_number(0x1005, 0); held && (*held & (generates | 0x7FF)) != cob_sync)
    sdo_.write_checked(0x1005, 0, cob_sync);
  if (const auto counter = sdo_.find_number(0x1019, 0); counter && *counter != 0) sdo_.write_checked(0x1019, 0, 0);
}

void NodeConfigurator::write_parameters() {
  check_profile();
  check_identity();
  write_dcf();
  write_supervision();
  write_emergency();
  write_sync();
  // 1 would let it go on in operational when we are gone.
  if (const auto behaviour = sdo_.find_number(0x1029, 1); behaviour && *behaviour == 1)
    sdo_.write_checked(0x1029, 1, 0);
  for (const CanChannel& channel : setup_.channels) {
    if (channel.node != setup_.name) continue;
    if (channel.is_output) write_substitute(channel);
    else check_pressure_unit(channel);
  }
}

void NodeConfigurator::refuse_errors() {
  const std::uint32_t error_register = sdo_.find_number(0x1001, 0).value_or(0);
  if (error_register == 0) return;
  std::string last;
  if (const auto field = sdo_.find_number(0x1003, 1); field && *field != 0)
    last = fmt::format(", its last error 0x1003:1 is 0x{:04x} ({})", *field & 0xFFFF,
                       emergency_class_word(static_cast<std::uint16_t>(*field)));
  refuse(fmt::format("its error register 0x1001 is 0x{:02x} ({}){}: mend the cause before this axis moves",
                     error_register, error_register_words(static_cast<std::uint8_t>(error_register)), last));
}

// Without it the valve would keep its last command when we die: some devices' default is just that.
void NodeConfigurator::write_substitute(const CanChannel& output) {
  if (!output.substitute)
    throw std::runtime_error(fmt::format("node {} ({}): hal.channels.{}.can.substitute: found nothing for object "
                                         "0x{:08x}, expected the device's objects for the output without master",
                                         setup_.name, node_.node_id, output.name, output.object.word));
  const CanSubstitute& substitute = *output.substitute;
  const CountScale counts{output.scale, output.zero, output.is_signed, output.object.bits()};
  const std::uint64_t raw = counts.raw_of(safe_outputs_V(setup_.rig)[output.command]);
  const std::int64_t value =
      output.is_signed ? sign_extended(raw, output.object.bits()) : static_cast<std::int64_t>(raw);
  const auto write = [&](CanObject object, std::uint32_t number) {
    if (sdo_.write_found(object.index(), object.sub(), number)) return;
    refuse(fmt::format("it has no object 0x{:04x}:{}: the valve would keep its last command when this program dies; "
                       "state hal.channels.{}.can.substitute, the device's own objects for it",
                       object.index(), object.sub(), output.name));
  };
  write(substitute.value, static_cast<std::uint32_t>(value));
  if (substitute.mode.word != 0) write(substitute.mode, substitute.mode_value);
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

void NodeConfigurator::write_identifier(std::uint16_t index, std::uint8_t sub, std::uint32_t wanted) {
  const std::uint32_t held = sdo_.read_number(index, sub);
  if (held == wanted) return;
  const std::uint32_t identifier = 0x3FFFFFFFu;
  if ((held & pdo_off) == 0 && ((held ^ wanted) & identifier) != 0) sdo_.write_checked(index, sub, held | pdo_off);
  if ((wanted & pdo_off) == 0 && ((held ^ wanted) & identifier) != 0) sdo_.write_checked(index, sub, wanted | pdo_off);
  sdo_.write_checked(index, sub, wanted);
}

// Event-driven PDOs are type 254, the maker's event, or 255, the profile's: devices have one or both.
void NodeConfigurator::write_type(std::uint16_t parameters, bool by_event) {
  const std::uint32_t held = sdo_.read_number(parameters, 2);
  if (by_event ? held >= on_event : held == on_every_sync) return;
  try {
    sdo_.write_checked(parameters, 2, by_event ? on_event : on_every_sync);
  } catch (const SdoError& error) {
    if (error.code == 0) throw;
    if (by_event) return sdo_.write_checked(parameters, 2, 255);
    if (parameters < 0x1800) {
      note(fmt::format("0x{:04x}:2 stays {}: the output acts when it comes, not at SYNC", parameters, held));
      return;
    }
    refuse(
        fmt::format("0x{:04x}:2 refuses type 1, an answer to each SYNC ({}): where it takes event-driven PDOs alone, "
                    "hal.can.nodes.{}.transmission: event",
                    parameters, sdo_abort_text(error.code), setup_.name));
  }
}

SetUpPdo NodeConfigurator::set_up_pdo(const CanPdo& pdo) {
  const std::uint16_t parameters = parameters_of(pdo.is_output, pdo.pdo);
  const auto mapping = static_cast<std::uint16_t>(parameters + 0x200);
  const std::uint32_t id =
      pdo.is_output ? cob_receive_pdo(pdo.pdo, node_.node_id) : cob_transmit_pdo(pdo.pdo, node_.node_id);
  const bool by_event = !pdo.is_output && node_.transmission == CanTransmission::event;
  const std::uint32_t timer_ms = by_event ? milliseconds(setup_.rig.period_s) : 0;
  // Bit 30: no remote requests. Devices that know it for a transmit PDO keep it, others ignore it.
  const std::uint32_t wanted = id | (sdo_.read_number(parameters, 1) & 0x40000000u);
  std::vector<CanObject> objects = read_mapping(mapping);
  if (node_.mapping == CanMapping::write) {
    std::vector<CanObject> named;
    named.reserve(pdo.signals.size());
    for (const std::size_t i : pdo.signals) named.push_back(setup_.channels[i].object);
    if (objects != named) {
      try_turn_off(pdo);
      write_mapping(mapping, named);
      objects = read_mapping(mapping);
    }
  }
  if (!is_set_up(parameters, pdo.is_output, by_event, timer_ms)) {
    try_turn_off(pdo);
    write_type(parameters, by_event);
    if (!pdo.is_output) {
      sdo_.write_found(parameters, 3, 0);  // inhibit time, often 10 ms
      sdo_.write_found(parameters, 5, timer_ms);
    }
  }
  if (by_event) sdo_.write_found(input_interrupts, 0, 1);
  SetUpPdo done{id, objects};
  for (const std::size_t i : pdo.signals)
    if (!done.place_of(setup_.channels[i].object))
      refuse(fmt::format("object 0x{:08x} of channel {} is not in the mapping 0x{:04x}", setup_.channels[i].object.word,
                         setup_.channels[i].name, mapping));
  if (pdo.is_output && is_valve() && std::ranges::count(objects, valve_control_word, &CanObject::index) > 0)
    refuse(fmt::format("its mapping 0x{:04x} has the control word 0x6040, which is written by SDO alone: "
                       "hal.can.nodes.{}.mapping: write",
                       mapping, setup_.name));
  if (done.bits() > 64) refuse(fmt::format("mapping 0x{:04x} has {} bits, expected at most 64", mapping, done.bits()));
  write_identifier(parameters, 1, wanted);
  return done;
}

// Where nothing has to change the PDO need not be turned off: some devices let its objects only be read.
bool NodeConfigurator::is_set_up(std::uint16_t parameters, bool is_output, bool by_event, std::uint32_t timer_ms) {
  const std::uint32_t type = sdo_.read_number(parameters, 2);
  if (by_event ? type < on_event : type != on_every_sync) return false;
  if (is_output) return true;
  return sdo_.find_number(parameters, 3).value_or(0) == 0 &&
         sdo_.find_number(parameters, 5).value_or(timer_ms) == timer_ms;
}

// One whose identifier can only be read may take its other objects all the same; where it does not, they say so.
void NodeConfigurator::try_turn_off(const CanPdo& pdo) {
  try {
    turn_off(pdo.is_output, pdo.pdo);
  } catch (const SdoError& error) {
    if (error.code != static_cast<std::uint32_t>(SdoAbort::read_only)) throw;
  }
}

/// False: the device has no such PDO.
bool NodeConfigurator::turn_off(bool is_output, std::uint32_t number) {
  const std::uint16_t parameters = parameters_of(is_output, number);
  const auto id = sdo_.find_number(parameters, 1);
  if (id && (*id & pdo_off) == 0) sdo_.write_checked(parameters, 1, *id | pdo_off);
  return id.has_value();
}

// CiA 301 has 512 of each. Devices number them from 1 on, with gaps of at most a block of four a module.
void NodeConfigurator::turn_off_others(const std::vector<CanPdo>& used) {
  for (const bool is_output : {false, true}) {
    std::uint32_t missing = 0;
    for (std::uint32_t number = 1; number <= 512 && missing < 8; ++number) {
      const bool is_used = std::any_of(used.begin(), used.end(), [&](const CanPdo& pdo) {
        return pdo.node == setup_.name && pdo.pdo == number && pdo.is_output == is_output;
      });
      missing = is_used || turn_off(is_output, number) ? 0 : missing + 1;
    }
  }
}

}  // namespace pneuservo
