// The valve's inner loop on the simulated spool: the lag that is asked for, one tick late; disturbances; bad inputs.
#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <vector>

#include <pneuservo/control/spool_loop.hpp>
#include <pneuservo/elements/second_order_filter.hpp>
#include <pneuservo/elements/spool_mass.hpp>

using namespace pneuservo;

namespace {

constexpr double T = 100e-6;

/// Loop and spool, tick by tick: the command of tick k acts over the tick after it.
struct Bench {
  SpoolLoop loop;
  SpoolMass<double> spool;
  double acting_V = 0.0, highest_m = 0.0;
  int inside = 1;  ///< sub-steps a tick

  explicit Bench(double Hz, double mass_error = 1.0) {
    SpoolLoopParameters parameters;
    parameters.natural_frequency_Hz = Hz;
    loop.configure(parameters);
    SpoolMassParameters<double> mass;
    mass.acceleration_per_volt_mps2_per_V /= mass_error;
    mass.mass_kg *= mass_error;
    spool.configure(mass);
  }
  void tick(double wanted_m, double force_N = 0.0) {
    const double next_V = loop.step(spool.position_m(), wanted_m);
    for (int i = 0; i < inside; ++i) {
      spool.step(acting_V, force_N, T / inside);
      highest_m = std::max(highest_m, std::fabs(spool.position_m()));
    }
    acting_V = next_V;
  }
};

struct Golden {
  double Hz, K1, K2, K3, gain_dB, delay_us, step, force_peak_um, force_late_um, open_peak_um;
};
constexpr Golden golden[]{{50, 432.415, 1.99201, 0.043995, 0.000, 150.4, 0.0001, 25, 1.1, 54},
                          {100, 1692.03, 4.02518, 0.087985, 0.001, 150.7, 0.0002, 6.7, 0.003, 14.2},
                          {200, 6476.77, 8.19669, 0.175784, 0.006, 151.5, 0.0008, 1.9, 0.000, 4.0},
                          {300, 13945.2, 12.4799, 0.263082, 0.013, 152.2, 0.0019, 0.95, 0.000, 2.0}};

/// Position over command at one frequency, from whole periods after the start has died away.
std::complex<double> response(double loop_Hz, double Hz) {
  Bench bench(loop_Hz);
  const double w = 2.0 * std::numbers::pi * Hz;
  const int start = 4000, ticks = 8000;  // whole periods of every multiple of 1.25 Hz
  std::complex<double> sum = 0.0, input = 0.0;
  for (int k = 0; k < start + ticks; ++k) {
    const double wanted = 1e-4 * std::sin(w * k * T);
    if (k >= start) {
      const std::complex<double> turn = std::exp(std::complex<double>(0.0, -w * k * T));
      sum += turn * bench.spool.position_m();
      input += turn * wanted;
    }
    bench.tick(wanted);
  }
  return sum / input;
}

/// What the loop's frequency response has beside the lag's: the largest gain error up to the set frequency, and the
/// pure delay that the phase there amounts to.
struct Likeness {
  double gain_error_dB = 0.0, delay_us = 0.0;
};
Likeness likeness_in_frequency(double loop_Hz) {
  const double wv = 2.0 * std::numbers::pi * loop_Hz;
  Likeness found;
  for (const double share : {0.1, 0.25, 0.5, 0.75, 1.0}) {
    const double w = share * wv;
    const std::complex<double> s(0.0, w), lag = wv * wv / (s * s + 1.4 * wv * s + wv * wv);
    const std::complex<double> ratio = response(loop_Hz, share * loop_Hz) / lag;
    found.gain_error_dB = std::max(found.gain_error_dB, std::fabs(20.0 * std::log10(std::abs(ratio))));
    if (share == 1.0) found.delay_us = -1e6 * std::arg(ratio) / w;
  }
  return found;
}

/// Largest distance from the lag's step one tick later, as a share of the step.
double step_error(double loop_Hz) {
  Bench bench(loop_Hz);
  bench.inside = 10;
  SecondOrderFilter<double> lag;
  lag.configure(loop_Hz, 0.7, T);
  lag.reset(0.0);
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    bench.tick(1e-3);
    worst = std::max(worst, std::fabs(bench.spool.position_m() / 1e-3 - lag.value()));
    lag.step(1.0);  // a tick behind the bench
  }
  return worst;
}

}  // namespace

TEST_CASE("golden gains of the valve's inner loop") {
  for (const Golden& g : golden) {
    SpoolLoopParameters parameters;
    parameters.natural_frequency_Hz = g.Hz;
    const SpoolLoopGains gains = spool_loop_gains(parameters);
    CHECK(gains.K1_V_per_m == Approx(g.K1).epsilon(1e-5));
    CHECK(gains.K2_Vs_per_m == Approx(g.K2).epsilon(1e-5));
    CHECK(gains.K3 == Approx(g.K3).epsilon(2e-5));
  }
}

TEST_CASE("the spool's frequency response is the lag's, behind one tick and the hold") {
  for (const Golden& g : golden) {
    const Likeness found = likeness_in_frequency(g.Hz);
    INFO(g.Hz << " Hz");
    CHECK(found.delay_us == Approx(g.delay_us).margin(0.15));
    CHECK(found.gain_error_dB == Approx(g.gain_dB).margin(0.0011));
    CHECK(found.gain_error_dB <= 0.02);
  }
}

TEST_CASE("a step is that of the lag with the same command, one tick later") {
  for (const Golden& g : golden) {
    const double worst = step_error(g.Hz);
    INFO(g.Hz << " Hz");
    CHECK(worst <= 0.002);
    CHECK(worst == Approx(g.step).margin(1e-4));
  }
}

