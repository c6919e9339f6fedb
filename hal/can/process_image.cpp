// What the control loop does with frames.
#include "can/process_image.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace pneuservo {

CanProcessImage::CanProcessImage(std::vector<CanInputPdo> inputs, std::vector<CanOutputPdo> outputs,
                                 std::vector<CanWatchedNode> nodes, std::uint8_t own_node)
    : inputs_(std::move(inputs)), outputs_(std::move(outputs)), nodes_(std::move(nodes)), samples_(inputs_.size()),
      watches_(nodes_.size()), own_node_(own_node) {}

void CanProcessImage::start(std::int64_t now_ns) noexcept {
  for (Sample& sample : samples_) sample = {};
  for (Watch& watch : watches_) watch = {.seen_ns = now_ns, .toggle = watch.toggle};
  sync_ns_ = now_ns;
  faults_ = 0;
  counts_ = {};
  event_count_ = 0;
  sent_ = {};
  master_balance_ = {};
  master_frames_ = master_frames_before_ = 0;
  in_cycle_ = let_go_ = confirmed_ = false;
}

void CanProcessImage::begin_cycle(std::int64_t now_ns, const std::array<double, 2>& commands) noexcept {
  if (in_cycle_) close_answers(now_ns);
  in_cycle_ = true;
  sync_ns_ = now_ns;
  for (Sample& sample : samples_) sample.answers = sample.arrivals = 0;
  for (std::size_t i = 0; i < sent_.size(); ++i) {
    sent_[i].before = sent_[i].now;
    sent_[i].now = commands[i];
  }
}

// A second device with a node's number, or a second master whose SYNC is answered too.
void CanProcessImage::close_answers(std::int64_t now_ns) noexcept {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (!inputs_[i].on_sync) continue;
    const bool doubled = samples_[i].balance.end_cycle(samples_[i].arrivals, inputs_[i].most_owed);
    if (!doubled || (faults_ & device_double_answer) != 0) continue;
    faults_ |= device_double_answer;
    note(CanEvent::Kind::double_answer, inputs_[i].node, inputs_[i].id, now_ns);
  }
  // Of these none is expected: the cycle's own frame is what the balance takes off.
  const auto others = static_cast<std::uint32_t>(master_frames_ - master_frames_before_);
  master_frames_before_ = master_frames_;
  if (!master_balance_.end_cycle(others + 1, 0) || (faults_ & device_double_answer) != 0) return;
  faults_ |= device_double_answer;
  note(CanEvent::Kind::second_master, 0, 0, now_ns);
}

int CanProcessImage::watched(std::uint8_t node) const noexcept {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i].node == node) return static_cast<int>(i);
  return -1;
}

void CanProcessImage::note(CanEvent::Kind kind, std::uint8_t node, std::uint32_t detail, std::int64_t at_ns) noexcept {
  if (event_count_ < events_.size()) events_[event_count_++] = {kind, node, detail, at_ns};
}

void CanProcessImage::on_frame(const ReceivedFrame& received) noexcept {
  const CanFrame& frame = received.frame;
  if (frame.error) return on_error(received);
  if (is_plain(frame)) {
    for (std::size_t i = 0; i < inputs_.size(); ++i)
      if (inputs_[i].id == frame.id) return on_process_data(i, received);
    if (is_sync(frame) || (own_node_ != 0 && frame.id == cob_heartbeat + own_node_)) {
      ++master_frames_;
      return;
    }
    if (const auto answer = parse_guard_answer(frame)) return on_guard_answer(*answer, received.received_ns);
    if (const auto emergency = parse_emergency(frame)) return on_emergency(*emergency, received.received_ns);
  }
  ++counts_.foreign;
}

void CanProcessImage::on_error(const ReceivedFrame& received) noexcept {
  ++counts_.error_frames;
  if ((received.frame.id & error_bus_off) != 0) {
    if ((faults_ & device_bus_off) == 0) note(CanEvent::Kind::bus_off, 0, 0, received.received_ns);
    faults_ |= device_bus_off;
  }
  // A controller that was restarted behind our back may have sent old commands: still a fault.
  if ((received.frame.id & error_restarted) != 0) {
    note(CanEvent::Kind::restarted, 0, 0, received.received_ns);
    faults_ |= device_bus_off;
  }
}

void CanProcessImage::on_link_down(std::int64_t now_ns) noexcept {
  if ((faults_ & device_link_down) == 0) note(CanEvent::Kind::link_down, 0, 0, now_ns);
  faults_ |= device_link_down;
}

