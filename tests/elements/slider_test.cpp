// Slider: every friction law and load by its own formula, rest that holds exactly, end stops.
#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <vector>

#include <pneuservo/elements/slider.hpp>

using namespace pneuservo;

namespace {
Slider<double> make_slider(const MotionEffects<double>& effects = {}, double viscous = 0.0, double stroke = 100.0) {
  Slider<double> slider;
  SliderParameters<double> parameters;
  parameters.mass_kg = 1.5;
  parameters.payload_kg = 0.5;
  parameters.viscous_friction_Ns_per_m = viscous;
  slider.configure(parameters, effects, stroke, 0.3);
  return slider;
}
double acceleration(const MotionEffects<double>& effects, double force, double v, double x = 0.0, double gauge = 0.0,
                    double viscous = 0.0) {
  Slider<double> slider = make_slider(effects, viscous);
  slider.reset(x, v);
  slider.step(1e-7, force, {gauge});
  return (slider.velocity() - v) / 1e-7;
}
}  // namespace

TEST_CASE("slider: each law has its force, m = 2 kg with payload") {
  const MotionEffects<double> none;
  CHECK(acceleration(none, 10.0, 0.0) == Approx(5.0));
  CHECK(acceleration(none, 0.0, 0.5, 0.0, 0.0, 60.0) == Approx(-15.0).epsilon(1e-5));
  MotionEffects<double> e = none;
  e.coulomb_friction.force_N = 4.0;
  CHECK(acceleration(e, 10.0, 0.1) == Approx(3.0));
  CHECK(acceleration(e, 10.0, -0.1) == Approx(7.0));
  e = none, e.stribeck_friction = {15.0, 0.02, 20.0};
  CHECK(acceleration(e, 0.0, 0.02) == Approx(-0.5 * (20.0 + 15.0 * std::exp(-1.0))).epsilon(1e-5));
  e = none, e.direction_dependent_friction = {4.0, 6.0};
  CHECK(acceleration(e, 0.0, 0.1) == Approx(-2.0));
  CHECK(acceleration(e, 0.0, -0.1) == Approx(3.0));
  e = none, e.pressure_dependent_friction.force_per_pressure_N_per_Pa = 1e-5;
  CHECK(acceleration(e, 0.0, 0.1, 0.0, 8e5) == Approx(-2.0));
  e = none, e.friction_zone = {10.0, 0.05, 0.01};
  CHECK(acceleration(e, 0.0, 0.1, 0.05) == Approx(-5.0).epsilon(1e-4));
  CHECK(acceleration(e, 0.0, 0.1, 0.06) == Approx(-5.0 * std::exp(-1.0)).epsilon(1e-4));
  e = none, e.quadratic_drag.coefficient_Ns2_per_m2 = 8.0;
  CHECK(acceleration(e, 0.0, 0.5) == Approx(-1.0).epsilon(1e-4));
  CHECK(acceleration(e, 0.0, -0.5) == Approx(1.0).epsilon(1e-4));
  e = none, e.direction_dependent_viscous_friction = {4.0, -6.0};
  CHECK(acceleration(e, 0.0, 0.5) == Approx(-1.0).epsilon(1e-4));
  CHECK(acceleration(e, 0.0, -0.5) == Approx(-1.5).epsilon(1e-4));
  e = none, e.viscous_friction.coefficient_Ns_per_m = 6.0;
  CHECK(acceleration(e, 0.0, 0.5, 0.0, 0.0, 4.0) == Approx(-2.5).epsilon(1e-4));
  CHECK(acceleration(e, 0.0, -0.5, 0.0, 0.0, 4.0) == Approx(2.5).epsilon(1e-4));
  e = none, e.gravity_load = {6.0, 2.0};
  CHECK(acceleration(e, 0.0, 0.0, 0.0) == Approx(-1.0));
  CHECK(acceleration(e, 0.0, 0.0, M_PI / 2) == Approx(-3.0));
  CHECK(acceleration(e, 0.0, 0.0, M_PI) == Approx(1.0));
  e = none, e.constant_force.force_N = 3.0;
  CHECK(acceleration(e, 10.0, 0.0) == Approx(3.5));
  e = none, e.spring_load = {100.0, 0.02};
  CHECK(acceleration(e, 0.0, 0.0, 0.05) == Approx(-1.5));
}

