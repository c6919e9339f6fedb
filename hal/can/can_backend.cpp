// Backend `can`.
#include "can/can_backend.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "can/fluid_valve.hpp"
#include "can/open_carrier.hpp"
#include "config/input_error.hpp"
#include "input_wait.hpp"
#include "rig/bus_load.hpp"

namespace pneuservo {
namespace {

constexpr double answer_share = 0.9;       // of a period: later is too near to the next SYNC
constexpr double oldest_periods = 2.0;
constexpr double lost_after_heartbeats = 2.5;
constexpr int probes = 3;
constexpr int most_frames_a_tick = 256;    // a babbling node must not hold the loop
constexpr std::int64_t probe_timeout_ns = 1'000'000'000, start_timeout_ns = 2'000'000'000;

std::int64_t nanoseconds(double time_s) { return std::llround(time_s * 1e9); }

}  // namespace

CanBackend::CanBackend(const Rig& rig, std::unique_ptr<CanCarrier> bus)
    : rig_(rig), bus_(std::move(bus)), opens_(bus_ == nullptr), period_ns_(nanoseconds(rig.period_s)) {
  if (!rig.hal || !rig.hal->can)
    throw InputError(rig.name + ": hal.can: found nothing, expected the bus with its nodes (docs/can.md)");
  const CanBusParameters& can = *rig.hal->can;
  is_paced_ = can.sync == CanSync::foreign;
  sends_sync_ = !is_paced_;
  sync_timeout_ns_ = nanoseconds(can.sync_timeout_s > 0.0 ? can.sync_timeout_s : lost_after_heartbeats * rig.period_s);
  channels_ = can_channels(*rig.hal);
  heartbeat_ticks_ = std::max<std::int64_t>(std::llround(rig.hal->can->heartbeat_s / rig.period_s), 1);
}

CanBackend::~CanBackend() { deactivate(); }

void CanBackend::check_load() const {
  const BusLoad load = bus_load(rig_);
  if (load.share <= bus_load_limit) return;
  throw InputError(
      fmt::format("{}: hal.can: found a bus load of {}, expected at most {:.0f} %: a longer period_s, fewer "
                  "bytes, or DA/AD boards",
                  rig_.name, bus_load_text(load, rig_.period_s), 100.0 * bus_load_limit));
}

void CanBackend::check_against_eds(const CanChannel& channel, const EdsFile& eds) const {
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("{}: object 0x{:08x} of hal.channels.{}: {}", eds.source(), channel.object.word,
                                 channel.name, what));
  };
  const EdsObject* object = eds.find(channel.object.index(), channel.object.sub());
  if (object == nullptr)
    refuse(eds.describes_modules ? "found no such entry; the file describes modules ([...SubExt...]), whose objects "
                                   "are there only once they are plugged: leave hal.can.nodes.*.eds out"
                                 : "found no such entry, expected one that the device has");
  if (!object->can_map) refuse("found PDOMapping=0, expected an entry that can be mapped");
  if (object->bits() != channel.object.bits())
    refuse(fmt::format("found a data type of {} bits, expected {}", object->bits(), channel.object.bits()));
  if (object->is_signed() != channel.is_signed)
    refuse(fmt::format("found {} data, expected signed: {} in the config", object->is_signed() ? "signed" : "unsigned",
                       channel.is_signed));
}

void CanBackend::read_eds_files() {
  eds_.clear();
  for (const auto& [name, node] : rig_.hal->can->nodes)
    if (!node.eds.empty()) {
      const EdsFile& eds = eds_.emplace(name, EdsFile::read(node.eds)).first->second;
      if (eds.node != 0 && eds.node != node.node_id)
        throw InputError(fmt::format("{}: NodeID: found {}, expected {} (hal.can.nodes.{}.node_id): its values are for "
                                     "another node",
                                     eds.source(), eds.node, node.node_id, name));
    }
  for (const CanChannel& channel : channels_)
    if (const auto eds = eds_.find(channel.node); eds != eds_.end()) check_against_eds(channel, eds->second);
}

