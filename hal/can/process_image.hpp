// What the control loop does with frames: process data to channels, commands to process data, nodes watched. Allocates
// nothing after it was built; any frame whatever may be given to it.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <pneuservo/core/rt.hpp>
#include <pneuservo/hal/channel.hpp>

#include "can/canopen.hpp"
#include "can/process_data.hpp"

namespace pneuservo {

/// One channel inside a PDO.
struct CanSignal {
  Signal signal = Signal::x;  ///< of an input
  std::size_t command = 0;    ///< of an output or its readback: counts as in Command
  BitField place;
  CountScale counts;
  double lowest = 0.0, highest = 0.0;
  bool is_readback = false;  ///< shows what the command is
  double tolerance = 0.0;    ///< of a readback
};

/// A PDO that a node sends.
struct CanInputPdo {
  std::uint32_t id = 0;
  std::uint8_t node = 0, length = 0;
  bool on_sync = true;          ///< one answer to each SYNC; else by the node's own timer
  std::int64_t oldest_ns = 0;   ///< an older sample is none
  std::int64_t most_owed = 1;   ///< so many SYNC may wait for their answer; a node that owes more is lost
  std::vector<CanSignal> signals;
};

/// A PDO that we send.
struct CanOutputPdo {
  std::uint32_t id = 0;
  std::uint8_t length = 0;
  std::vector<CanSignal> signals;
};

/// A node whose heartbeat and emergencies are watched.
struct CanWatchedNode {
  std::string name;
  std::uint8_t node = 0;
  std::int64_t silence_ns = 0;  ///< longer without a heartbeat: lost; 0: it sends none
  std::int64_t heartbeat_ns = 0;  ///< it sends one so often; 0: not known
  bool has_output = false;      ///< watches our heartbeat, and gives its substitute without it
  bool is_guarded = false;      ///< says its state when it is asked, so often as a heartbeat would come
};

/// What happened on the bus, in the order it happened; told after the run.
struct CanEvent {
  enum class Kind : std::uint8_t {
    bus_off,
    restarted,
    link_down,
    silent,
    left_operational,
    emergency,
    emergency_gone,
    double_answer,
    second_master,
    not_read_back,
    substituted,
    no_sync
  } kind{};
  std::uint8_t node = 0;
  std::uint32_t detail = 0;  ///< state, or emergency code and register
  std::int64_t at_ns = 0;
};

/// Counted since the start.
struct CanCounts {
  std::uint64_t answers = 0;      ///< process data taken as samples
  std::uint64_t missed = 0;       ///< cycles in which an awaited PDO did not come
  std::uint64_t late = 0;         ///< came after the next SYNC, or twice in a cycle, before the end
  std::uint64_t malformed = 0;    ///< a known PDO with fewer bytes than are mapped
  std::uint64_t foreign = 0;      ///< frames that belong to nothing here
  std::uint64_t out_of_limits = 0;
  std::uint64_t error_frames = 0;
  std::int64_t slowest_answer_ns = 0;  ///< longest from SYNC to the answer's time stamp
};

/// Answers against questions. A node answers each SYNC once, so that its answers never outnumber the SYNC, however late
/// they come. What it owes is forgotten beyond `most_owed`. One frame in a hundred may come twice: CAN repeats a frame
/// of which some receivers saw the last bit disturbed. More than three beyond that are another node's.
class AnswerBalance {
 public:
  static constexpr double most_surplus = 3.0, forgiven_a_cycle = 0.01;
  /// At the end of a cycle with so many answers. True: another node answers too.
  bool end_cycle(std::uint32_t answers, std::int64_t most_owed) noexcept {
    return add(static_cast<double>(answers), 1.0, static_cast<double>(most_owed));
  }
  /// So many came where so many were due.
  bool add(double came, double due, double most_owed) noexcept {
    surplus_ += came - due;
    if (surplus_ > 0.0) surplus_ = surplus_ > forgiven_a_cycle ? surplus_ - forgiven_a_cycle : 0.0;
    if (surplus_ < -most_owed) surplus_ = -most_owed;
    return surplus_ > most_surplus;
  }

 private:
  double surplus_ = 0.0;
};

/// The cycle: send outputs, begin_cycle at the SYNC; then every frame that comes; then take at the next tick. An input
/// on SYNC is a sample only if it came after this cycle's SYNC: its age is one period, known and checked.
class CanProcessImage {
 public:
  CanProcessImage() = default;
  CanProcessImage(std::vector<CanInputPdo> inputs, std::vector<CanOutputPdo> outputs, std::vector<CanWatchedNode> nodes,
                  std::uint8_t own_node = 0);

