// Residuals of a cylinder on recordings of the project's own plant: the truth leaves noise, every effect shows where it
// must and nowhere else, the grid's error is taken out, hypotheses do not see each other.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <Eigen/Dense>

#include "config/rig_parameters.hpp"
#include "diagnosis/residuals/cylinder_residuals.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

/// Root mean square of a column over each channel's rows.
std::map<std::string, double> by_channel(const ResidualModel& model, const Eigen::VectorXd& column) {
  std::map<std::string, double> sum, count;
  for (std::size_t i = 0; i < model.rows().size(); ++i) {
    const std::string& name = model.channels()[static_cast<std::size_t>(model.rows()[i].channel)].name;
    sum[name] += column(static_cast<Eigen::Index>(i)) * column(static_cast<Eigen::Index>(i));
    count[name] += 1;
  }
  for (auto& [name, value] : sum) value = std::sqrt(value / count[name]);
  return sum;
}

/// The hypothesis with the start factors that suit the rows best.
Hypothesis started(ResidualModel& model, const Rig& rig) {
  Hypothesis out{rig, std::vector<double>(model.start_factor_count(), 0.0)};
  const double step = 0.25 * model.start_factor_sigma();
  for (int iteration = 0; iteration < 2; ++iteration) {
    std::vector<Hypothesis> tried{out};
    for (std::size_t i = 0; i < out.start_factors.size(); ++i) {
      tried.push_back(out);
      tried.back().start_factors[i] += step;
    }
    const Eigen::MatrixXd columns = model.residuals(tried);
    const Eigen::MatrixXd slopes = (columns.rightCols(columns.cols() - 1).colwise() - columns.col(0)) / step;
    const Eigen::VectorXd change = slopes.householderQr().solve(-columns.col(0));
    for (std::size_t i = 0; i < out.start_factors.size(); ++i)
      out.start_factors[i] += change(static_cast<Eigen::Index>(i));
  }
  return out;
}

Hypothesis with(const Rig& rig, std::initializer_list<std::pair<const char*, double>> values) {
  Hypothesis out{rig, {}};
  for (const auto& [path, value] : values) set_parameter(out.rig, path, value);
  return out;
}

}  // namespace

TEST_CASE("cylinder residuals: at the truth every channel is at its noise") {
  Rig rig = cylinder_rig();
  rig.axis.effects.motion.coulomb_friction.force_N = 3.0;
  rig.axis.effects.chamber_leak_1.area_m2 = 1e-8;
  const Recording recording = simulated_recording(rig, 6.0, 1, all_of_the_gas);
  CylinderResiduals model(rig, {recording});
  REQUIRE(model.channels().size() == 7);
  REQUIRE(model.start_factor_count() == 2);
  const auto rms = by_channel(model, model.residuals(std::vector<Hypothesis>{started(model, rig)}).col(0));
  for (const auto& [name, value] : rms) {
    CAPTURE(name);
    CHECK(value > 0.3);
    CHECK(value < 1.2);
  }
  const auto misfit = model.sample_misfit(started(model, rig));
  for (std::size_t c = 0; c < model.channels().size(); ++c) {
    CAPTURE(model.channels()[c].name);
    CHECK(misfit[c].fitted < 1.5 * std::hypot(model.channels()[c].noise, model.channels()[c].floor));
  }
}

