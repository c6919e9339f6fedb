// Analog devices behind their backend: scale, limits, readback, safe output, age; files, keys, scans and refusals of
// Industrial I/O. The kernel's own devices are tried in tests/kernel.
#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <system_error>

#include <unistd.h>

#include "analog/analog_backend.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#if __has_include(<iio.h>)
#include "hal/fake_iio.hpp"
#endif
#include "iio/iio_attribute.hpp"
#include "iio/iio_backend.hpp"
#include "input_wait.hpp"
#include "loop/device_grade.hpp"

using namespace pneuservo;
using Catch::Contains;

namespace {

const std::string iio_config = std::string(PNEUSERVO_SOURCE_DIR) + "/config/iio/cylinder-10m-7.65mm.yaml";

Rig iio_rig(const std::vector<std::string>& sets = {}) { return read_rig(iio_config, sets); }

/// What is at the terminals of a device with two inputs and an output of +-10 V in steps of 10 mV.
struct Terminals {
  std::array<double, 2> volts{};
  double output_V = std::numeric_limits<double>::quiet_NaN(), age_s = 0.0;
  bool is_saturated = false, refuses = false, refuses_readings = false;
};

class TerminalBoard final : public AnalogBoard {
 public:
  explicit TerminalBoard(Terminals& terminals) : terminals_(terminals) {}
  bool read() noexcept override { return !terminals_.refuses && !terminals_.refuses_readings; }
  bool write() noexcept override {
    if (!terminals_.refuses) terminals_.output_V = wanted_V_;
    return !terminals_.refuses;
  }
  double volts(std::size_t input) const noexcept override { return terminals_.volts[input]; }
  bool is_saturated(std::size_t) const noexcept override { return terminals_.is_saturated; }
  double age_s() const noexcept override { return terminals_.age_s; }
  void set_volts(std::size_t, double volts) noexcept override { wanted_V_ = std::nearbyint(volts * 100.0) / 100.0; }
  double set_volts_of(std::size_t) const noexcept override { return wanted_V_; }
  std::vector<std::string> description() const override { return {"terminals"}; }

 private:
  Terminals& terminals_;
  double wanted_V_ = 0.0;
};

/// Input 0 is the position, input 1 is wired to the output.
class TerminalBackend final : public AnalogBackend {
 public:
  TerminalBackend(const Rig& rig, Terminals& terminals) : AnalogBackend(rig, "test", "test"), terminals_(terminals) {}

 protected:
  std::unique_ptr<AnalogBoard> open() override {
    inputs_.push_back({Signal::x, 0, 0.5, 0.1, -1.0, 1.0});
    Output output = output_of(0, 0, *rig_.hal->channels.u.iio);
    output.scale = 2.0;
    output.is_read_back = true;
    output.readback = 1;
    output.tolerance_V = 0.02;
    outputs_.push_back(output);
    return std::make_unique<TerminalBoard>(terminals_);
  }

 private:
  Terminals& terminals_;
};

std::string refused(const std::string& set) {
  try {
    iio_rig({set});
  } catch (const InputError& error) { return error.what(); }
  return "accepted";
}

}  // namespace

TEST_CASE("analog backend: value = zero + scale * volts, invalid beyond the limits and at the converter's end") {
  Terminals terminals{.volts = {1.2, 0.0}};
  TerminalBackend backend(iio_rig(), terminals);
  backend.configure();
  backend.activate();
  REQUIRE(terminals.output_V == 0.0);  // the safe output
  Measurement measured;
  terminals.age_s = 3e-4;
  REQUIRE(backend.read(0, measured));
  const auto& x = measured.channel[Signal::x];
  REQUIRE(x.value == 0.1 + 0.5 * 1.2);
  REQUIRE((x.valid && x.age_s == 3e-4));
  terminals.volts[0] = 1.9;  // 1.05 m
  backend.read(1, measured);
  REQUIRE_FALSE(x.valid);
  terminals.volts[0] = 1.2;
  terminals.is_saturated = true;
  backend.read(2, measured);
  REQUIRE_FALSE(x.valid);
  terminals.is_saturated = false;
  terminals.refuses = true;
  backend.read(3, measured);
  REQUIRE_FALSE(x.valid);
  REQUIRE_FALSE(backend.write(3, {1.0, 0.0}));
  terminals.refuses = false;
  REQUIRE(backend.write(4, {9.0, 0.0}));
  REQUIRE(terminals.output_V == 2.5);  // held at 5 V, of which one is 0.5 V at the terminal
  backend.write(5, {std::numeric_limits<double>::quiet_NaN(), 0.0});
  REQUIRE(terminals.output_V == 0.0);
  backend.write(6, {4.0, 0.0});
  backend.deactivate();
  REQUIRE(terminals.output_V == 0.0);
  REQUIRE_THAT(backend.notes().back(), Contains("1 samples at the converter's end, 1 out of limits, 2 calls refused"));
}