// Devices that watch us since an earlier run must not give up while the nodes are started.
void CanBackend::keep_alive(std::int64_t now_ns) {
  if (!active_) return;
  ask_guarded(now_ns, true);
  if (now_ns < next_alive_ns_) return;
  send_or_throw(own_heartbeat());
  next_alive_ns_ = now_ns + nanoseconds(rig_.hal->can->heartbeat_s);
}

// Those with outputs are no longer asked after a fault: their life guarding gives the substitute output then.
void CanBackend::ask_guarded(std::int64_t now_ns, bool with_outputs) noexcept {
  for (Guarded& guarded : guarded_) {
    if (now_ns < guarded.next_ns || (guarded.has_output && !with_outputs)) continue;
    if (bus_->send(guard_request_frame(guarded.node)) == Sent::sent) process_.on_guard_request(guarded.node);
    guarded.next_ns = now_ns + guarded.period_ns;
  }
}

CanFrame CanBackend::own_heartbeat() const noexcept {
  return heartbeat_frame(static_cast<std::uint8_t>(rig_.hal->can->node_id), NmtState::operational);
}

/// What nodes say of themselves before the loop runs.
void CanBackend::hear(const ReceivedFrame& received) {
  take_frame(received);
  if (const auto heartbeat = parse_guard_answer(received.frame)) {
    states_[heartbeat->node] = heartbeat->state;
    if (heartbeat->state == NmtState::boot_up) open_emergencies_.erase(heartbeat->node);
  } else if (const auto emergency = parse_emergency(received.frame)) {
    if (emergency->code >> 8 == 0) open_emergencies_.erase(emergency->node);
    else open_emergencies_[emergency->node] = *emergency;
  }
}

std::string CanBackend::words_of(std::uint8_t node) const {
  const auto emergency = open_emergencies_.find(node);
  return emergency == open_emergencies_.end() ? "" : "reported " + emergency_text(emergency->second);
}

void CanBackend::refuse_open_emergencies() const {
  for (const CanWatchedNode& node : process_.nodes())
    if (open_emergencies_.contains(node.node))
      throw std::runtime_error(fmt::format("{}: node {} ({}) {}: mend the cause before this axis moves", bus_->name(),
                                           node.name, node.node, words_of(node.node)));
}

template <class Wanted> bool CanBackend::receive_until(std::int64_t timeout_ns, const Wanted& wanted) {
  const std::int64_t end_ns = bus_->now_ns() + timeout_ns;
  for (std::int64_t now_ns = bus_->now_ns(); now_ns < end_ns; now_ns = bus_->now_ns()) {
    ReceivedFrame received;
    while (bus_->receive(received)) {
      hear(received);
      if (wanted(received)) return true;
    }
    if (!bus_->is_up()) throw std::runtime_error(bus_->name() + ": the link went down");
    keep_alive(now_ns);
    bus_->wait(std::min(end_ns, next_alive_ns_) - now_ns);
  }
  return false;
}

void CanBackend::send_or_throw(const CanFrame& frame) {
  if (bus_->send(frame) != Sent::sent)
    throw std::runtime_error(fmt::format("{}: frame 0x{:03x} could not be sent: is the bus connected and terminated?",
                                         bus_->name(), frame.id));
}

void CanBackend::wait_for_boot(const std::string& name, const CanNodeParameters& node) {
  const auto number = static_cast<std::uint8_t>(node.node_id);
  send_or_throw(nmt_frame(NmtCommand::reset_communication, number));
  const bool came = receive_until(nanoseconds(node.boot_timeout_s), [&](const ReceivedFrame& received) {
    const auto heartbeat = parse_heartbeat(received.frame);
    return heartbeat && heartbeat->node == number && heartbeat->state == NmtState::boot_up;
  });
  if (!came)
    throw std::runtime_error(
        fmt::format("{}: node {} ({}) did not come up within {:g} s after a reset: is it there, with "
                    "this number and {:g} bit/s?",
                    bus_->name(), name, number, node.boot_timeout_s, rig_.hal->can->bit_rate_bps));
}

