// A CANopen device as it stands on a bus.
#include "can/canopen_node.hpp"

#include <algorithm>
#include <limits>

namespace pneuservo {
namespace {

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t millisecond_ns = 1'000'000;
constexpr std::uint16_t receive_parameters = 0x1400, receive_mapping = 0x1600, transmit_parameters = 0x1800,
                        transmit_mapping = 0x1A00, consumer_heartbeat = 0x1016, producer_heartbeat = 0x1017,
                        error_behaviour = 0x1029;
constexpr std::uint8_t register_generic = 0x01, register_communication = 0x10;

bool in_range_of(std::uint16_t index, std::uint16_t first) { return index >= first && index < first + 4; }

}  // namespace

CanopenNode::CanopenNode(const NodeIdentity& identity)
    : identity_(identity),
      server_(identity.node, dictionary_, [this](std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
        return accept_write(index, sub, value);
      }) {
  add_communication_objects();
}

void CanopenNode::add_communication_objects() {
  dictionary_.add_number(0x1000, 0, 32, identity_.device_type, false, "Device type");
  dictionary_.add_number(0x1001, 0, 8, 0, false, "Error register");
  dictionary_.add_text(0x1008, identity_.name, "Manufacturer device name");
  dictionary_.name_object(consumer_heartbeat, "Consumer heartbeat time");
  dictionary_.add_number(consumer_heartbeat, 0, 8, 1, false, "Highest sub-index supported");
  dictionary_.add_number(consumer_heartbeat, 1, 32, 0, true, "Node (bits 16 to 22) and time in ms");
  dictionary_.add_number(producer_heartbeat, 0, 16, 0, true, "Producer heartbeat time");
  dictionary_.name_object(0x1018, "Identity object");
  dictionary_.add_number(0x1018, 0, 8, 1, false, "Highest sub-index supported");
  dictionary_.add_number(0x1018, 1, 32, 0, false, "Vendor-ID");
  dictionary_.name_object(error_behaviour, "Error behaviour");
  dictionary_.add_number(error_behaviour, 0, 8, 1, false, "Highest sub-index supported");
  dictionary_.add_number(error_behaviour, 1, 8, 0, true, "Communication error");
  for (std::uint16_t i = 0; i < 4; ++i)
    for (const bool transmit : {false, true}) add_pdo_objects(transmit, i);
}

void CanopenNode::add_pdo_objects(bool transmit, std::uint16_t i) {
  const auto parameters = static_cast<std::uint16_t>((transmit ? transmit_parameters : receive_parameters) + i);
  const auto mapping = static_cast<std::uint16_t>((transmit ? transmit_mapping : receive_mapping) + i);
  const std::uint32_t id =
      transmit ? cob_transmit_pdo(i + 1u, identity_.node) : cob_receive_pdo(i + 1u, identity_.node);
  const std::string which = (transmit ? "TPDO" : "RPDO") + std::to_string(i + 1);
  dictionary_.name_object(parameters, which + " communication parameter");
  dictionary_.add_number(parameters, 0, 8, transmit ? 5 : 2, false, "Highest sub-index supported");
  dictionary_.add_number(parameters, 1, 32, id | pdo_off, true, "COB-ID");
  dictionary_.find(parameters, 1)->adds_node = true;
  dictionary_.add_number(parameters, 2, 8, 255, true, "Transmission type");
  if (transmit) dictionary_.add_number(parameters, 3, 16, 0, true, "Inhibit time");
  if (transmit) dictionary_.add_number(parameters, 5, 16, 0, true, "Event timer");
  dictionary_.name_object(mapping, which + " mapping parameter");
  dictionary_.add_number(mapping, 0, 8, 0, true, "Number of mapped objects");
  for (std::uint8_t sub = 1; sub <= 8; ++sub)
    dictionary_.add_number(mapping, sub, 32, 0, true, "Mapped object " + std::to_string(sub));
}

void CanopenNode::map(bool transmit, std::uint32_t pdo, const std::vector<CanObject>& objects, std::uint8_t type) {
  const auto parameters = static_cast<std::uint16_t>((transmit ? transmit_parameters : receive_parameters) + pdo - 1);
  const auto mapping = static_cast<std::uint16_t>((transmit ? transmit_mapping : receive_mapping) + pdo - 1);
  dictionary_.set_number(parameters, 1, dictionary_.number(parameters, 1) & ~pdo_off);
  dictionary_.set_number(parameters, 2, type);
  dictionary_.set_number(mapping, 0, static_cast<std::uint32_t>(objects.size()));
  for (std::size_t i = 0; i < objects.size(); ++i)
    dictionary_.set_number(mapping, static_cast<std::uint8_t>(i + 1), objects[i].word);
}

void CanopenNode::add_output(CanObject output, const std::optional<CanSubstitute>& substitute) {
  dictionary_.add(output.index(), output.sub(), {.bits = output.bits(), .can_write = true, .can_map = true});
  if (!substitute) return;
  // A mode of 0: keep the last value.
  for (const CanObject& object : {substitute->mode, substitute->value})
    if (object.word != 0) dictionary_.add_number(object.index(), object.sub(), object.bits(), 0, true);
  substitutes_.emplace_back(output, *substitute);
}

void CanopenNode::power_on(std::int64_t now_ns, std::vector<CanFrame>& out) { reset(now_ns, out); }

void CanopenNode::reset(std::int64_t now_ns, std::vector<CanFrame>& out) {
  substitute_outputs();
  server_.reset();
  watch_ = {};
  dictionary_.set_number(consumer_heartbeat, 1, 0);
  dictionary_.set_number(producer_heartbeat, 0, 0);
  dictionary_.set_number(0x1001, 0, 0);
  dictionary_.set_number(guard_time, 0, 0);
  dictionary_.set_number(life_time_factor, 0, 0);
  substituted_ = guard_toggle_ = false;
  now_ns_ = now_ns;
  enter(NmtState::pre_operational);
  out.push_back(heartbeat_frame(identity_.node, NmtState::boot_up));
}

void CanopenNode::enter(NmtState state) {
  state_ = state;
  if (state == NmtState::operational) read_pdos();
  else
    for (Pdo& pdo : receive_) pdo.has_waiting = false;
}

void CanopenNode::on_nmt(NmtCommand command, std::int64_t now_ns, std::vector<CanFrame>& out) {
  switch (command) {
    case NmtCommand::start:
      enter(NmtState::operational);
      substituted_ = false;
      break;
    case NmtCommand::stop:
      substitute_outputs();
      enter(NmtState::stopped);
      break;
    case NmtCommand::enter_pre_operational: enter(NmtState::pre_operational); break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication: reset(now_ns, out); break;
  }
}

CanopenNode::Pdo CanopenNode::read_pdo(bool transmit, unsigned i) const {
  const auto parameters = static_cast<std::uint16_t>((transmit ? transmit_parameters : receive_parameters) + i);
  const auto mapping = static_cast<std::uint16_t>((transmit ? transmit_mapping : receive_mapping) + i);
  Pdo pdo;
  const std::uint32_t id = dictionary_.number(parameters, 1);
  pdo.enabled = (id & pdo_off) == 0;
  pdo.id = id & 0x7FF;
  pdo.type = static_cast<std::uint8_t>(dictionary_.number(parameters, 2));
  const std::uint32_t count = std::min<std::uint32_t>(dictionary_.number(mapping, 0), 8);
  for (std::uint32_t k = 1; k <= count; ++k) {
    pdo.objects.push_back({dictionary_.number(mapping, static_cast<std::uint8_t>(k))});
    pdo.bits += pdo.objects.back().bits();
  }
  pdo.enabled = pdo.enabled && pdo.bits > 0 && pdo.bits <= 64;
  const std::uint32_t timer_ms = transmit ? dictionary_.number(parameters, 5) : 0;
  pdo.next_event_ns = timer_ms == 0 ? never : now_ns_ + timer_ms * millisecond_ns;
  return pdo;
}

void CanopenNode::read_pdos() {
  for (unsigned i = 0; i < 4; ++i) {
    receive_[i] = read_pdo(false, i);
    transmit_[i] = read_pdo(true, i);
  }
}

SdoAbort CanopenNode::accept_write(std::uint16_t index, std::uint8_t sub, std::uint32_t value) const {
  if (in_range_of(index, receive_mapping) || in_range_of(index, transmit_mapping))
    return accept_mapping(index, sub, value);
  if (index == error_behaviour && value > 2) return SdoAbort::value;
  return accept_application ? accept_application(index, sub, value) : SdoAbort::none;
}

// The order that CiA 301 asks for: PDO off, number of entries 0, entries, number, PDO on.
SdoAbort CanopenNode::accept_mapping(std::uint16_t index, std::uint8_t sub, std::uint32_t value) const {
  const bool transmit = index >= transmit_mapping;
  if ((dictionary_.number(static_cast<std::uint16_t>(index - 0x200), 1) & pdo_off) == 0) return SdoAbort::state;
  if (sub > 0) {
    if (dictionary_.number(index, 0) != 0) return SdoAbort::state;
    const CanObject object{value};
    const DictionaryEntry* entry = dictionary_.find(object.index(), object.sub());
    if (entry == nullptr) return SdoAbort::no_object;
    if (!entry->can_map || entry->bits != object.bits() || (!transmit && !entry->can_write))
      return SdoAbort::not_mappable;
    return SdoAbort::none;
  }
  if (value > 8) return SdoAbort::value;
  unsigned bits = 0;
  for (std::uint32_t k = 1; k <= value; ++k)
    bits += CanObject{dictionary_.number(index, static_cast<std::uint8_t>(k))}.bits();
  return bits > 64 ? SdoAbort::mapping_length : SdoAbort::none;
}

void CanopenNode::apply(const Pdo& pdo, std::uint64_t image) {
  unsigned offset = 0;
  for (const CanObject& object : pdo.objects) {
    const auto raw = static_cast<std::uint32_t>(extract(image, {offset, object.bits()}));
    offset += object.bits();
    DictionaryEntry* entry = dictionary_.find(object.index(), object.sub());
    if (entry == nullptr || !entry->can_write) continue;
    entry->value = raw;
    ++entry->writes;
  }
}

std::uint64_t CanopenNode::image_to_send(const Pdo& pdo, std::span<const std::uint16_t> indices) const {
  std::uint64_t image = 0;
  unsigned offset = 0;
  for (const CanObject& object : pdo.objects) {
    if (indices.empty() || std::ranges::find(indices, object.index()) != indices.end())
      image = insert(image, {offset, object.bits()}, dictionary_.number(object.index(), object.sub()));
    offset += object.bits();
  }
  return image;
}

CanFrame CanopenNode::transmit(const Pdo& pdo) const {
  CanFrame frame{.id = pdo.id, .length = static_cast<std::uint8_t>((pdo.bits + 7) / 8)};
  put_image(frame.data, image_to_send(pdo, {}));
  return frame;
}

void CanopenNode::send_events(std::span<const std::uint16_t> indices, std::vector<CanFrame>& out) {
  if (state_ != NmtState::operational) return;
  for (Pdo& pdo : transmit_) {
    if (!pdo.enabled || pdo.type <= 240) continue;
    const std::uint64_t image = image_to_send(pdo, indices);
    if (pdo.told == image) continue;
    pdo.told = image;
    out.push_back(transmit(pdo));
  }
}

void CanopenNode::on_frame(const CanFrame& frame, std::int64_t now_ns, std::vector<CanFrame>& out) {
  now_ns_ = now_ns;
  if (const auto order = parse_nmt(frame)) {
    if (order->node == 0 || order->node == identity_.node) on_nmt(order->command, now_ns, out);
    return;
  }
  if (const auto heartbeat = parse_heartbeat(frame)) return on_heartbeat_of(heartbeat->node, now_ns);
  if (is_guard_request(frame, identity_.node)) return on_guard_request(now_ns, out);
  if (!is_plain(frame)) return;
  if (frame.id == cob_sdo_request + identity_.node && state_ != NmtState::stopped) {
    if (const auto answer = server_.answer(frame)) out.push_back(*answer);
    return;
  }
  if (state_ != NmtState::operational || is_deaf) return;
  for (Pdo& pdo : receive_) {
    if (!pdo.enabled || pdo.id != frame.id) continue;
    if (frame.length * 8u < pdo.bits) {
      raise_emergency(0x8210, register_generic | register_communication, out);  // PDO not processed: length
      return;
    }
    if (pdo.type <= 240) {
      pdo.waiting = image_of(frame.data);
      pdo.has_waiting = true;
    } else {
      apply(pdo, image_of(frame.data));
    }
  }
}

void CanopenNode::act_on_sync() {
  if (state_ != NmtState::operational) return;
  for (Pdo& pdo : receive_) {
    if (pdo.has_waiting) apply(pdo, pdo.waiting);
    pdo.has_waiting = false;
  }
}

void CanopenNode::answer_sync(std::vector<CanFrame>& out) {
  if (state_ != NmtState::operational) return;
  for (Pdo& pdo : transmit_) {
    if (!pdo.enabled || pdo.type == 0 || pdo.type > 240 || ++pdo.syncs < pdo.type) continue;
    pdo.syncs = 0;
    out.push_back(transmit(pdo));
  }
}

void CanopenNode::on_heartbeat_of(std::uint8_t node, std::int64_t now_ns) {
  const std::uint32_t wanted = dictionary_.number(consumer_heartbeat, 1);
  if (node != (wanted >> 16 & 0xFF) || (wanted & 0xFFFF) == 0) return;
  watch_ = {node, static_cast<std::int64_t>(wanted & 0xFFFF) * millisecond_ns, now_ns, true};
}

// Only devices that have the objects answer; life guarding begins with the first request.
void CanopenNode::on_guard_request(std::int64_t now_ns, std::vector<CanFrame>& out) {
  if (dictionary_.find(guard_time, 0) == nullptr || heartbeat_muted) return;
  out.push_back(guard_answer_frame({identity_.node, state_, guard_toggle_}));
  guard_toggle_ = !guard_toggle_;
  const std::int64_t life_ms =
      std::int64_t{dictionary_.number(guard_time, 0)} * dictionary_.number(life_time_factor, 0);
  if (life_ms > 0) watch_ = {0, life_ms * millisecond_ns, now_ns, true};
}

void CanopenNode::lose_master(std::int64_t, std::vector<CanFrame>& out) {
  watch_.running = false;
  raise_emergency(emergency_heartbeat_lost, register_generic | register_communication, out);
  substitute_outputs();
  substituted_ = true;
  const std::uint32_t behaviour = dictionary_.number(error_behaviour, 1);
  if (behaviour == 2) enter(NmtState::stopped);
  else if (behaviour == 0 && state_ == NmtState::operational) enter(NmtState::pre_operational);
}

void CanopenNode::substitute_outputs() {
  for (const auto& [output, substitute] : substitutes_) {
    const auto number = [&](CanObject object) { return dictionary_.number(object.index(), object.sub()); };
    if (substitute.mode.word != 0 && number(substitute.mode) != substitute.mode_value) continue;
    const std::uint32_t value = number(substitute.value) & static_cast<std::uint32_t>(low_bits(output.bits()));
    dictionary_.set_number(output.index(), output.sub(), value);
  }
}

void CanopenNode::on_time(std::int64_t now_ns, std::vector<CanFrame>& out) {
  now_ns_ = now_ns;
  const std::int64_t heartbeat_ns = dictionary_.number(producer_heartbeat, 0) * millisecond_ns;
  if (heartbeat_ns > 0 && !heartbeat_muted && now_ns >= next_heartbeat_ns_) {
    out.push_back(heartbeat_frame(identity_.node, state_));
    next_heartbeat_ns_ = std::max(next_heartbeat_ns_ + heartbeat_ns, now_ns);
  }
  if (watch_.running && now_ns - watch_.seen_ns > watch_.limit_ns) lose_master(now_ns, out);
  if (state_ != NmtState::operational) return;
  for (unsigned i = 0; i < 4; ++i) {
    Pdo& pdo = transmit_[i];
    if (!pdo.enabled || pdo.type <= 240 || now_ns < pdo.next_event_ns) continue;
    out.push_back(transmit(pdo));
    const auto parameters = static_cast<std::uint16_t>(transmit_parameters + i);
    pdo.next_event_ns = std::max(pdo.next_event_ns + dictionary_.number(parameters, 5) * millisecond_ns, now_ns);
  }
}

std::int64_t CanopenNode::next_due_ns() const noexcept {
  std::int64_t due = never;
  if (dictionary_.number(producer_heartbeat, 0) > 0 && !heartbeat_muted) due = next_heartbeat_ns_;
  if (watch_.running) due = std::min(due, watch_.seen_ns + watch_.limit_ns + 1);
  if (state_ == NmtState::operational)
    for (const Pdo& pdo : transmit_)
      if (pdo.enabled && pdo.type > 240) due = std::min(due, pdo.next_event_ns);
  return due;
}

void CanopenNode::raise_emergency(std::uint16_t code, std::uint8_t error_register, std::vector<CanFrame>& out) {
  dictionary_.set_number(0x1001, 0, error_register);
  if (state_ != NmtState::stopped) out.push_back(emergency_frame({identity_.node, code, error_register}));
}

}  // namespace pneuservo
