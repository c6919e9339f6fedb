// The design of a config: golden numbers of the servo table, the cylinder's model against distributed lines, the rules.
#include <catch2/catch.hpp>

#include <numbers>

#include "config/dump_rig.hpp"
#include "config/read_rig.hpp"
#include "design/axis_design.hpp"
#include "design/gain_rules.hpp"
#include "report/design_json.hpp"
#include "report/design_report.hpp"
#include "report/design_summary.hpp"

using namespace pneuservo;
using Complex = std::complex<double>;

namespace {

const std::string source = PNEUSERVO_SOURCE_DIR;

Rig table_rig(const std::vector<std::string>& overrides = {}) {
  return parse_rig(R"(format: pneuservo-rig/1
name: table
rig: servo_table
period_s: 0.0002
supply: {pressure_Pa: 251300}
valve: {command_max_V: 1.6, area_per_volt_m2_per_V: 3.1226e-6, area_max_m2: 5.0e-6, critical_pressure_ratio: 0.4,
        natural_frequency_Hz: 100, damping_ratio: 0.7}
line_1: {length_m: 0.5, diameter_m: 0.004, natural_frequency_Hz: 110, damping_ratio: 0.068}
line_2: {length_m: 0.5, diameter_m: 0.004, natural_frequency_Hz: 110, damping_ratio: 0.068}
cylinder: {stroke_m: 0.140, area_1_m2: 1.2e-3, area_2_m2: 1.2e-3, dead_volume_1_m3: 1.08e-4,
           dead_volume_2_m3: 1.08e-4, wall_heat_W_per_m2K: 50.0}
slider: {mass_kg: 26.0, viscous_friction_Ns_per_m: 0.0}
sensors: {position: {quantum_m: 62.5e-12}, port_pressure: {quantum_Pa: 100.0}}
controller: {kind: ppd2, position_gain_V_per_m: 1200, velocity_gain_Vs_per_m: 54.0,
             acceleration_gain_Vs2_per_m: 1.3, observer: error, observer_rad_per_s: 1000}
reference: {kind: cruise, start_m: -0.05, end_m: 0.05, speed_mps: 0.0597, ramp_s: 0.156, start_s: 0.2, smoothness: 9}
duration_s: 3.0
)",
                   "table.yaml", overrides);
}

Rig cylinder_rig(const std::string& lines, const std::vector<std::string>& overrides = {}) {
  return read_rig(source + "/config/cylinder-" + lines + ".yaml", overrides);
}

AxisDesign designed(const Rig& rig, DesignMethod method = DesignMethod::config) {
  DesignRequest request;
  request.method = method;
  request.needs_mean_pressure = false;
  return design_axis(rig, request);
}

Complex at_Hz(double f) { return {0.0, 2.0 * std::numbers::pi * f}; }

}  // namespace

TEST_CASE("the design of the servo table is the golden one") {
  const AxisDesign design = designed(table_rig());
  CHECK(design.linear.axis.gain_per_V == Approx(45.580).epsilon(2e-4));
  CHECK(std::sqrt(design.linear.axis.natural_frequency_squared()) == Approx(7.9663).epsilon(1e-5));
  CHECK(design.linear.discharge_ratio == Approx(0.21693).epsilon(3e-5));
  CHECK(design.linear.speed_per_area_per_ms == Approx(2.30011e5).epsilon(3e-6));
  REQUIRE(design.models.size() == 3);
  CHECK(design.models[2].feedforward[6] == Approx(9.69482e-17).epsilon(1e-4));
  CHECK(design.matched.natural_frequency_rad_per_s == Approx(444.34).margin(0.005));
  CHECK(design.matched.damping_ratio == Approx(0.53875).margin(5e-6));
  CHECK(design.margins.gain_up == Approx(3.897).epsilon(1e-3));
  CHECK(design.margins.gain_down == Approx(0.375).margin(6e-4));
  CHECK(design.margins.phase_deg == Approx(36.0).margin(0.06));
  CHECK(design.step.overshoot == Approx(0.124).margin(6e-4));
  CHECK(design.command_noise_V == Approx(6.1e-6).epsilon(0.01));  // the scale's quantum alone
  REQUIRE(design.spool);
  CHECK(design.spool->K1_V_per_m == Approx(1692.03).epsilon(1e-5));
  CHECK(design.is_stable);
  CHECK(design.warnings.empty());
}

TEST_CASE("noise of the scale by observer frequency") {
  for (const auto& [w, volts] : {std::pair{"400", 7.2e-7}, {"1000", 6.1e-6}, {"2000", 3.1e-5}})
    CHECK(designed(table_rig({std::string("controller.observer_rad_per_s=") + w})).command_noise_V ==
          Approx(volts).epsilon(0.02));
}