TEST_CASE("analog backend: an output that deviates for three ticks is a fault, the safe output is confirmed") {
  Terminals terminals;
  TerminalBackend backend(iio_rig(), terminals);
  backend.configure();
  backend.activate();
  Measurement measured;
  const auto tick = [&](std::int64_t k, double back_V, const Command& command) {
    terminals.volts[1] = back_V;
    measured = {};
    backend.read(k, measured);
    backend.write(k, command);
    return (measured.device_faults & device_output_unconfirmed) != 0;
  };
  REQUIRE_FALSE(tick(0, 0.0, {2.0, 0.0}));
  REQUIRE_FALSE(tick(1, 1.01, {2.0, 0.0}));  // within tolerance
  REQUIRE_FALSE(tick(2, 0.5, {2.0, 0.0}));
  REQUIRE_FALSE(tick(3, 0.5, {2.0, 0.0}));
  REQUIRE_FALSE(tick(4, 1.0, {2.0, 0.0}));  // two are bridged
  for (std::int64_t k = 5; k < 7; ++k) REQUIRE_FALSE(tick(k, 0.5, {2.0, 0.0}));
  REQUIRE(tick(7, 0.5, {.ended = true}));
  REQUIRE(backend.safe_output().sent_tick == 7);
  REQUIRE(backend.safe_output().confirmed_tick < 0);
  tick(8, 0.0, {.ended = true});
  REQUIRE(backend.safe_output().confirmed_tick == 8);
}

TEST_CASE("analog backend: a readback that cannot be read for three ticks is a fault until the next start") {
  Terminals terminals;
  TerminalBackend backend(iio_rig(), terminals);
  backend.configure();
  backend.activate();
  std::int64_t k = 0;
  const auto tick = [&](bool is_read) {
    terminals.refuses_readings = !is_read;
    Measurement measured;
    backend.read(k, measured);
    backend.write(k++, {0.0, 0.0});
    return (measured.device_faults & device_output_unconfirmed) != 0;
  };
  for (const bool is_read : {true, false, false, true, false, false}) REQUIRE_FALSE(tick(is_read));
  REQUIRE(tick(false));
  REQUIRE(tick(true));  // it stays
  REQUIRE_THAT(backend.notes().at(1), Contains("could not be read: check its wire"));
  backend.deactivate();
  backend.activate();
  for (const bool is_read : {false, false, true}) REQUIRE_FALSE(tick(is_read));
}

TEST_CASE("iio: numbers as the kernel prints them") {
  REQUIRE(iio_number("73\n") == 73.0);
  REQUIRE(iio_number("-34\n") == -34.0);
  REQUIRE(iio_number("0.001333\n") == 0.001333);
  REQUIRE(iio_number("-1234.500000000\n") == -1234.5);
  REQUIRE(iio_number("2147483647") == 2147483647.0);
  for (const char* text : {"", "-", "\n", "busy", ".5"}) REQUIRE_FALSE(iio_number(text).has_value());
}

TEST_CASE("iio: a file is read anew each time and written from its beginning") {
  const auto path = std::filesystem::temp_directory_path() / ("pneuservo-iio-" + std::to_string(getpid()));
  std::ofstream(path) << "100\n";
  {
    const IioAttribute attribute(path, true);
    REQUIRE(attribute.read() == 100.0);
    REQUIRE(attribute.write(-12));
    REQUIRE(attribute.read() == -12.0);
    std::ofstream(path) << "7\n";
    REQUIRE(attribute.read() == 7.0);
    std::ofstream(path) << "";
    REQUIRE_FALSE(attribute.read().has_value());
  }
  REQUIRE_FALSE(IioAttribute(path, false).write(1));
  std::filesystem::remove(path);
  REQUIRE_THROWS_AS(IioAttribute(path, false), std::system_error);
}