void CanBackend::set_up_node(CanWatchedNode& watched, std::vector<CanInputPdo>& inputs,
                             std::vector<CanOutputPdo>& outputs) {
  const std::string& name = watched.name;
  const CanNodeParameters& node = rig_.hal->can->nodes.at(name);
  wait_for_boot(name, node);
  // A node that starts itself: objects of PDOs may be written in pre-operational alone.
  send_or_throw(nmt_frame(NmtCommand::enter_pre_operational, watched.node));
  SdoClient sdo(
      *bus_, watched.node, name, [this](const ReceivedFrame& received) { hear(received); }, node.sdo_timeout_s);
  const auto eds = eds_.find(name);
  const NodeSetup setup{rig_, channels_, name, eds == eds_.end() ? nullptr : &eds->second};
  NodeConfigurator configurator(sdo, setup);
  configurator.write_parameters();
  const std::vector<CanPdo> pdos = can_pdos(channels_);
  configurator.turn_off_others(pdos);
  for (const CanPdo& pdo : pdos) {
    if (pdo.node != name) continue;
    const SetUpPdo done = configurator.set_up_pdo(pdo);
    std::vector<CanSignal> signals;
    for (const std::size_t i : pdo.signals) {
      const CanChannel& c = channels_[i];
      const CountScale counts = CountScale{c.scale, c.zero, c.is_signed, c.object.bits()}.wrapped(
          configurator.wrap_counts(c), c.lowest, c.highest);
      signals.push_back({c.signal,
                         c.command,
                         {*done.place_of(c.object), c.object.bits()},
                         counts,
                         c.lowest,
                         c.highest,
                         c.is_readback,
                         c.tolerance_V});
    }
    const auto length = static_cast<std::uint8_t>((done.bits() + 7) / 8);
    if (pdo.is_output) outputs.push_back({done.id, length, signals});
    else
      inputs.push_back({done.id, static_cast<std::uint8_t>(node.node_id), length,
                        node.transmission == CanTransmission::sync, nanoseconds(oldest_periods * rig_.period_s),
                        std::llround(lost_after_heartbeats * node.heartbeat_s / rig_.period_s) + 1, signals});
  }
  configurator.refuse_errors();
  if (configurator.is_valve()) valves_.push_back(watched.node);
  watched.is_guarded = configurator.is_guarded();
  if (watched.is_guarded) guarded_.push_back({watched.node, watched.has_output, watched.heartbeat_ns, 0});
  if (!configurator.has_heartbeat()) watched.silence_ns = watched.heartbeat_ns = 0;
  setup_notes_.insert(setup_notes_.end(), configurator.notes().begin(), configurator.notes().end());
}

std::vector<std::uint32_t> CanBackend::process_ids() const {
  std::vector<std::uint32_t> ids{cob_sync, cob_heartbeat + rig_.hal->can->node_id};
  for (const CanInputPdo& input : process_.inputs()) ids.push_back(input.id);
  for (const std::uint8_t node : node_numbers_) {
    ids.push_back(cob_heartbeat + node);
    ids.push_back(cob_emergency + node);
  }
  return ids;
}

void CanBackend::configure() {
  check_load();
  read_eds_files();
  const CanBusParameters& can = *rig_.hal->can;
  // An interface that went down stays down for its socket: the way back opens a new one.
  if (opens_) {
    bus_.reset();
    lock_.reset();
    lock_ = std::make_unique<BusLock>(can);
    bus_ = open_carrier(can.interface, can.bit_rate_bps, false);
  }
  node_numbers_.clear();
  open_emergencies_.clear();
  states_.clear();
  setup_notes_.clear();
  valves_.clear();
  guarded_.clear();
  foreign_ = {};
  sends_sync_ = !is_paced_;
  std::vector<std::uint32_t> ids{cob_sync, cob_heartbeat + can.node_id};
  std::vector<CanWatchedNode> watched;
  for (const auto& [name, node] : can.nodes) {
    const auto number = static_cast<std::uint8_t>(node.node_id);
    node_numbers_.push_back(number);
    ids.insert(ids.end(), {cob_sdo_answer + number, cob_heartbeat + number, cob_emergency + number});
    const bool has_output = std::any_of(channels_.begin(), channels_.end(),
                                        [&](const CanChannel& c) { return c.is_output && c.node == name; });
    watched.push_back({name, number, nanoseconds(lost_after_heartbeats * node.heartbeat_s),
                       nanoseconds(node.heartbeat_s), has_output});
  }
  bus_->accept_only(ids);
  const auto own = static_cast<std::uint8_t>(can.node_id);
  process_ = CanProcessImage({}, {}, watched, own);
  refuse_second_master();
  if (is_paced_) check_foreign_sync();
  std::vector<CanInputPdo> inputs;
  std::vector<CanOutputPdo> outputs;
  for (CanWatchedNode& node : watched) set_up_node(node, inputs, outputs);
  process_ = CanProcessImage(std::move(inputs), std::move(outputs), std::move(watched), own);
  bus_->accept_only(process_ids());
}

