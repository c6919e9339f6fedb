// Derivatives by bumps are what whole changes of the rig do, and gas that is let in stays.
#include <catch2/catch.hpp>

#include <cmath>

#include "config/rig_parameters.hpp"
#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/gas_bumps.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

constexpr std::size_t bump_bin = 10;

/// Change of a pressure in each bin between two rigs.
Eigen::VectorXd change(const ImposedInputs& inputs, const Rig& from, const Rig& to, const PlantGrid& grid,
                       Signal signal) {
  const std::array<ImposedRun, 1> before{ImposedRun{&from, {}}}, after{ImposedRun{&to, {}}};
  const auto was = run_imposed(inputs, before, grid)[0][signal], is = run_imposed(inputs, after, grid)[0][signal];
  Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(was.size() / bump_bin));
  for (std::size_t k = 0; k / bump_bin < was.size() / bump_bin; ++k)
    out(static_cast<Eigen::Index>(k / bump_bin)) += (is[k] - was[k]) / static_cast<double>(bump_bin);
  return out;
}

double off(const Eigen::VectorXd& found, const Eigen::VectorXd& expected) {
  const Eigen::Index from = expected.size() / 3;  // the start is not disturbed by bumps
  return (found - expected).tail(expected.size() - from).norm() / expected.tail(expected.size() - from).norm();
}

}  // namespace

TEST_CASE("gas bumps: all together are a change of the rig") {
  const Rig rig = cylinder_rig(2.0, 6.1e-3);
  const bool measures_supply = GENERATE(false, true);
  std::vector<std::string> channels{"p1_port_Pa", "p2_port_Pa"};
  if (measures_supply) channels.emplace_back("p_supply_Pa");
  ImposedInputs inputs = prepare_recording(simulated_recording(rig, 4.0, 3, channels), rig, 1e9).inputs;
  inputs.wanted.assign(gas_signals.begin(), gas_signals.end());  // also what nothing measures
  const PlantGrid grid = grid_for(rig, 30, 1e-3);
  const auto gas = bump_responses(inputs, {&rig, {}}, grid, bumps_of(inputs, 0.1), bump_bin, 2);
  const auto sum = [&](GasInput input, Signal signal, double size) {
    return Eigen::VectorXd(size * gas[static_cast<std::size_t>(input)][signal].rowwise().sum());
  };
  if (measures_supply) {
    Rig reads_less = rig;  // then the valves find more than it says
    reads_less.sensor_effects[Signal::p_supply].sensor_offset.offset = -500;
    for (const Signal signal : {Signal::p1_port, Signal::p2_chamber})
      CHECK(off(sum(GasInput::supply_pressure, signal, 500), change(inputs, rig, reads_less, grid, signal)) < 0.1);
    CHECK(sum(GasInput::supply_pressure, Signal::p_supply, 500).norm() == 0.0);
    return;
  }
  SECTION("supply pressure") {
    Rig other = rig;
    other.axis.supply.pressure_Pa += 500;
    for (const Signal signal : {Signal::p1_port, Signal::p2_chamber, Signal::p_supply})
      CHECK(off(sum(GasInput::supply_pressure, signal, 500), change(inputs, rig, other, grid, signal)) < 0.1);
  }
  SECTION("shift of the spool") {
    Rig other = rig;
    other.axis.effects.valve.valve_offset.offset_V = 2e-3;
    const double area_m2 = 2e-3 * rig.axis.valve.area_per_volt_m2_per_V;
    CHECK(off(sum(GasInput::valve_area, Signal::p1_port, area_m2), change(inputs, rig, other, grid, Signal::p1_port)) <
          0.1);
    CHECK(off(sum(GasInput::valve_area, Signal::p2_port, -area_m2), change(inputs, rig, other, grid, Signal::p2_port)) <
          0.1);
  }
  SECTION("flow from the supply, of both sides together and of one") {
    Rig other = rig;
    other.axis.supply.pressure_Pa += 500;
    const BumpResponse& fed = gas[static_cast<std::size_t>(GasInput::supply_pressure)];
    const auto flow = [](const BumpResponse& response, std::size_t side, double size) {
      return Eigen::VectorXd(size * response.supply_flow_of_side[side].rowwise().sum());
    };
    CHECK(off(flow(fed, 0, 500) + flow(fed, 1, 500), change(inputs, rig, other, grid, Signal::supply_flow)) < 0.1);
    Rig leaking = rig;
    leaking.axis.effects.chamber_leak_1.area_m2 = 1e-9;
    const double leak_kgps = 1e-9 * 0.0404 * 4.7e5 / std::sqrt(293.0);  // sonic from 4.7 bar
    const BumpResponse& lost = gas[static_cast<std::size_t>(GasInput::chamber_flow)];
    CHECK(off(flow(lost, 0, -leak_kgps), change(inputs, rig, leaking, grid, Signal::supply_flow)) < 0.3);
    CHECK(flow(lost, 1, -leak_kgps).norm() > 0.0);
  }
  SECTION("late command") {
    Rig other = rig;
    other.axis.effects.valve.command_delay.delay_s = 1e-4;
    CHECK(off(sum(GasInput::command_time, Signal::p1_port, 1e-4), change(inputs, rig, other, grid, Signal::p1_port)) <
          0.1);
  }
}

TEST_CASE("gas bumps: what comes into a closed side at rest is there as pressure") {
  const Rig rig = cylinder_rig(2.0, 6.1e-3);
  ImposedInputs inputs;
  const std::size_t samples = 4000;
  inputs.command_V[0].assign(samples, 0.0);
  inputs.position_m.assign(samples, 0.0);
  inputs.velocity_mps.assign(samples, 0.0);
  for (auto& p : inputs.start_Pa) p.assign(samples, 4e5);
  for (auto& p : inputs.start_Pa_per_s) p.assign(samples, 0.0);
  inputs.release = 300;
  const PlantGrid grid = grid_for(rig, 30, 1e-3);
  const auto gas = bump_responses(inputs, {&rig, {}}, grid, bumps_of(inputs, 0.1), bump_bin, 2);
  const AxisParameters<double>& axis = rig.axis;
  const double line_m3 = axis.line_1.section_m2() * axis.line_1.length_m,
               chamber_m3 = axis.cylinder.dead_volume_1_m3 + 0.5 * axis.cylinder.stroke_m * axis.cylinder.area_1_m2,
               volume_m3 = line_m3 + chamber_m3;
  const double expected = 0.1 * axis.air.gas_constant_J_per_kgK * axis.air.temperature_K / volume_m3;  // a unit, 0.1 s
  for (const GasInput input : {GasInput::line_flow, GasInput::chamber_flow})
    for (const Signal signal : {Signal::p1_port, Signal::p1_chamber})
      CHECK(gas[static_cast<std::size_t>(input)][signal](399, 0) == Approx(expected).epsilon(0.02));
  CHECK(gas[0][Signal::p1_port].topLeftCorner(30, 5).cwiseAbs().maxCoeff() == 0);  // nothing before it acts

  // A lost pressure that stays parts the gas anew, and makes none.
  const BumpResponse& lost = gas[static_cast<std::size_t>(GasInput::end_loss)];
  const double line = lost[Signal::p1_port].row(399).sum(), chamber = lost[Signal::p1_chamber].row(399).sum();
  CHECK(line - chamber == Approx(1.0).epsilon(0.02));
  CHECK(line * line_m3 == Approx(-chamber * chamber_m3).epsilon(0.02));
}