TEST_CASE("iio: keys that do not fit are refused in one sentence") {
  REQUIRE(refused("hal.iio.trigger=clock") == "accepted");
  REQUIRE_THAT(refused("hal.channels.x.iio.channel=voltage0"),
               Contains("input voltage0 of ad7606-8 a second time") && Contains("a channel of its own"));
  REQUIRE_THAT(refused("hal.channels.u.iio.readback.channel=voltage0"), Contains("a second time"));
  REQUIRE_THAT(refused("hal.channels.x.iio.device="), Contains("hal.channels.x.iio.device"));
  REQUIRE_THAT(refused("hal.channels.x.iio.scale_m_per_V=0"), Contains("the value of one volt, not 0"));
  REQUIRE_THAT(refused("hal.channels.u.iio.lowest_V=1"), Contains("safe_output.command_V"));
  REQUIRE_THAT(refused("hal.iio.sample_timeout_s=0.0005"), Contains("more than period_s (0.001)"));
  REQUIRE_THAT(refused("hal.iio.sample_timeout_s=0.01"),
               Contains("hal.iio.sample_timeout_s: found 0.01 without hal.iio.trigger"));
  REQUIRE_THAT(refused("hal.iio.watchdog=board"), Contains("enable_line, guard, external, none"));
  REQUIRE_THAT(refused("hal.iio.watchdog=guard"), Contains("guard without hal.guard"));
  REQUIRE_THAT(refused("hal.iio={}"), Contains("hal.iio.watchdog") && Contains("keeps its outputs"));
}

TEST_CASE("a foreign clock keeps our period where ten of its periods span ours to within half of one") {
  REQUIRE(keeps_period(10'499'000, timed_periods, 1e-3));
  REQUIRE(keeps_period(9'501'000, timed_periods, 1e-3));
  REQUIRE_FALSE(keeps_period(10'501'000, timed_periods, 1e-3));
  REQUIRE_FALSE(keeps_period(9'499'000, timed_periods, 1e-3));
}

TEST_CASE("iio: one clock alone paces the loop") {
  REQUIRE(IioBackend(iio_rig({"hal.iio.trigger=clock"})).is_paced());
  REQUIRE_FALSE(IioBackend(iio_rig()).is_paced());
  const std::string can = "hal.can={interface: can0, sync: foreign, nodes: {io: {node_id: 2}}}";
  REQUIRE_THROWS_WITH(iio_rig({can, "hal.iio.trigger=clock"}), Contains("hal.iio.trigger") && Contains("one clock"));
}

TEST_CASE("iio: what closes the valve without this program is graded") {
  const auto level = [](const std::vector<std::string>& sets) { return grade_devices(iio_rig(sets)).front().level; };
  REQUIRE(level({}) == FindingLevel::acceptable);
  REQUIRE(level({"hal.iio.watchdog=none"}) == FindingLevel::bad);
  REQUIRE(level({"hal.iio.watchdog=guard", "hal.guard={}"}) == FindingLevel::good);
  REQUIRE_THAT(device_warning(iio_rig({"hal.iio.watchdog=none"})), Contains("state hal.iio.watchdog"));
}

TEST_CASE("iio: a device that the machine has not is named, with those that it has") {
  const std::vector<std::string> refusals = iio_refusals(iio_rig({"hal.channels.x.iio.device=no-such-device"}));
  REQUIRE_FALSE(refusals.empty());
  REQUIRE_THAT(refusals.front(), Contains("no-such-device: hal.channels.x.iio.device: found the devices") ||
                                     Contains("built without libiio: install libiio-dev"));
}

#if __has_include(<iio.h>)

namespace {

// Time is that of the stamps: nothing waits so long.
constexpr std::int64_t period_ns = 100'000'000;
constexpr double iio_period_s = 0.1;

iio_channel stamp() { return {.id = "timestamp", .attributes = {}}; }

/// Devices of one input each and one of an output, on one trigger.
struct Converters {
  fake_iio::Machine machine;
  IioBoard board{true, machine.folder()};
  std::int64_t at_ns = 1'000'000'000, step_ns = period_ns;
  std::int64_t code = 0;

  explicit Converters(std::vector<iio_device> devices = {{.id = "iio:device0",
                                                          .name = "adc",
                                                          .channels = {{.id = "voltage0"}, stamp()}}})
      : machine(with_trigger(std::move(devices))) {}
  static std::vector<iio_device> with_trigger(std::vector<iio_device> devices) {
    devices.push_back({.id = "trigger0", .name = "clock", .is_trigger = true});
    return devices;
  }