// Before a node is reset: another controller may be moving its axis. It shows within its heartbeat, taken as ours.
void CanBackend::refuse_second_master() {
  const double longest_s = std::max(lost_after_heartbeats * rig_.hal->can->heartbeat_s, 2.0 * rig_.period_s);
  receive_until(nanoseconds(longest_s), [&](const ReceivedFrame&) { return process_.master_frames() > 0; });
  if (process_.master_frames() > 0)
    throw std::runtime_error(
        fmt::format("{}: somebody else sends SYNC or has number {} (hal.can.node_id): end the other "
                    "master before this axis moves; one whose SYNC shall be kept: hal.can.sync: foreign",
                    bus_->name(), rig_.hal->can->node_id));
}

// The loop's period is the master's.
void CanBackend::check_foreign_sync() {
  const std::uint64_t before = foreign_.count;
  std::int64_t first_ns = 0;
  receive_until(2 * timed_periods * period_ns_ + probe_timeout_ns, [&](const ReceivedFrame&) {
    if (first_ns == 0 && foreign_.count > before) first_ns = foreign_.at_ns;
    return foreign_.count - before > std::uint64_t{timed_periods};
  });
  const auto count = static_cast<std::int64_t>(foreign_.count - before);
  const std::int64_t span_ns = foreign_.at_ns - first_ns;
  if (count > timed_periods && keeps_period(span_ns, timed_periods, rig_.period_s)) return;
  const double span_s = static_cast<double>(span_ns) * 1e-9;
  throw std::runtime_error(
      fmt::format("{}: hal.can.sync is foreign: found {}, expected one every {:g} s (period_s): start the master that "
                  "sends SYNC, give both the same period, or hal.can.sync: own",
                  bus_->name(),
                  count > 1 ? fmt::format("a SYNC every {:.4g} s", span_s / static_cast<double>(count - 1))
                            : fmt::format("{} SYNC", count),
                  rig_.period_s));
}

void CanBackend::wait_until_operational() {
  std::vector<const CanWatchedNode*> waiting;
  for (const CanWatchedNode& node : process_.nodes()) {
    send_or_throw(nmt_frame(NmtCommand::start, node.node));
    if (node.heartbeat_ns > 0) waiting.push_back(&node);
  }
  receive_until(start_timeout_ns, [&](const ReceivedFrame& received) {
    const auto heartbeat = parse_guard_answer(received.frame);
    if (heartbeat && heartbeat->state == NmtState::operational)
      std::erase_if(waiting, [&](const CanWatchedNode* node) { return node->node == heartbeat->node; });
    return waiting.empty();
  });
  if (waiting.empty()) return;
  const CanWatchedNode& node = *waiting.front();
  const auto state = states_.find(node.node);
  throw std::runtime_error(
      fmt::format("{}: node {} ({}) did not become operational within 2 s{}{}{}: see its manual for what holds "
                  "it back",
                  bus_->name(), node.name, node.node,
                  state == states_.end() ? "" : fmt::format(", it stays {}", nmt_state_word(state->second)),
                  open_emergencies_.contains(node.node) ? "; it " : "", words_of(node.node)));
}

