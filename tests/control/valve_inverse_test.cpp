// What a law adds for the valve's known dead band or play, and what the valve makes of it.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include <pneuservo/control/pd_force.hpp>
#include <pneuservo/control/valve_inverse.hpp>
#include <pneuservo/elements/valve.hpp>

#include "control/test_axis.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

/// Command of a law that asks for this and has asked for nothing before.
double command_V(const ValveInverse& inverse, double asked_V) { return inverse.command_V(inverse.next({}, asked_V)); }

constexpr double half_width_V = 0.05, offset_V = -0.02;

ValveEffects<double> known_effects() {
  ValveEffects<double> known;
  known.valve_dead_band.width_V = half_width_V;
  known.valve_offset.offset_V = offset_V;
  return known;
}

/// Opening of a port under a command, as the voltage of a valve without dead band: filling positive.
double opening_V(double command_V) {
  const ValveParameters<double> parameters = nominal_axis().valve;
  Valve<double> valve;
  valve.configure(parameters, known_effects(), 0.001);
  const PortAreas<double> areas = valve.areas(command_V);
  return (areas.supply - areas.exhaust) / parameters.area_per_volt_m2_per_V;
}

}  // namespace

TEST_CASE("with the inverse the valve opens from half the dead band on, and fully from its end on") {
  const ValveInverse inverse(known_effects());
  for (double asked_V = -0.2; asked_V < 0.2; asked_V += 0.001) {
    const double wanted_V = asked_V + offset_V, size_V = std::fabs(wanted_V);
    const double opens_V = size_V < half_width_V ? std::max(2.0 * size_V - half_width_V, 0.0) : size_V;
    CAPTURE(asked_V);
    CHECK(opening_V(command_V(inverse, asked_V)) == Approx(std::copysign(opens_V, wanted_V)).margin(1e-12));
  }
}

TEST_CASE("no step of what is asked for is more than doubled, and what was asked for comes back") {
  const ValveInverse inverse(known_effects());
  double before_V = command_V(inverse, -0.2);
  for (double asked_V = -0.199; asked_V < 0.2; asked_V += 0.001) {
    const double now_V = command_V(inverse, asked_V);
    CHECK(now_V - before_V > 0.0009);
    CHECK(now_V - before_V < 0.0021);
    CHECK(inverse.at(now_V).asked_V == Approx(asked_V).margin(1e-12));
    before_V = now_V;
  }
}

TEST_CASE("an underlap and no dead band get nothing") {
  ValveEffects<double> known = known_effects();
  for (const double width_V : {0.0, -0.03}) {
    known.valve_dead_band.width_V = width_V;
    for (const double asked_V : {-1.0, -0.01, 0.0, 0.02, 3.0})
      CHECK(command_V(ValveInverse(known), asked_V) == asked_V);
  }
}

TEST_CASE("with the inverse a spool with play turns after half of it, and has all of it back after the whole") {
  constexpr double width_V = 0.05, step_V = 0.001;
  ValveEffects<double> known;
  known.valve_hysteresis.width_V = width_V;
  const ValveInverse inverse(known);
  Valve<double> valve;
  valve.configure(nominal_axis().valve, known, 0.001);
  valve.set_time_step(0.001);
  ValveInverse::State state;
  const auto spool_V = [&](double asked_V) {
    const double before_V = inverse.command_V(state);
    state = inverse.next(state, asked_V);
    CHECK(std::fabs(inverse.command_V(state) - before_V) < 2.001 * step_V);
    valve.set_command(inverse.command_V(state));
    valve.step(0.0);
    return valve.spool();
  };
  for (double asked_V = 0.0; asked_V < 0.2; asked_V += step_V) spool_V(asked_V);
  const double top_V = spool_V(0.2);
  CHECK(top_V == Approx(0.2));
  for (double back_V = step_V; back_V < 0.1; back_V += step_V) {
    CAPTURE(back_V);
    const double found_V = spool_V(0.2 - back_V);
    if (back_V < 0.5 * width_V - step_V) CHECK(found_V == top_V);
    if (back_V > 0.5 * width_V + step_V) CHECK(found_V < top_V);
    if (back_V > width_V + step_V) CHECK(found_V == Approx(0.2 - back_V));
  }
}

TEST_CASE("a valve with dead band and play gets the dead band's share alone") {
  ValveEffects<double> both = known_effects();
  both.valve_hysteresis.width_V = 0.05;
  for (const double asked_V : {-0.3, -0.04, 0.01, 0.06})
    CHECK(command_V(ValveInverse(both), asked_V) == command_V(ValveInverse(known_effects()), asked_V));
}

TEST_CASE("a law that knows the dead band commands it in addition, and starts bumpless all the same") {
  AxisParameters<double> axis = nominal_axis();
  PdForceParameters gains = nominal_gains();
  gains.force_integral_V_per_Ns = 0.3;
  PdForce plain(gains, axis, 0.001);
  axis.effects.valve = known_effects();
  PdForce knowing(gains, axis, 0.001);
  const ReferencePoint reference{};
  const double plain_V = plain.step(0.0005, 470e3, 540e3, reference, reference);
  CHECK(knowing.step(0.0005, 470e3, 540e3, reference, reference) ==
        Approx(command_V(ValveInverse(axis.effects.valve), plain_V)));
  for (const double command_V : {-0.4, -0.03, 0.01, 0.06, 0.5}) {
    knowing.start_bumpless(0.0005, 470e3, 540e3, reference, reference, command_V);
    CHECK(knowing.step(0.0005, 470e3, 540e3, reference, reference) == Approx(command_V));
  }
}
