// The supervisor: its states, what single causes it knows, cross-checks of stated sizes, the way back, no false fault.
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include <pneuservo/loop/axis_loop.hpp>

#include "inject/injecting_backend.hpp"
#include "loop/loop_rigs.hpp"
#include "loop/runner.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

/// A loop on a backend whose measurements a test may change before they reach the loop.
class TouchedBackend final : public Backend {
 public:
  explicit TouchedBackend(const Rig& rig) : plant_(rig) { plant_.configure(); }
  Measurement extra;                 ///< digital inputs and device faults of the next ticks
  double supply_Pa = std::nan("");   ///< instead of the measured one
  bool has_supply_sensor = true;
  Command last;
  void configure() override {}
  void activate() override {}
  bool read(std::int64_t tick, Measurement& measurement) noexcept override {
    plant_.read(tick, measurement);
    measurement.digital = extra.digital;
    measurement.device_faults = extra.device_faults;
    if (!has_supply_sensor) measurement.channel[Signal::p_supply] = {};
    if (std::isfinite(supply_Pa)) measurement.channel[Signal::p_supply].value = supply_Pa;
    return true;
  }
  bool write(std::int64_t tick, const Command& command) noexcept override {
    last = command;
    return plant_.write(tick, command);
  }
  void deactivate() noexcept override {}
  Origins origins() const override { return plant_.origins(); }
  std::string name() const override { return "sim"; }
  SimBackend& plant() { return plant_; }

 private:
  SimBackend plant_;
};

struct Bench {
  explicit Bench(const Rig& rig) : backend(rig) { loop.configure(rig); }
  const Row& step(std::int64_t skipped = 0) {
    tick += skipped;
    loop.pass(backend, tick++, skipped, nullptr, nullptr);
    return loop.row();
  }
  /// After re-arming, which waits until the slider rests.
  const Row& step_until_active() {
    while (!loop.supervisor().is_active() && tick < 20000) step();
    return loop.row();
  }
  TouchedBackend backend;
  AxisLoop loop;
  std::int64_t tick = 0;
};

Rig usual_rig(const std::vector<std::string>& sets = {}) {
  std::vector<std::string> all{"duration_s=4"};
  all.insert(all.end(), sets.begin(), sets.end());
  return config_rig("cylinder-10m-7.65mm", all);
}

