// Lanes: what a lane of a pack computes is what the scalar program computes, bit for bit; derivatives and float follow
// it.
#include <catch2/catch.hpp>

#include <bit>
#include <cstdint>
#include <random>
#include <vector>

#include <pneuservo/core/dual.hpp>
#include <pneuservo/core/random.hpp>
#include <pneuservo/rig/plant.hpp>

#include "core/test_seed.hpp"

using namespace pneuservo;

namespace {
bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

LineParameters<double> random_line(Random& random) {
  LineParameters<double> line;
  line.length_m = random.uniform(6.0, 14.0);
  line.diameter_m = random.uniform(0.004, 0.009);
  line.laminar_reynolds = random.uniform(1500.0, 2500.0);
  line.turbulent_reynolds = line.laminar_reynolds + (random.uniform() < 0.3 ? 0.0 : random.uniform(500.0, 2500.0));
  return line;
}

AirParameters<double> random_air(Random& random) {
  AirParameters<double> air;
  air.temperature_K = random.uniform(280.0, 310.0);
  air.heat_capacity_ratio = random.uniform(1.35, 1.42);
  air.viscosity_Pas = random.uniform(1.6e-5, 2.0e-5);
  return air;
}

AxisParameters<double> random_axis(Random& random) {
  AxisParameters<double> axis;
  axis.air = random_air(random);
  axis.supply.pressure_Pa = random.uniform(6e5, 8e5);
  axis.valve.command_max_V = 5.0;
  axis.valve.area_per_volt_m2_per_V = random.uniform(1e-6, 3e-6);
  axis.valve.area_max_m2 = 5.0 * axis.valve.area_per_volt_m2_per_V;
  axis.valve.critical_pressure_ratio = random.uniform(0.25, 0.5);
  axis.valve.natural_frequency_Hz = random.uniform() < 0.5 ? 0.0 : random.uniform(60.0, 120.0);
  axis.line_1 = random_line(random);
  axis.line_2 = random_line(random);
  axis.line_1.length_m = axis.line_2.length_m = 9.0;  // one cell count for all lanes
  axis.cylinder.stroke_m = 0.3;
  axis.cylinder.area_1_m2 = random.uniform(1.1e-3, 1.4e-3);
  axis.cylinder.area_2_m2 = random.uniform(0.9e-3, 1.1e-3);
  axis.cylinder.dead_volume_1_m3 = axis.cylinder.dead_volume_2_m3 = random.uniform(3e-5, 6e-5);
  axis.cylinder.wall_heat_W_per_m2K = random.uniform(20.0, 80.0);
  axis.slider.mass_kg = random.uniform(1.0, 4.0);
  axis.slider.viscous_friction_Ns_per_m = random.uniform(30.0, 100.0);
  AxisEffects<double>& e = axis.effects;
  const auto sometimes = [&](double value) { return random.uniform() < 0.4 ? value * random.uniform(0.5, 1.5) : 0.0; };
  e.motion.coulomb_friction.force_N = sometimes(10.0);
  e.motion.stribeck_friction.extra_force_N = sometimes(8.0);
  e.valve.valve_neutral_leak.area_m2 = sometimes(5e-8);
  e.valve.valve_offset.offset_V = sometimes(0.05);
  e.line_restriction_1.area_m2 = sometimes(2e-5);
  e.line_leak_2.area_m2 = sometimes(1e-7);
  e.line_branch_1.volume_m3 = sometimes(2e-4);
  e.line_branch_2.volume_m3 = sometimes(1e-5);
  e.chamber_leak_1.area_m2 = sometimes(1e-7);
  e.piston_leak.area_m2 = sometimes(1e-7);
  e.piston_leak_zone = {sometimes(1e-7), 0.02, 0.03};
  e.valve.valve_curve = {sometimes(0.2), sometimes(-0.3)};
  for (auto* linearity : {&e.valve.valve_linearity_forward, &e.valve.valve_linearity_backward})
    *linearity = {sometimes(0.1), sometimes(-0.1), sometimes(0.2), sometimes(-0.2), sometimes(0.1), sometimes(-0.1)};
  e.valve.valve_edge_slopes = {sometimes(0.1), sometimes(-0.1), sometimes(0.2), sometimes(-0.2)};
  e.valve.valve_edge_overlaps = {sometimes(0.1), sometimes(-0.1), sometimes(0.2), sometimes(-0.2)};
  e.supply_droop.area_m2 = sometimes(3e-5);
  e.supply_swing = {sometimes(2e4), 3.0, 0.5};
  e.motion.elastic_load = {sometimes(0.4), 12.0, 0.05};
  e.motion.load_backlash = {sometimes(0.4), 5e-4, 60.0, 0.2};
  e.motion.periodic_force = {sometimes(3.0), 8.0, 0.2};
  for (std::size_t i = 0; i < PointTable<double>::points; ++i) {
    const auto place = static_cast<double>(i);
    e.motion.force_over_position.place[i] = 0.02 * place;
    e.motion.force_over_position.value[i] = sometimes(3.0);
    e.leak_over_pressure_1.place[i] = 1e5 * (1.0 + place);
    e.leak_over_pressure_1.value[i] = sometimes(3e-8);
  }
  e.frequency_dependent_losses.share = sometimes(1.0);
  return axis;
}

template <class P> P random_lanes(Random& random, double low, double high) {
  P out;
  for (int i = 0; i < ScalarTraits<P>::lanes; ++i) set_lane(out, i, random.uniform(low, high));
  return out;
}
}  // namespace

