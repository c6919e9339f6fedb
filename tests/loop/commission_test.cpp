// Commissioning and homing: wiring mistakes on several rigs get their own verdict, within the ways and speeds that are
// promised.
#include <catch2/catch.hpp>

#include <cmath>
#include <memory>

#include "loop/calibration.hpp"
#include "loop/commission.hpp"
#include "loop/loop_rigs.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

/// What an electrician may have done to an axis.
struct Wiring {
  bool valve_reversed = false, encoder_reversed = false, hoses_exchanged = false, ports_exchanged = false,
       chambers_exchanged = false;
  double encoder_scale = 1.0;
  double frozen_from_s = 1e9;
  PerSignal<double> offset{};
};

/// The simulated plant behind that wiring. Exchanged hoses are another machine: valve port 1 feeds chamber 2.
class WiredBackend final : public Backend {
 public:
  WiredBackend(const Rig& rig, const Wiring& wiring) : rig_(rig), wiring_(wiring), plant_(rig) { plant_.configure(); }
  void configure() override {}
  void activate() override {}
  bool read(std::int64_t tick, Measurement& m) noexcept override {
    plant_.read(tick, m);
    if (wiring_.hoses_exchanged != wiring_.ports_exchanged)
      std::swap(m.channel[Signal::p1_port], m.channel[Signal::p2_port]);
    if (wiring_.chambers_exchanged) std::swap(m.channel[Signal::p1_chamber], m.channel[Signal::p2_chamber]);
    if (!has_chambers) m.channel[Signal::p1_chamber] = m.channel[Signal::p2_chamber] = {};
    m.channel[Signal::x].value *= wiring_.encoder_scale * (wiring_.encoder_reversed ? -1.0 : 1.0);
    for (const Signal signal : channel_signals) m.channel[signal].value += wiring_.offset[signal];
    if (static_cast<double>(tick) * rig_.period_s >= wiring_.frozen_from_s) m.channel[Signal::x].value = frozen_m_;
    else frozen_m_ = m.channel[Signal::x].value;
    const double x = plant_.truth().x_m;
    if (has_switches) {
      m.digital.limit_low.state = x < -0.149 ? LineState::on : LineState::off;
      m.digital.limit_high.state = x > 0.149 ? LineState::on : LineState::off;
    }
    if (tick == 0) first_m = x;
    farthest_m = std::max(farthest_m, std::fabs(x - first_m));
    if (tick > last_tick_) fastest_mps = std::max(fastest_mps, std::fabs(x - last_m_) / rig_.period_s);
    last_m_ = x, last_tick_ = tick;
    return true;
  }
  bool write(std::int64_t tick, const Command& command) noexcept override {
    const bool turned = wiring_.valve_reversed != wiring_.hoses_exchanged;
    last = command;
    return plant_.write(tick, turned ? Command{-command.valve_V, -command.valve_2_V, command.enable} : command);
  }
  void deactivate() noexcept override {}
  Origins origins() const override {
    Origins all = plant_.origins();
    if (!has_chambers) all.channels[Signal::p1_chamber] = all.channels[Signal::p2_chamber] = Origin::absent;
    return all;
  }
  std::string name() const override { return "sim"; }
  bool has_chambers = true, has_switches = false;
  double first_m = 0.0, farthest_m = 0.0, fastest_mps = 0.0;
  Command last;

 private:
  Rig rig_;
  Wiring wiring_;
  SimBackend plant_;
  double frozen_m_ = 0.0, last_m_ = 0.0;
  std::int64_t last_tick_ = 1'000'000'000;
};

const CommissionCheck* named(const CommissionResult& result, const std::string& name) {
  for (const CommissionCheck& check : result.checks)
    if (check.name == name && check.verdict != CommissionVerdict::good) return &check;
  return nullptr;
}

std::string all_of(const CommissionResult& result) {
  std::string text;
  for (const CommissionCheck& check : result.checks)
    text += check.name + " (" + std::to_string(static_cast<int>(check.verdict)) + "): " + check.what + "\n";
  return text;
}

CommissionResult commissioned(const Rig& rig, const Wiring& wiring, bool chambers = true) {
  WiredBackend backend(rig, wiring);
  backend.has_chambers = chambers;
  CommissionResult result = commission_axis(rig, backend, false);
  INFO(all_of(result));
  CHECK(backend.farthest_m <= 5e-3);
  CHECK(backend.fastest_mps <= 0.2);
  const auto safe_V = safe_commands_V(rig);
  CHECK(backend.last.valve_V == safe_V[0]);
  CHECK_FALSE(backend.last.enable);
  return result;
}