TEST_CASE("cylinder residuals: what a coarse encoder hides of the volume is in the floor of the pressures") {
  Rig rig = cylinder_rig();
  rig.sensors.position = {1e-9, 0};
  const Recording recording = simulated_recording(rig, 3.0, 3, all_pressures);
  const CylinderResiduals fine(rig, {recording});
  rig.sensors.position.quantum_m = 100e-6;
  const CylinderResiduals coarse(rig, {recording});
  const CylinderParameters<double>& cylinder = rig.axis.cylinder;
  const std::vector<double>& x = recording.column("x_m");
  for (const std::size_t side : {0, 1}) {
    const std::vector<double>& p = recording.column(side == 0 ? "p1_chamber_Pa" : "p2_chamber_Pa");
    const double area_m2 = side == 0 ? cylinder.area_1_m2 : cylinder.area_2_m2,
                 dead_m3 = side == 0 ? cylinder.dead_volume_1_m3 : cylinder.dead_volume_2_m3;
    double squares = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const double way_m = 0.5 * cylinder.stroke_m + (side == 0 ? x[k] : -x[k]);
      squares += std::pow(rig.axis.air.heat_capacity_ratio * p[k] * area_m2 * 100e-6 / std::sqrt(12.0) /
                              (dead_m3 + area_m2 * way_m),
                          2);
    }
    for (const std::size_t c : {side, side + 2}) {  // port and chamber
      CAPTURE(fine.channels()[c].name);
      const double more_Pa = std::sqrt(std::pow(coarse.channels()[c].floor, 2) - std::pow(fine.channels()[c].floor, 2));
      CHECK(more_Pa == Approx(std::sqrt(squares / static_cast<double>(x.size()))).epsilon(0.03));
    }
  }
}

TEST_CASE("cylinder residuals: a friction that is not there gains nothing from the noise at rest") {
  const Rig rig = cylinder_rig();
  CylinderResiduals model(rig, {simulated_recording(rig, 6.0, 9, all_pressures)});
  // So slow a Stribeck velocity that the friction acts at rest alone.
  const std::vector<Hypothesis> hypotheses{
      {rig, {}},
      with(rig, {{"effects.stribeck_friction.extra_force_N", 5.0}, {"effects.stribeck_friction.velocity_mps", 2e-4}})};
  const Eigen::MatrixXd columns = model.residuals(hypotheses);
  CHECK(columns.col(0).squaredNorm() - columns.col(1).squaredNorm() < 10.0);
}

TEST_CASE("cylinder residuals: with ports alone the force is balanced through the simulated chambers") {
  const Rig rig = cylinder_rig();
  CylinderResiduals model(rig, {simulated_recording(rig, 6.0, 2, {"p1_port_Pa", "p2_port_Pa"})});
  REQUIRE(model.channels().size() == 3);
  const auto rms = by_channel(model, model.residuals(std::vector<Hypothesis>{started(model, rig)}).col(0));
  CHECK(rms.at("F") < 1.2);
}

TEST_CASE("cylinder residuals: what the supply does as measured shows in no other channel") {
  const Rig owner = cylinder_rig();
  Rig machine = owner;
  machine.axis.effects.supply_swing = {20e3, 2.0, 0.3};
  const auto rms = [&](const std::vector<std::string>& channels) {
    CylinderResiduals model(owner, {simulated_recording(machine, 6.0, 4, channels)});
    return by_channel(model, model.residuals(std::vector<Hypothesis>{started(model, owner)}).col(0));
  };
  const auto measured = rms({"p1_port_Pa", "p2_port_Pa", "p_supply_Pa"}), hidden = rms({"p1_port_Pa", "p2_port_Pa"});
  for (const char* channel : {"p1_port", "p2_port"}) {
    CAPTURE(channel);
    CHECK(measured.at(channel) < 1.2);
    CHECK(hidden.at(channel) > 3.0);
  }
  CHECK(measured.at("p_supply") > 50.0);
}

TEST_CASE("cylinder residuals: the valves find what a faulty sensor of the supply reads less its fault") {
  const Rig owner = cylinder_rig();
  Rig machine = owner;
  machine.sensor_effects[Signal::p_supply].sensor_offset.offset = 15e3;
  CylinderResiduals model(owner, {simulated_recording(machine, 6.0, 5, {"p1_port_Pa", "p2_port_Pa", "p_supply_Pa"})});
  const auto rms = [&](const Rig& rig) {
    return by_channel(model, model.residuals(std::vector<Hypothesis>{started(model, rig)}).col(0));
  };
  const auto as_read = rms(owner), corrected = rms(machine);
  for (const char* channel : {"p1_port", "p2_port", "p_supply"}) {
    CAPTURE(channel);
    CHECK(as_read.at(channel) > 3.0);
    CHECK(corrected.at(channel) < 1.2);
  }
}