TEST_CASE("slider: below breakaway nothing moves, exactly, above it does, direction by direction") {
  MotionEffects<double> e;
  e.direction_dependent_friction = {4.0, 6.0};
  Slider<double> slider = make_slider(e);
  slider.reset(0.01, 0.0);
  for (const double force : {3.999, -5.999, 4.0, -6.0}) {
    for (int k = 0; k < 1000; ++k) slider.step(1e-3, force, {});
    CHECK((slider.position() == 0.01 && slider.velocity() == 0.0));
  }
  slider.step(1e-3, 4.001, {});
  CHECK(slider.velocity() > 0.0);
  slider.reset(0.01, 0.0);
  slider.step(1e-3, -6.001, {});
  CHECK(slider.velocity() < 0.0);
}

TEST_CASE("slider: friction that the way builds up is a spring for small ways, dry friction for long ones, and loses") {
  const ElasticFriction<double> own{20.0, 1e-3};
  CHECK(own.carried(0.0, 1e-3) == Approx(20.0 * (1 - std::exp(-1.0))));
  CHECK(own.carried(20.0, -1e-3 * std::log(2.0)) == Approx(0.0).margin(1e-12));
  CHECK(own.carried(-20.0, 1.0) == Approx(20.0));
  MotionEffects<double> e;
  e.elastic_friction = own;
  Slider<double> slider = make_slider(e);
  // F_c/w on 2 kg: 100 rad/s. The swing of 1 um is at its end after a quarter of its period.
  slider.reset(0.0, 1e-4);
  int steps = 0;
  while (slider.velocity() > 0.0 && ++steps < 10000) slider.step(1e-5, 0.0, {});
  CHECK(1e-5 * steps == Approx(M_PI / 200).epsilon(0.01));
  CHECK(slider.position() == Approx(1e-6).epsilon(0.01));
  // A long slide is slowed by F_c: v^2/(2 F_c/m), and on average w more for what is not built up yet.
  slider.reset(0.0, 1.0);
  while (slider.velocity() > 0.0 && slider.position() < 1.0) slider.step(1e-5, 0.0, {});
  CHECK(slider.position() == Approx(0.05 + 1e-3).epsilon(2e-3));
}

TEST_CASE("slider: a payload that is taken up is mass and weight from its instant on, and none before") {
  MotionEffects<double> e;
  e.payload_change = {0.5, 3.0, 0.25};
  Slider<double> slider = make_slider(e);
  slider.reset(0.0, 0.0);
  for (int k = 0; k < 250; ++k) slider.step(1e-3, 0.0, {});
  CHECK((slider.position() == 0.0 && slider.velocity() == 0.0));
  CHECK(slider.mass() == Approx(2.5));
  for (int k = 0; k < 100; ++k) slider.step(1e-3, 0.0, {});
  CHECK(slider.velocity() == Approx(-3.0 / 2.5 * 0.1));
  slider.reset(0.0, 0.0);  // a run's start: it is not there yet
  slider.step(1e-3, 1.0, {});
  CHECK(slider.velocity() == Approx(1e-3 / 2.0));
}

TEST_CASE("slider: friction never turns the motion round") {
  MotionEffects<double> e;
  e.coulomb_friction.force_N = 50.0;
  Slider<double> slider = make_slider(e);
  for (const double v : {0.3, -0.3, 1e-6}) {
    slider.reset(0.0, v);
    double x = 0.0;
    for (int k = 0; k < 200; ++k) {
      slider.step(1e-3, 0.0, {});
      CHECK((slider.velocity() * v >= 0.0 && (slider.position() - x) * v >= 0.0));
      x = slider.position();
    }
    CHECK(slider.velocity() == 0.0);
    CHECK(std::fabs(x) == Approx(0.5 * v * v / 25.0).epsilon(1e-6));  // v^2/(2 F/m): exact for a constant force
  }
}