std::string homing_refusal(const Rig& rig, const Wiring& wiring, HomingEnd end = HomingEnd::low) {
  WiredBackend backend(rig, wiring);
  try {
    HomingSettings settings;
    settings.end = end;
    find_home(rig, backend, settings);
  } catch (const std::runtime_error& error) { return error.what(); }
  return "";
}

}  // namespace

TEST_CASE("a well wired axis passes its commissioning on every rig") {
  const std::string name = GENERATE("cylinder-2m-4.15mm", "cylinder-5m-6.10mm", "cylinder-10m-4.15mm",
                                    "cylinder-10m-7.65mm", "servo-table-0.5m-4mm", "servo-table-2m-8mm");
  const std::uint64_t seed = GENERATE(1u, 7u);
  CAPTURE(name, seed);
  const CommissionResult result = commissioned(config_rig(name, {"seed=" + std::to_string(seed)}), {});
  INFO(all_of(result));
  REQUIRE(result.passed());
  REQUIRE(result.encoder_scale);
  REQUIRE(std::fabs(*result.encoder_scale - 1.0) < 0.25);
  REQUIRE(result.neutral_V);
  REQUIRE(std::fabs(*result.neutral_V) < 3.0 * *result.neutral_error_V);
  REQUIRE_FALSE(result.dead_band_V);
}

TEST_CASE("each wiring mistake is told by its name, within 5 mm and 0.2 m/s") {
  const std::string name =
      GENERATE("cylinder-2m-4.15mm", "cylinder-10m-7.65mm", "cylinder-10m-4.15mm", "servo-table-1m-8mm");
  const bool chambers = GENERATE(true, false);
  CAPTURE(name, chambers);
  const Rig rig = config_rig(name);
  const bool equal_areas = rig.axis.cylinder.area_1_m2 == rig.axis.cylinder.area_2_m2;
  const auto wrong = [&](const Wiring& wiring, const std::string& check, const std::string& word) {
    const CommissionResult result = commissioned(rig, wiring, chambers);
    INFO(word << ":\n" << all_of(result));
    REQUIRE_FALSE(result.passed());
    const CommissionCheck* found = named(result, check);
    REQUIRE(found);
    REQUIRE(found->verdict == CommissionVerdict::wrong);
    REQUIRE(found->what.find(word) != std::string::npos);
    REQUIRE_FALSE(found->remedy.empty());
  };
  wrong({.valve_reversed = true}, "valve", "the valve is reversed");
  wrong({.ports_exchanged = true}, "port sensors", "the port sensors are exchanged");
  wrong({.encoder_reversed = true}, equal_areas ? "encoder or hoses" : "encoder", "the encoder is reversed");
  wrong({.hoses_exchanged = true}, equal_areas ? "encoder or hoses" : "hoses", "the hoses are exchanged");
  if (chambers && !equal_areas) wrong({.chambers_exchanged = true}, "chamber sensors", "they are exchanged");
}

TEST_CASE("a frozen encoder ends the first probe by what the air does") {
  const std::string name = GENERATE("cylinder-2m-7.65mm", "cylinder-10m-4.15mm", "servo-table-1m-8mm");
  const double from_s = GENERATE(0.0, 1.15, 1.25);
  CAPTURE(name, from_s);
  WiredBackend backend(config_rig(name), {.frozen_from_s = from_s});
  const CommissionResult result = commission_axis(config_rig(name), backend, false);
  INFO(all_of(result));
  REQUIRE_FALSE(result.passed());
  REQUIRE(named(result, "encoder"));
  REQUIRE(backend.farthest_m <= 15e-3);
  REQUIRE(backend.fastest_mps <= 0.2);
}

TEST_CASE("a wrong scale, a gauge sensor, another supply and a blocked slider are told") {
  const Rig rig = config_rig("cylinder-5m-6.10mm");
  for (const double scale : {0.4, 2.2}) {
    const CommissionResult result = commissioned(rig, {.encoder_scale = scale});
    INFO(scale << "\n" << all_of(result));
    REQUIRE(named(result, "scale"));
    REQUIRE(*result.encoder_scale == Approx(scale).epsilon(0.25));
  }
  const double atmosphere_Pa = rig.axis.air.atmosphere_Pa;
  REQUIRE(named(commissioned(rig, {.offset = {0, -atmosphere_Pa, 0, 0, 0, 0}}), "p1_port"));
  REQUIRE(named(commissioned(rig, {.offset = {0, 0, -atmosphere_Pa, 0, 0, 0}}), "p2_port"));
  const CommissionResult supply = commissioned(rig, {.offset = {0, 0, 0, 0, 0, -atmosphere_Pa}});
  REQUIRE(named(supply, "p_supply"));
  REQUIRE(named(supply, "p_supply")->what.find("gauge") != std::string::npos);
  WiredBackend jammed(config_rig("cylinder-5m-6.10mm", {"effects={coulomb_friction: {force_N: 400}}"}), {});
  const CommissionResult blocked = commission_axis(rig, jammed, false);
  INFO(all_of(blocked));
  REQUIRE_FALSE(blocked.passed());
  REQUIRE(named(blocked, "slider"));
}

