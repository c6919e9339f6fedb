// A CANopen device (CiA 301 with the outputs of CiA 401) as it stands on a bus: states, heartbeat both ways, SDO
// server, PDOs as its dictionary maps them, emergencies, substitute outputs. Time is given to it, so that tests need no
// clock.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <pneuservo/rig/hal_parameters.hpp>

#include "can/object_dictionary.hpp"
#include "can/process_data.hpp"
#include "can/sdo_server.hpp"

namespace pneuservo {

/// What the dictionary of a node begins with.
struct NodeIdentity {
  std::uint8_t node = 1;
  std::uint32_t device_type = 0;  ///< 0x1000: profile in the lower 16 bits
  std::string name;  ///< 0x1008
};

class CanopenNode {
 public:
  /// Communication objects 0x1000 to 0x1A03 are there; the application's are added to dictionary().
  explicit CanopenNode(const NodeIdentity& identity);
  CanopenNode(const CanopenNode&) = delete;
  CanopenNode& operator=(const CanopenNode&) = delete;

  ObjectDictionary& dictionary() noexcept { return dictionary_; }
  const ObjectDictionary& dictionary() const noexcept { return dictionary_; }
  /// Mapping that the device has of its own; PDO 1 to 4.
  void map(bool transmit, std::uint32_t pdo, const std::vector<CanObject>& objects, std::uint8_t type);

  /// An output, and what it gets without master; none: it keeps its last value.
  void add_output(CanObject output, const std::optional<CanSubstitute>& substitute);

  /// Powered on: boot-up message, pre-operational.
  void power_on(std::int64_t now_ns, std::vector<CanFrame>& out);
  /// Any frame of the bus except SYNC, which the two calls below take.
  void on_frame(const CanFrame& frame, std::int64_t now_ns, std::vector<CanFrame>& out);
  /// At SYNC: outputs that waited for it act...
  void act_on_sync();
  /// ...then, when the application has sampled its inputs into the dictionary, they are sent.
  void answer_sync(std::vector<CanFrame>& out);
  /// Event-driven PDOs in which one of these objects has changed, and all once after the start.
  void send_events(std::span<const std::uint16_t> indices, std::vector<CanFrame>& out);
  /// Heartbeat, watch over the master's, timers of event-driven PDOs.
  void on_time(std::int64_t now_ns, std::vector<CanFrame>& out);
  /// When on_time is due next.
  std::int64_t next_due_ns() const noexcept;

  void raise_emergency(std::uint16_t code, std::uint8_t error_register, std::vector<CanFrame>& out);
  NmtState state() const noexcept { return state_; }
  std::uint8_t node() const noexcept { return identity_.node; }
  const std::string& name() const noexcept { return identity_.name; }
  /// The outputs are the substitutes because the master was lost.
  bool is_substituted() const noexcept { return substituted_; }

  /// Judges what a master writes by SDO into an object of the application; none: it takes everything.
  SdoServer::AcceptWrite accept_application;
  bool heartbeat_muted = false;  ///< fault on command: no heartbeat
  bool is_deaf = false;  ///< fault on command: no process data come in

 private:
  struct Pdo {
    bool enabled = false;
    std::uint32_t id = 0;
    std::uint8_t type = 255;
    unsigned bits = 0;
    std::vector<CanObject> objects;
    std::uint64_t waiting = 0;  // received, acts at SYNC
    bool has_waiting = false;
    int syncs = 0;
    std::int64_t next_event_ns = 0;
    std::optional<std::uint64_t> told;  // by send_events
  };
  struct Watch {
    std::uint8_t node = 0;
    std::int64_t limit_ns = 0, seen_ns = 0;
    bool running = false;
  };

  void add_communication_objects();
  void add_pdo_objects(bool transmit, std::uint16_t i);
  void on_nmt(NmtCommand command, std::int64_t now_ns, std::vector<CanFrame>& out);
  void reset(std::int64_t now_ns, std::vector<CanFrame>& out);
  void enter(NmtState state);
  void read_pdos();
  Pdo read_pdo(bool transmit, unsigned i) const;
  SdoAbort accept_write(std::uint16_t index, std::uint8_t sub, std::uint32_t value) const;
  SdoAbort accept_mapping(std::uint16_t index, std::uint8_t sub, std::uint32_t value) const;
  void apply(const Pdo& pdo, std::uint64_t image);
  std::uint64_t image_to_send(const Pdo& pdo, std::span<const std::uint16_t> indices) const;
  CanFrame transmit(const Pdo& pdo) const;
  void on_heartbeat_of(std::uint8_t node, std::int64_t now_ns);
  void on_guard_request(std::int64_t now_ns, std::vector<CanFrame>& out);
  void lose_master(std::int64_t now_ns, std::vector<CanFrame>& out);
  void substitute_outputs();

  NodeIdentity identity_;
  ObjectDictionary dictionary_;
  SdoServer server_;
  NmtState state_ = NmtState::boot_up;
  std::vector<std::pair<CanObject, CanSubstitute>> substitutes_;
  std::array<Pdo, 4> receive_{}, transmit_{};
  Watch watch_;
  std::int64_t next_heartbeat_ns_ = 0, now_ns_ = 0;
  bool substituted_ = false, guard_toggle_ = false;
};

}  // namespace pneuservo
