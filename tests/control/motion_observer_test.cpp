// The observer's exact discretisation: golden numbers, and the continuous observer integrated finely.
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

#include <pneuservo/control/motion_observer.hpp>

#include "core/test_seed.hpp"

using namespace pneuservo;

TEST_CASE("golden matrices of the printed observer at 200 us") {
  const DiscreteObserver d = discretise({530.5, 140739.9, 1.85e7}, 2e-4);
  const double phi[]{0.8966891632526983, 1.8957635506523644e-4, 1.9301996743810156e-8};
  const double g0[]{0.0511926120734838, 13.335142268037327, 1721.7278699044377};
  const double g1[]{0.0521182246738179, 13.702901925969027, 1785.4346988024358};
  for (std::size_t i = 0; i < 3; ++i) {
    INFO(i);
    CHECK(std::fabs(d.phi[0][i] / phi[i] - 1.0) < 1e-13);
    CHECK(std::fabs(d.g0[i] / g0[i] - 1.0) < 1e-13);
    CHECK(std::fabs(d.g1[i] / g1[i] - 1.0) < 1e-13);
  }
}

TEST_CASE("the observer is the continuous one for a measurement that is linear between samples") {
  const ObserverGains l = ObserverGains::butterworth(1000.0);
  const double T = 2e-4;
  MotionObserver observer;
  observer.configure(l, T);
  observer.step(0.01);
  double x = 0.01, v = 0.0, a = 0.0, last = 0.01;
  const auto sample = [](int k) { return 0.01 + 1e-4 * std::sin(0.3 * k) + 1e-5 * k; };
  for (int k = 1; k <= 40; ++k) {
    const double next = sample(k);
    constexpr int fine = 2000;
    for (int i = 0; i < fine; ++i) {  // mid-point rule
      const double h = T / fine, y0 = last + (next - last) * i / fine, y1 = last + (next - last) * (i + 0.5) / fine;
      const double e0 = y0 - x;
      const double xm = x + 0.5 * h * (v + l.l1 * e0), vm = v + 0.5 * h * (a + l.l2 * e0), am = a + 0.5 * h * l.l3 * e0;
      x += h * (vm + l.l1 * (y1 - xm));
      v += h * (am + l.l2 * (y1 - xm));
      a += h * l.l3 * (y1 - xm);
    }
    last = next;
    observer.step(next);
    CHECK(observer.position_m() == Approx(x).epsilon(1e-8));
    CHECK(observer.velocity_mps() == Approx(v).margin(1e-7));
    CHECK(observer.acceleration_mps2() == Approx(a).margin(1e-4));
  }
}

TEST_CASE("steady acceleration is found exactly, and late samples count over their time") {
  const double T = 2e-4;
  MotionObserver every, late;
  every.configure(ObserverGains::butterworth(1000.0), T);
  late.configure(ObserverGains::butterworth(1000.0), T);
  const auto sample = [&](int k) { return 0.5 * 3.0 * (k * T) * (k * T); };
  for (int k = 0; k <= 3000; ++k) every.step(sample(k));
  CHECK(every.acceleration_mps2() == Approx(3.0).epsilon(1e-5));  // the chord between samples ripples
  // Linear between samples: what is 2 periods away stands in the middle at the mean.
  late.step(0.0);
  late.step(2e-6, 2);
  MotionObserver twice;
  twice.configure(ObserverGains::butterworth(1000.0), T);
  twice.step(0.0);
  twice.step(1e-6);
  twice.step(2e-6);
  CHECK(late.velocity_mps() == twice.velocity_mps());
  CHECK(late.acceleration_mps2() == twice.acceleration_mps2());
}

TEST_CASE("at 70 mm a scale of 62.5 pm makes the noise of its quantum, not of rounding") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  MotionObserver observer;
  observer.configure(ObserverGains::butterworth(1000.0), 2e-4);
  constexpr int settle = 1000, count = 40000;
  double v2 = 0.0, a2 = 0.0;
  for (int k = 0; k < settle + count; ++k) {
    observer.step(0.0699 + 62.5e-12 * unit(random));
    if (k < settle) continue;
    v2 += std::pow(observer.velocity_mps(), 2);
    a2 += std::pow(observer.acceleration_mps2(), 2);
  }
  CHECK(std::sqrt(v2 / count) == Approx(9.2e-9).epsilon(0.05));
  CHECK(std::sqrt(a2 / count) == Approx(4.3e-6).epsilon(0.05));
}