TEST_CASE("the valve's inner loop: print its figures", "[.spool-loop]") {
  for (const Golden& g : golden) {
    const Likeness found = likeness_in_frequency(g.Hz);
    std::printf("{\"Hz\": %g, \"gain_error_dB\": %.6g, \"delay_us\": %.6g, \"step_error\": %.6g}\n", g.Hz,
                found.gain_error_dB, found.delay_us, step_error(g.Hz));
  }
}

TEST_CASE("a force step is held down and then removed") {
  for (const Golden& g : golden) {
    INFO(g.Hz << " Hz");
    Bench bench(g.Hz);
    bench.inside = 10;
    for (int k = 0; k < 200; ++k) bench.tick(0.0, 0.3);
    CHECK(1e6 * bench.highest_m == Approx(g.force_peak_um).epsilon(0.02));
    CHECK(1e6 * std::fabs(bench.spool.position_m()) == Approx(g.force_late_um).margin(0.05));
    // The disturbance that the observer found is the force's command.
    CHECK(bench.loop.disturbance_V() == Approx(0.3 / 0.061 / 223.28).epsilon(0.1));
    // Feedback of the true position and velocity without observer: the force stays.
    const SpoolLoopGains& k = bench.loop.gains();
    SpoolMass<double> spool;
    spool.configure({});
    double u = 0.0, highest = 0.0;
    for (int tick = 0; tick < 1000; ++tick) {
      const double next = -k.K1_V_per_m * spool.position_m() - k.K2_Vs_per_m * spool.velocity_mps() - k.K3 * u;
      spool.step(u, 0.3, T);
      highest = std::max(highest, spool.position_m());
      u = next;
    }
    CHECK(1e6 * highest == Approx(g.open_peak_um).epsilon(0.05));
    CHECK(1e6 * spool.position_m() > 20.0 * g.force_late_um);
  }
}

TEST_CASE("ten percent of wrong spool mass leave a step within 2.5 percent") {
  for (const double error : {0.9, 1.1}) {
    Bench bench(100.0, error);
    SecondOrderFilter<double> lag;
    lag.configure(100.0, 0.7, T);
    lag.reset(0.0);
    double worst = 0.0;
    for (int k = 0; k < 1000; ++k) {
      bench.tick(1e-3);
      worst = std::max(worst, std::fabs(bench.spool.position_m() / 1e-3 - lag.value()));
      lag.step(1.0);
    }
    CHECK(worst < 0.025);
    CHECK(std::fabs(bench.spool.position_m() / 1e-3 - 1.0) < 1e-6);
  }
}

TEST_CASE("a quantised position keeps the spool within its quantum at rest") {
  for (const double Hz : {50.0, 300.0}) {
    Bench bench(Hz);
    const double quantum = 0.125e-6;
    double square = 0.0;
    for (int k = 0; k < 20000; ++k) {
      const double next = bench.loop.step(quantum * std::round(bench.spool.position_m() / quantum), 0.33 * quantum);
      bench.spool.step(bench.acting_V, 0.0, T);
      bench.acting_V = next;
      if (k >= 10000) square += std::pow(bench.spool.position_m() - 0.33 * quantum, 2) / 10000.0;
    }
    CHECK(std::sqrt(square) < 0.12e-6);
  }
}

TEST_CASE("the loop's lag changes while it runs, without a jump of the spool") {
  Bench bench(100.0);
  for (int k = 0; k < 500; ++k) bench.tick(1e-3, 0.2);
  const double before = bench.spool.position_m();
  SpoolLoopParameters faster;
  faster.natural_frequency_Hz = 300.0;
  bench.loop.change(spool_loop_gains(faster));
  double highest = 0.0;
  for (int k = 0; k < 500; ++k) {
    bench.tick(1e-3, 0.2);
    highest = std::max(highest, std::fabs(bench.spool.position_m() - before));
  }
  CHECK(highest < 1e-8);
}

TEST_CASE("a limited coil does not wind the loop up") {
  SpoolLoopParameters parameters;
  parameters.command_max_V = 0.5;
  SpoolLoop loop;
  loop.configure(parameters);
  SpoolMass<double> spool;
  spool.configure({});
  double u = 0.0, highest = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double next = loop.step(spool.position_m(), 2e-3);
    CHECK(std::fabs(next) <= 0.5);
    spool.step(u, 0.0, T);
    u = next;
    highest = std::max(highest, spool.position_m());
    REQUIRE(std::fabs(loop.disturbance_V()) < 1e-6);  // the observer knows what acted
  }
  CHECK(spool.position_m() == Approx(2e-3).epsilon(1e-6));
  CHECK(highest < 2.6e-3);
}

TEST_CASE("inputs that are not numbers leave the command finite and are told") {
  Bench bench(100.0);
  for (int k = 0; k < 500; ++k) bench.tick(1e-3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int k = 0; k < 3; ++k) {
    const double u = bench.loop.step(nan, 1e-3);
    CHECK(std::isfinite(u));
    CHECK_FALSE(bench.loop.finite());
    bench.spool.step(bench.acting_V, 0.0, T);
    bench.acting_V = u;
  }
  CHECK(std::isfinite(bench.loop.step(bench.spool.position_m(), nan)));
  bench.tick(1e-3);
  CHECK(bench.loop.finite());
  CHECK(bench.spool.position_m() == Approx(1e-3).epsilon(1e-3));
}