// An answer that always comes after the next SYNC would look like a quick one of a wrong age: the bus is quiet now.
void CanBackend::check_answers() {
  std::int64_t quickest_ns = std::numeric_limits<std::int64_t>::max();
  int doubled = 0;
  const CanInputPdo* twice = nullptr;
  for (int probe = 0; probe < probes; ++probe) {
    process_.start(bus_->now_ns());
    const std::uint64_t before = foreign_.count;
    if (!send_outputs(safe_outputs_V(rig_))) throw std::runtime_error(bus_->name() + ": SYNC could not be sent");
    const bool all = receive_until(probe_timeout_ns, [&](const ReceivedFrame&) {
      return (sends_sync_ || foreign_.count > before) && process_.all_answered();
    });
    const bool any_expected = !process_.inputs().empty();
    if (any_expected && !all) {
      std::string who;
      for (const std::string& silent : process_.unanswered())
        who += fmt::format("{}{}", who.empty() ? "" : "; ", silent);
      for (const CanWatchedNode& node : process_.nodes())
        if (open_emergencies_.contains(node.node)) who += fmt::format("; node {} {}", node.name, words_of(node.node));
      throw std::runtime_error(fmt::format("{}: no sample within 1 s: {}", bus_->name(), who));
    }
    quickest_ns = std::min(quickest_ns, process_.counts().slowest_answer_ns);
    if (is_paced_) continue;  // the loop finds it: a period of silence would be another SYNC
    // A second device with the same number is as quick as the first.
    receive_until(period_ns_, [](const ReceivedFrame&) { return false; });
    if (process_.answered_twice() != nullptr) twice = process_.answered_twice(), ++doubled;
  }
  // One of three may be a frame that the bus repeated.
  if (doubled > 1)
    throw std::runtime_error(
        fmt::format("{}: PDO 0x{:03x} answers a SYNC more than once: a second device has number {}, "
                    "or a second master sends SYNC; take it off the bus",
                    bus_->name(), twice->id, twice->node));
  if (static_cast<double>(quickest_ns) > answer_share * static_cast<double>(period_ns_))
    throw std::runtime_error(fmt::format(
        "{}: the slowest answer to SYNC took {:.0f} us at best, expected at most {:.0f} us "
        "(0.9 periods)",
        bus_->name(), static_cast<double>(quickest_ns) * 1e-3, answer_share * static_cast<double>(period_ns_) * 1e-3));
}

// CiA 408: the spool follows its set point in the state ACTIVE alone. The set point is the safe output since the first
// SYNC.
void CanBackend::activate_valves() {
  std::vector<std::uint32_t> ids = process_ids();
  for (const std::uint8_t node : valves_) ids.push_back(cob_sdo_answer + node);
  if (!valves_.empty()) bus_->accept_only(ids);
  for (const CanWatchedNode& node : process_.nodes()) {
    if (std::ranges::find(valves_, node.node) == valves_.end()) continue;
    const auto others = [this](const ReceivedFrame& received) {
      hear(received);
      keep_alive(bus_->now_ns());
    };
    SdoClient sdo(*bus_, node.node, node.name, others, rig_.hal->can->nodes.at(node.name).sdo_timeout_s);
    if (const std::string note = activate_valve(sdo); !note.empty())
      setup_notes_.push_back(fmt::format("node {} ({}): {}", node.name, node.node, note));
  }
  if (!valves_.empty()) bus_->accept_only(process_ids());
}

void CanBackend::activate() {
  if (!bus_) throw std::runtime_error("backend can: activated without configure");
  active_ = true;
  sends_sync_ = !is_paced_;
  next_alive_ns_ = bus_->now_ns();
  process_.start(bus_->now_ns());
  wait_until_operational();
  check_answers();
  activate_valves();
  refuse_open_emergencies();
  start_ns_ = bus_->now_ns();
  dropped_before_ = bus_->dropped();
  queue_full_ = 0;
  next_heartbeat_tick_ = std::numeric_limits<std::int64_t>::min();
  cycling_ = ended_ = is_awaited_ = false;
  foreign_ = {};
  unconfirmed_cycles_ = 0;
  safe_output_ = {.has_outputs = process_.outputs() > 0, .is_read_back = process_.outputs_are_read_back()};
}