TEST_CASE("a line without a stated lag gets its resonance from the exact theory") {
  const std::vector<std::string> unstated{"line_1.natural_frequency_Hz=0", "line_2.natural_frequency_Hz=0"};
  const AxisDesign design = designed(table_rig(unstated));
  CHECK(design.linear.sides[0].source == LagSource::resonance);
  CHECK(design.linear.sides[0].lag.natural_frequency_rad_per_s / (2.0 * std::numbers::pi) == Approx(163.5).margin(0.5));
  CHECK(design.linear.axis.order() == 7);
  // A line that friction damps away: matched at low frequency.
  auto thin = unstated;
  for (const char* key :
       {"line_1.diameter_m=0.0006", "line_2.diameter_m=0.0006", "line_1.length_m=2", "line_2.length_m=2"})
    thin.emplace_back(key);
  const AxisDesign damped = designed(table_rig(thin));
  CHECK(damped.linear.sides[0].source == LagSource::low_frequency);
  CHECK(damped.linear.sides[0].lag.damping_ratio > 0.7);
}

TEST_CASE("with short lines the exact response is the linear model's") {
  // Lines of 10 mm: what is left is chamber, slider and valve.
  const Rig rig = table_rig({"line_1.length_m=0.01", "line_2.length_m=0.01", "line_1.diameter_m=0.004",
                             "line_1.natural_frequency_Hz=0", "line_2.natural_frequency_Hz=0"});
  const AxisDesign design = designed(rig);
  const LinearAxis& axis = design.linear.axis;
  for (const double f : {0.3, 3.0, 30.0}) {
    const Complex s = at_Hz(f);
    const Complex linear = axis.gain_per_V * value_at(axis.numerator(), s) / value_at(axis.open_loop(), s);
    CHECK(std::abs(exact_response(design.linear, s).position_m / linear - 1.0) < 2e-3);
  }
}

TEST_CASE("the cylinder's model of seventh order has the margins of distributed lines") {
  for (const char* lines : {"2m-7.65mm", "5m-7.65mm", "10m-7.65mm", "10m-6.10mm"}) {
    INFO(lines);
    const AxisDesign design = designed(cylinder_rig(lines));
    CHECK(design.linear.axis.order() == 7);
    CHECK(design.is_stable);
    CHECK(design.margins.gain_up == Approx(design.exact_margins.gain_up).epsilon(0.15));
    const LinearAxis& axis = design.linear.axis;
    const Complex s = at_Hz(0.02);  // line friction and heat have no part yet
    const Complex linear = axis.gain_per_V / value_at(axis.open_loop(), s);
    CHECK(std::abs(exact_response(design.linear, s).position_m / linear - 1.0) < 0.02);
    // The chambers push the slider: F = m x'' + B x'.
    const AxisResponse exact = exact_response(design.linear, at_Hz(4.0));
    const Complex w = at_Hz(4.0);
    CHECK(std::abs(exact.chamber_force_N / ((2.0 * w * w + 60.0 * w) * exact.position_m) - 1.0) < 1e-9);
  }
}

TEST_CASE("port pressures see the line's loss: other margins than the chambers'") {
  const AxisDesign chamber = designed(cylinder_rig("10m-7.65mm", {"controller.pressure_source=chamber"})),
                   port = designed(cylinder_rig("10m-7.65mm", {"controller.pressure_source=valve"}));
  CHECK(chamber.exact_margins.gain_up != Approx(port.exact_margins.gain_up).epsilon(0.05));
}

TEST_CASE("rules set the gains that they promise, on both rigs") {
  DesignRequest request;
  request.method = DesignMethod::alpha_beta;
  request.needs_mean_pressure = false;
  request.position_gain_V_per_m = 1500.0;
  const AxisDesign table = design_axis(table_rig(), request);
  CHECK(table.controller.of<Ppd2>().velocity_gain_Vs_per_m == Approx(71.97).margin(0.02));
  CHECK(table.controller.of<Ppd2>().acceleration_gain_Vs2_per_m == Approx(1.794).margin(0.001));
  CHECK(table.gains_before.position_V_per_m == 1200.0);

  request.position_gain_V_per_m = 120.0;
  const AxisDesign cylinder = design_axis(cylinder_rig("2m-7.65mm"), request);
  const Polynomial loop = closed_loop(without_lags(cylinder.linear.axis), cylinder.gains);
  const double w = std::cbrt(loop[0]);
  CHECK(loop[2] == Approx(2.0 * w));
  CHECK(loop[1] == Approx(2.0 * w * w));
  const PdForceParameters& p = cylinder.controller.of<PdForce>();
  CHECK(p.force_gain_V_per_N * p.position_gain_N_per_m == Approx(120.0));
  CHECK(p.force_gain_V_per_N * 2.0 == Approx(cylinder.gains.acceleration_Vs2_per_m));

  request.method = DesignMethod::itae_min;
  request.position_gain_V_per_m.reset();
  const AxisDesign least = design_axis(table_rig(), request);
  CHECK(least.gains.velocity_Vs_per_m == Approx(66.57).epsilon(1.5e-3));
  CHECK(least.models.back().itae_s2 < table.models.back().itae_s2 * 1.5);
  CHECK(least.models.back().itae_s2 < designed(table_rig()).models.back().itae_s2);
}

