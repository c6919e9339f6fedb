// What a law adds for the valve's known dead band or play, and what the valve makes of it.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <vector>

#include <pneuservo/control/dead_band_and_play.hpp>
#include <pneuservo/control/pd_force.hpp>
#include <pneuservo/elements/valve.hpp>

#include "control/test_axis.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

/// Command of a law that asks for this and has asked for nothing before.
double command_V(const DeadBandAndPlayCompensation& compensation, double asked_V) {
  return compensation.command_V(compensation.next({}, asked_V));
}

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

TEST_CASE("with the compensation the valve opens from half the dead band on, and fully from its end on") {
  const DeadBandAndPlayCompensation compensation(known_effects());
  for (double asked_V = -0.2; asked_V < 0.2; asked_V += 0.001) {
    const double wanted_V = asked_V + offset_V, size_V = std::fabs(wanted_V);
    const double opens_V = size_V < half_width_V ? std::max(2.0 * size_V - half_width_V, 0.0) : size_V;
    CAPTURE(asked_V);
    CHECK(opening_V(command_V(compensation, asked_V)) == Approx(std::copysign(opens_V, wanted_V)).margin(1e-12));
  }
}

TEST_CASE("no step of what is asked for is more than doubled, and what was asked for comes back") {
  const DeadBandAndPlayCompensation compensation(known_effects());
  double before_V = command_V(compensation, -0.2);
  for (double asked_V = -0.199; asked_V < 0.2; asked_V += 0.001) {
    const double now_V = command_V(compensation, asked_V);
    CHECK(now_V - before_V > 0.0009);
    CHECK(now_V - before_V < 0.0021);
    CHECK(compensation.at(now_V).asked_V == Approx(asked_V).margin(1e-12));
    before_V = now_V;
  }
}

TEST_CASE("an underlap and no dead band get nothing") {
  ValveEffects<double> known = known_effects();
  for (const double width_V : {0.0, -0.03}) {
    known.valve_dead_band.width_V = width_V;
    for (const double asked_V : {-1.0, -0.01, 0.0, 0.02, 3.0})
      CHECK(command_V(DeadBandAndPlayCompensation(known), asked_V) == asked_V);
  }
}

TEST_CASE("with the compensation a spool with play turns after half of it, and has all of it back after the whole") {
  constexpr double width_V = 0.05, step_V = 0.001;
  ValveEffects<double> known;
  known.valve_hysteresis.width_V = width_V;
  const DeadBandAndPlayCompensation compensation(known);
  Valve<double> valve;
  valve.configure(nominal_axis().valve, known, 0.001);
  valve.set_time_step(0.001);
  DeadBandAndPlayCompensation::State state;
  const auto spool_V = [&](double asked_V) {
    const double before_V = compensation.command_V(state);
    state = compensation.next(state, asked_V);
    CHECK(std::fabs(compensation.command_V(state) - before_V) < 2.001 * step_V);
    valve.set_command(compensation.command_V(state));
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

TEST_CASE("of dead band and half a play the larger one gets its share alone") {
  ValveEffects<double> band = known_effects(), play = known_effects(), both = known_effects();
  play.valve_dead_band.width_V = 0.0;
  play.valve_hysteresis.width_V = both.valve_hysteresis.width_V = 0.05;
  const auto are_alike = [](const ValveEffects<double>& a, const ValveEffects<double>& b) {
    const DeadBandAndPlayCompensation one(a), other(b);
    DeadBandAndPlayCompensation::State of_one, of_other;
    for (const double asked_V : {-0.3, -0.04, 0.01, 0.06, 0.05, -0.01}) {
      of_one = one.next(of_one, asked_V), of_other = other.next(of_other, asked_V);
      CHECK(one.command_V(of_one) == other.command_V(of_other));
    }
  };
  are_alike(both, band);
  both.valve_dead_band.width_V = 0.001;
  are_alike(both, play);
}

TEST_CASE("with overlaps of their own no edge opens further than the command alone says") {
  ValveEffects<double> known = known_effects();
  known.valve_offset.offset_V = 0.0;
  known.valve_edge_overlaps.supply_1 = -0.5;
  const double width_V = known.valve_dead_band.width_V, least_V = 0.5 * width_V;
  const DeadBandAndPlayCompensation compensation(known);
  for (const double asked_V : {0.1 * width_V, 0.4 * width_V, width_V, 4 * width_V})
    CHECK(command_V(compensation, asked_V) - least_V <= asked_V + 1e-12);
  CHECK(command_V(compensation, 4 * width_V) == Approx(4 * width_V + least_V));
}

namespace {

/// A law that knows a play of 50 mV.
PdForce law_with_play(double integral_V_per_Ns) {
  AxisParameters<double> axis = nominal_axis();
  axis.effects.valve.valve_hysteresis.width_V = 0.05;
  PdForceParameters gains = nominal_gains();
  gains.force_integral_V_per_Ns = integral_V_per_Ns;
  return PdForce(gains, axis, 0.001);
}

}  // namespace

TEST_CASE("a law that knows a play starts bumpless") {
  PdForce law = law_with_play(0.3);
  const ReferencePoint reference{};
  for (const double command_V : {-0.4, -0.03, 0.01, 0.06, 0.5}) {
    law.start_bumpless(0.0005, 470e3, 540e3, reference, reference, command_V);
    CHECK(law.step(0.0005, 470e3, 540e3, reference, reference) == Approx(command_V));
  }
}

TEST_CASE(
    "a bad sample in the middle of a turn leaves the play's share as it was, and the same inputs the same commands") {
  const ReferencePoint reference{};
  PdForce law = law_with_play(0.0), undisturbed = law_with_play(0.0);
  const auto step = [&](PdForce& of, double p1_Pa) { return of.step(0.0, p1_Pa, 540e3, reference, reference); };
  std::vector<double> first;
  for (const double p1_Pa : {470e3, 468e3, 466e3, 467e3}) {
    first.push_back(step(law, p1_Pa));
    CHECK(step(undisturbed, p1_Pa) == first.back());
  }
  CHECK(step(law, std::numeric_limits<double>::quiet_NaN()) == first.back());
  for (const double p1_Pa : {468e3, 469e3, 467e3}) CHECK(step(law, p1_Pa) == step(undisturbed, p1_Pa));
  law.reset();
  std::size_t i = 0;
  for (const double p1_Pa : {470e3, 468e3, 466e3, 467e3}) CHECK(step(law, p1_Pa) == first[i++]);
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
        Approx(command_V(DeadBandAndPlayCompensation(axis.effects.valve), plain_V)));
  for (const double command_V : {-0.4, -0.03, 0.01, 0.06, 0.5}) {
    knowing.start_bumpless(0.0005, 470e3, 540e3, reference, reference, command_V);
    CHECK(knowing.step(0.0005, 470e3, 540e3, reference, reference) == Approx(command_V));
  }
}