void CanBackend::take_frame(const ReceivedFrame& received) noexcept {
  newest_frame_ns_ = received.received_ns;
  if (sends_sync_ || !is_sync(received.frame)) return process_.on_frame(received);
  // A second master's, too: it would be double answers.
  const double periods = static_cast<double>(received.received_ns - foreign_.at_ns) / static_cast<double>(period_ns_);
  foreign_.periods += foreign_.at_ns == 0 ? 1 : std::max<std::int64_t>(std::llround(periods), 1);
  foreign_.at_ns = received.received_ns;
  ++foreign_.count;
  process_.begin_cycle(received.received_ns, commands_V_);
}

/// False: there may be more.
bool CanBackend::take_waiting_frames() noexcept {
  ReceivedFrame received;
  for (int i = 0; i < most_frames_a_tick; ++i) {
    if (!bus_->receive(received)) return true;
    take_frame(received);
  }
  return false;
}

// From here on we send SYNC, so that the safe output acts. Where the other master's SYNC is lost on its way to us
// alone, the devices get two a period: they sample and act twice as often, which does no harm with the valve closed.
void CanBackend::give_up_sync(std::int64_t now_ns) noexcept {
  sends_sync_ = true;
  process_.on_sync_missing(now_ns);
}

Pace CanBackend::await_sample() noexcept {
  const std::int64_t begun_ns = bus_->now_ns();
  const std::int64_t answers_ns = std::llround(answer_share * static_cast<double>(period_ns_));
  foreign_.periods = 0;
  std::int64_t at_ns = 0;
  for (std::int64_t now_ns = begun_ns; at_ns == 0; now_ns = bus_->now_ns()) {
    const bool is_empty = take_waiting_frames();
    if (!bus_->is_up()) sends_sync_ = true;  // nothing to wait for
    const bool has_sample = foreign_.periods > 0 && !sends_sync_;
    const std::int64_t since_ns = foreign_.at_ns == 0 || sends_sync_ ? begun_ns : foreign_.at_ns;
    const std::int64_t end_ns = since_ns + (sends_sync_ ? period_ns_ : has_sample ? answers_ns : sync_timeout_ns_);
    if (has_sample && is_empty && process_.all_answered()) at_ns = newest_frame_ns_;
    else if (now_ns >= end_ns) at_ns = now_ns;
    else if (is_empty) bus_->wait(end_ns - now_ns);
    if (now_ns >= end_ns && !has_sample && !sends_sync_) give_up_sync(now_ns);
  }
  const std::int64_t periods = sends_sync_ ? 0 : cycling_ ? foreign_.periods : 1;
  is_awaited_ = cycling_ = true;
  return {periods, at_ns};
}

bool CanBackend::read(std::int64_t tick, Measurement& measurement) noexcept {
  if (!bus_) return false;
  if (!is_awaited_) take_waiting_frames();
  is_awaited_ = false;
  const std::int64_t now_ns = bus_->now_ns();
  if (!bus_->is_up()) process_.on_link_down(now_ns);
  // Before the first SYNC of the loop there is no sample of a known age; the loop waits for it.
  if (cycling_) process_.take(now_ns, measurement);
  else measurement.device_faults |= process_.faults();
  if (ended_) follow_safe_output(tick);
  return true;
}

void CanBackend::follow_safe_output(std::int64_t tick) noexcept {
  SafeOutput& safe = safe_output_;
  const bool shown = safe.sent_tick >= 0 && safe.is_read_back && process_.outputs_confirmed();
  if (shown && safe.confirmed_tick < 0) safe.confirmed_tick = tick;
  if (safe.sent_tick >= 0 && safe.is_read_back) unconfirmed_cycles_ = shown ? 0 : unconfirmed_cycles_ + 1;
  if (process_.all_substituted() && safe.substitute_tick < 0) safe.substitute_tick = tick;
}