TEST_CASE("thin margins are warned of, instability is told") {
  const AxisDesign printed =
      designed(table_rig({"controller.observer=measured", "controller.observer_gains=[530.5, 140739.9, 1.85e7]"}));
  CHECK(printed.is_stable);
  CHECK(printed.margins.gain_up == Approx(1.49).margin(0.006));
  REQUIRE(printed.warnings.size() >= 2);
  CHECK_THAT(printed.warnings[0], Catch::Contains("less than 2"));
  const AxisDesign unstable = designed(table_rig({"controller.position_gain_V_per_m=6000"}));
  CHECK_FALSE(unstable.is_stable);
  CHECK_THAT(unstable.warnings[0], Catch::Contains("unstable"));
  CHECK_THAT(designed(table_rig({"valve.natural_frequency_Hz=20"})).warnings.back(), Catch::Contains("50 to 300 Hz"));
}

TEST_CASE("a delayed command costs phase") {
  const AxisDesign prompt = designed(table_rig()), late = designed(table_rig({"controller.command_delay_s=0.0003"}));
  const double lost = prompt.margins.phase_deg - late.margins.phase_deg;
  CHECK(lost == Approx(360.0 * prompt.margins.phase_Hz * 0.0003).epsilon(0.05));
}

TEST_CASE("the mean pressure that the printed move needs") {
  const AxisDesign design = design_axis(table_rig(), {});
  REQUIRE(design.mean_pressure_needed_Pa);
  // 120 kPa works with 1.44 V of 1.6 V, 110 kPa does not.
  CHECK(*design.mean_pressure_needed_Pa > 112e3);
  CHECK(*design.mean_pressure_needed_Pa <= 120e3);
  const AxisDesign starved = design_axis(table_rig({"controller.mean_pressure_Pa=110000"}), {});
  REQUIRE_FALSE(starved.warnings.empty());
  CHECK_THAT(starved.warnings.back(), Catch::Contains("does not suffice"));
}

TEST_CASE("requests that do not fit are one sentence") {
  DesignRequest request;
  request.method = DesignMethod::alpha_beta;
  request.needs_mean_pressure = false;
  CHECK_THROWS_WITH(design_axis(table_rig({"controller.position_gain_V_per_m=0"}), request),
                    Catch::Contains("position_gain_V_per_m"));
  request.position_gain_V_per_m = 0.01;  // slower than the air spring: the rule asks for a negative velocity gain
  CHECK_THROWS_WITH(design_axis(table_rig(), request), Catch::Contains("velocity_gain_Vs_per_m"));
}

TEST_CASE("text, JSON and page say the same") {
  const Rig rig = table_rig();
  const AxisDesign design = designed(rig);
  const std::string text = design_text(rig, design, false);
  CHECK_THAT(text, Catch::Contains("-17.5 ± 41.4j"));
  CHECK_THAT(text, Catch::Contains("1692.02"));
  const auto json = design_json(rig, design, false);
  CHECK(json["margins"]["gain_up"].get<double>() == design.margins.gain_up);
  CHECK(json["models"].size() == 3);
  CHECK(json["models"][2]["feedforward_c"].size() == 7);
  const std::string page = design_report_html(rig, design, dump_rig(rig));
  for (const char* part : {"Pole loci", "Bode diagrams", "<svg class='poles'", "plot-data", "Config as designed"})
    CHECK_THAT(page, Catch::Contains(part));
}

TEST_CASE("a rule that fails says which way the position gain has to go, or what stands in the way") {
  DesignRequest request;
  request.needs_mean_pressure = false;
  request.method = DesignMethod::alpha_beta;
  request.position_gain_V_per_m = 1e-3;
  CHECK_THROWS_WITH(design_axis(table_rig(), request), Catch::Contains("up: the loop is stable from"));
  request.position_gain_V_per_m = 1e5;
  const AxisDesign high = design_axis(table_rig(), request);
  REQUIRE_FALSE(high.is_stable);
  CHECK_THAT(high.warnings.front(), Catch::Contains("position gain down: the loop is stable from"));
  request.position_gain_V_per_m = 35.0;  // the lines' lag, which the third order does not know
  CHECK_THROWS_WITH(design_axis(cylinder_rig("10m-7.65mm"), request), Catch::Contains("the lag of the lines at"));
}

TEST_CASE("a point of the loop is the design's own") {
  const Rig rig = cylinder_rig("10m-7.65mm");
  const AxisDesign design = designed(rig);
  const LoopPoint point = loop_point(rig, true);
  CHECK(point.is_stable);
  CHECK(point.margins.gain_up == design.margins.gain_up);
  Rig higher = rig;
  higher.controller.of<PdForce>().force_gain_V_per_N *= 1.02 * point.margins.gain_up;
  CHECK_FALSE(loop_point(higher, false).is_stable);
  CHECK(loop_point(higher, false).weakest_Hz == Approx(point.margins.gain_up_Hz).epsilon(0.05));
  higher.controller.of<PdForce>().force_gain_V_per_N /= 1.04;
  CHECK(loop_point(higher, false).is_stable);
}
