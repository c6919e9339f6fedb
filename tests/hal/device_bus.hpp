// A bus inside one thread for tests: the simulated device answers what the controller sends, on a clock that only the
// test and waiting move.
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "can/canopen.hpp"
#include "can/frame.hpp"
#include "can/plant_device.hpp"

namespace pneuservo {

/// The controller's end. Everything the device sends arrives `delay_ns` later.
class DeviceBus final : public CanCarrier {
 public:
  explicit DeviceBus(PlantDevice& device) : device_(device) {
    std::vector<CanFrame> out;
    device_.power_on(now, out);
    put(out);
  }

  std::int64_t now = 1'000'000'000;
  std::int64_t delay_ns = 200'000;
  bool queue_is_full = false, up = true;
  std::vector<CanFrame> sent;                      ///< by the controller, in order
  std::function<bool(CanFrame&)> spoil{};          ///< changes a frame of the device; false: it is lost
  std::function<bool(const CanFrame&)> lose{};     ///< a frame of the controller does not reach the device
  std::function<void(CanFrame&)> rewrite{};        ///< changes a frame of the controller on its way

  /// For the end of a test: last frames meet no function whose variables are gone.
  void let_all_pass() { spoil = nullptr, lose = nullptr, rewrite = nullptr; }

  /// Time goes on; the device's heartbeats fall due.
  void advance(std::int64_t ns) {
    for (const std::int64_t end = now + ns; now < end;) {
      now = std::min(end, now + 250'000);
      std::vector<CanFrame> out;
      device_.on_time(now, out);
      put(out);
    }
  }
  void inject(const CanFrame& frame) { waiting_.push_back({frame, now}); }
  /// Behind what the device sends now.
  void after(const CanFrame& frame) { behind_.push_back(frame); }

  void accept_only(const std::vector<std::uint32_t>& ids) override { ids_ = ids; }
  void wait(std::int64_t timeout_ns) override { advance(std::min<std::int64_t>(timeout_ns, 250'000)); }
  Sent send(const CanFrame& frame) noexcept override {
    if (!up) return Sent::down;
    if (queue_is_full) return Sent::queue_full;
    sent.push_back(frame);
    CanFrame arrives = frame;
    if (rewrite) rewrite(arrives);
    std::vector<CanFrame> out;
    if (!lose || !lose(frame)) device_.on_frame({arrives, now}, out);
    put(out);
    return Sent::sent;
  }
  bool receive(ReceivedFrame& received) noexcept override {
    while (!waiting_.empty() && waiting_.front().received_ns <= now) {
      received = waiting_.front();
      waiting_.pop_front();
      const bool wanted = received.frame.error || std::find(ids_.begin(), ids_.end(), received.frame.id) != ids_.end();
      if (wanted) return true;
    }
    return false;
  }
  std::int64_t now_ns() noexcept override { return now; }
  bool is_up() const noexcept override { return up; }
  std::uint64_t dropped() const noexcept override { return 0; }
  std::string name() const override { return "test bus"; }

 private:
  void put(const std::vector<CanFrame>& frames) {
    for (CanFrame frame : frames)
      if (!spoil || spoil(frame)) waiting_.push_back({frame, now + delay_ns});
    for (const CanFrame& frame : behind_) waiting_.push_back({frame, now + delay_ns});
    behind_.clear();
  }
  PlantDevice& device_;
  std::deque<ReceivedFrame> waiting_;
  std::vector<CanFrame> behind_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace pneuservo