TEST_CASE("slider: end stops hold, rebound and come to rest") {
  Slider<double> slider = make_slider({}, 0.0, 0.3);
  slider.reset(0.1, 1.0);
  double fastest_back = 0.0;
  for (int k = 0; k < 100; ++k) {
    slider.step(1e-3, 0.0, {});
    fastest_back = std::min(fastest_back, slider.velocity());
    REQUIRE(slider.position() <= 0.15);
  }
  CHECK(fastest_back == Approx(-0.3));
  slider.reset(0.149, 0.0);
  for (int k = 0; k < 5000; ++k) slider.step(1e-3, 50.0, {});
  CHECK((slider.position() == 0.15 && std::fabs(slider.velocity()) < 1e-12));
  slider.step(1e-3, -50.0, {});  // and lets go
  CHECK(slider.velocity() < 0.0);
}

TEST_CASE(
    "coupled load: where its carrier stands still it swings with its frequency and damping, and pulls by its law") {
  CoupledLoad<double> load;
  load.configure(ElasticLoad<double>{0.8, 6.0, 0.05});
  load.reset(0.0, 0.3);  // the carrier stands at 0, the mass passes it
  const double w = 2 * M_PI * 6.0, w_d = w * std::sqrt(1 - 0.05 * 0.05), h = 2e-5;
  for (int k = 1; k <= 20000; ++k) {
    load.step(h, 0.0, 0.0, 0.0, 0.0);
    const double t = k * h, decay = std::exp(-0.05 * w * t);
    const double y = 0.3 / w_d * decay * std::sin(w_d * t),
                 v = 0.3 * decay * (std::cos(w_d * t) - 0.05 * w / w_d * std::sin(w_d * t));
    REQUIRE(load.force() == Approx(0.8 * (w * w * y + 2 * 0.05 * w * v)).margin(2e-4 * 0.8 * w * 0.3));
  }
}

TEST_CASE("slider: slider and elastic load keep their momentum and swing with the frequency of two masses") {
  MotionEffects<double> e;
  e.elastic_load = {0.8, 6.0, 0.0};  // of 2 kg
  Slider<double> slider = make_slider(e);
  CHECK(slider.mass() == Approx(1.2));
  slider.reset(0.0, 0.0);
  const double h = 1e-4;
  for (int k = 0; k < 100; ++k) slider.step(h, 40.0, {});  // 0.4 N s, then left alone
  std::vector<double> crossings;
  double mean = 0, largest = 0;
  const double drift = 0.4 / 2.0;
  double last = slider.velocity() - drift;
  const int steps = 100000;
  for (int k = 0; k < steps; ++k) {
    slider.step(h, 0.0, {});
    const double now = slider.velocity() - drift;
    if (last < 0 && now >= 0) crossings.push_back(h * (k + last / (last - now)));
    if (k >= steps - 10000) largest = std::max(largest, std::abs(now));
    mean += slider.velocity() / steps;
    last = now;
  }
  CHECK(mean == Approx(drift).epsilon(5e-3));
  const double frequency_Hz = static_cast<double>(crossings.size() - 1) / (crossings.back() - crossings.front());
  CHECK(frequency_Hz == Approx(6.0 * std::sqrt(2.0 / 1.2)).epsilon(1e-4));
  // The pulse is short beside a period: the swing starts with what the pulse gave the slider beyond the drift, and ten
  // seconds later the coupling has neither fed nor eaten it.
  CHECK(largest == Approx(0.4 / 1.2 - drift).epsilon(0.03));
}

TEST_CASE("slider: a periodic force moves it as its law says") {
  MotionEffects<double> e;
  e.periodic_force = {3.0, 7.0, 0.5};
  Slider<double> slider = make_slider(e);
  slider.reset(0.0, 0.0);
  const double w = 2 * M_PI * 7.0, h = 1e-5;
  for (int k = 0; k < 50000; ++k) slider.step(h, 0.0, {});
  // m v = integral of A sin(w t + phase).
  CHECK(slider.velocity() == Approx(3.0 / 2.0 / w * (std::cos(0.5) - std::cos(w * 0.5 + 0.5))).epsilon(1e-3));
}

