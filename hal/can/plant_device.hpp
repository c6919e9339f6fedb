// The simulated plant of a rig as the CANopen nodes that its config names: what the verb device puts on a bus.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "can/canopen_node.hpp"
#include "can/fluid_valve.hpp"
#include "inject/plant_faults.hpp"
#include "inject/sample_faults.hpp"
#include "rig/can_channels.hpp"
#include "rig/injected_fault.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {

class RecordingRing;

/// Every SYNC moves the plant of the backend `sim` on by the whole periods since the last one (at least one), applies
/// the outputs that waited for it, samples the sensors and answers. When SYNC falls silent the plant goes on by the
/// clock it is given. With hal.can.sync: foreign it is the master that sends SYNC, too. Only channels that stand on CAN
/// are served.
class PlantDevice {
 public:
  /// The rig must have hal.can. Throws InputError where it has not.
  explicit PlantDevice(const Rig& rig);

  void power_on(std::int64_t now_ns, std::vector<CanFrame>& out);
  void on_frame(const ReceivedFrame& received, std::vector<CanFrame>& out);
  void on_time(std::int64_t now_ns, std::vector<CanFrame>& out);
  std::int64_t next_due_ns() const noexcept;

  /// Faults on command; their time counts from the first SYNC. Throws InputError naming a node or channel that is not
  /// there.
  void add_fault(const InjectedFault& fault);

  std::vector<std::unique_ptr<CanopenNode>>& nodes() noexcept { return nodes_; }
  std::int64_t syncs() const noexcept { return syncs_; }
  bool sends_sync = false;  ///< by its clock; false from the start where the rig's hal.can.sync is own
  /// Periods since the first SYNC.
  std::int64_t tick() const noexcept { return tick_; }
  double time_s() const noexcept { return static_cast<double>(tick_) * rig_.period_s; }
  /// Command that the (first) valve has now [V].
  double command_V() const noexcept { return commands_V_[0]; }
  Truth truth() const noexcept { return plant_.truth(); }
  /// Every row of the plant goes there: its true state and the commands that its valves have; null: nowhere.
  void record_into(RecordingRing* ring) noexcept { ring_ = ring; }
  /// Columns of these rows.
  static std::vector<std::string> recorded_columns(const Rig& rig);

 private:
  struct DeviceChannel {
    CanChannel channel;
    CanopenNode* node;
    CountScale counts;
    ValveStates* valve = nullptr;  // of a CiA 408 node
  };
  struct Order {
    InjectedFault order;
    bool begun = false;
  };

  void build_nodes();
  void on_sync(const ReceivedFrame& received, std::vector<CanFrame>& out);
  void take_command();
  void sample_inputs();
  void record() noexcept;
  void begin_orders(std::vector<CanFrame>& out);
  void begin(const InjectedFault& order, std::vector<CanFrame>& out);
  bool is_active(InjectedKind kind, const std::string& target) const;
  bool is_off(const CanopenNode& node) const;
  void answer(CanopenNode& node, std::vector<CanFrame>& out);

  Rig rig_;
  SimBackend plant_;
  PlantFaults plant_faults_;
  SampleFaults sample_faults_;
  std::vector<CanChannel> channels_;
  std::vector<std::unique_ptr<CanopenNode>> nodes_;
  std::map<std::string, ValveStates> valves_;
  std::vector<DeviceChannel> signals_;
  std::vector<Order> orders_;
  std::vector<CanFrame> held_back_;  // answers that come a cycle late on command
  std::int64_t period_ns_, last_step_ns_ = 0, now_ns_ = 0, next_sync_ns_ = 0;
  std::int64_t tick_ = 0, syncs_ = 0;
  std::array<double, 2> commands_V_{};
  Measurement measured_;
  RecordingRing* ring_ = nullptr;
};

}  // namespace pneuservo
