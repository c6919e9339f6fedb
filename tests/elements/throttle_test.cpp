// Throttles that look at the flow's direction and the piston's place, and a relief valve that looks at the pressure.
#include <catch2/catch.hpp>

#include <vector>

#include <pneuservo/elements/line.hpp>
#include <pneuservo/rig/plant.hpp>

#include "rig/held_piston.hpp"

using namespace pneuservo;

namespace {

constexpr double area_m2 = 4e-6;

/// Flow into the chamber, step by step, with the port 50 kPa above or below the chamber.
std::vector<double> flows(const LineEffects<double>& effects, double port_Pa, double distance_m = 0.1) {
  Line<double> line;
  LineParameters<double> parameters;
  parameters.length_m = 2.0;
  parameters.diameter_m = 6.1e-3;
  line.configure(parameters, {}, 10);
  line.set_effects(effects);
  line.set_time_step(0.4 * line.cell_length() / 343.0);
  line.reset(port_Pa, 293.0);  // from the first step on the gas flows one way
  line.set_piston_distance(distance_m);
  std::vector<double> out;
  for (int k = 0; k < 400; ++k) out.push_back(line.step_prescribed(port_Pa, {500e3, 293.0}).chamber_mass_flow_kgps);
  return out;
}

LineEffects<double> restricted() {
  LineEffects<double> effects;
  effects.restriction.area_m2 = area_m2;
  return effects;
}
LineEffects<double> controlled() {
  LineEffects<double> effects;
  effects.flow_control.area_m2 = area_m2;
  return effects;
}
LineEffects<double> cushioned() {
  LineEffects<double> effects;
  effects.end_cushion = {area_m2, 0.03};
  return effects;
}

}  // namespace

TEST_CASE("a flow control is a restriction for what leaves the chamber, and nothing for what enters") {
  const std::vector<double> out = flows(controlled(), 450e3);
  CHECK(out == flows(restricted(), 450e3));
  CHECK(out.back() > 0.8 * flows({}, 450e3).back());  // both are negative: less leaves
  CHECK(flows(controlled(), 550e3) == flows({}, 550e3));
}

TEST_CASE("a cushion is a flow control near its end, and nothing elsewhere") {
  CHECK(flows(cushioned(), 450e3, 0.02) == flows(controlled(), 450e3));
  CHECK(flows(cushioned(), 450e3, 0.04) == flows({}, 450e3));
  CHECK(flows(cushioned(), 550e3, 0.02) == flows({}, 550e3));
}

TEST_CASE("two fittings one after the other pass what one of 1/sqrt(1/a^2 + 1/b^2) does") {
  LineEffects<double> both = restricted();
  both.flow_control.area_m2 = 3e-6;
  LineEffects<double> one;
  one.restriction.area_m2 = 2.4e-6;  // 4 and 3 make 12/5
  CHECK(flows(both, 450e3).back() == Approx(flows(one, 450e3).back()).epsilon(1e-9));
}

TEST_CASE("a relief valve lets a chamber down to its opening pressure, and does nothing below") {
  const auto course = [](double opening_Pa) {
    AxisEffects<double> effects;
    effects.chamber_relief_1 = {opening_Pa < 1e7 ? 1e-11 : 0.0, opening_Pa};
    return test::held_pressures(effects, 600e3, 600e3, 60000);
  };
  CHECK(course(550e3).end()[-2] == Approx(550e3).epsilon(0.01));
  CHECK(course(550e3)[20] > 590e3);
  CHECK(course(700e3) == course(1e8));
}