std::string text_of_file(const std::string& path) {
  std::ifstream file(std::string(PNEUSERVO_SOURCE_DIR) + "/" + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

TEST_CASE("states: only configured and ready inputs make an axis active, only re-arming leads out of a fault") {
  using S = SupervisorState;
  using E = SupervisorEvent;
  STATIC_REQUIRE(next_state(S::unconfigured, E::rearmed) == S::unconfigured);
  STATIC_REQUIRE(next_state(S::unconfigured, E::inputs_ready) == S::unconfigured);
  STATIC_REQUIRE(next_state(S::unconfigured, E::configured) == S::inactive);
  STATIC_REQUIRE(next_state(S::inactive, E::inputs_ready) == S::active);
  for (const E event : {E::inputs_ready, E::fault_found, E::stop_asked})
    REQUIRE(next_state(S::fault, event) == S::fault);
  for (const S state : {S::inactive, S::active, S::fault, S::safe_stop}) {
    REQUIRE(next_state(state, E::rearmed) == S::inactive);
    REQUIRE(next_state(state, E::fault_found) == S::fault);
  }
  REQUIRE(next_state(S::safe_stop, E::inputs_ready) == S::safe_stop);
}

TEST_CASE("the state is in every row, and the enable output is on only while the axis is active") {
  Bench bench(usual_rig());
  REQUIRE(bench.loop.supervisor().state() == SupervisorState::inactive);
  REQUIRE(bench.step().state == static_cast<std::uint32_t>(SupervisorState::active));
  REQUIRE(bench.backend.last.enable);
  bench.backend.extra.device_faults = device_link_down;
  REQUIRE(bench.step().state == static_cast<std::uint32_t>(SupervisorState::fault));
  REQUIRE_FALSE(bench.backend.last.enable);
  bench.backend.extra.device_faults = 0;
  bench.loop.rearm();
  REQUIRE(bench.step().state == static_cast<std::uint32_t>(SupervisorState::inactive));  // it has to rest first
  bench.step_until_active();
  REQUIRE(bench.backend.last.enable);
  bench.loop.stop(bench.backend, bench.tick);
  REQUIRE_FALSE(bench.backend.last.enable);
  REQUIRE(bench.step().state == static_cast<std::uint32_t>(SupervisorState::safe_stop));
  REQUIRE(bench.loop.row().u_V == 0.0);
}

TEST_CASE("digital lines: an emergency stop, lost valve power, a limit switch that is run onto, any unreadable line") {
  struct Case {
    DigitalLine DigitalInputs::* line;
    LineState good, bad;
    std::uint64_t fault;
  };
  const Case c =
      GENERATE(Case{&DigitalInputs::emergency_stop, LineState::off, LineState::on, fault_emergency_stop},
               Case{&DigitalInputs::emergency_stop, LineState::off, LineState::unreadable, fault_emergency_stop},
               Case{&DigitalInputs::valve_power, LineState::on, LineState::off, fault_valve_power},
               Case{&DigitalInputs::valve_power, LineState::on, LineState::unreadable, fault_valve_power},
               Case{&DigitalInputs::limit_low, LineState::off, LineState::on, fault_limit_switch},
               Case{&DigitalInputs::limit_high, LineState::off, LineState::unreadable, fault_limit_switch});
  const Rig rig = usual_rig({"safe_output.command_V=0.25"});
  Bench bench(rig);
  (bench.backend.extra.digital.*c.line).state = c.good;
  for (int i = 0; i < 50; ++i) REQUIRE(bench.step().fault == 0);
  (bench.backend.extra.digital.*c.line).state = c.bad;
  REQUIRE(bench.step().fault == c.fault);
  REQUIRE(bench.backend.last.valve_V == 0.25);
  bench.loop.rearm();
  // A switch that is pressed lets the slider go; the others must be put right first.
  const bool leads_off = c.bad == LineState::on && c.fault == fault_limit_switch;
  REQUIRE((bench.step().fault == 0) == leads_off);
  (bench.backend.extra.digital.*c.line).state = c.good;
  bench.loop.rearm();
  REQUIRE(bench.step().fault == 0);
}

TEST_CASE("a tick later than limits.lateness_s is a fault in that tick, a shorter one is not") {
  Bench bench(usual_rig({"limits.lateness_s=0.005"}));
  for (int i = 0; i < 20; ++i) bench.step();
  REQUIRE(bench.step(5).fault == 0);
  REQUIRE(bench.step(6).fault == fault_late_tick);
  REQUIRE(bench.loop.row().u_V == 0.0);
}

TEST_CASE("supply and pressures beyond their limits") {
  Bench low(usual_rig());
  for (int i = 0; i < 20; ++i) low.step();
  low.backend.supply_Pa = 0.49 * 700e3;
  REQUIRE(low.step().fault == fault_supply_low);
  Rig tight = usual_rig();
  tight.limits.pressure_Pa = 4.0e5;  // below the supply a config is refused
  Bench high(tight);
  REQUIRE(high.step().fault == fault_pressure_limit);
}

TEST_CASE("a supply that is lost shows in the air of a side where no sensor stands at it") {
  Bench bench(usual_rig());
  bench.backend.has_supply_sensor = false;
  while (bench.tick < 2000) REQUIRE(bench.step().fault == 0);
  bench.backend.plant().set_machine(3e5, {0.0, 0.0});
  while (bench.loop.faults() == 0 && bench.tick < 2500) bench.step();
  REQUIRE((bench.loop.first_faults() &
           (fault_flow_mismatch_1 | fault_flow_mismatch_2 | fault_chamber_mismatch_1 | fault_chamber_mismatch_2)) != 0);
}

TEST_CASE("an encoder of half its scale shows in the air that the moving piston takes") {
  Bench bench(
      usual_rig({"concealed={'sensor_gain:x': {gain: 0.5}}", "limits.deviation_m=0", "limits.speed_deviation_mps=0"}));
  while (bench.loop.faults() == 0 && bench.tick < 1500) bench.step();
  REQUIRE((bench.loop.first_faults() & (fault_flow_mismatch_1 | fault_flow_mismatch_2)) != 0);
}

TEST_CASE("a sample older than limits.age_periods is missing") {
  const Rig rig = usual_rig({"limits.age_periods=2.5"});
  InjectingBackend backend(
      rig, {parse_fault_order("delay:x:0.002@0.1+0.1", 0.0), parse_fault_order("delay:x:0.003@0.3", 0.0)}, "test");
  backend.configure();
  AxisLoop loop;
  loop.configure(rig);
  std::int64_t tick = 0;
  while (loop.faults() == 0 && tick < 1000) loop.pass(backend, tick++, 0, nullptr, nullptr);
  REQUIRE(loop.first_faults() == fault_position_missing);
  REQUIRE(tick - 1 == 300);
}

TEST_CASE("safe output: hold, centre and vent are what the valves get") {
  REQUIRE(safe_commands_V(usual_rig({"safe_output.command_V=0.25"})) == std::array{0.25, 0.25});
  REQUIRE(safe_commands_V(usual_rig({"safe_output.action=centre"})) == std::array{0.0, 0.0});
  const Rig table = config_rig("servo-table-0.5m-4mm", {"safe_output.action=vent"});
  REQUIRE(safe_commands_V(table) == std::array{-1.6, -1.6});
  REQUIRE_THROWS_WITH(usual_rig({"safe_output.action=vent"}), Catch::Contains("safe_output.action: found vent"));
  REQUIRE_THROWS_WITH(usual_rig({"safe_output={action: centre, command_V: 1}"}),
                      Catch::Contains("safe_output.command_V"));
}

TEST_CASE("re-arming starts from the measured position, softly, with nothing kept") {
  Bench bench(usual_rig());
  while (bench.tick < 1700) bench.step();  // in full motion
  bench.backend.extra.digital.emergency_stop.state = LineState::on;
  for (int i = 0; i < 300; ++i) bench.step();
  REQUIRE(bench.loop.first_faults() == fault_emergency_stop);
  bench.backend.extra.digital.emergency_stop.state = LineState::off;
  bench.loop.rearm();
  const Row& first = bench.step_until_active();
  REQUIRE(first.fault == 0);
  REQUIRE(first.x_ref_m == Approx(first.measured[Signal::x]).margin(1e-9));
  REQUIRE(std::fabs(first.v_ref_mps) < 1e-9);
  double fastest_mps = 0.0;
  for (int i = 0; i < 400; ++i) fastest_mps = std::max(fastest_mps, std::fabs(bench.step().v_ref_mps));
  REQUIRE(fastest_mps < 0.3);
  REQUIRE(bench.loop.faults() == 0);
}

TEST_CASE("docs/faults.md has a row for each fault, with its bit, meaning and remedy, and all states") {
  const std::string page = text_of_file("docs/faults.md");
  for (const FaultText& text : fault_texts) {
    const std::size_t colon = text.meaning.find(": ");
    const std::string row = fmt::format("| `{}` | {} | {} | {} |", text.name, text.bit, text.meaning.substr(0, colon),
                                        text.meaning.substr(colon + 2));
    CAPTURE(row);
    REQUIRE(page.find(row) != std::string::npos);
  }
  const std::string picture = text_of_file("docs/figures/supervisor-states.svg");
  for (const std::string_view state : supervisor_state_names) {
    REQUIRE(page.find(std::string("| `").append(state).append("` |")) != std::string::npos);
    REQUIRE(picture.find(std::string("class=\"name\">").append(state)) != std::string::npos);
  }
}

TEST_CASE("no false fault in normal running: nine lines with noise, 20 s each, an hour in the long run", "[long]") {
  const bool whole = std::getenv("PNEUSERVO_LONG") != nullptr;
  for (const std::string& name : nine_configs()) {
    const Rig rig = config_rig(name, {whole ? "duration_s=3600" : "duration_s=20", "seed=11"});
    SimBackend backend(rig);
    backend.configure();
    backend.activate();
    AxisLoop loop;
    loop.configure(rig);
    const std::int64_t ticks = std::llround(rig.duration_s / rig.period_s);
    double flow = 0.0, chamber = 0.0;
    for (std::int64_t tick = 0; tick < ticks; ++tick) {
      loop.pass(backend, tick, 0, nullptr, nullptr);
      const CrossCheck& checks = loop.supervisor().checks();
      for (std::size_t side = 0; side < 2; ++side) {
        flow = std::max(flow, checks.flow_share()[side]);
        chamber = std::max(chamber, checks.chamber_share()[side]);
      }
      if (loop.faults() != 0 || (loop.row().flags & row_input_bridged) != 0) {
        CAPTURE(name, tick, loop.faults());
        FAIL("a fault or a bridged sample in normal running");
      }
    }
    std::printf("%-20s %.0f s, no fault; nearest: flow %.2f, chamber %.2f of their limits\n", name.c_str(),
                rig.duration_s, flow, chamber);
    REQUIRE((flow > 0.0 && flow < 0.7));
    REQUIRE((chamber > 0.0 && chamber < 0.7));
  }
}