TEST_CASE("cylinder residuals: every effect shows in the channels that it moves and in none that are blind to it") {
  const Rig rig = cylinder_rig();
  CylinderResiduals model(rig, {simulated_recording(rig, 5.0, 3, all_of_the_gas)});
  struct Case {
    std::vector<std::pair<std::string, double>> values;
    std::set<std::string> moved, blind;
  };
  const std::set<std::string> gas{"p1_port", "p2_port", "p1_chamber", "p2_chamber"}, force{"F"};
  std::set<std::string> all = gas;
  all.insert({"F", "p_supply"});
  const auto motion = [&](std::vector<std::pair<std::string, double>> values) {
    return Case{
        std::move(values), force, {"p1_port", "p2_port", "p1_chamber", "p2_chamber", "p_supply", "supply_flow"}};
  };
  const auto valve = [&](std::vector<std::pair<std::string, double>> values) {
    return Case{std::move(values), gas, {"F", "p_supply"}};
  };
  const auto sensor = [&](const std::string& channel, std::set<std::string> moved, std::set<std::string> blind) {
    return std::vector<Case>{{{{"effects.sensor_offset:" + channel + ".offset", 3000.0}}, moved, blind},
                             {{{"effects.sensor_gain:" + channel + ".gain", 1.02}}, moved, blind},
                             {{{"effects.sensor_lag:" + channel + ".time_constant_s", 0.05}}, moved, blind}};
  };
  std::vector<Case> cases{
      motion({{"effects.coulomb_friction.force_N", 5}}),
      motion({{"effects.stribeck_friction.extra_force_N", 5}, {"effects.stribeck_friction.velocity_mps", 0.1}}),
      motion({{"effects.direction_dependent_friction.forward_N", 5}}),
      motion({{"effects.pressure_dependent_friction.force_per_pressure_N_per_Pa", 1e-5}}),
      motion({{"effects.friction_zone.force_N", 10}}),
      motion({{"effects.quadratic_drag.coefficient_Ns2_per_m2", 200}}),
      motion({{"effects.constant_force.force_N", 5}}),
      motion({{"effects.spring_load.stiffness_N_per_m", 100}}),
      motion({{"slider.mass_kg", 3}}),
      motion({{"slider.viscous_friction_Ns_per_m", 90}}),
      valve({{"effects.valve_dead_band.width_V", 0.05}}),
      valve({{"effects.valve_offset.offset_V", 0.02}}),
      valve({{"effects.valve_hysteresis.width_V", 0.05}}),
      valve({{"effects.valve_lag.time_constant_s", 0.01}}),
      valve({{"effects.valve_neutral_leak.area_m2", 5e-8}}),
      valve({{"effects.valve_asymmetry.exhaust_ratio", 0.8}}),
      valve({{"effects.command_delay.delay_s", 0.006}}),
      valve({{"effects.line_restriction_1.area_m2", 4e-6}, {"effects.line_restriction_2.area_m2", 4e-6}}),
      valve({{"effects.piston_leak.area_m2", 2e-8}}),
      {{{"effects.supply_droop.area_m2", 3e-6}}, {"p_supply"}, {"p1_port", "p2_port", "supply_flow", "F"}},
      {{{"effects.chamber_leak_1.area_m2", 2e-8}},
       {"p1_port", "p1_chamber", "supply_flow"},
       {"p2_port", "p2_chamber", "F"}},
      {{{"effects.chamber_leak_2.area_m2", 2e-8}},
       {"p2_port", "p2_chamber", "supply_flow"},
       {"p1_port", "p1_chamber", "F"}},
      {{{"effects.line_leak_1.area_m2", 2e-8}}, {"p1_port", "p1_chamber"}, {"p2_port", "p2_chamber", "F"}},
      {{{"effects.line_leak_2.area_m2", 2e-8}}, {"p2_port", "p2_chamber"}, {"p1_port", "p1_chamber", "F"}},
      {{{"effects.sensor_gain:x.gain", 1.1}}, all, {"p_supply"}}};
  cases.back().moved.erase("p_supply");
  const auto add = [&](std::vector<Case> more) { cases.insert(cases.end(), more.begin(), more.end()); };
  add(sensor("p1_chamber", {"p1_chamber", "F"}, {"p1_port", "p2_port", "p2_chamber"}));
  add(sensor("p2_chamber", {"p2_chamber", "F"}, {"p1_port", "p2_port", "p1_chamber"}));
  add(sensor("p1_port", {"p1_port"}, {"p2_port", "p2_chamber", "F"}));
  add(sensor("p2_port", {"p2_port"}, {"p1_port", "p1_chamber", "F"}));
  add({{{{"effects.sensor_offset:p_supply.offset", 3000.0}}, {"p_supply", "p1_port", "p2_port"}, {"F"}}});
  add({{{{"effects.sensor_offset:supply_flow.offset", 1e-5}}, {"supply_flow"}, {"p1_port", "p_supply", "F"}}});

  std::vector<Hypothesis> hypotheses{{rig, {}}};
  for (const Case& one : cases) {
    hypotheses.push_back({rig, {}});
    for (const auto& [path, value] : one.values) set_parameter(hypotheses.back().rig, path, value);
  }
  const Eigen::MatrixXd columns = model.residuals(hypotheses);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    CAPTURE(cases[i].values.front().first);
    const auto change = by_channel(model, columns.col(static_cast<Eigen::Index>(i + 1)) - columns.col(0));
    for (const std::string& channel : cases[i].moved) {
      CAPTURE(channel);
      CHECK(change.at(channel) > 0.3);
    }
    for (const std::string& channel : cases[i].blind) {
      CAPTURE(channel);
      CHECK(change.at(channel) < 1e-12);
    }
  }
}

