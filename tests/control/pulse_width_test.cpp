// Pulses of two on/off valves: their mean opening, the shortest pulse, what the switching times leave.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <pneuservo/control/pulse_width.hpp>
#include <pneuservo/elements/valve.hpp>

using namespace pneuservo;

namespace {

constexpr double tick_s = 1e-3, coil_V = 24.0;
constexpr int carrier_ticks = 20;

/// The pulses on the valves that they are made for.
struct Pulsed {
  Pulsed(double on_s, double off_s) {
    parameters.on_off = {
        .carrier_period_s = carrier_ticks * tick_s, .switching_time_on_s = on_s, .switching_time_off_s = off_s};
    pulses.configure(parameters, tick_s);
    valve.configure(parameters, {}, tick_s);
    valve.set_time_step(tick_s);
  }
  /// For how much of a period the filling valve less the emptying one is open.
  double step(double share) {
    command_V = pulses.step(share * coil_V);
    return hold();
  }
  double hold() {
    valve.set_command(command_V);
    const PortAreas<double> areas = valve.step(0.0);
    return (areas.supply - areas.exhaust) / parameters.area_max_m2;
  }
  double mean(double share, int carriers) {
    double open = 0.0;
    for (int i = 0; i < carriers * carrier_ticks; ++i) open += step(share);
    return open / (carriers * carrier_ticks);
  }
  ValveParameters<double> parameters{coil_V, 1e-6 / coil_V, 1e-6, 0.35};
  PulseWidth pulses;
  Valve<double> valve;
  double command_V = 0.0;
};

}  // namespace

TEST_CASE("the mean opening over carrier periods is the wanted one, whatever the switching times") {
  constexpr int carriers = 200;
  const double on_s = GENERATE(0.0, 1.5e-3, 3e-3, 6e-3), off_s = GENERATE(0.0, 2e-3, 4.4e-3);
  Pulsed rig(on_s, off_s);
  for (const double share : {0.0, 0.01, 0.1, 0.37, 0.8, 0.93, 1.0, -0.02, -0.5, -0.97, 0.6}) {
    CAPTURE(on_s, off_s, share);
    // Of the last pulse no more is missing than half of the widest step between two pulses, and what is still to close.
    const double most = (on_s + off_s + 2.0 * tick_s) / (carriers * carrier_ticks * tick_s);
    CHECK(std::fabs(rig.mean(share, carriers) - share) <= most);
  }
}

TEST_CASE("periods that were skipped with the coil on or off leave the mean as it was wanted") {
  constexpr int carriers = 60;
  const int at_tick = GENERATE(1, 4, 6, 11, 19), skipped = GENERATE(1, 7, 19);
  CAPTURE(at_tick, skipped);
  Pulsed rig(3e-3, 2e-3);
  constexpr double share = 0.3;
  double open = rig.mean(share, 10) * 10 * carrier_ticks;
  for (int i = 0; i < at_tick; ++i) open += rig.step(share);
  rig.pulses.skip(skipped);
  for (int i = 0; i < skipped; ++i) open += rig.hold();
  int periods = 10 * carrier_ticks + at_tick + skipped;
  // Beyond the carrier period that was skipped into nothing was wanted.
  const int unwanted = std::max(at_tick + skipped - carrier_ticks, 0);
  for (; periods < carriers * carrier_ticks; ++periods) open += rig.step(share);
  // The last pulse may be half done, and is as fine as two periods.
  CHECK(std::fabs(open - share * (periods - unwanted)) <= share * carrier_ticks + 4.0);
}

TEST_CASE("a coil is on for longer than its valve needs to open, and off for as long as it needs to close") {
  Pulsed rig(3e-3, 2.5e-3);
  int on = 0, off = 1000, pulses = 0;
  for (int i = 0; i < 400 * carrier_ticks; ++i) {
    const double share = std::sin(1e-3 * i);
    rig.step(share);
    CHECK((rig.command_V == 0.0 || std::fabs(rig.command_V) == coil_V));
    if (rig.command_V != 0.0) {
      if (on == 0 && off > 0) CHECK(off >= 3);
      ++on, off = 0;
    } else {
      if (on > 0) CHECK(on >= 4);
      pulses += on > 0;
      ++off, on = 0;
    }
  }
  CHECK(pulses > 200);
}

TEST_CASE("an opening shorter than the shortest pulse is given every few carrier periods") {
  Pulsed rig(3e-3, 2e-3);
  CHECK(rig.pulses.least_open_s() == Approx(3e-3));
  int carriers_with_pulse = 0;
  for (int carrier = 0; carrier < 100; ++carrier) {
    double open = 0.0;
    for (int i = 0; i < carrier_ticks; ++i) open += rig.step(0.03);
    carriers_with_pulse += open > 0.0;
  }
  CHECK(carriers_with_pulse == 20);  // 0.03 of 20 ms is a fifth of 3 ms
}

TEST_CASE("the shortest carrier period has room for a pulse that opens and a gap that closes") {
  CHECK(PulseWidth::shortest_carrier_s({0.02, 3e-3, 2e-3}, tick_s) == Approx(6e-3));
  CHECK(PulseWidth::shortest_carrier_s({0.02, 2.5e-3, 1.1e-3}, tick_s) == Approx(5e-3));
}
