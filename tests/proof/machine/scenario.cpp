// Keys of a scenario and the numbers that they set.
#include "scenario.hpp"

#include <sstream>
#include <stdexcept>

namespace proof {
namespace {

using Keys = std::map<std::string, double*>;

void add_side(Keys& keys, const std::string& n, SideData& s) {
  keys["tube_" + n + ".length"] = &s.tube.length_m;
  keys["tube_" + n + ".bore"] = &s.tube.diameter_m;
  keys["tube_" + n + ".layers"] = &s.tube.memory_share;
  keys["tube_" + n + ".swelling"] = &s.tube.swelling_per_Pa;
  keys["tube_" + n + ".leak"] = &s.tube.leak_m2;
  keys["tube_" + n + ".leak_place"] = &s.tube.leak_place;
  keys["tube_" + n + ".refine"] = &s.tube.refine;
  keys["side_" + n + ".piston"] = &s.piston_m2;
  keys["side_" + n + ".dead"] = &s.dead_m3;
  keys["side_" + n + ".heat"] = &s.heat_W_per_m2K;
  keys["side_" + n + ".port"] = &s.port_m3;
  keys["side_" + n + ".inlet_loss"] = &s.inlet_loss;
  keys["side_" + n + ".end"] = &s.end_m2;
  keys["side_" + n + ".check_valve"] = &s.out_of_chamber_m2;
  keys["side_" + n + ".kink"] = &s.kink_m2;
  keys["side_" + n + ".kink_from"] = &s.kink_from_m;
  keys["side_" + n + ".cushion"] = &s.cushion_m2;
  keys["side_" + n + ".cushion_length"] = &s.cushion_m;
  keys["side_" + n + ".leak"] = &s.leak_m2;
  keys["side_" + n + ".relief_pressure"] = &s.relief_Pa;
  keys["side_" + n + ".relief_slope"] = &s.relief_m2_per_Pa;
}

void add_valve(Keys& keys, ValveData& v) {
  keys["valve.range"] = &v.command_max_V;
  keys["valve.slope"] = &v.area_per_volt;
  keys["valve.largest"] = &v.area_max;
  keys["valve.b"] = &v.critical_ratio;
  keys["valve.frequency"] = &v.frequency_Hz;
  keys["valve.damping"] = &v.damping;
  keys["valve.lag"] = &v.lag_s;
  keys["valve.delay"] = &v.delay_s;
  keys["valve.play"] = &v.play_V;
  keys["valve.dead_band"] = &v.dead_band_V;
  keys["valve.offset"] = &v.offset_V;
  keys["valve.neutral_leak"] = &v.neutral_leak_m2;
  keys["valve.exhaust_ratio"] = &v.exhaust_ratio;
  keys["valve.wave"] = &v.wave_share;
  keys["valve.wave_length"] = &v.wave_V;
  keys["valve.sticks"] = &v.sticks_V;
  keys["valve.drift"] = &v.drift_per_s;
  keys["valve.silencer"] = &v.silencer_m2;
}

void add_supply(Keys& keys, SupplyData& s) {
  keys["supply.pressure"] = &s.pressure_Pa;
  keys["supply.temperature"] = &s.temperature_K;
  keys["supply.hose"] = &s.hose_m2;
  keys["supply.volume"] = &s.volume_m3;
  keys["supply.swing"] = &s.swing_Pa;
  keys["supply.swing_frequency"] = &s.swing_Hz;
  keys["supply.regulator_gap"] = &s.regulator_gap_Pa;
  keys["supply.dip"] = &s.dip_Pa;
  keys["supply.dip_every"] = &s.dip_every_s;
  keys["supply.dip_lasts"] = &s.dip_lasts_s;
}

void add_motion(Keys& keys, MotionData& m) {
  keys["motion.mass"] = &m.mass_kg;
  keys["motion.viscous"] = &m.viscous;
  keys["motion.stroke"] = &m.stroke_m;
  keys["motion.restitution"] = &m.restitution;
  keys["motion.forward"] = &m.forward_N;
  keys["motion.backward"] = &m.backward_N;
  keys["motion.extra"] = &m.extra_N;
  keys["motion.extra_speed"] = &m.stribeck_mps;
  keys["motion.seal"] = &m.seal_N_per_Pa;
  keys["motion.zone"] = &m.zone_N;
  keys["motion.zone_at"] = &m.zone_at_m;
  keys["motion.zone_width"] = &m.zone_m;
  keys["motion.drag"] = &m.drag;
  keys["motion.load"] = &m.load_N;
  keys["motion.spring"] = &m.spring_N_per_m;
  keys["motion.spring_at"] = &m.spring_at_m;
  keys["motion.periodic"] = &m.periodic_N;
  keys["motion.periodic_frequency"] = &m.periodic_Hz;
  keys["motion.bristle"] = &m.bristle_N;
  keys["motion.bristle_way"] = &m.bristle_m;
  keys["motion.warm"] = &m.warm_N;
  keys["motion.warm_time"] = &m.warm_s;
  keys["motion.bumper"] = &m.bumper_N_per_m;
  keys["motion.bumper_at"] = &m.bumper_at_m;
  keys["motion.gained"] = &m.gained_kg;
  keys["motion.gained_at"] = &m.gained_at_s;
  keys["motion.gained_weight"] = &m.gained_weight_N;
  keys["motion.blow"] = &m.blow_N;
  keys["motion.blow_every"] = &m.blow_every_s;
  keys["motion.blow_lasts"] = &m.blow_lasts_s;
  keys["motion.tail"] = &m.tail_kg;
  keys["motion.tail_frequency"] = &m.tail_Hz;
  keys["motion.tail_damping"] = &m.tail_damping;
}

void add_sensors(Keys& keys, std::array<SensorData, 6>& sensors) {
  const std::array<std::string, 6> names{"x", "port_1", "port_2", "chamber_1", "chamber_2", "supply"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    SensorData& s = sensors[i];
    keys["sensor." + names[i] + ".noise"] = &s.noise;
    keys["sensor." + names[i] + ".quantum"] = &s.quantum;
    keys["sensor." + names[i] + ".offset"] = &s.offset;
    keys["sensor." + names[i] + ".gain"] = &s.gain;
    keys["sensor." + names[i] + ".lag"] = &s.lag_s;
    keys["sensor." + names[i] + ".play"] = &s.play;
    keys["sensor." + names[i] + ".bend"] = &s.bend;
  }
}

Keys keys_of(Scenario& s) {
  Keys keys;
  MachineData& m = s.machine;
  keys["gas.constant"] = &m.gas.gas_constant;
  keys["gas.heat_ratio"] = &m.gas.heat_ratio;
  keys["gas.viscosity"] = &m.gas.viscosity_Pas;
  keys["gas.prandtl"] = &m.gas.prandtl;
  keys["gas.atmosphere"] = &m.gas.atmosphere_Pa;
  keys["room"] = &m.room_K;
  keys["piston.leak"] = &m.piston_leak_m2;
  keys["piston.zone"] = &m.piston_zone_m2;
  keys["piston.zone_at"] = &m.piston_zone_at_m;
  keys["piston.zone_width"] = &m.piston_zone_m;
  add_valve(keys, m.valve);
  add_supply(keys, m.supply);
  add_side(keys, "1", m.side[0]);
  add_side(keys, "2", m.side[1]);
  add_motion(keys, m.motion);
  add_sensors(keys, s.sensors);
  keys["loop.position_gain"] = &s.loop.position_gain;
  keys["loop.speed_gain"] = &s.loop.speed_gain;
  keys["loop.force_gain"] = &s.loop.force_gain;
  keys["loop.filter"] = &s.loop.filter_s;
  keys["loop.bias"] = &s.loop.bias_N;
  keys["loop.step"] = &s.loop.step_V;
  keys["loop.area_1"] = &s.area_1_m2;
  keys["loop.area_2"] = &s.area_2_m2;
  keys["move.center"] = &s.move.center_m;
  keys["move.start"] = &s.move.start_s;
  keys["move.ramp"] = &s.move.ramp_s;
  keys["period"] = &s.period_s;
  keys["first"] = &s.first_s;
  keys["length"] = &s.length_s;
  keys["jitter"] = &s.jitter_s;
  keys["start_pressure"] = &s.start_Pa;
  keys["start_pressure_2"] = &s.start_2_Pa;
  return keys;
}

void read_line(Scenario& s, const Keys& keys, const std::string& key, std::istringstream& words, int line) {
  bool read = false;
  if (key == "move.wave") {
    std::array<double, 3> w{};
    read = static_cast<bool>(words >> w[0] >> w[1] >> w[2]);
    s.move.waves.push_back(w);
  } else if (key == "move.point") {
    std::pair<double, double> p;
    read = static_cast<bool>(words >> p.first >> p.second);
    s.move.points.push_back(p);
  } else if (key == "loop.at_chambers") {
    read = static_cast<bool>(words >> s.loop.at_chambers);
  } else if (key == "seed") {
    read = static_cast<bool>(words >> s.seed);
  } else {
    const auto found = keys.find(key);
    if (found == keys.end()) throw std::runtime_error("line " + std::to_string(line) + ": unknown key " + key);
    read = static_cast<bool>(words >> *found->second);
  }
  std::string more;
  if (!read || words >> more)
    throw std::runtime_error("line " + std::to_string(line) + ": " + key +
                             ": expected numbers and nothing behind them");
}

}  // namespace

Scenario read_scenario(std::istream& in) {
  Scenario s;
  const Keys keys = keys_of(s);
  std::string text;
  for (int line = 1; std::getline(in, text); ++line) {
    std::istringstream words(text);
    std::string key;
    if (words >> key && key[0] != '#') read_line(s, keys, key, words, line);
  }
  if (s.area_1_m2 <= 0.0) s.area_1_m2 = s.machine.side[0].piston_m2;
  if (s.area_2_m2 <= 0.0) s.area_2_m2 = s.machine.side[1].piston_m2;
  for (SideData& side : s.machine.side) {
    side.tube.wall_K = s.machine.room_K;
    side.tube.critical_ratio = s.machine.valve.critical_ratio;
  }
  return s;
}

}  // namespace proof