  /// Nodes count as seen at `now_ns`; faults and counts are forgotten.
  void start(std::int64_t now_ns) noexcept;
  /// `commands`: what the outputs of this cycle were given.
  void begin_cycle(std::int64_t now_ns, const std::array<double, 2>& commands) noexcept PNEUSERVO_NONBLOCKING;
  static constexpr int most_unconfirmed = 2;  ///< a lost frame or two, as InputGuard bridges them
  /// Our heartbeat is withheld from now on and the commands are the safe ones: what the watchdogs do then is no fault.
  void let_go(bool withheld) noexcept { let_go_ = withheld; }
  void on_frame(const ReceivedFrame& received) noexcept PNEUSERVO_NONBLOCKING;
  void on_link_down(std::int64_t now_ns) noexcept PNEUSERVO_NONBLOCKING;
  void on_guard_request(std::uint8_t node) noexcept PNEUSERVO_NONBLOCKING;
  /// The master whose SYNC the loop waits for sends none: a node that is lost.
  void on_sync_missing(std::int64_t now_ns) noexcept PNEUSERVO_NONBLOCKING;
  /// Fills the channels that stand on the bus; all others are left as they are. A channel is valid only if its sample
  /// is of this cycle and within its limits.
  void take(std::int64_t now_ns, Measurement& measurement) noexcept PNEUSERVO_NONBLOCKING;

  /// The frame of output `i`; commands are held within their limits, not-a-number counts as 0 V.
  CanFrame output(std::size_t i, const std::array<double, 2>& commands) const noexcept PNEUSERVO_NONBLOCKING;
  std::size_t outputs() const noexcept { return outputs_.size(); }

  /// Bits of DeviceFault, latched since start().
  std::uint32_t faults() const noexcept { return faults_; }
  const CanCounts& counts() const noexcept { return counts_; }
  /// Every input on SYNC answered since begin_cycle.
  bool all_answered() const noexcept;
  /// Those of all_answered() that have not, in sentences with node, identifier and what came instead.
  std::vector<std::string> unanswered() const;
  /// An input on SYNC that came more than once since begin_cycle; null: none.
  const CanInputPdo* answered_twice() const noexcept;
  /// SYNC and heartbeats of our own number that others sent, since start().
  std::uint64_t master_frames() const noexcept { return master_frames_; }
  /// Every output has a readback, which showed the commands of the last cycle.
  bool outputs_confirmed() const noexcept { return confirmed_; }
  bool outputs_are_read_back() const noexcept;
  const std::vector<CanWatchedNode>& nodes() const noexcept { return nodes_; }
  /// Every node with an output said that it misses our heartbeat, or that it is stopped.
  bool all_substituted() const noexcept;
  /// The events in sentences; `start_ns` is time 0.
  std::vector<std::string> event_lines(std::int64_t start_ns) const;
  const std::vector<CanInputPdo>& inputs() const noexcept { return inputs_; }

 private:
  struct Sample {
    std::uint64_t image = 0;
    std::int64_t received_ns = 0;
    std::uint32_t answers = 0, arrivals = 0;  // in this cycle; arrivals: late ones too
    std::uint8_t short_length = 0;  // of a frame that was too short; 0: none was
    bool ever = false;
    AnswerBalance balance;
  };
  struct Watch {
    std::int64_t seen_ns = 0, beat_ns = 0;
    AnswerBalance balance{};
    bool lost = false, substituted = false;
    bool toggle = false;  // of the next answer to a guard request
    int guard_requests = 0;  // since the last answer
  };
  /// What an output was given of late: a device shows the command of this SYNC, or of the one before.
  struct Sent {
    double now = 0.0, before = 0.0;
    int unconfirmed = 0;  // cycles in a row
  };
  void on_error(const ReceivedFrame& received) noexcept;
  void on_process_data(std::size_t input, const ReceivedFrame& received) noexcept;
  void on_heartbeat(const Heartbeat& heartbeat, std::int64_t at_ns) noexcept;
  void on_guard_answer(const GuardAnswer& answer, std::int64_t at_ns) noexcept;
  void on_emergency(const Emergency& emergency, std::int64_t at_ns) noexcept;
  void close_answers(std::int64_t now_ns) noexcept;
  void look_for_silence(std::int64_t now_ns) noexcept;
  void count_heartbeat(std::size_t node, std::int64_t at_ns) noexcept;
  void on_our_absence(int node, std::int64_t at_ns) noexcept;
  void check_output(const CanSignal& signal, double value, bool fresh, std::uint8_t node, std::int64_t now_ns) noexcept;
  void note(CanEvent::Kind kind, std::uint8_t node, std::uint32_t detail, std::int64_t at_ns) noexcept;
  int watched(std::uint8_t node) const noexcept;
  const char* name_of(std::uint8_t node) const noexcept;

  std::vector<CanInputPdo> inputs_;
  std::vector<CanOutputPdo> outputs_;
  std::vector<CanWatchedNode> nodes_;
  std::vector<Sample> samples_;
  std::vector<Watch> watches_;
  std::uint8_t own_node_ = 0;
  AnswerBalance master_balance_;
  std::array<Sent, 2> sent_{};
  bool in_cycle_ = false, let_go_ = false, confirmed_ = false;
  std::uint64_t master_frames_ = 0, master_frames_before_ = 0;
  std::int64_t sync_ns_ = 0;
  std::uint32_t faults_ = 0;
  CanCounts counts_;
  std::array<CanEvent, 32> events_{};  // the first ones tell the cause
  std::size_t event_count_ = 0;
};

}  // namespace pneuservo
