// A controller before the simulated device with habits of real ones, on the bus of one thread.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "can/sdo_codec.hpp"
#include "hal/can_bench.hpp"

namespace pneuservo::habits {

inline constexpr std::uint8_t io = 2, encoder = 3;

/// A controller before a device with one habit; it is configured and activated by start().
struct Habit {
  Rig rig;
  PlantDevice device;
  DeviceBus* bus = nullptr;
  CanBackend backend;

  explicit Habit(const std::vector<std::string>& sets = {})
      : rig(can_rig(sets)), device(rig), backend(rig, make_bus()) {}
  ~Habit() { bus->let_all_pass(); }
  Habit(const Habit&) = delete;
  Habit& operator=(const Habit&) = delete;
  std::unique_ptr<CanCarrier> make_bus() {
    auto made = std::make_unique<DeviceBus>(device);
    bus = made.get();
    return made;
  }
  ObjectDictionary& dictionary(std::uint8_t number) { return node(number).dictionary(); }
  CanopenNode& node(std::uint8_t number) {
    for (auto& node : device.nodes())
      if (node->node() == number) return *node;
    FAIL("no node " << int(number));
    throw 0;
  }
  /// The node answers requests for this object with an abort; `writes`: those to write its sub-index 2 alone.
  void refuse(std::uint8_t number, std::uint16_t index, std::uint32_t code, bool writes = false) {
    also_spoil([=](CanFrame& frame) {
      const auto answer = parse_sdo_answer(frame);
      const bool is_meant = answer && frame.id == cob_sdo_answer + number && answer->index == index &&
                            (!writes || answer->sub == 2) &&
                            answer->specifier == (writes ? sdo_downloaded : sdo_upload_begun);
      if (is_meant) frame = sdo_abort_frame(frame.id, answer->index, answer->sub, static_cast<SdoAbort>(code));
      return true;
    });
  }
  /// Beside what spoils and loses frames already.
  void also_spoil(const std::function<bool(CanFrame&)>& more) {
    bus->spoil = [more, before = bus->spoil](CanFrame& frame) { return (!before || before(frame)) && more(frame); };
  }
  void also_lose(const std::function<bool(const CanFrame&)>& more) {
    bus->lose = [more, before = bus->lose](const CanFrame& frame) { return (before && before(frame)) || more(frame); };
  }
  void also_judge(std::uint8_t number, const SdoServer::AcceptWrite& more) {
    SdoServer::AcceptWrite& accept = node(number).accept_application;
    accept = [more, before = accept](std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
      const SdoAbort refused = before ? before(index, sub, value) : SdoAbort::none;
      return refused != SdoAbort::none ? refused : more(index, sub, value);
    };
  }
  void start() {
    backend.configure();
    backend.activate();
  }
  std::string notes() const {
    std::string all;
    for (const std::string& note : backend.notes()) all += note + "\n";
    return all;
  }
};

/// Whether the node has this state now, in a heartbeat.
inline bool tells(const CanFrame& frame, std::uint8_t node, NmtState state) {
  const auto heartbeat = parse_heartbeat(frame);
  return heartbeat && heartbeat->node == node && heartbeat->state == state;
}

}  // namespace pneuservo::habits
