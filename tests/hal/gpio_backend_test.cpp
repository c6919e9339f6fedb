// Digital lines behind the backend: states, edges between two ticks, lines that cannot be read, the enable output; keys
// of lines and boards in a config. The kernel's own lines are tried in tests/kernel.
#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <utility>

#include "analog/running_count.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "gpio/chip_name.hpp"
#include "gpio/gpio_backend.hpp"

using namespace pneuservo;

namespace {

/// A line whose other side the test holds.
struct Wire {
  std::optional<bool> level = false;
  GpioLine::Edges edges;
  bool refuses = false;
  int writes = 0;
  bool is_requested = false, is_output = false;
};

class WireLine final : public GpioLine {
 public:
  explicit WireLine(Wire& wire) : wire_(wire) { wire_.is_requested = true; }
  ~WireLine() override { wire_.is_requested = false; }
  WireLine(const WireLine&) = delete;
  WireLine& operator=(const WireLine&) = delete;
  std::optional<bool> read() noexcept override { return wire_.level; }
  bool write(bool active) noexcept override {
    if (wire_.refuses) return false;
    ++wire_.writes;
    wire_.level = active;
    return true;
  }
  Edges take_edges() noexcept override { return std::exchange(wire_.edges, Edges{}); }

 private:
  Wire& wire_;
};

Rig mixed_rig(const std::vector<std::string>& sets = {}) {
  return read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/mixed/cylinder-10m-7.65mm.yaml", sets);
}

struct Panel {
  std::map<std::string, Wire> wires;
  GpioBackend backend{mixed_rig(), [this](const std::string& key, const GpioLineParameters&, bool is_output) {
                        wires[key].is_output = is_output;
                        return std::make_unique<WireLine>(wires[key]);
                      }};
  DigitalInputs read() {
    Measurement measured;
    REQUIRE(backend.read(0, measured));
    return measured.digital;
  }
};

}  // namespace

TEST_CASE("gpio: levels become states, a line that cannot be read says so, a missing one is absent") {
  Panel panel;
  panel.backend.configure();
  panel.wires["limit_low"].level = true;
  panel.wires["valve_power"].level = {};
  const DigitalInputs inputs = panel.read();
  REQUIRE(inputs.emergency_stop.state == LineState::off);
  REQUIRE(inputs.limit_low.state == LineState::on);
  REQUIRE(inputs.valve_power.state == LineState::unreadable);
  REQUIRE(std::isnan(inputs.limit_low.edge_age_s));
  REQUIRE(panel.wires["enable"].is_output);
  REQUIRE_FALSE(panel.wires["emergency_stop"].is_output);
  REQUIRE(panel.backend.notes().front() == "gpio: valve_power could not be read");
}

TEST_CASE("gpio: an emergency stop that was pressed and let go between two ticks is one, a limit switch is its level") {
  Panel panel;
  panel.backend.configure();
  for (const char* key : {"emergency_stop", "limit_high"}) panel.wires[key].edges = {true, 1};
  const DigitalInputs inputs = panel.read();
  REQUIRE(inputs.emergency_stop.state == LineState::on);
  REQUIRE(inputs.emergency_stop.edge_age_s > 0.0);
  REQUIRE(inputs.limit_high.state == LineState::off);
  const DigitalInputs next = panel.read();
  REQUIRE(next.emergency_stop.state == LineState::off);
  REQUIRE(next.emergency_stop.edge_age_s > inputs.emergency_stop.edge_age_s);
}

TEST_CASE("gpio: enable follows the command, is off at the end, and a refusal is a missed output") {
  Panel panel;
  panel.backend.configure();
  Wire& enable = panel.wires["enable"];
  REQUIRE(panel.backend.write(0, {0.0, 0.0, false}));
  REQUIRE(enable.writes == 0);
  for (int tick = 1; tick < 4; ++tick) REQUIRE(panel.backend.write(tick, {1.0, 0.0, true}));
  REQUIRE((enable.level == true && enable.writes == 1));
  enable.refuses = true;
  REQUIRE_FALSE(panel.backend.write(4, {0.0, 0.0, false}));
  enable.refuses = false;
  REQUIRE(panel.backend.write(5, {1.0, 0.0, true}));
  panel.backend.deactivate();
  REQUIRE(enable.level == false);
  for (const auto& [key, wire] : panel.wires) REQUIRE_FALSE(wire.is_requested);
}

TEST_CASE("gpio: a chip is named by path, in any folder, by name, number or label") {
  CHECK(is_chip_path("/dev/gpiochip1"));
  CHECK(is_chip_path("/dev/gpio/panel"));
  for (const char* chip : {"gpiochip1", "1", "panel", ""}) CHECK_FALSE(is_chip_path(chip));
  const auto is_first = [](const std::string& chip) { return is_chip_named(chip, "gpiochip1", "pinctrl-panel"); };
  for (const char* chip : {"gpiochip1", "1", "pinctrl-panel"}) CHECK(is_first(chip));
  for (const char* chip : {"gpiochip11", "11", "", "chip1", "panel"}) CHECK_FALSE(is_first(chip));
}

TEST_CASE("a counter runs past its end in both directions") {
  RunningCount count;
  constexpr std::uint32_t last = (1u << 24) - 1;
  REQUIRE(count.advance(last - 1, last) == 0);
  REQUIRE(count.advance(3, last) == 5);
  REQUIRE(count.advance(last, last) == 1);
  REQUIRE(count.advance(100, last) == 102);
  RunningCount wide;
  REQUIRE(wide.advance(10, 0xFFFFFFFFu) == 0);
  REQUIRE(wide.advance(0xFFFFFFFFu, 0xFFFFFFFFu) == -11);
}

TEST_CASE("lines and boards: what a config can get wrong is named by its key") {
  const auto refused = [](const std::string& set) {
    try {
      mixed_rig({set});
    } catch (const InputError& error) { return std::string(error.what()); }
    return std::string("accepted");
  };
  REQUIRE_THAT(refused("hal.gpio.limit_low.line=ESTOP"),
               Catch::Contains("hal.gpio.limit_low.line") && Catch::Contains("a second time"));
  REQUIRE_THAT(refused("hal.gpio.enable.line=3"),
               Catch::Contains("the number 3") && Catch::Contains("hal.gpio.enable.chip"));
  REQUIRE_THAT(refused("hal.gpio.emergency_stop.bias=up"), Catch::Contains("pull_up"));
  REQUIRE_THAT(refused("hal.channels.p_supply.simulated=true"),
               Catch::Contains("hal.channels.p_supply") && Catch::Contains("2 sources"));
  REQUIRE_THAT(refused("hal.channels.p_supply.comedi.scale_Pa_per_V=0"), Catch::Contains("the value of one volt"));
  REQUIRE_THAT(refused("hal.channels.p_supply.comedi.lowest_Pa=2e6"), Catch::Contains("less than highest_Pa"));
  REQUIRE(refused("hal.gpio.enable.chip=gpiochip0") == "accepted");
}