TEST_CASE("cylinder residuals: a measured loss tells of the line and of its sensor, not of the end of its range") {
  Rig rig = cylinder_rig();
  rig.sensors.differential_pressure = {10.0, 100.0, 5e3};
  std::vector<std::string> channels = all_pressures;
  channels.insert(channels.end(), {"dp1_Pa", "dp2_Pa"});
  const Recording recording = simulated_recording(rig, 5.0, 5, channels);
  const CylinderRecording prepared = prepare_recording(recording, rig, 1e9);
  const std::vector<double>& kept = prepared.measured[Signal::dp1];
  CHECK(std::ranges::count_if(kept, [](double value) { return std::isnan(value); }) > 10);
  CHECK(std::ranges::count_if(kept, [](double value) { return std::fabs(value) < 5e3; }) > 2000);
  CHECK(std::ranges::none_of(kept, [](double value) { return std::fabs(value) >= 5e3; }));

  CylinderResiduals model(rig, {recording});
  const std::vector<Hypothesis> hypotheses{started(model, rig), with(rig, {{"line_1.diameter_m", 6.0e-3}}),
                                           with(rig, {{"effects.sensor_offset:dp2.offset", 2000.0}})};
  const Eigen::MatrixXd columns = model.residuals(hypotheses);
  const auto truth = by_channel(model, columns.col(0)), narrower = by_channel(model, columns.col(1) - columns.col(0)),
             offset = by_channel(model, columns.col(2) - columns.col(0));
  CHECK(truth.at("dp1") < 1.3);
  CHECK(truth.at("dp2") < 1.3);
  CHECK(narrower.at("dp1") > 0.3);
  CHECK(offset.at("dp2") > 1.0);
}