void CanProcessImage::on_process_data(std::size_t input, const ReceivedFrame& received) noexcept {
  const CanInputPdo& pdo = inputs_[input];
  Sample& sample = samples_[input];
  // A longer frame is taken by its first bytes, as CiA 301 has it.
  if (received.frame.length < pdo.length) {
    ++counts_.malformed;
    sample.short_length = received.frame.length;
    return;
  }
  ++sample.arrivals;
  if (pdo.on_sync) {
    // After the end the bus is read off the loop's grid: two answers in one look are late to nothing.
    const std::uint64_t late = let_go_ ? 0 : 1;
    if (received.received_ns < sync_ns_) {  // the answer to an earlier SYNC, older than a period
      counts_.late += late;
      return;
    }
    if (++sample.answers > 1) counts_.late += late;  // where one node answers, the first was of an earlier cycle
    counts_.slowest_answer_ns = std::max(counts_.slowest_answer_ns, received.received_ns - sync_ns_);
  }
  sample.image = image_of(received.frame.data);
  sample.received_ns = received.received_ns;
  sample.ever = true;
}

void CanProcessImage::on_sync_missing(std::int64_t now_ns) noexcept {
  note(CanEvent::Kind::no_sync, 0, 0, now_ns);
  faults_ |= device_node_lost;
}

void CanProcessImage::on_guard_request(std::uint8_t node) noexcept {
  if (const int i = watched(node); i >= 0) ++watches_[static_cast<std::size_t>(i)].guard_requests;
}

// CiA 301: the toggle bit changes with each answer; one that repeats it is dropped, unless an answer was lost before it
// or the node booted. In a heartbeat the bit is 0: a frame of a node that is not guarded, with the bit, tells no state.
void CanProcessImage::on_guard_answer(const GuardAnswer& answer, std::int64_t at_ns) noexcept {
  const int i = watched(answer.node);
  const bool is_guarded = i >= 0 && nodes_[static_cast<std::size_t>(i)].is_guarded;
  if (is_guarded) {
    Watch& watch = watches_[static_cast<std::size_t>(i)];
    const bool is_lost_count = std::exchange(watch.guard_requests, 0) > 1 || answer.state == NmtState::boot_up;
    if (!is_lost_count && answer.toggle != watch.toggle) {
      ++counts_.malformed;
      return;
    }
    watch.toggle = answer.state != NmtState::boot_up && !answer.toggle;
  } else if (answer.toggle) {
    ++counts_.foreign;
    return;
  }
  on_heartbeat({answer.node, answer.state}, at_ns);
}

void CanProcessImage::on_heartbeat(const Heartbeat& heartbeat, std::int64_t at_ns) noexcept {
  const int i = watched(heartbeat.node);
  if (i < 0) {
    ++counts_.foreign;
    return;
  }
  Watch& watch = watches_[static_cast<std::size_t>(i)];
  watch.seen_ns = std::max(watch.seen_ns, at_ns);
  count_heartbeat(static_cast<std::size_t>(i), at_ns);
  if (heartbeat.state == NmtState::operational) return;
  // A node that watches our heartbeat leaves that state when we withhold it. Stopped, its outputs are the substitutes.
  const bool is_let_go = let_go_ && nodes_[static_cast<std::size_t>(i)].has_output;
  if (is_let_go && heartbeat.state == NmtState::stopped) watch.substituted = true;
  if (watch.lost) return;
  watch.lost = true;
  if (!is_let_go || heartbeat.state == NmtState::boot_up) faults_ |= device_node_lost;
  note(CanEvent::Kind::left_operational, heartbeat.node, static_cast<std::uint32_t>(heartbeat.state), at_ns);
}

// Two devices with one number send twice as many heartbeats: found also where their inputs come by their own timer.
void CanProcessImage::count_heartbeat(std::size_t node, std::int64_t at_ns) noexcept {
  Watch& watch = watches_[node];
  const CanWatchedNode& known = nodes_[node];
  const std::int64_t since_ns = at_ns - watch.beat_ns;
  const bool is_first = watch.beat_ns == 0 || known.heartbeat_ns == 0;
  watch.beat_ns = at_ns;
  if (is_first) return;
  const double period_ns = static_cast<double>(known.heartbeat_ns);
  const double due = static_cast<double>(since_ns) / period_ns,
               most_owed = static_cast<double>(known.silence_ns) / period_ns;
  if (!watch.balance.add(1.0, due, most_owed) || (faults_ & device_double_answer) != 0) return;
  faults_ |= device_double_answer;
  note(CanEvent::Kind::double_answer, known.node, cob_heartbeat + known.node, at_ns);
}

