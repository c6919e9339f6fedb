// The observer of the position on gas that is known in closed form: chambers of constant pressure, a piston of even
// speed, a line without storage.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include <pneuservo/estimator/position_observer.hpp>

using namespace pneuservo;

namespace {

constexpr double temperature_K = 293.0, pressure_1_Pa = 4.7e5;

PositionObserverParameters known_axis() {
  PositionObserverParameters p;
  p.period_s = 1e-3, p.stroke_m = 0.3;
  p.area_m2 = {1.257e-3, 1.056e-3};
  p.dead_volume_m3 = {2e-5, 2e-5}, p.line_volume_m3 = {9e-5, 9e-5};
  p.gas_constant_J_per_kgK = 287.0, p.atmosphere_Pa = 101325.0;
  p.mass_kg = 2.0, p.viscous_friction_Ns_per_m = 60.0;
  p.travel_s = 0.006, p.mode_s = 0.08;
  p.unknown_force_N = 1.0, p.switch_m = 2e-4;
  return p;
}

/// The piston moves as it is told; pressures give the force that this takes. The valve gives more than its law says by
/// `gain`, the sides lose `leak_kgps`.
struct KnownGas {
  PositionObserverParameters p = known_axis();
  PositionObserver observer;
  double x_m = 0.0, gain = 0.0, leak_1_kgps = 0.0, bound_Pa = 100.0, largest_error_m = 0.0;
  long within = 0, ticks = 0;

  explicit KnownGas(const PositionObserverParameters& parameters, double deviation_m = 1e-3) : p(parameters) {
    observer.configure(p);
    observer.reset(x_m, deviation_m);
  }
  double air_per_way(std::size_t side, double pressure_Pa) const {
    return (side == 0 ? 1.0 : -1.0) * pressure_Pa * p.area_m2[side] / (p.gas_constant_J_per_kgK * temperature_K);
  }
  void step(double speed_mps, double acceleration_mps2) {
    const double force_N = p.mass_kg * acceleration_mps2 + p.viscous_friction_Ns_per_m * speed_mps;
    const double pressure_2_Pa =
        (p.area_m2[0] * pressure_1_Pa - (p.area_m2[0] - p.area_m2[1]) * p.atmosphere_Pa - force_N) / p.area_m2[1];
    const std::array<double, 2> pressure_Pa{pressure_1_Pa, pressure_2_Pa};
    PositionObserverInput in;
    for (std::size_t side = 0; side < 2; ++side) {
      const double per_way = air_per_way(side, pressure_Pa[side]);
      in.valve_flow_kgps[side] = (per_way * speed_mps + (side == 0 ? leak_1_kgps : 0.0)) / (1.0 + gain);
      in.line_flow_kgps[side] = per_way * observer.velocity_mps();
    }
    in.chamber_Pa = pressure_Pa;
    in.chamber_K = {temperature_K, temperature_K};
    in.chamber_bound_Pa = {bound_Pa, bound_Pa};
    x_m += p.period_s * speed_mps;
    observer.step(in);
    const double error_m = std::fabs(observer.position_m() - x_m);
    largest_error_m = std::max(largest_error_m, error_m);
    within += error_m <= observer.bound_m() ? 1 : 0;
    ++ticks;
  }
  void rest(double time_s) { move(0.0, time_s); }
  /// Speed rises and falls as sin^2.
  void move(double way_m, double time_s) {
    const long n = std::lround(time_s / p.period_s);
    for (long k = 0; k < n; ++k) {
      const double phase = std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(n),
                   peak = 2.0 * way_m / time_s;
      step(peak * std::pow(std::sin(phase), 2), peak * std::numbers::pi / time_s * std::sin(2.0 * phase));
    }
  }
  double error_m() const { return observer.position_m() - x_m; }
};

}  // namespace