TEST_CASE("cylinder residuals: a column does not depend on what stands beside it, nor on threads") {
  const Rig rig = cylinder_rig(2.0, 7.65e-3);
  const Recording recording = simulated_recording(rig, 4.0, 4, all_pressures);
  const std::vector<Hypothesis> hypotheses{{rig, {}},
                                           with(rig, {{"effects.valve_lag.time_constant_s", 0.004}}),
                                           with(rig, {{"effects.command_delay.delay_s", 0.0004}}),
                                           with(rig, {{"effects.coulomb_friction.force_N", 4}}),
                                           with(rig, {{"line_1.diameter_m", 7.5e-3}}),
                                           with(rig, {{"effects.line_leak_2.area_m2", 5e-9}})};
  CylinderResiduals together(rig, {recording}, {2, 1e9}), alone(rig, {recording}, {1, 1e9});
  const Eigen::MatrixXd all = together.residuals(hypotheses);
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    CAPTURE(i);
    const Eigen::MatrixXd one = alone.residuals(std::span(hypotheses).subspan(i, 1));
    CHECK((all.col(static_cast<Eigen::Index>(i)) - one.col(0)).cwiseAbs().maxCoeff() == 0.0);
  }
}

TEST_CASE("cylinder residuals: the error of the work grid is taken out, also some way from the working point") {
  const Rig owner = cylinder_rig();
  Rig truth = owner;
  truth.axis.line_1.diameter_m *= 1.02;
  truth.axis.effects.valve.valve_lag.time_constant_s = 0.004;
  CylinderResiduals model(owner, {simulated_recording(truth, 5.0, 5, all_pressures)});
  const std::vector<Hypothesis> right{started(model, truth)};
  const Eigen::VectorXd far = model.residuals(right).col(0);
  model.set_working_point(right[0]);
  const Eigen::VectorXd near = model.residuals(right).col(0);
  const auto change = by_channel(model, far - near);
  for (const auto& [name, value] : change) {
    CAPTURE(name);
    CHECK(value < 1.0);  // floors
  }
  for (const auto& [name, value] : by_channel(model, near)) {
    CAPTURE(name);
    CHECK(value < 1.2);
  }
}

TEST_CASE("cylinder residuals: a delay below the period and one above it show in proportion") {
  const Rig rig = cylinder_rig();
  CylinderResiduals model(rig, {simulated_recording(rig, 5.0, 6, all_pressures)});
  std::vector<Hypothesis> hypotheses{{rig, {}}};
  for (const double delay : {0.3e-3, 0.6e-3, 1.2e-3, 2.4e-3})
    hypotheses.push_back(with(rig, {{"effects.command_delay.delay_s", delay}}));
  const Eigen::MatrixXd columns = model.residuals(hypotheses);
  // The chambers hardly see the command's noise from sample to sample, which has no proportion to a delay.
  const auto moved = [&](Eigen::Index i) {
    return by_channel(model, columns.col(i) - columns.col(0)).at("p1_chamber");
  };
  CHECK(moved(2) / moved(1) == Approx(2.0).epsilon(0.1));
  CHECK(moved(3) / moved(2) == Approx(2.0).epsilon(0.1));
  CHECK(moved(4) / moved(3) == Approx(2.0).epsilon(0.1));
}

TEST_CASE("cylinder residuals: on a short wide line the gas starts where it was, whatever noise the sensors have") {
  // A pressure imposed at the port would ring with the noise: 1.3 kPa in the chambers over these four recordings.
  const Rig rig = cylinder_rig(2.0, 7.65e-3);
  double squares = 0, count = 0;
  for (const std::uint64_t seed : {11, 12, 13, 14}) {
    CylinderResiduals model(rig, {simulated_recording(rig, 2.0, seed, all_pressures)});
    const std::vector<Hypothesis> neutral{{rig, {0.0, 0.0}}};
    const Eigen::VectorXd column = model.residuals(neutral).col(0);
    for (std::size_t i = 0; i < model.rows().size(); ++i) {
      const std::string& name = model.channels()[static_cast<std::size_t>(model.rows()[i].channel)].name;
      if (!name.ends_with("_chamber") || model.rows()[i].time_s > 0.8) continue;
      squares += std::pow(column(static_cast<Eigen::Index>(i)) * model.rows()[i].sigma, 2);
      count += 1;
    }
  }
  REQUIRE(count > 200);
  CHECK(std::sqrt(squares / count) < 450.0);
}