bool CanBackend::send_outputs(const std::array<double, 2>& commands) noexcept {
  bool all = true;
  for (std::size_t i = 0; i < process_.outputs(); ++i)
    all = bus_->send(process_.output(i, commands)) == Sent::sent && all;
  commands_V_ = commands;
  if (!sends_sync_) {
    if (!all) ++queue_full_;
    return all;
  }
  process_.begin_cycle(bus_->now_ns(), commands);
  all = bus_->send(sync_frame()) == Sent::sent && all;
  if (!all) ++queue_full_;
  return all;
}

// The device shows another output than the safe one: its process data are not ours. A stopped node takes none.
void CanBackend::stop_unconfirmed_outputs(std::int64_t tick) noexcept {
  if (safe_output_.stop_tick >= 0 || safe_output_.substitute_tick >= 0) return;
  if (unconfirmed_cycles_ <= CanProcessImage::most_unconfirmed) return;
  for (const CanWatchedNode& node : process_.nodes())
    if (node.has_output) bus_->send(nmt_frame(NmtCommand::stop, node.node));
  safe_output_.stop_tick = tick;
}

bool CanBackend::write(std::int64_t tick, const Command& command) noexcept {
  if (!bus_) return false;
  // Whatever were handed over now would wait in the queue and act when the bus comes back.
  if ((process_.faults() & (device_bus_off | device_link_down)) != 0) return false;
  process_.let_go(command.ended);
  ended_ = command.ended;
  if (!guarded_.empty()) ask_guarded(bus_->now_ns(), !ended_);
  const bool all = send_outputs(outputs_V(rig_, {command.valve_V, command.valve_2_V}));
  cycling_ = true;
  if (ended_) {
    if (all && safe_output_.sent_tick < 0) safe_output_.sent_tick = tick;
    stop_unconfirmed_outputs(tick);
    return all;
  }
  if (tick >= next_heartbeat_tick_ && bus_->send(own_heartbeat()) == Sent::sent)
    next_heartbeat_tick_ = tick + heartbeat_ticks_;
  return all;
}

void CanBackend::deactivate() noexcept {
  if (!bus_ || !active_) return;
  active_ = false;
  next_alive_ns_ = std::numeric_limits<std::int64_t>::max();
  dropped_ = bus_->dropped() - dropped_before_;
  if ((process_.faults() & (device_bus_off | device_link_down)) != 0) return;
  sends_sync_ = true;  // whatever the other master does, the last outputs act
  send_outputs(safe_outputs_V(rig_));
  for (const std::uint8_t node : node_numbers_) bus_->send(nmt_frame(NmtCommand::enter_pre_operational, node));
}

bool CanBackend::emergency_write() noexcept {
  if (!bus_ || !active_) return true;
  sends_sync_ = true;
  bool all = send_outputs(safe_outputs_V(rig_));
  for (const std::uint8_t node : node_numbers_)
    all = bus_->send(nmt_frame(NmtCommand::enter_pre_operational, node)) == Sent::sent && all;
  return all;
}

Origins CanBackend::origins() const {
  Origins all;
  for (const CanChannel& channel : channels_)
    if (!channel.is_readback) (channel.is_output ? all.command : all.channels[channel.signal]) = Origin::real;
  return all;
}

std::vector<std::string> CanBackend::notes() const {
  std::vector<std::string> lines;
  for (const std::string& line : setup_notes_) lines.push_back("can: " + line);
  for (const std::string& line : process_.event_lines(start_ns_)) lines.push_back("can: " + line);
  const CanCounts& counts = process_.counts();
  lines.push_back(fmt::format(
      "can: {} samples, {} missed, {} late, {} out of limits, {} malformed, {} error frames, {} "
      "outputs not sent, {} frames dropped, slowest answer {:.0f} us, {} foreign frames",
      counts.answers, counts.missed, counts.late, counts.out_of_limits, counts.malformed, counts.error_frames,
      queue_full_, dropped_, static_cast<double>(counts.slowest_answer_ns) * 1e-3, counts.foreign));
  return lines;
}

}  // namespace pneuservo
