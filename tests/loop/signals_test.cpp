// What hangs on the table of signals: keys of the wiring, sensors, faults.
#include <catch2/catch.hpp>

#include <bit>
#include <set>
#include <string>
#include <vector>

#include <pneuservo/loop/fault.hpp>
#include <pneuservo/rig/rig.hpp>

using namespace pneuservo;

TEST_CASE("hal.channels has a key for every channel, in the table's order, beside the commands") {
  std::vector<Signal> inputs;
  HalChannels{}.for_each_input([&](Signal signal, const auto&) { inputs.push_back(signal); });
  CHECK(inputs == std::vector<Signal>(channel_signals.begin(), channel_signals.end()));
  std::set<std::string_view> keys;
  const HalChannels channels;
  HalChannels::visit([&](const Field& field, const auto&) { keys.insert(field.key); }, channels);
  channels.for_each_command([&](std::string_view key, std::size_t, const auto&) { CHECK(keys.erase(key) == 1); });
  CHECK(keys.size() == channel_signals.size());
}

TEST_CASE("the signals of a kind share their sensor") {
  SensorsParameters sensors;
  sensors.position.quantum_m = 1.0, sensors.port_pressure.quantum_Pa = 2.0, sensors.chamber_pressure.quantum_Pa = 3.0;
  sensors.supply_pressure.quantum_Pa = 4.0, sensors.supply_flow.quantum_kgps = 5.0, sensors.force.quantum_N = 6.0;
  sensors.position.noise_m = 10.0, sensors.port_pressure.noise_Pa = 20.0, sensors.chamber_pressure.noise_Pa = 30.0;
  sensors.supply_pressure.noise_Pa = 40.0, sensors.supply_flow.noise_kgps = 50.0, sensors.force.noise_N = 60.0;
  sensors.differential_pressure = {7.0, 70.0, 700.0};
  const PerSignal<double> quanta{1, 2, 2, 3, 3, 4, 5, 6, 7, 7};
  for (const Signal signal : all_signals) {
    CHECK(sensors.resolution(signal).quantum == quanta[signal]);
    CHECK(sensors.resolution(signal).noise == 10.0 * quanta[signal]);
    CHECK(sensors.resolution(signal).range == (is_difference(signal) ? 700.0 : infinite));
  }
}

TEST_CASE("every channel that a motion rests on has fault bits of its own, with texts that name its kind and side") {
  std::uint64_t seen = 0;
  for (const Signal signal : channel_signals) {
    const SignalFaults faults = faults_of(signal);
    const bool any_step = signal == Signal::p_supply;  // no step of it is too large
    for (const std::uint64_t bit : {faults.missing, faults.frozen, any_step ? 0 : faults.jumped}) {
      if (bit == 0) continue;
      CAPTURE(info(signal).name, bit);
      CHECK(std::has_single_bit(bit));
      CHECK((seen & bit) == 0);
      seen |= bit;
    }
    for (const FaultText& text : fault_texts) {
      const std::string side = "_" + std::to_string(info(signal).side) + "_";
      const std::string kind = signal == Signal::x     ? "position_"
                               : is_port(signal)       ? "port_pressure" + side
                               : is_chamber(signal)    ? "chamber_pressure" + side
                               : is_difference(signal) ? "differential_pressure" + side
                                                       : "supply_";
      if (text.bit == faults.missing) CHECK(text.name == kind + "missing");
      if (text.bit == faults.frozen) CHECK(text.name == kind + "frozen");
      if (text.bit == faults.jumped && !any_step) CHECK(text.name == kind + "jump");
    }
  }
  CHECK(std::popcount(seen) == 19);
  CHECK(faults_of(Signal::F).missing == 0);
  CHECK(faults_of(Signal::supply_flow).missing == 0);
}
