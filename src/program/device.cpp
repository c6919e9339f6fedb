// Verb device: the simulated plant as CANopen nodes on a bus, for a controller in another process or machine.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <iostream>
#include <memory>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <pneuservo/record/ring.hpp>

#include "can/open_carrier.hpp"
#include "can/plant_device.hpp"
#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "loop/realtime.hpp"
#include "loop/realtime_stop.hpp"
#include "program/output_files.hpp"
#include "program/rig_options.hpp"
#include "program/verbs.hpp"
#include "record/writer.hpp"
#include "rig/injected_fault.hpp"

namespace pneuservo {
namespace {

struct DeviceOptions {
  std::string config, interface, record;
  std::vector<std::string> sets, faults, scenarios;
  double duration_s = 0.0;
  int priority = 0;
};

/// Fault orders typed while it runs, one a line.
class TypedOrders {
 public:
  TypedOrders() { fcntl(STDIN_FILENO, F_SETFL, fcntl(STDIN_FILENO, F_GETFL) | O_NONBLOCK); }
  ~TypedOrders() { fcntl(STDIN_FILENO, F_SETFL, fcntl(STDIN_FILENO, F_GETFL) & ~O_NONBLOCK); }
  TypedOrders(const TypedOrders&) = delete;
  TypedOrders& operator=(const TypedOrders&) = delete;

  void read_into(PlantDevice& device) {
    char text[256];
    const ssize_t got = open_ ? read(STDIN_FILENO, text, sizeof text) : -1;
    if (got == 0 || (got < 0 && errno != EAGAIN)) open_ = false;
    if (got > 0) line_.append(text, static_cast<std::size_t>(got));
    for (std::size_t end = line_.find('\n'); end != std::string::npos; end = line_.find('\n')) {
      const std::string order = line_.substr(0, end);
      line_.erase(0, end + 1);
      if (order.empty()) continue;
      try {
        device.add_fault(parse_fault_order(order, device.time_s()));
        std::cerr << fmt::format("t = {:.4f} s: {}\n", device.time_s(), order);
      } catch (const InputError& error) { std::cerr << error.what() << "\n"; }
    }
  }

 private:
  std::string line_;
  bool open_ = true;
};

/// What goes wrong on the way out is counted: a device does not stop for it.
void send_all(CanCarrier& bus, std::vector<CanFrame>& out, std::int64_t& not_sent) {
  for (const CanFrame& frame : out)
    if (bus.is_up() && bus.send(frame) == Sent::queue_full) ++not_sent;
  out.clear();
}

/// The plant's own recording, written beside it.
class TruthRecording {
 public:
  TruthRecording(const std::string& path, const Rig& rig, PlantDevice& device)
      : writer_(path, header(rig), PlantDevice::recorded_columns(rig), {.ring = std::make_shared<RecordingRing>()}) {
    device.record_into(writer_.ring());
  }
  /// Says what is missing. True: nothing.
  bool close() {
    const RecordingSummary summary = writer_.close();
    if (summary.dropped > 0) std::cerr << fmt::format("{}: {} rows were dropped\n", writer_.path(), summary.dropped);
    if (!summary.error.empty()) std::cerr << summary.error << "\n";
    return summary.whole();
  }