  void sample(std::size_t device) { machine.devices[device].push({code, at_ns}); }
  /// The trigger's next period, with another code.
  void fire() {
    at_ns += step_ns;
    ++code;
    for (std::size_t i = 0; i + 1 < machine.devices.size(); ++i) sample(i);
  }
  /// From now on one comes to each wait.
  void fire_by_itself(bool fires) {
    for (iio_device& device : machine.devices)
      device.on_wait = fires ? std::function<void()>([this] { fire(); }) : std::function<void()>();
  }
  void start() {
    fire_by_itself(true);
    board.start_scans("clock", iio_period_s);
    REQUIRE(next(10 * period_ns) == 1);
    fire_by_itself(false);
  }
  /// Periods of the next tick; what it reads is new where there is one.
  std::int64_t next(std::int64_t timeout_ns = 0) {
    const std::int64_t samples = board.await_scan(timeout_ns).samples;
    REQUIRE(board.read() == (samples > 0));
    return samples;
  }
};

/// The sentence of a refusal.
template <class Part> std::string sentence(Part&& part) {
  try {
    part();
  } catch (const std::runtime_error& error) { return error.what(); }
  return "accepted";
}

bool is_built_with_iio() {
  const std::string said = sentence([] { const IioBoard board(true); });
  if (said != "accepted") WARN("SKIPPED: " + said);
  return said == "accepted";
}

}  // namespace

TEST_CASE("iio: without a wait a reading has what came since the last one, and nothing where nothing came") {
  if (!is_built_with_iio()) return;
  Converters all;
  all.board.add_input("x.iio", {"adc", "voltage0"});
  all.start();
  all.fire();
  REQUIRE(all.next() == 1);
  REQUIRE(all.board.volts(0) == static_cast<double>(all.code));
  REQUIRE_FALSE(all.board.read());
  all.fire();
  all.fire();
  REQUIRE(all.board.read());
  REQUIRE(all.board.volts(0) == static_cast<double>(all.code));
  REQUIRE_FALSE(all.board.read());
  REQUIRE(all.next() == 0);
}

TEST_CASE("iio: scans that the kernel dropped are counted by the clock, and what it kept is not taken as new") {
  if (!is_built_with_iio()) return;
  Converters all;
  all.board.add_input("x.iio", {"adc", "voltage0"});
  all.start();
  all.at_ns += 3 * period_ns;  // the trigger was held off
  all.fire();
  REQUIRE(all.next() == 4);
  for (int i = 0; i < 100; ++i) all.fire();
  REQUIRE(all.machine.devices[0].waiting.size() == 64);
  all.fire_by_itself(true);
  REQUIRE(all.next(10 * period_ns) == 101);
  all.fire_by_itself(false);
  REQUIRE(all.board.volts(0) == static_cast<double>(all.code));
  all.fire();
  REQUIRE(all.next() == 1);
}

TEST_CASE("iio: a scan of one device that waits for the other's counts once, and is not lost") {
  if (!is_built_with_iio()) return;
  Converters all({{.id = "iio:device0", .name = "adc", .channels = {{.id = "voltage0"}, stamp()}},
                  {.id = "iio:device1", .name = "adc-2", .channels = {{.id = "voltage0"}, stamp()}}});
  all.board.add_input("x.iio", {"adc", "voltage0"});
  all.board.add_input("p1_port.iio", {"adc-2", "voltage0"});
  all.start();
  all.fire();
  all.at_ns += period_ns;
  all.sample(0);
  REQUIRE(all.next() == 1);
  all.sample(1);
  REQUIRE(all.next() == 1);
  REQUIRE(all.next() == 0);
  // One that is silent is missed at once, however long the other one goes on.
  for (int i = 0; i < 5; ++i) {
    all.at_ns += period_ns;
    all.sample(0);
    REQUIRE(all.next() == 0);
  }
  all.sample(1);
  REQUIRE(all.next() == 1);
  for (int i = 0; i < 5; ++i) {
    all.at_ns += period_ns;
    all.sample(1);
    REQUIRE(all.next() == 0);
  }
}