TEST_CASE("neutral and dead band of the valve come out beside the signs") {
  const double width_V = GENERATE(0.1, 0.25);
  Rig rig = config_rig("cylinder-5m-7.65mm");
  const Rig machine =
      config_rig("cylinder-5m-7.65mm", {"effects={valve_dead_band: {width_V: " + std::to_string(width_V) +
                                        "}, valve_offset: {offset_V: 0.04}}"});
  WiredBackend backend(machine, {});
  const CommissionResult result = commission_axis(rig, backend, false);
  INFO(all_of(result));
  REQUIRE(result.passed());
  REQUIRE(result.neutral_V);
  REQUIRE(*result.neutral_V == Approx(-0.04).margin(0.012));
  REQUIRE(result.dead_band_V);
  REQUIRE(*result.dead_band_V == Approx(width_V).epsilon(0.2));
}

TEST_CASE("homing finds both ends and refuses what is none") {
  const std::string name = GENERATE("cylinder-10m-7.65mm", "cylinder-2m-4.15mm");
  const HomingEnd end = GENERATE(HomingEnd::low, HomingEnd::high);
  const bool high = end == HomingEnd::high;
  CAPTURE(name, high);
  const Rig rig = config_rig(name);
  WiredBackend shifted(rig, {.offset = {0.02, 0, 0, 0, 0, 0}});
  HomingSettings settings;
  settings.end = end;
  const ChannelZero zero = find_home(rig, shifted, settings);
  REQUIRE(zero.zero == Approx(-0.02).margin(2e-5));
  REQUIRE(shifted.fastest_mps <= 0.2);

  REQUIRE(homing_refusal(rig, {.valve_reversed = true}, end).find("away from") != std::string::npos);
  REQUIRE(homing_refusal(rig, {.encoder_reversed = true}, end).find("away from") != std::string::npos);
  REQUIRE(homing_refusal(rig, {.hoses_exchanged = true}, end).find("away from") != std::string::npos);
  REQUIRE(homing_refusal(rig, {.ports_exchanged = true}, end).find("port sensors are exchanged") != std::string::npos);
  REQUIRE(homing_refusal(rig, {.encoder_scale = 0.9}, end).find("way between both stops") != std::string::npos);
  const double frozen_s = GENERATE(0.6, 1.5, 4.0);
  INFO("frozen from " << frozen_s);
  const std::string frozen = homing_refusal(rig, {.frozen_from_s = frozen_s}, end);
  INFO(frozen);
  REQUIRE_FALSE(frozen.empty());
}

TEST_CASE("an obstacle is no end stop") {
  const double stroke_m = GENERATE(0.12, 0.21, 0.29);
  const Rig rig = config_rig("cylinder-5m-6.10mm");
  const Rig machine =
      config_rig("cylinder-5m-6.10mm", {"cylinder.stroke_m=" + std::to_string(stroke_m), "reference.amplitude_m=0.02"});
  WiredBackend backend(machine, {});
  REQUIRE_THROWS_WITH(find_home(rig, backend, {}), Catch::Matchers::Contains("way between both stops"));
}

TEST_CASE("a limit switch confirms its end, and its absence refuses it") {
  const Rig rig = config_rig("mixed/cylinder-10m-7.65mm");
  WiredBackend whole(rig, {});
  whole.has_switches = true;
  const ChannelZero zero = find_home(rig, whole, {});
  REQUIRE(zero.what.find("limit switch") != std::string::npos);
  REQUIRE(whole.farthest_m < 0.16);  // the other end was not needed
  WiredBackend obstructed(config_rig("mixed/cylinder-10m-7.65mm", {"cylinder.stroke_m=0.2"}), {});
  obstructed.has_switches = true;
  REQUIRE_THROWS_WITH(find_home(rig, obstructed, {}), Catch::Matchers::Contains("limit switch of the low end"));
}