 private:
  static RecordingHeader header(const Rig& rig) {
    RecordingHeader header(rig.name, rig.period_s);
    header.add_text("backend", "device");
    header.add_text("config", dump_rig(rig));
    return header;
  }
  RecordingWriter writer_;
};

int run_device(const DeviceOptions& options) {
  const Rig rig = read_rig(options.config, options.sets, ConfigUse::simulation);
  OutputFiles()
      .reads("CONFIG", options.config)
      .reads("--scenario", options.scenarios)
      .records("--record", options.record, ExistingFile::refuse);
  PlantDevice device(rig);
  for (const std::string& fault : options.faults) device.add_fault(parse_fault_order(fault, 0.0));
  for (const std::string& file : options.scenarios)
    for (const auto& [name, fault] : read_scenario(file).faults) {
      require_injectable(fault, InjectionPlace::device, rig, fmt::format("{}: faults.{}", file, name));
      device.add_fault(fault);
    }
  const auto bus = open_carrier(options.interface, rig.hal->can->bit_rate_bps, true);
  std::unique_ptr<RealTimeSession> session;
  if (options.priority > 0) {
    session = std::make_unique<RealTimeSession>(RealTimeSettings{.priority = options.priority, .cpu = std::nullopt});
    std::cerr << refusal_message(session->findings());
  }
  std::unique_ptr<TruthRecording> recording;
  if (!options.record.empty()) recording = std::make_unique<TruthRecording>(options.record, rig, device);
  StopRequest stop;
  TypedOrders orders;
  std::int64_t not_sent = 0;
  std::vector<CanFrame> out;
  out.reserve(64);
  device.power_on(bus->now_ns(), out);
  send_all(*bus, out, not_sent);
  std::cerr << fmt::format("{}: nodes of {} are on the bus; Ctrl-C ends\n", bus->name(), rig.name);
  constexpr std::int64_t longest_wait_ns = 20'000'000;  // typed orders and Ctrl-C are looked for so often
  constexpr int most_frames_a_look = 256;  // a flood must not stop the plant and its watchdogs
  while (!StopRequest::requested()) {
    bus->wait(std::clamp<std::int64_t>(device.next_due_ns() - bus->now_ns(), 1, longest_wait_ns));
    int taken = 0;
    for (ReceivedFrame received; taken < most_frames_a_look && bus->receive(received); ++taken) {
      device.on_frame(received, out);
      send_all(*bus, out, not_sent);
    }
    device.on_time(bus->now_ns(), out);
    send_all(*bus, out, not_sent);
    orders.read_into(device);
    if (options.duration_s > 0.0 && device.time_s() >= options.duration_s) break;
  }
  const bool whole = !recording || recording->close();
  const Truth truth = device.truth();
  std::cout << fmt::format(
      "{} SYNC in {:.3f} s of the plant, {} frames not sent, {} dropped; x = {:.6f} m, valve {:.4f} V\n",
      device.syncs(), device.time_s(), not_sent, bus->dropped(), truth.x_m, device.command_V());
  return whole ? 0 : 1;
}

}  // namespace

void add_device(CommandLine& app, int& status) {
  auto o = std::make_shared<DeviceOptions>();
  Verb verb = app.add_verb("device", "the simulated plant as CANopen nodes on a bus");
  verb.add_option("CONFIG", o->config, "rig with the section hal, e.g. config/can/cylinder-10m-7.65mm.yaml").required();
  verb.add_option("--can", o->interface, "can0, vcan0, slcan:/dev/ttyACM0, or unix:PATH where there is no CAN kernel")
      .required();
  add_set_option(verb, o->sets);
  verb.add_option("--fault", o->faults, "a fault on command; may stand several times")
      .type_name("KIND[:TARGET[:VALUE]][@START_S[+DURATION_S]]");
  verb.add_option("--scenario", o->scenarios, "faults from a scenario file (docs/faults.md)");
  verb.add_option("--record", o->record, "the plant's true state and its valves' commands, FILE.csv.gz");
  verb.add_option("--duration-s", o->duration_s, "end after so much time of the plant [s]; default: Ctrl-C")
      .above_zero();
  verb.add_option("--priority", o->priority, "SCHED_FIFO priority; 0: an ordinary process")
      .within(0, 99)
      .shows_default();
  verb.footer(fault_order_help(InjectionPlace::device) +
              "The same may be typed, one a line, while it runs. Times count from the first SYNC.\n"
              "  pneuservo device config/can/cylinder-10m-7.65mm.yaml --can vcan0 --fault freeze:x@2\n"
              "  pneuservo run config/can/cylinder-10m-7.65mm.yaml --set hal.can.interface=vcan0 --time real");
  verb.callback([o, &status] { status = run_device(*o); });
}

}  // namespace pneuservo