TEST_CASE("position observer: air of a known valve tells the way of the piston") {
  KnownGas gas(known_axis(), 0.0);
  for (const double way_m : {0.08, -0.05, 0.02}) {
    gas.move(way_m, 0.5);
    gas.rest(0.5);
  }
  CHECK(gas.x_m == Approx(0.05));
  CHECK(gas.largest_error_m < 3e-4);
  CHECK(std::fabs(gas.observer.velocity_mps()) < 1e-4);
  CHECK(gas.within == gas.ticks);
}

TEST_CASE("position observer: two passages a known way apart teach the valve's gain") {
  PositionObserverParameters p = known_axis();
  p.valve_area_share = 0.03;
  KnownGas gas(p);
  gas.gain = 0.03;
  gas.observer.pass(gas.x_m);
  gas.move(0.08, 1.0);
  // What the nominal valve would make of that air; the force, which fits the true speed, takes a little of it.
  CHECK(gas.error_m() == Approx(-0.03 / 1.03 * 0.08).epsilon(0.15));
  CHECK(gas.within == gas.ticks);
  gas.observer.pass(gas.x_m);
  CHECK(gas.observer.supply_gain() == Approx(0.03).epsilon(0.1));
  CHECK(gas.observer.exhaust_gain() == Approx(0.03).epsilon(0.1));
  gas.largest_error_m = 0.0;
  gas.move(-0.08, 1.0);
  CHECK(gas.largest_error_m < 4e-4);
  CHECK(gas.within == gas.ticks);
}

TEST_CASE("position observer: the bound is the switch's at a passage and grows from there, faster with more unknown") {
  PositionObserverParameters p = known_axis();
  p.leak_kgps = 2e-6;
  KnownGas tight(known_axis()), leaky(p);
  for (KnownGas* gas : {&tight, &leaky}) {
    gas->rest(0.2);
    gas->observer.pass(gas->x_m);
    CHECK(gas->observer.bound_m() == Approx(PositionObserver::bound_deviations * p.switch_m).epsilon(0.01));
    gas->rest(1.0);
  }
  const double after_1_s = leaky.observer.bound_m();
  CHECK(after_1_s > tight.observer.bound_m());
  tight.rest(9.0), leaky.rest(9.0);
  CHECK(leaky.observer.bound_m() > 3.0 * after_1_s);
  CHECK(tight.observer.bound_m() < after_1_s);  // nothing is unknown that would add up
  leaky.observer.pass(leaky.x_m);
  CHECK(leaky.observer.bound_m() == Approx(PositionObserver::bound_deviations * p.switch_m).epsilon(0.01));
}

TEST_CASE("position observer: a leak looks like a motion, so the position drifts, within a bound that knows of leaks") {
  PositionObserverParameters p = known_axis();
  p.leak_kgps = 2e-6;
  KnownGas told(p);
  told.leak_1_kgps = 2e-6;
  told.rest(20.0);
  // One of two sides says so, and both count alike: half of the leak over the air per way.
  const double drift_m = 0.5 * 20.0 * told.leak_1_kgps / told.air_per_way(0, pressure_1_Pa);
  CHECK(told.error_m() == Approx(drift_m).epsilon(0.25));
  CHECK(told.within == told.ticks);
  KnownGas untold(known_axis(), 0.0);
  untold.leak_1_kgps = 2e-6;
  untold.rest(20.0);
  CHECK(untold.within < untold.ticks / 2);
}

TEST_CASE("position observer: at rest the bound keeps growing, for a leak is not what it was") {
  PositionObserverParameters p = known_axis();
  p.leak_kgps = 2e-6;
  KnownGas gas(p);
  gas.rest(30.0);
  const double after_30_s = gas.observer.bound_m();
  gas.leak_1_kgps = 2e-6;
  gas.rest(30.0);
  CHECK(gas.observer.bound_m() > 2.2 * after_30_s);  // of a leak that stays what it is, twice
  CHECK(gas.within == gas.ticks);
}
