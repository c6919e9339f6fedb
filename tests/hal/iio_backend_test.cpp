// Analog devices behind their backend: scale, limits, readback, safe output, age; files and keys of Industrial I/O. The
// kernel's own devices are tried in tests/kernel.
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
#include "iio/iio_attribute.hpp"
#include "iio/iio_backend.hpp"
#include "loop/device_grade.hpp"

using namespace pneuservo;
#include "input_wait.hpp"
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

TEST_CASE("iio: numbers as the kernel prints them") {
  REQUIRE(iio_number("73\n") == 73.0);
  REQUIRE(iio_number("-34\n") == -34.0);
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
  REQUIRE_THAT(refused("hal.iio.watchdog=board"), Contains("enable_line, guard, external, none"));
  REQUIRE_THAT(refused("hal.iio.watchdog=guard"), Contains("guard without hal.guard"));
  REQUIRE_THAT(refused("hal.iio={}"), Contains("hal.iio.watchdog") && Contains("keeps its outputs"));
  REQUIRE_THAT(refused("hal.iio.sample_timeout_s=0.01"),
               Contains("hal.iio.sample_timeout_s: found 0.01 without hal.iio.trigger"));
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
TEST_CASE("a foreign clock keeps our period where ten of its periods span ours to within half of one") {
  REQUIRE(keeps_period(10'499'000, timed_periods, 1e-3));
  REQUIRE(keeps_period(9'501'000, timed_periods, 1e-3));
  REQUIRE_FALSE(keeps_period(10'501'000, timed_periods, 1e-3));
  REQUIRE_FALSE(keeps_period(9'499'000, timed_periods, 1e-3));
}