TEST_CASE("slider: couplings stay bounded at any stiffness and step, and momentum is kept") {
  const double mass_kg = GENERATE(0.2, 1.0, 1.8), frequency_Hz = GENERATE(30.0, 150.0, 500.0),
               damping_ratio = GENERATE(0.0, 0.1, 5.0);
  const bool is_loose = GENERATE(false, true);
  CAPTURE(mass_kg, frequency_Hz, damping_ratio, is_loose);
  MotionEffects<double> e;
  if (is_loose) e.load_backlash = {mass_kg, 1e-3, frequency_Hz, damping_ratio};
  else e.elastic_load = {mass_kg, frequency_Hz, damping_ratio};
  Slider<double> slider = make_slider(e);
  slider.reset(0.0, 0.0);
  const double h = 5e-4;  // a coarse plant's
  for (int k = 0; k < 20; ++k) slider.step(h, 40.0, {});  // 0.4 N s
  double fastest = 0, mean = 0;
  for (int k = 0; k < 8000; ++k) {
    slider.step(h, 0.0, {});
    fastest = std::max(fastest, std::abs(slider.velocity()));
    if (k >= 4000) mean += slider.velocity() / 4000;
  }
  CHECK(fastest <= 1.02 * 0.4 / (2.0 - mass_kg));  // as if the slider had got it all
  CHECK(mean == Approx(0.2).epsilon(0.03));
}

TEST_CASE("slider: a loose load flies at even speed across its play, strikes, and the two keep their momentum") {
  MotionEffects<double> e;
  e.load_backlash = {0.8, 2e-3, 80.0, 0.2};  // of 2 kg
  Slider<double> slider = make_slider(e);
  slider.reset(0.0, 0.0);
  const double h = 1e-5;
  for (int k = 0; k < 100; ++k) slider.step(h, 12.0, {});  // 0.012 N s: half the play takes 0.1 s at 0.01 m/s
  const double pushed = slider.velocity();
  CHECK(pushed == Approx(0.012 / 1.2));
  int free_steps = 0;
  while (slider.velocity() == pushed && free_steps < 20000) slider.step(h, 0.0, {}), ++free_steps;
  CHECK(h * free_steps == Approx(1e-3 / pushed).epsilon(0.02));  // half the play, from the middle of it
  double mean = 0;
  const int steps = 400000;
  for (int k = 0; k < steps; ++k) {
    slider.step(h, 0.0, {});
    if (k >= steps / 2) mean += slider.velocity() / (steps - steps / 2);
  }
  CHECK(mean == Approx(0.012 / 2.0).epsilon(0.02));
}

TEST_CASE(
    "slider: dry friction with presliding is a spring before it slides, holds what has built up, and loses as much") {
  MotionEffects<double> e;
  e.coulomb_friction.force_N = 20.0;
  e.presliding.way_m = 1e-3;
  CHECK(e.presliding.carried(0.0, 1e-3) == Approx(1 - std::exp(-1.0)));
  CHECK(e.presliding.carried(1.0, -1e-3 * std::log(2.0)) == Approx(0.0).margin(1e-12));
  MotionEffects<double> bristles;
  bristles.elastic_friction = {20.0, 1e-3};
  Slider<double> slider = make_slider(e), dragged = make_slider(bristles);
  // The same motion as that of bristles: coulomb friction is all that there is.
  slider.reset(0.0, 0.0);
  dragged.reset(0.0, 0.0);
  for (int k = 0; k < 20000; ++k) {
    const double force_N = 25.0 * std::sin(4.0 * 1e-4 * k);
    slider.step(1e-4, force_N, {});
    dragged.step(1e-4, force_N, {});
  }
  CHECK(slider.position() == Approx(dragged.position()).epsilon(1e-9));
  CHECK(std::abs(slider.position()) > 5e-3);
  // A way of 0 is friction that slides at once.
  e.presliding.way_m = 0.0;
  Slider<double> plain = make_slider(e);
  plain.reset(0.0, 0.0);
  plain.step(1e-3, 19.9, {});
  CHECK(plain.velocity() == 0.0);
}