TEMPLATE_TEST_CASE("a line in a lane is the scalar line, guards included", "", (Pack<double, 2>), (Pack<double, 4>),
                   (Pack<double, 8>)) {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  Random random(seed);
  constexpr int lanes = ScalarTraits<TestType>::lanes;
  std::int64_t guards = 0;
  for (const int cells : {1, 2, 3, 4, 5, 10, 13}) {
    LineParameters<TestType> line;
    AirParameters<TestType> air;
    LineEffects<TestType> effects;
    Line<TestType> packed;
    std::vector<Line<double>> scalar(lanes);
    for (int i = 0; i < lanes; ++i) {
      const auto one = random_line(random);
      const auto gas = random_air(random);
      set_parameters_lane(line, i, one);
      set_parameters_lane(air, i, gas);
      scalar[static_cast<std::size_t>(i)].configure(one, gas, cells);
      LineEffects<double> own;
      own.frequency_dependent_losses.share = random.uniform() < 0.5 ? 0.0 : random.uniform(0.5, 1.5);
      scalar[static_cast<std::size_t>(i)].set_effects(own);
      set_lane(effects.frequency_dependent_losses.share, i, own.frequency_dependent_losses.share);
    }
    packed.configure(line, air, cells);
    packed.set_effects(effects);
    const double step_s = 0.4e-3 * 6.0 / cells;  // near the Courant limit, so that jumps set off the guards
    packed.set_time_step(step_s);
    for (auto& s : scalar) s.set_time_step(step_s);
    ChamberEnd<TestType> chamber{TestType(4e5), TestType(293.0)};
    TestType port(4e5);
    int different = 0;
    for (int k = 0; k < 400; ++k) {
      if (k % 20 == 0) port = random_lanes<TestType>(random, 0.5e5, 12e5);
      if (k % 30 == 0)
        chamber = {random_lanes<TestType>(random, 1e5, 8e5), random_lanes<TestType>(random, 240.0, 380.0)};
      if (k == 380) {  // for the guards of those whose own jumps were small
        port = TestType(0.2e5);
        chamber.pressure_Pa = TestType(40e5);
      }
      const auto flow = packed.step_prescribed(port, chamber);
      for (int i = 0; i < lanes; ++i) {
        auto& s = scalar[static_cast<std::size_t>(i)];
        const auto one = s.step_prescribed(port[i], {chamber.pressure_Pa[i], chamber.temperature_K[i]});
        different += !same_bits(one.port_mass_flow_kgps, flow.port_mass_flow_kgps[i]) ||
                     !same_bits(one.chamber_mass_flow_kgps, flow.chamber_mass_flow_kgps[i]) ||
                     !same_bits(one.chamber_enthalpy_flow_W, flow.chamber_enthalpy_flow_W[i]);
        for (int c = 0; c < cells; ++c)
          different += !same_bits(s.cell_pressure(c), packed.cell_pressure(c)[i]) ||
                       !same_bits(s.cell_density(c), packed.cell_density(c)[i]) ||
                       !same_bits(s.cell_temperature(c), packed.cell_temperature(c)[i]);
        for (int f = 0; f <= cells; ++f) different += !same_bits(s.face_velocity(f), packed.face_velocity(f)[i]);
      }
      double fastest = 0.0;
      for (const auto& s : scalar) fastest = std::max(fastest, s.largest_speed());
      different += !same_bits(fastest, packed.largest_speed());
    }
    CAPTURE(cells);
    CHECK(different == 0);
    std::int64_t scalar_guards = 0;
    for (const auto& s : scalar) scalar_guards += s.guard_actions();
    CHECK(packed.guard_actions() == scalar_guards);
    guards += scalar_guards;
  }
  CHECK(guards > 0);  // the rare path was taken
}

