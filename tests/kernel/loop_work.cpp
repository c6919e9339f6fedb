// Work of a tick with recording, CAN codec and all checks of the loop, beside the bare loop: the same rig, the same
// inputs, once handed over in memory, once as frames of a bus whose answers are ready before they are asked for. Prints
// JSON.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <memory>
#include <vector>

#include <pneuservo/record/ring.hpp>

#include "can/can_backend.hpp"
#include "config/read_rig.hpp"
#include "hal/device_bus.hpp"
#include "loop/realtime.hpp"
#include "loop/runner.hpp"
#include "record/writer.hpp"

using namespace pneuservo;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::size_t samples = 1000;  // a period of the reference, which both runs' sensors pretend to follow
constexpr double count_m = 5e-6, count_Pa = 25.0;

/// Counts of position, port pressures and supply.
struct Counts {
  std::int32_t position;
  std::array<std::uint16_t, 3> pressures;
};

std::vector<Counts> counts_of_a_period() {
  std::vector<Counts> all;
  std::uint32_t noise = 1;
  const auto pressure = [&](double mean_Pa) {
    noise = noise * 1664525u + 1013904223u;
    return static_cast<std::uint16_t>(std::lround(mean_Pa / count_Pa) + static_cast<long>(noise >> 28));
  };
  for (std::size_t i = 0; i < samples; ++i) {
    const double x_m = 0.08 * std::sin(2.0 * pi * static_cast<double>(i) / samples);
    all.push_back(
        {static_cast<std::int32_t>(std::lround(x_m / count_m)), {pressure(470e3), pressure(540.2e3), pressure(700e3)}});
  }
  return all;
}

/// Hands the samples over and takes the command: no device, no codec.
class StillBackend final : public Backend {
 public:
  void configure() override {}
  void activate() override {}
  bool read(std::int64_t tick, Measurement& m) noexcept override {
    const Counts& c = counts_[static_cast<std::size_t>(tick) % samples];
    const auto channel = [](double value) { return Channel{value, 0.001, true, Origin::real}; };
    m.position_m = channel(c.position * count_m);
    m.port_pressure_1_Pa = channel(c.pressures[0] * count_Pa);
    m.port_pressure_2_Pa = channel(c.pressures[1] * count_Pa);
    m.supply_pressure_Pa = channel(c.pressures[2] * count_Pa);
    return true;
  }
  bool write(std::int64_t, const Command& command) noexcept override {
    last_ = command;
    return true;
  }
  void deactivate() noexcept override {}
  std::array<Origin, 6> origins() const override { return {}; }
  std::string name() const override { return "still"; }

 private:
  std::vector<Counts> counts_ = counts_of_a_period();
  Command last_;
};

/// The simulated device for the start; from then on each SYNC finds its answers waiting.
class ReadyBus final : public CanCarrier {
 public:
  ReadyBus(PlantDevice& device, std::int64_t period_ns) : bus_(device), period_ns_(period_ns) {}

  void begin() { ready_ = true; }
  void accept_only(const std::vector<std::uint32_t>& ids) override { bus_.accept_only(ids); }
  void wait(std::int64_t timeout_ns) override { bus_.wait(timeout_ns); }
  Sent send(const CanFrame& frame) noexcept override {
    if (!ready_) return bus_.send(frame);
    if (frame.id != cob_sync) return Sent::sent;
    answer();
    return Sent::sent;
  }
  bool receive(ReceivedFrame& received) noexcept override {
    if (!ready_) return bus_.receive(received);
    if (next_ == waiting_) return false;
    received = frames_[next_++];
    return true;
  }
  std::int64_t now_ns() noexcept override { return bus_.now; }
  bool is_up() const noexcept override { return true; }
  std::uint64_t dropped() const noexcept override { return 0; }
  std::string name() const override { return "ready bus"; }

