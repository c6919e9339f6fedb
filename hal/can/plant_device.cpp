// The simulated plant of a rig as the CANopen nodes that its config names.
#include "can/plant_device.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <pneuservo/record/ring.hpp>

#include "config/input_error.hpp"

namespace pneuservo {
namespace {

constexpr std::uint32_t profile_analog = 401, profile_transmitter = 404, profile_encoder = 406;
constexpr double usual_emergency = 0x5000;  // device hardware
/// Chambers are recorded as the plant has them, not as a sensor shows them.
constexpr std::array recorded_signals{Signal::x, Signal::p1_port, Signal::p2_port, Signal::p_supply,
                                      Signal::supply_flow};

std::uint32_t device_type_of(const CanNodeParameters& node, const std::vector<CanChannel>& channels,
                             const std::string& name) {
  if (node.profile != 0) return node.profile;
  const auto has = [&](std::uint16_t index) {
    return std::any_of(channels.begin(), channels.end(),
                       [&](const CanChannel& c) { return c.node == name && c.object.index() == index; });
  };
  if (has(valve_set_point)) return valve_profile;
  if (has(0x9130) || has(0x7130)) return profile_transmitter;
  const bool analog = std::any_of(channels.begin(), channels.end(), [&](const CanChannel& c) {
    return c.node == name && (c.object.index() >> 8 == 0x64);
  });
  return analog ? profile_analog : profile_encoder;
}

/// A transmitter of CiA 404 states what a count is: here a power of ten of a bar, if it is one.
void state_pressure_unit(ObjectDictionary& dictionary, const CanChannel& channel) {
  if (channel.object.index() != 0x9130 && channel.object.index() != 0x7130) return;
  const double digits = std::log10(1e5 / std::abs(channel.scale));
  if (std::abs(digits - std::round(digits)) > 1e-9 || digits < 0) return;
  constexpr std::uint32_t bar = 0x004E0000;
  dictionary.add_number(0x6131, channel.object.sub(), 32, bar, false);
  dictionary.add_number(0x6132, channel.object.sub(), 8, static_cast<std::uint32_t>(std::lround(digits)), false);
}

/// What a saturated channel sends: beyond the highest of its counts, which hold it there.
PerSignal<double> highest_counts(const Rig& rig) {
  PerSignal<double> values;
  if (!rig.hal) return values;
  for (const CanChannel& c : can_channels(*rig.hal))
    if (!c.is_output && !c.is_readback) values[c.signal] = std::copysign(1e300, c.scale);
  return values;
}

}  // namespace

PlantDevice::PlantDevice(const Rig& rig)
    : rig_(rig), plant_(rig), plant_faults_(rig), sample_faults_(rig.period_s, highest_counts(rig)),
      period_ns_(std::llround(rig.period_s * 1e9)) {
  if (!rig.hal || !rig.hal->can)
    throw InputError(rig.name + ": hal.can: found nothing, expected the bus with its nodes (docs/can.md)");
  channels_ = can_channels(*rig.hal);
  sends_sync = rig.hal->can->sync == CanSync::foreign;
  build_nodes();
  plant_.configure();
  plant_.activate();
}

void PlantDevice::build_nodes() {
  for (const auto& [name, parameters] : rig_.hal->can->nodes) {
    auto node = std::make_unique<CanopenNode>(
        NodeIdentity{static_cast<std::uint8_t>(parameters.node_id), device_type_of(parameters, channels_, name), name});
    ValveStates* valve = nullptr;
    if (node->dictionary().number(0x1000, 0) == valve_profile) valve = &valves_.try_emplace(name, *node).first->second;
    for (const CanChannel& c : channels_) {
      if (c.node != name) continue;
      if (!c.is_output) state_pressure_unit(node->dictionary(), c);
      if (c.is_output) node->add_output(c.object, c.substitute);
      else if (node->dictionary().find(c.object.index(), c.object.sub()) == nullptr)
        node->dictionary().add(c.object.index(), c.object.sub(),
                               {.bits = c.object.bits(), .can_write = false, .can_map = true});
      if (c.wrap_counts > 0.0 && c.wrap_counts < 4294967296.0)
        node->dictionary().add_number(0x6002, 0, 32, static_cast<std::uint32_t>(c.wrap_counts), false,
                                      "Total measuring range");
      const CountScale counts{c.scale, c.zero, c.is_signed, c.object.bits()};
      signals_.push_back({c, node.get(), counts.wrapped(c.wrap_counts, c.lowest, c.highest), valve});
    }
    nodes_.push_back(std::move(node));
  }
  // A device with a mapping of its own shows it in the order of the config; others get theirs written.
  for (const CanPdo& pdo : can_pdos(channels_)) {
    const CanNodeParameters& parameters = rig_.hal->can->nodes.at(pdo.node);
    if (parameters.mapping != CanMapping::read) continue;
    std::vector<CanObject> objects;
    objects.reserve(pdo.signals.size());
    for (const std::size_t i : pdo.signals) objects.push_back(channels_[i].object);
    for (auto& node : nodes_)
      if (node->name() == pdo.node) node->map(!pdo.is_output, pdo.pdo, objects, 255);
  }
}

void PlantDevice::power_on(std::int64_t now_ns, std::vector<CanFrame>& out) {
  now_ns_ = now_ns;
  for (auto& node : nodes_) node->power_on(now_ns, out);
  for (auto& [name, valve] : valves_) valve.power_on();
}

bool PlantDevice::is_active(InjectedKind kind, const std::string& target) const {
  const double t = time_s();
  return std::any_of(orders_.begin(), orders_.end(), [&](const Order& o) {
    return o.order.kind == kind && o.order.target == target && o.order.is_on(t) && o.begun;
  });
}

bool PlantDevice::is_off(const CanopenNode& node) const { return is_active(InjectedKind::off, node.name()); }

void PlantDevice::on_frame(const ReceivedFrame& received, std::vector<CanFrame>& out) {
  now_ns_ = received.received_ns;
  if (is_sync(received.frame)) return on_sync(received, out);
  for (auto& node : nodes_) {
    node->is_deaf = is_active(InjectedKind::deaf, node->name());
    if (!is_off(*node)) node->on_frame(received.frame, received.received_ns, out);
  }
}

void PlantDevice::on_sync(const ReceivedFrame& received, std::vector<CanFrame>& out) {
  if (syncs_++ > 0) {
    const double periods = static_cast<double>(received.received_ns - last_step_ns_) / static_cast<double>(period_ns_);
    tick_ += std::max<std::int64_t>(std::llround(periods), 1);
  }
  last_step_ns_ = received.received_ns;
  begin_orders(out);
  for (auto& node : nodes_)
    if (!is_off(*node)) node->act_on_sync();
  sample_inputs();  // brings the plant here under the command that it had until now
  take_command();
  out.insert(out.end(), held_back_.begin(), held_back_.end());
  held_back_.clear();
  for (auto& node : nodes_) answer(*node, out);
}

void PlantDevice::answer(CanopenNode& node, std::vector<CanFrame>& out) {
  if (is_off(node)) return;
  std::vector<CanFrame> answers;
  node.answer_sync(answers);
  if (is_active(InjectedKind::drop, node.name())) return;
  auto& where = is_active(InjectedKind::late, node.name()) ? held_back_ : out;
  where.insert(where.end(), answers.begin(), answers.end());
  if (is_active(InjectedKind::doubled, node.name())) where.insert(where.end(), answers.begin(), answers.end());
}

void PlantDevice::take_command() {
  for (const DeviceChannel& signal : signals_) {
    if (!signal.channel.is_output) continue;
    const bool follows = signal.valve == nullptr || signal.valve->follows_set_point();
    const std::uint32_t raw = signal.node->dictionary().number(
        follows ? signal.channel.object.index() : valve_hold_set_point, signal.channel.object.sub());
    commands_V_[signal.channel.command] = is_off(*signal.node) ? 0.0 : signal.counts.value_of(raw);  // no supply
  }
  for (const DeviceChannel& signal : signals_)  // what an output is, in an object of its own or in the output's
    if (signal.channel.is_readback)
      signal.node->dictionary().set_number(
          signal.channel.object.index(), signal.channel.object.sub(),
          static_cast<std::uint32_t>(signal.counts.raw_of(commands_V_[signal.channel.command])));
  const auto command_V = commands_of_outputs_V(rig_, commands_V_);
  plant_.write(tick_, plant_faults_.command(time_s(), {command_V[0], command_V[1]}));
  record();
}

std::vector<std::string> PlantDevice::recorded_columns(const Rig& rig) {
  std::vector<std::string> columns;
  for (const char* column : {"t_s", "v_mps", "x_true_m", "p1_chamber_true_Pa", "p2_chamber_true_Pa"})
    if (is_column_of(column, rig.controls_pressure())) columns.emplace_back(column);
  for (const Signal signal : recorded_signals)
    if (rig.has_sensor(signal)) columns.emplace_back(info(signal).column);
  for (const std::string& command : command_columns(rig)) columns.push_back(command);
  return columns;
}

// A row that finds no room is lost; the writer counts it.
void PlantDevice::record() noexcept {
  if (ring_ == nullptr) return;
  Row row;
  row.t_s = time_s();
  row.v_mps = plant_.speed_mps();
  row.u_V = row.u1_V = commands_of_outputs_V(rig_, commands_V_)[0];
  row.u2_V = commands_V_[1];
  for (const Signal signal : recorded_signals) row.measured[signal] = measured_.channel[signal].value;
  const Truth truth = plant_.truth();
  row.x_true_m = truth.x_m;
  row.p1_chamber_true_Pa = truth.p1_chamber_Pa;
  row.p2_chamber_true_Pa = truth.p2_chamber_Pa;
  ring_->push(row);
}

void PlantDevice::sample_inputs() {
  plant_.read(tick_, measured_);
  plant_faults_.apply(time_s(), plant_);
  sample_faults_.apply(tick_, time_s(), measured_);
  for (const DeviceChannel& signal : signals_) {
    if (signal.channel.is_output || signal.channel.is_readback) continue;
    const double value = measured_.channel[signal.channel.signal].value;
    signal.node->dictionary().set_number(signal.channel.object.index(), signal.channel.object.sub(),
                                         static_cast<std::uint32_t>(signal.counts.raw_of(value)));
  }
}

void PlantDevice::on_time(std::int64_t now_ns, std::vector<CanFrame>& out) {
  now_ns_ = now_ns;
  // Without SYNC the plant goes on alone, a period behind the clock so that it never runs ahead of a SYNC that is late.
  while (syncs_ > 0 && now_ns - last_step_ns_ > 2 * period_ns_) {
    last_step_ns_ += period_ns_;
    ++tick_;
    begin_orders(out);
    sample_inputs();
    take_command();
  }
  for (auto& node : nodes_)
    if (!is_off(*node)) node->on_time(now_ns, out);
  if (!sends_sync || now_ns < next_sync_ns_) return;
  next_sync_ns_ = std::max(next_sync_ns_ + period_ns_, now_ns);
  out.push_back(sync_frame());
  on_sync({sync_frame(), now_ns}, out);
}

std::int64_t PlantDevice::next_due_ns() const noexcept {
  std::int64_t due = syncs_ > 0 ? last_step_ns_ + 2 * period_ns_ + 1 : std::numeric_limits<std::int64_t>::max();
  for (const auto& node : nodes_) due = std::min(due, node->next_due_ns());
  return sends_sync ? std::min(due, next_sync_ns_) : due;
}

void PlantDevice::add_fault(const InjectedFault& fault) {
  require_injectable(fault, InjectionPlace::device, rig_, "fault");
  orders_.push_back({fault, false});
  plant_faults_.add(fault);
  sample_faults_.add(fault);
}

void PlantDevice::begin_orders(std::vector<CanFrame>& out) {
  for (Order& o : orders_) {
    if (o.begun || time_s() < o.order.start_s) continue;
    o.begun = true;
    begin(o.order, out);
  }
  for (auto& node : nodes_) {
    const bool ended = std::any_of(orders_.begin(), orders_.end(), [&](const Order& o) {
      const double end_s = o.order.start_s + o.order.duration_s;
      return o.order.kind == InjectedKind::off && o.order.target == node->name() && time_s() >= end_s &&
             time_s() < end_s + rig_.period_s;
    });
    if (ended) node->power_on(now_ns_, out);
    node->heartbeat_muted = is_active(InjectedKind::no_heartbeat, node->name());
  }
}

void PlantDevice::begin(const InjectedFault& order, std::vector<CanFrame>& out) {
  if (order.kind == InjectedKind::bus_off) {
    out.push_back({.id = error_bus_off, .length = 8, .error = true});
    return;
  }
  for (auto& node : nodes_) {
    if (node->name() != order.target) continue;
    const double code = order.value.value_or(usual_emergency);
    if (order.kind == InjectedKind::emergency) node->raise_emergency(static_cast<std::uint16_t>(code), 0x01, out);
    if (order.kind == InjectedKind::pre_operational)
      node->on_frame(nmt_frame(NmtCommand::enter_pre_operational, node->node()), now_ns_, out);
    if (order.kind == InjectedKind::reboot) node->power_on(now_ns_, out);
  }
}

}  // namespace pneuservo