TEMPLATE_TEST_CASE("a chamber in a lane is the scalar chamber", "", (Pack<double, 2>), (Pack<double, 4>),
                   (Pack<double, 8>)) {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  Random random(seed);
  constexpr int lanes = ScalarTraits<TestType>::lanes;
  const ChamberGeometry<TestType> geometry{random_lanes<TestType>(random, 5e-4, 2e-3),
                                           random_lanes<TestType>(random, 1e-5, 5e-5),
                                           random_lanes<TestType>(random, 0.0, 100.0)};
  Chamber<TestType> packed;
  packed.configure(geometry, Air<TestType>{});
  packed.reset(TestType(4e5), TestType(293.0), TestType(0.1));
  std::vector<Chamber<double>> scalar(lanes);
  for (int i = 0; i < lanes; ++i) {
    scalar[static_cast<std::size_t>(i)].configure(
        {geometry.area_m2[i], geometry.dead_volume_m3[i], geometry.wall_heat_W_per_m2K[i]}, Air<double>{});
    scalar[static_cast<std::size_t>(i)].reset(4e5, 293.0, 0.1);
  }
  int different = 0;
  for (int k = 0; k < 2000; ++k) {
    const ChamberInflow<TestType> inflow{random_lanes<TestType>(random, -5e-3, 5e-3),
                                         random_lanes<TestType>(random, -1500.0, 1500.0)};
    const TestType s = random_lanes<TestType>(random, 0.09, 0.11);
    packed.step(1e-3, inflow, s);
    for (int i = 0; i < lanes; ++i) {
      auto& one = scalar[static_cast<std::size_t>(i)];
      one.step(1e-3, {inflow.mass_flow_kgps[i], inflow.enthalpy_flow_W[i]}, s[i]);
      different += !same_bits(one.pressure(), packed.pressure()[i]) ||
                   !same_bits(one.temperature(), packed.temperature()[i]) || !same_bits(one.mass(), packed.mass()[i]);
    }
  }
  CHECK(different == 0);
}

