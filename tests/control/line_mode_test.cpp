// The first mode of a shut line, and the force loop in which it does not show.
#include <catch2/catch.hpp>

#include <cmath>

#include <pneuservo/control/line_mode.hpp>
#include <pneuservo/control/pd_force.hpp>

#include "control/test_axis.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

constexpr double rest_1_Pa = 470e3, rest_2_Pa = 540e3;

PdForceParameters filtered_gains(ModalFilter filter) {
  PdForceParameters gains = nominal_gains();
  gains.modal_filter = filter;
  return gains;
}

ControlInput at_pressures(double chamber_1_Pa, double chamber_2_Pa, double port_1_Pa, double port_2_Pa) {
  return {.pressure_Pa = {chamber_1_Pa, chamber_2_Pa}, .port_Pa = {port_1_Pa, port_2_Pa}};
}

/// Change of the force in one period when both lines are thrown into their first mode, 1 kPa at the port [N].
double mode_force_N(ModalFilter filter) {
  const AxisParameters<double> axis = nominal_axis();
  const double gas = axis.air.gas_constant_J_per_kgK * axis.air.temperature_K, half_m = 0.5 * axis.cylinder.stroke_m;
  const auto mode_Pa = [&](const LineParameters<double>& line, double area_m2, double dead_m3) {
    return 1e3 * first_line_mode(line, dead_m3 + area_m2 * half_m, gas).chamber_over_port;
  };
  const auto& c = axis.cylinder;
  const double at_1_Pa = mode_Pa(axis.line_1, c.area_1_m2, c.dead_volume_1_m3),
               at_2_Pa = mode_Pa(axis.line_2, c.area_2_m2, c.dead_volume_2_m3);
  PdForce law(filtered_gains(filter), axis, 1e-3);
  law.step(at_pressures(rest_1_Pa, rest_2_Pa, rest_1_Pa, rest_2_Pa));
  const double before_N = law.state().F_N;
  law.step(at_pressures(rest_1_Pa + at_1_Pa, rest_2_Pa - at_2_Pa, rest_1_Pa + 1e3, rest_2_Pa - 1e3));
  return law.state().F_N - before_N;
}

}  // namespace

TEST_CASE("a shut line swings by half a wave without a chamber and by a quarter before a large one") {
  const LineParameters<double> line = nominal_axis().line_1;
  const double gas = 287.0 * 293.0, sound_mps = std::sqrt(gas);
  const LineMode alone = first_line_mode(line, 1e-12, gas), open = first_line_mode(line, 1e3, gas);
  CHECK(alone.frequency_Hz == Approx(0.5 * sound_mps / line.length_m));
  CHECK(alone.chamber_over_port == Approx(-1.0));
  CHECK(open.frequency_Hz == Approx(0.25 * sound_mps / line.length_m).epsilon(1e-5));
  CHECK(open.chamber_over_port == Approx(0.0).margin(1e-5));
}

TEST_CASE("with the modal filter the first mode of the lines does not show in the force") {
  const double seen_N = mode_force_N(ModalFilter::none), left_N = mode_force_N(ModalFilter::line);
  CHECK(std::fabs(seen_N) > 1.0);
  // What is left is the mean's first step.
  CHECK(std::fabs(left_N) < 0.02 * std::fabs(seen_N));
}

TEST_CASE("the loss of the reference's flow along the lines is not in the force from the first period of a motion on") {
  const FlowFeedforward feedforward(nominal_axis());
  PdForce law(filtered_gains(ModalFilter::line), nominal_axis(), 1e-3), chambers(nominal_gains(), nominal_axis(), 1e-3);
  ControlInput in = at_pressures(rest_1_Pa, rest_2_Pa, rest_1_Pa, rest_2_Pa);
  law.step(in), chambers.step(in);
  in.now.d[1] = 0.3;
  const auto loss_Pa = feedforward.line_loss_Pa(in.now, rest_1_Pa, rest_2_Pa);
  in.port_Pa = {rest_1_Pa + loss_Pa[0], rest_2_Pa + loss_Pa[1]};
  law.step(in), chambers.step(in);
  CHECK(law.state().line_loss_N > 5.0);
  CHECK(law.state().F_N == Approx(chambers.state().F_N).margin(1e-9));
}

TEST_CASE("a loss of pressure that the reference does not explain leaves the force in time") {
  PdForce law(filtered_gains(ModalFilter::line), nominal_axis(), 1e-3), chambers(nominal_gains(), nominal_axis(), 1e-3);
  const ControlInput rest = at_pressures(rest_1_Pa, rest_2_Pa, rest_1_Pa, rest_2_Pa),
                     flow = at_pressures(rest_1_Pa, rest_2_Pa, rest_1_Pa + 20e3, rest_2_Pa - 10e3);
  law.step(rest), chambers.step(rest);
  law.step(flow), chambers.step(flow);
  CHECK(law.state().F_N > chambers.state().F_N + 5.0);
  for (int k = 0; k < 6000; ++k) law.step(flow);
  CHECK(law.state().F_N == Approx(chambers.state().F_N).margin(1e-3));
}