void CanProcessImage::on_emergency(const Emergency& emergency, std::int64_t at_ns) noexcept {
  const int node = watched(emergency.node);
  if (node < 0) {
    ++counts_.foreign;
    return;
  }
  if (let_go_ && emergency.code == emergency_heartbeat_lost) return on_our_absence(node, at_ns);
  const bool gone = (emergency.code >> 8) == 0;
  note(gone ? CanEvent::Kind::emergency_gone : CanEvent::Kind::emergency, emergency.node,
       static_cast<std::uint32_t>(emergency.code) << 8 | emergency.error_register, at_ns);
  if (!gone) faults_ |= device_emergency;
}

void CanProcessImage::look_for_silence(std::int64_t now_ns) noexcept {
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    Watch& watch = watches_[i];
    if (watch.lost || nodes_[i].silence_ns == 0 || now_ns - watch.seen_ns <= nodes_[i].silence_ns) continue;
    watch.lost = true;
    faults_ |= device_node_lost;
    note(CanEvent::Kind::silent, nodes_[i].node, 0, now_ns);
  }
}

void CanProcessImage::take(std::int64_t now_ns, Measurement& measurement) noexcept {
  look_for_silence(now_ns);
  confirmed_ = true;
  const bool bus_works = (faults_ & (device_bus_off | device_link_down)) == 0;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const CanInputPdo& pdo = inputs_[i];
    const Sample& sample = samples_[i];
    // On SYNC the node samples when the SYNC comes; else the time of arrival is all that is known.
    const std::int64_t sampled_ns = pdo.on_sync ? sync_ns_ : sample.received_ns;
    const bool answered = pdo.on_sync ? sample.answers > 0 : sample.ever;
    const bool fresh = answered && now_ns - sampled_ns <= pdo.oldest_ns;
    if (fresh) ++counts_.answers;
    else ++counts_.missed;
    const double age_s = static_cast<double>(now_ns - sampled_ns) * 1e-9;
    for (const CanSignal& signal : pdo.signals) {
      const double value = signal.counts.value_of(extract(sample.image, signal.place));
      if (signal.is_readback) {
        if (bus_works) check_output(signal, value, fresh, pdo.node, now_ns);
        continue;
      }
      const bool within = value >= signal.lowest && value <= signal.highest;
      if (fresh && !within) ++counts_.out_of_limits;
      measurement.channel[signal.signal] = {value, age_s, fresh && within && bus_works, Origin::real};
    }
  }
  measurement.device_faults |= faults_;
}

// A device shows the command of this SYNC or of the one before; between both it may be on its way.
void CanProcessImage::check_output(const CanSignal& signal, double value, bool fresh, std::uint8_t node,
                                   std::int64_t now_ns) noexcept {
  Sent& sent = sent_[signal.command];
  const auto held = [&](double command) {
    return std::clamp(command == command ? command : 0.0, signal.lowest, signal.highest);
  };
  const double now = held(sent.now), before = held(sent.before);
  const bool shown =
      fresh && value >= std::min(now, before) - signal.tolerance && value <= std::max(now, before) + signal.tolerance;
  confirmed_ = confirmed_ && fresh && std::fabs(value - now) <= signal.tolerance;
  // Where the device's watchdog was let act, no answer is its consequence.
  if (shown || (let_go_ && !fresh)) sent.unconfirmed = 0;
  else ++sent.unconfirmed;
  if (sent.unconfirmed <= most_unconfirmed || (faults_ & device_output_unconfirmed) != 0) return;
  faults_ |= device_output_unconfirmed;
  note(CanEvent::Kind::not_read_back, node, 0, now_ns);
}

bool CanProcessImage::outputs_are_read_back() const noexcept {
  std::array<int, 2> outputs{}, shown{};
  for (const CanOutputPdo& pdo : outputs_)
    for (const CanSignal& signal : pdo.signals) ++outputs[signal.command];
  for (const CanInputPdo& pdo : inputs_)
    for (const CanSignal& signal : pdo.signals)
      if (signal.is_readback) ++shown[signal.command];
  return outputs == shown;
}