TEST_CASE("cylinder residuals: a wrong temperature at the start shows while the wall takes it out, and fades") {
  const Rig rig = cylinder_rig(2.0, 7.65e-3);
  CylinderResiduals model(rig, {simulated_recording(rig, 6.0, 7, all_pressures)});
  const std::vector<Hypothesis> hypotheses{{rig, {0.0, 0.0}}, {rig, {0.01, 0.0}}};
  const Eigen::MatrixXd columns = model.residuals(hypotheses);
  double first = 0, most = 0, last = 0;
  for (std::size_t i = 0; i < model.rows().size(); ++i) {
    const double change =
        model.rows()[i].sigma * (columns(static_cast<Eigen::Index>(i), 1) - columns(static_cast<Eigen::Index>(i), 0));
    if (model.channels()[static_cast<std::size_t>(model.rows()[i].channel)].name != "p1_chamber") continue;
    if (model.rows()[i].time_s < 0.36) first = std::max(first, std::abs(change));
    if (model.rows()[i].time_s < 1.5) most = std::max(most, -change);
    if (model.rows()[i].time_s > 5.5) last = std::max(last, std::abs(change));
  }
  CHECK(most > 2000.0);  // warmer by 1 % of 293 K at 470 kPa: so much less gas is there once it has cooled
  CHECK(first < 0.4 * most);
  CHECK(last < 0.3 * most);
}

TEST_CASE("cylinder residuals: lost rows and columns that are missing are left out") {
  const Rig rig = cylinder_rig();
  Recording recording = simulated_recording(rig, 5.0, 8, {"p1_port_Pa", "p2_port_Pa", "p1_chamber_Pa"});
  for (auto& column : recording.values) column.erase(column.begin() + 2000, column.begin() + 2005);
  recording.line_numbers.erase(recording.line_numbers.begin() + 2000, recording.line_numbers.begin() + 2005);
  CylinderResiduals model(rig, {recording});
  REQUIRE(model.channels().size() == 4);
  const auto rms = by_channel(model, model.residuals(std::vector<Hypothesis>{started(model, rig)}).col(0));
  for (const auto& [name, value] : rms) {
    CAPTURE(name);
    CHECK(value < 1.25);
  }
  for (const ResidualRow& row : model.rows()) CHECK_FALSE(std::abs(row.time_s - 2.002) < 0.002);
}

TEST_CASE("cylinder residuals: rows of a slow logger know of the commands that it left out") {
  const Rig rig = cylinder_rig();
  const Recording recording = simulated_recording(rig, 8.0, 5, all_pressures);
  Recording slow = recording;
  for (std::vector<double>& values : slow.values) {
    std::vector<double> kept;
    for (std::size_t row = 0; row < values.size(); row += 10) kept.push_back(values[row]);
    values.swap(kept);
  }
  slow.line_numbers.resize(slow.values.front().size());
  slow.period_s = 10 * recording.period_s;
  CylinderResiduals model(rig, {slow});
  const auto rms = by_channel(model, model.residuals(std::vector<Hypothesis>{started(model, rig)}).col(0));
  for (const auto& [name, value] : rms) {
    CAPTURE(name);
    CHECK(value < 1.2);
  }
  // The flow of a command that nobody wrote down stays in the gas: no sensor's noise, and more at the port than in F.
  const auto sigma_over_noise = [&](const std::string& name) {
    double most = 0;
    for (const ResidualRow& row : model.rows()) {
      const ResidualChannel& channel = model.channels()[static_cast<std::size_t>(row.channel)];
      if (channel.name == name && row.time_s > 2.0)
        most = std::max(most, row.sigma / std::hypot(channel.noise, channel.floor));
    }
    return most;
  };
  CHECK(sigma_over_noise("p1_port") > 2.0);
  CHECK(sigma_over_noise("F") < 0.5 * sigma_over_noise("p1_port"));
}
