// Backend `can`: the channels of a rig that stand on a CANopen bus.
#pragma once
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

#include "can/bus_lock.hpp"
#include "can/eds.hpp"
#include "can/frame.hpp"
#include "can/node_setup.hpp"
#include "can/process_image.hpp"
#include "can/sdo_client.hpp"
#include "rig/can_channels.hpp"

namespace pneuservo {

/// A fault or the end withholds our heartbeat while the safe output and SYNC go on: the watchdog of a device that no
/// longer takes PDOs then closes the valve, and the sensors still tell what the axis does. NMT stop would go the way
/// that may be cut, and would end the sensors' answers.
///
/// One cycle: read() takes what came since the last SYNC; write() sends the outputs, then SYNC, at which the devices
/// let them act and sample their inputs. The inputs of a tick are therefore one period old, neither more nor less; one
/// that is not there in time is invalid. With another master's SYNC (hal.can.sync: foreign) the tick begins when the
/// answers to it are there, and its outputs act at the next one: from sample to command it is one period as well. A
/// frame that the queue has no room for is a missed output and is never sent later. After bus-off nothing is sent until
/// a new configure().
class CanBackend final : public Backend {
 public:
  /// `bus`: what carries the frames; null: configure() opens hal.can.interface.
  explicit CanBackend(const Rig& rig, std::unique_ptr<CanCarrier> bus = nullptr);
  ~CanBackend() override;

  /// Resets the nodes and sets them up by SDO. Throws InputError or std::runtime_error.
  void configure() override;
  /// Starts the nodes with the safe output, checks that each answers a SYNC once, within 0.9 periods, and that none has
  /// told of an error that is not over.
  void activate() override;
  bool is_paced() const noexcept override { return is_paced_; }
  Pace await_sample() noexcept override;
  bool read(std::int64_t tick, Measurement& measurement) noexcept override;
  bool write(std::int64_t tick, const Command& command) noexcept override;
  void deactivate() noexcept override;
  /// Outputs, SYNC, and the nodes to pre-operational, so that their substitute output holds whatever comes after.
  bool emergency_write() noexcept override;
  Origins origins() const override;
  SafeOutput safe_output() const override { return safe_output_; }
  std::vector<std::string> notes() const override;
  std::string name() const override { return "can"; }

  const CanProcessImage& process() const noexcept { return process_; }
  CanCarrier* bus() noexcept { return bus_.get(); }

 private:
  void check_load() const;
  void read_eds_files();
  void check_against_eds(const CanChannel& channel, const EdsFile& eds) const;
  std::vector<std::uint32_t> process_ids() const;
  void hear(const ReceivedFrame& received);
  void refuse_open_emergencies() const;
  std::string words_of(std::uint8_t node) const;
  void wait_for_boot(const std::string& name, const CanNodeParameters& node);
  void set_up_node(CanWatchedNode& watched, std::vector<CanInputPdo>& inputs, std::vector<CanOutputPdo>& outputs);
  void wait_until_operational();
  void refuse_second_master();
  void check_foreign_sync();
  void take_frame(const ReceivedFrame& received) noexcept;
  bool take_waiting_frames() noexcept;
  void give_up_sync(std::int64_t now_ns) noexcept;
  void ask_guarded(std::int64_t now_ns, bool with_outputs) noexcept;
  void check_answers();
  void activate_valves();
  void follow_safe_output(std::int64_t tick) noexcept;
  void stop_unconfirmed_outputs(std::int64_t tick) noexcept;
  bool send_outputs(const std::array<double, 2>& commands) noexcept;
  void keep_alive(std::int64_t now_ns);
  CanFrame own_heartbeat() const noexcept;
  void send_or_throw(const CanFrame& frame);
  template <class Wanted> bool receive_until(std::int64_t timeout_ns, const Wanted& wanted);

  Rig rig_;
  std::vector<CanChannel> channels_;
  std::unique_ptr<CanCarrier> bus_;
  bool opens_;  // bus_ is opened by configure
  std::map<std::string, EdsFile> eds_;
  CanProcessImage process_;
  std::vector<std::uint8_t> node_numbers_;
  std::map<std::uint8_t, Emergency> open_emergencies_;  // by node, since its boot-up: each is sent once
  std::map<std::uint8_t, NmtState> states_;  // as its heartbeats told last
  std::vector<std::string> setup_notes_;
  std::vector<std::uint8_t> valves_;  // nodes of CiA 408
  /// A node that is asked for its state.
  struct Guarded {
    std::uint8_t node;
    bool has_output;
    std::int64_t period_ns, next_ns;
  };
  std::vector<Guarded> guarded_;
  /// SYNC of another master.
  struct ForeignSync {
    std::int64_t at_ns = 0;  // of the newest; 0: none yet
    std::int64_t periods = 0;  // since the last tick
    std::uint64_t count = 0;
  } foreign_;
  std::int64_t newest_frame_ns_ = 0;
  std::array<double, 2> commands_V_{};  // as the outputs were given last
  std::unique_ptr<BusLock> lock_;
  SafeOutput safe_output_;
  int unconfirmed_cycles_ = 0;  // in a row, after the safe output was sent
  std::int64_t period_ns_, heartbeat_ticks_, next_heartbeat_tick_ = 0, start_ns_ = 0,
                                             next_alive_ns_ = std::numeric_limits<std::int64_t>::max();
  std::uint64_t queue_full_ = 0, dropped_ = 0, dropped_before_ = 0;
  std::int64_t sync_timeout_ns_;
  bool is_paced_;  // another master sends SYNC
  bool sends_sync_;  // always without one; else from the moment on that its SYNC is missing
  bool is_awaited_ = false;  // the frames of this tick were taken by await_sample
  bool active_ = false, cycling_ = false, ended_ = false;
};

}  // namespace pneuservo
