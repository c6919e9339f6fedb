// The cushion's stop law: where it acts, speed over way, and that a hard one stops and never throws back.
#include <catch2/catch.hpp>

#include <pneuservo/elements/cushion.hpp>
#include <pneuservo/elements/slider.hpp>

using namespace pneuservo;

namespace {

/// A slider without friction that runs towards an end stop at x = 0.5 m.
struct Running {
  CushionParameters<double> cushion;
  double h;
  Slider<double> slider;
  Running(const CushionParameters<double>& c, double mass_kg, double speed_mps, double step_s) : cushion(c), h(step_s) {
    SliderParameters<double> parameters;
    parameters.mass_kg = mass_kg;
    parameters.viscous_friction_Ns_per_m = 0.0;
    slider.configure(parameters, {}, 1.0, 0.0);
    slider.reset(0.5 - cushion.length_m, speed_mps);
  }
  double way_m() const { return slider.position() - (0.5 - cushion.length_m); }
  void step() {
    slider.step(h, -cushion_force(cushion, 0.5 - slider.position(), slider.velocity(), slider.mass(), h), {});
  }
};

}  // namespace

TEST_CASE("a cushion acts within its length, towards the end alone, in proportion to the speed") {
  const CushionParameters<double> cushion{0.02, 300.0};
  CHECK(cushion_force(cushion, 0.0199, 0.5, 2.0, 1e-4) == 150.0);
  CHECK(cushion_force(cushion, 0.0201, 0.5, 2.0, 1e-4) == 0.0);
  CHECK(cushion_force(cushion, 0.0199, -0.5, 2.0, 1e-4) == 0.0);
  CHECK(cushion_force(CushionParameters<double>{}, 0.0, 0.5, 2.0, 1e-4) == 0.0);
}

TEST_CASE("in a cushion the speed falls linearly with the way and ends after m v / d") {
  const double mass = 2.0, speed = 0.4, damping = 100.0;
  Running run({0.02, damping}, mass, speed, 1e-6);
  run.slider.reset(0.48 + 1e-12, speed);
  while (run.slider.velocity() > 1e-3 * speed) {
    run.step();
    REQUIRE(run.slider.velocity() == Approx(speed - damping / mass * run.way_m()).margin(1e-4 * speed));
  }
  CHECK(run.way_m() == Approx(mass * speed / damping).epsilon(2e-3));  // of 8 mm, 1/1000 is still to go
}

TEST_CASE("a cushion harder than a step can follow stops the slider within it and never throws it back") {
  Running run({0.02, 1e6}, 2.0, 0.4, 2e-4);
  run.slider.reset(0.49, 0.4);
  run.step();
  CHECK(run.slider.velocity() == Approx(0.0).margin(1e-15));
  const double stopped = run.slider.position();
  for (int i = 0; i < 10; ++i) run.step();
  CHECK(run.slider.position() == Approx(stopped).margin(1e-15));
}
