// Laws given by points: straight lines between them, and each table in its element is the law that it draws.
#include <catch2/catch.hpp>

#include <array>
#include <vector>

#include <pneuservo/core/pack.hpp>
#include <pneuservo/elements/slider.hpp>

#include "rig/held_piston.hpp"

using namespace pneuservo;

namespace {

constexpr std::array<double, 8> eighths(double from, double to) {
  std::array<double, 8> out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = from + (to - from) * static_cast<double>(i) / 7;
  return out;
}

/// Positions of a slider of 2 kg that a force drives to and fro for a second.
std::vector<double> slider_course(const MotionEffects<double>& effects) {
  Slider<double> slider;
  SliderParameters<double> parameters;
  parameters.mass_kg = 2.0;
  parameters.viscous_friction_Ns_per_m = 20.0;
  slider.configure(parameters, effects, 10.0, 0.0);
  slider.reset(0.0, 0.0);
  std::vector<double> out;
  for (int k = 0; k < 1000; ++k) {
    slider.step(1e-3, k < 400 ? 12.0 : -9.0, {});
    out.push_back(slider.position());
  }
  return out;
}

void check_same(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i] == Approx(b[i]).margin(1e-9));
}

std::vector<double> pressures_with(const AxisEffects<double>& effects) {
  return test::held_pressures(effects, 600e3, 500e3, 1000);
}

}  // namespace

TEST_CASE("a table is straight between its points and constant beyond them, in every lane") {
  PointTable<double> table;
  CHECK_FALSE(table.is_there());
  table.place = {-3, -2, 0, 1, 4, 5, 6, 8};
  table.value = {1, 3, -1, 0, 6, 6, 2, 4};
  CHECK(table.is_there());
  for (std::size_t i = 0; i < 8; ++i) CHECK(table.at(table.place[i]) == Approx(table.value[i]).margin(1e-12));
  CHECK(table.at(-1.5) == Approx(2.0));
  CHECK(table.at(2.5) == Approx(3.0));
  CHECK(table.at(-100) == Approx(1.0));
  CHECK(table.at(100) == Approx(4.0));
  using P = Pack<double, 4>;
  PointTable<P> lanes;
  for (std::size_t i = 0; i < 8; ++i) lanes.place[i] = P(table.place[i]), lanes.value[i] = P(table.value[i]);
  P x(0.0);
  const std::array<double, 4> at{-9.0, -1.5, 2.5, 7.0};
  for (int i = 0; i < 4; ++i) set_lane(x, i, at[static_cast<std::size_t>(i)]);
  for (int i = 0; i < 4; ++i) CHECK(lane(lanes.at(x), i) == table.at(at[static_cast<std::size_t>(i)]));
}

TEST_CASE("tables of the slider are the laws that they draw: a spring, dry friction, a load from an instant on") {
  MotionEffects<double> law, table;
  law.spring_load = {15.0, 0.2};
  table.force_over_position.place = eighths(-3, 3);
  for (std::size_t i = 0; i < 8; ++i)
    table.force_over_position.value[i] = 15.0 * (table.force_over_position.place[i] - 0.2);
  CHECK(slider_course(law) != slider_course({}));
  check_same(slider_course(table), slider_course(law));

  law = table = {};
  law.coulomb_friction.force_N = 3.0;
  table.friction_over_speed.place = eighths(0, 1);
  table.friction_over_speed.value.fill(3.0);
  check_same(slider_course(table), slider_course(law));
  // Beside a law it takes from it, and friction never drives.
  law.coulomb_friction.force_N = 1.0;
  table.coulomb_friction.force_N = 4.0;
  table.friction_over_speed.value.fill(-3.0);
  check_same(slider_course(table), slider_course(law));
  table.friction_over_speed.value.fill(-5.0);
  check_same(slider_course(table), slider_course({}));

  law = table = {};
  law.payload_change = {0.0, 6.0, 0.5};
  table.force_over_time.place = {0, 0.1, 0.2, 0.4999999, 0.5, 0.6, 0.8, 1.0};
  table.force_over_time.value = {0, 0, 0, 0, 6, 6, 6, 6};
  check_same(slider_course(table), slider_course(law));
}

TEST_CASE("a leak by a table is the leak that it draws") {
  AxisEffects<double> law, table;
  law.chamber_leak_2.area_m2 = 3e-8;
  table.leak_over_pressure_2.place = eighths(1e5, 8e5);
  table.leak_over_pressure_2.value.fill(3e-8);
  CHECK(pressures_with(law) != pressures_with({}));
  CHECK(pressures_with(table) == pressures_with(law));
  law = table = {};
  law.chamber_relief_1 = {2e-13, 550e3};
  table.leak_over_pressure_1.place = {1e5, 2e5, 3e5, 4e5, 5e5, 550e3, 650e3, 750e3};
  table.leak_over_pressure_1.value = {0, 0, 0, 0, 0, 0, 2e-8, 4e-8};
  const std::vector<double> a = pressures_with(table), b = pressures_with(law);
  CHECK(b != pressures_with({}));
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i] == Approx(b[i]).epsilon(1e-9));
}