 private:
  void answer() noexcept {
    const Counts& c = counts_[sync_ % samples];
    CanFrame position{.id = cob_transmit_pdo(1, 3), .length = 4}, pressures{.id = cob_transmit_pdo(2, 2), .length = 6};
    put_u32(position.data.data(), static_cast<std::uint32_t>(c.position));
    for (std::size_t i = 0; i < 3; ++i) put_u16(&pressures.data[2 * i], c.pressures[i]);
    const std::int64_t stamp_ns = bus_.now + period_ns_ / 10;
    next_ = waiting_ = 0;
    frames_[waiting_++] = {pressures, stamp_ns};
    frames_[waiting_++] = {position, stamp_ns};
    if (sync_++ % 20 == 0)
      for (const std::uint8_t node : {std::uint8_t{2}, std::uint8_t{3}})
        frames_[waiting_++] = {heartbeat_frame(node, NmtState::operational), stamp_ns};
    bus_.now += period_ns_;
  }

  DeviceBus bus_;
  std::int64_t period_ns_;
  bool ready_ = false;
  std::vector<Counts> counts_ = counts_of_a_period();
  std::size_t sync_ = 0, next_ = 0, waiting_ = 0;
  std::array<ReceivedFrame, 4> frames_;
};

/// Begins the ready answers when the backend is active.
class ReadyCan final : public Backend {
 public:
  explicit ReadyCan(const Rig& rig) : device_(rig) {
    auto bus = std::make_unique<ReadyBus>(device_, std::llround(rig.period_s * 1e9));
    bus_ = bus.get();
    can_ = std::make_unique<CanBackend>(rig, std::move(bus));
  }
  void configure() override { can_->configure(); }
  void activate() override {
    can_->activate();
    bus_->begin();
  }
  bool read(std::int64_t tick, Measurement& m) noexcept override { return can_->read(tick, m); }
  bool write(std::int64_t tick, const Command& command) noexcept override { return can_->write(tick, command); }
  void deactivate() noexcept override { can_->deactivate(); }
  std::array<Origin, 6> origins() const override { return can_->origins(); }
  std::string name() const override { return "can"; }

 private:
  PlantDevice device_;
  ReadyBus* bus_ = nullptr;
  std::unique_ptr<CanBackend> can_;
};

void print(const char* name, const RunOutcome& outcome, const char* after) {
  std::vector<double> work_us;
  for (std::size_t i = 200; i < outcome.rows.size(); ++i) work_us.push_back(outcome.rows[i].work_us);
  std::sort(work_us.begin(), work_us.end());
  const auto share = [&](double p) {
    return work_us[static_cast<std::size_t>(p * static_cast<double>(work_us.size() - 1))];
  };
  std::printf("\"%s\": {\"ticks\": %zu, \"faults\": %zu, \"work_us\": {\"p50\": %.3f, \"p99\": %.3f, \"p99_99\": %.3f, "
              "\"max\": %.3f}}%s\n",
              name, work_us.size(), outcome.faults.size(), share(0.5), share(0.99), share(0.9999), work_us.back(),
              after);
  for (const std::string& fault : outcome.faults) std::fprintf(stderr, "%s: %s\n", name, fault.c_str());
}

}  // namespace

int main(int count, char** words) {
  if (count != 4) {
    std::fprintf(stderr, "usage: kernel_loop_work CONFIG DURATION_S RECORDING.csv.gz\n");
    return 2;
  }
  Rig rig = read_rig(words[1]);
  rig.duration_s = std::atof(words[2]);
  const RealTimeSession session(RealTimeSettings{.priority = 80});
  StillBackend still;
  const RunOutcome bare = run_loop(rig, still, {.real_time = true});
  ReadyCan can(rig);
  can.configure();
  RecordingRing ring;
  RecordingHeader header(rig.name, rig.period_s);
  RecordingWriter writer(words[3], header,
                         {"t_s", "x_ref_m", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa", "p1_estimated_Pa",
                          "p2_estimated_Pa", "p_supply_Pa", "lateness_us", "work_us", "flags", "fault"},
                         ring);
  const RunOutcome whole = run_loop(rig, can, {.real_time = true, .ring = &ring});
  const RecordingSummary summary = writer.close();
  std::printf("{");
  print("bare", bare, ",");
  print("with_codec_and_recording", whole, "}");
  const bool good = bare.faults.empty() && whole.faults.empty() && summary.dropped == 0 && summary.error.empty();
  return good ? 0 : 1;
}