TEMPLATE_TEST_CASE("an axis in a lane is the scalar axis, whatever its neighbours do", "", (Pack<double, 2>),
                   (Pack<double, 4>), (Pack<double, 8>)) {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  Random random(seed);
  constexpr int lanes = ScalarTraits<TestType>::lanes;
  constexpr PlantGrid grid{9, 2};  // else the sub-steps are those of the lane with the fastest flow
  for (int round = 0; round < 4; ++round) {
    AxisParameters<TestType> axes;
    std::vector<AxisPlant<double>> scalar(lanes);
    PlantStart<TestType> start{TestType(0.0), TestType(4.7e5), TestType(0.0)};
    for (int i = 0; i < lanes; ++i) {
      const auto one = random_axis(random);
      set_parameters_lane(axes, i, one);
      set_lane(start.pressure_2_Pa, i, balancing_pressure_2(one, 4.7e5));
      scalar[static_cast<std::size_t>(i)].configure(one, 1e-3, grid);
      scalar[static_cast<std::size_t>(i)].reset({0.0, 4.7e5, balancing_pressure_2(one, 4.7e5)});
    }
    AxisPlant<TestType> packed;
    packed.configure(axes, 1e-3, grid);
    packed.reset(start);
    TestType command(0.0);
    int different = 0;
    for (int k = 0; k < 1500; ++k) {
      if (k % 40 == 0) command = random.uniform() < 0.2 ? TestType(0.0) : random_lanes<TestType>(random, -4.0, 4.0);
      packed.step(command);
      for (int i = 0; i < lanes; ++i) {
        auto& one = scalar[static_cast<std::size_t>(i)];
        one.step(command[i]);
        different +=
            !same_bits(one.position(), packed.position()[i]) || !same_bits(one.velocity(), packed.velocity()[i]);
        for (int side = 0; side < 2; ++side) {
          const auto of_side = [&](const auto& pair) { return side == 0 ? low(pair) : high(pair); };
          different += !same_bits(of_side(one.chamber_pressure()), of_side(packed.chamber_pressure())[i]) ||
                       !same_bits(of_side(one.port_pressure()), of_side(packed.port_pressure())[i]);
        }
      }
    }
    CHECK(different == 0);
  }
}

namespace {
// Chamber pressure after a port pressure swing, of a line with its chamber.
template <class S> S pressure_after_swing(const LineParameters<S>& line, const S& dead_volume_m3) {
  LineWithChamber<S> side;
  side.configure(line, {S(1.257e-3), dead_volume_m3, S(50.0)}, AirParameters<S>{}, 10);
  side.reset(S(4.7e5), S(293.0), S(0.15));
  for (int k = 0; k < 300; ++k) {
    REQUIRE(side.begin_period(1e-3) == 1);
    side.step_prescribed(S(4.7e5 + 5e4 * std::sin(0.0314 * k)), S(0.15));
  }
  return side.chamber().pressure();
}
}  // namespace

TEST_CASE("dual numbers give the line's derivatives that differences give") {
  using D = Dual<double, 3>;
  const double length = 10.0, diameter = 0.00765, volume = 6e-5;
  LineParameters<D> line;
  line.length_m = D::variable(length, 0);
  line.diameter_m = D::variable(diameter, 1);
  const D exact = pressure_after_swing<D>(line, D::variable(volume, 2));
  const auto value = [](double l, double d, double v) {
    LineParameters<double> plain;
    plain.length_m = l;
    plain.diameter_m = d;
    return pressure_after_swing<double>(plain, v);
  };
  CHECK(same_bits(exact.value, value(length, diameter, volume)));
  const double h = 1e-3;
  const double by_length =
      (value(length * (1 + h), diameter, volume) - value(length * (1 - h), diameter, volume)) / (2 * h * length);
  const double by_diameter =
      (value(length, diameter * (1 + h), volume) - value(length, diameter * (1 - h), volume)) / (2 * h * diameter);
  const double by_volume =
      (value(length, diameter, volume * (1 + h)) - value(length, diameter, volume * (1 - h))) / (2 * h * volume);
  CHECK(exact.derivative[0] == Approx(by_length).epsilon(0.01));
  CHECK(exact.derivative[1] == Approx(by_diameter).epsilon(0.01));
  CHECK(exact.derivative[2] == Approx(by_volume).epsilon(0.01));
}

TEST_CASE("single precision follows double") {
  LineParameters<double> line;
  line.length_m = 10.0;
  line.diameter_m = 0.00765;
  const double exact = pressure_after_swing<double>(line, 6e-5);
  CHECK(pressure_after_swing<float>(cast<LineParameters<float>>(line), 6e-5f) == Approx(exact).epsilon(2e-4));
  using F = Pack<float, 2>;
  const F pair = pressure_after_swing<F>(cast<LineParameters<F>>(line), F(6e-5));
  CHECK(pair[0] == Approx(exact).epsilon(2e-4));
  CHECK(pair[0] == pair[1]);
}