bool CanProcessImage::all_substituted() const noexcept {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i].has_output && !watches_[i].substituted) return false;
  return true;
}

void CanProcessImage::on_our_absence(int node, std::int64_t at_ns) noexcept {
  Watch& watch = watches_[static_cast<std::size_t>(node)];
  if (watch.substituted) return;
  watch.substituted = true;
  note(CanEvent::Kind::substituted, nodes_[static_cast<std::size_t>(node)].node, 0, at_ns);
}

CanFrame CanProcessImage::output(std::size_t i, const std::array<double, 2>& commands) const noexcept {
  const CanOutputPdo& pdo = outputs_[i];
  CanFrame frame{.id = pdo.id, .length = pdo.length};
  std::uint64_t image = 0;
  for (const CanSignal& signal : pdo.signals) {
    const double command = commands[signal.command];
    const double held = std::clamp(command == command ? command : 0.0, signal.lowest, signal.highest);
    image = insert(image, signal.place, signal.counts.raw_of(held));
  }
  put_image(frame.data, image);
  return frame;
}

bool CanProcessImage::all_answered() const noexcept {
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    if (inputs_[i].on_sync ? samples_[i].answers < 1 : !samples_[i].ever) return false;
  return true;
}

std::vector<std::string> CanProcessImage::unanswered() const {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const CanInputPdo& pdo = inputs_[i];
    if (pdo.on_sync ? samples_[i].answers > 0 : samples_[i].ever) continue;
    const int length = samples_[i].short_length;
    out.push_back(fmt::format("node {} ({}): PDO 0x{:03x} {}", name_of(pdo.node), pdo.node, pdo.id,
                              length > 0
                                  ? fmt::format("has {} bytes, its mapping {}: are the objects under hal.channels "
                                                "those that it sends?",
                                                length, pdo.length)
                              : pdo.on_sync ? "did not answer SYNC: see its 0x1005 and 0x1019, or take "
                                              "transmission: event"
                                            : "did not come"));
  }
  return out;
}

const CanInputPdo* CanProcessImage::answered_twice() const noexcept {
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    if (inputs_[i].on_sync && samples_[i].answers > 1) return &inputs_[i];
  return nullptr;
}

const char* CanProcessImage::name_of(std::uint8_t node) const noexcept {
  const int i = watched(node);
  return i < 0 ? "?" : nodes_[static_cast<std::size_t>(i)].name.c_str();
}

std::vector<std::string> CanProcessImage::event_lines(std::int64_t start_ns) const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < event_count_; ++i) {
    const CanEvent& event = events_[i];
    const std::string node = fmt::format("node {} ({})", name_of(event.node), event.node);
    std::string what;
    switch (event.kind) {
      case CanEvent::Kind::bus_off: what = "the controller went bus-off"; break;
      case CanEvent::Kind::restarted: what = "the controller was restarted by somebody else"; break;
      case CanEvent::Kind::link_down: what = "the link went down"; break;
      case CanEvent::Kind::silent: what = node + ": no heartbeat any more"; break;
      case CanEvent::Kind::left_operational:
        what = fmt::format("{}: state {}", node, nmt_state_word(static_cast<NmtState>(event.detail)));
        break;
      case CanEvent::Kind::emergency:
        what = fmt::format("{}: {}", node,
                           emergency_text({event.node, static_cast<std::uint16_t>(event.detail >> 8),
                                           static_cast<std::uint8_t>(event.detail)}));
        break;
      case CanEvent::Kind::double_answer:
        what =
            fmt::format("{}: frame 0x{:03x} came more often than it may: a second device has its number, or a second "
                        "master sends SYNC",
                        node, event.detail);
        break;
      case CanEvent::Kind::second_master: what = "somebody else sends SYNC or has this program's number"; break;
      case CanEvent::Kind::not_read_back: what = node + ": shows another output than the one that was sent"; break;
      case CanEvent::Kind::substituted: what = node + ": misses our heartbeat and gives its substitute output"; break;
      case CanEvent::Kind::no_sync: what = "no SYNC of the master that the loop waits for (hal.can.sync)"; break;
      case CanEvent::Kind::emergency_gone: what = node + ": emergency is over"; break;
    }
    lines.push_back(fmt::format("t = {:.4f} s: {}", static_cast<double>(event.at_ns - start_ns) * 1e-9, what));
  }
  return lines;
}

}  // namespace pneuservo