TEST_CASE("iio: a trigger of another period is refused, also where its scans are half as many") {
  if (!is_built_with_iio()) return;
  for (const double ratio : {0.94, 1.06, 2.0}) {
    Converters all;
    all.board.add_input("x.iio", {"adc", "voltage0"});
    all.step_ns = std::llround(ratio * static_cast<double>(period_ns));
    all.fire_by_itself(true);
    REQUIRE_THAT(sentence([&] { all.board.start_scans("clock", iio_period_s); }),
                 Contains("hal.iio.trigger: found a scan every") && Contains("expected one every 0.1 s"));
  }
}

TEST_CASE("iio: inputs that a trigger would sample wrongly are refused, and read directly") {
  if (!is_built_with_iio()) return;
  const std::vector<std::pair<iio_channel, const char*>> wrong{
      {{.id = "voltage0", .attributes = {{"input", "1500"}}}, "in millivolts"},
      {{.id = "voltage0", .format = format_of(16, 16, 8)}, "of several numbers"},
      {{.id = "voltage0", .format = format_of(128, 128, 1)}, "of more than 64 bits"}};
  for (const auto& [channel, word] : wrong) {
    Converters all({{.id = "iio:device0", .name = "adc", .channels = {channel, stamp()}}});
    all.board.add_input("x.iio", {"adc", "voltage0"});
    REQUIRE(all.board.read());
    REQUIRE(all.board.volts(0) == (channel.attributes.contains("input") ? 1.5 : 0.0));
    REQUIRE_THAT(sentence([&] { all.board.start_scans("clock", iio_period_s); }),
                 Contains("hal.channels.x.iio: found an input") && Contains(word));
  }
}

TEST_CASE("iio: a useless scale, a doubled scale and a channel that another key has are refused") {
  if (!is_built_with_iio()) return;
  Converters all({{.id = "iio:device0",
                   .name = "adc",
                   .channels = {{.id = "voltage0"},
                                {.id = "voltage1", .attributes = {{"raw", "0"}, {"scale", "0"}}},
                                {.id = "voltage2", .attributes = {{"raw", "0"}, {"scale", "inf"}}},
                                {.id = "voltage3", .attributes = {{"input", "0"}}},
                                {.id = "voltage0", .is_output = true}}}});
  const auto refused_input = [&](const IioPlace& place) {
    return sentence([&] { all.board.add_input("x.iio", place); });
  };
  REQUIRE_THAT(refused_input({"adc", "voltage1"}),
               Contains("x.iio: found a scale of 0 that") && Contains("another channel"));
  REQUIRE_THAT(refused_input({"adc", "voltage2"}), Contains("x.iio: found a scale of inf that"));
  REQUIRE_THAT(refused_input({"adc", "voltage3", 0.001}),
               Contains("x.iio.V_per_count: found 0.001") && Contains("millivolts"));
  all.board.add_input("p1_port.iio", {"adc", "voltage0"});
  REQUIRE_THAT(refused_input({"iio:device0", "voltage0"}),
               Contains("x.iio.channel: found voltage0, which hal.channels.p1_port.iio has"));
  REQUIRE(all.board.add_output("u.iio", {"adc", "voltage0"}) == 0);
}

TEST_CASE("iio: a code is held within what the driver states, else within what a double holds exactly") {
  if (!is_built_with_iio()) return;
  Converters all({{.id = "iio:device0",
                   .name = "dac",
                   .channels = {{.id = "voltage0",
                                 .is_output = true,
                                 .attributes = {{"raw", "0"}, {"scale", "1"}, {"raw_available", "[-10 1 4095]\n"}}},
                                {.id = "voltage1", .is_output = true, .attributes = {{"raw", "0"}}}}}});
  all.board.add_output("u1.iio", {"dac", "voltage0"});
  all.board.add_output("u2.iio", {"dac", "voltage1", 1e-300});
  const auto written = [&](std::size_t output, double volts) {
    const iio_device& dac = all.machine.devices[0];
    const auto file = all.machine.file(dac, dac.channels[output], "raw");
    std::ofstream(file) << "";
    all.board.set_volts(output, volts);
    REQUIRE(all.board.write());
    std::string text;
    std::ifstream(file) >> text;
    return text;
  };
  REQUIRE(written(0, 100.0) == "4095");
  REQUIRE(written(0, -100.0) == "-10");
  REQUIRE(written(1, 5.0) == "9007199254740992");
  REQUIRE(written(1, -5.0) == "-9007199254740992");
}

#endif
