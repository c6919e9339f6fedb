// Memory of the layer at a pipe's wall: weights against the exact theory, the recursion against the integral, rest.
#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <limits>

#include <pneuservo/elements/line_with_chamber.hpp>
#include <pneuservo/elements/wall_memory.hpp>

#include "acoustics/line_acoustics.hpp"

using namespace pneuservo;

namespace {
using Layer = WallLayer<double>;
using Complex = std::complex<double>;

/// W(s) of the theory of laminar layers, s in nu/R^2: the loss 8 + 4 W s is s/(1 - f) - s, f the mean of the layer.
Complex exact_weight(Complex s) {
  const Complex z = std::sqrt(s), layer = 2.0 * bessel_i1_over_i0(z) / z;
  return (s * (1.0 / (1.0 - layer) - 1.0) - 8.0) / (4.0 * s);
}
Complex fitted_weight(Complex s) {
  Complex sum = Layer::inertia;
  for (std::size_t i = 0; i < Layer::terms; ++i) sum += Layer::weight[i] / (s + Layer::decay[i]);
  return sum;
}

/// 5 m of 6.1 mm before a chamber, with all of the memory.
LineWithChamber<double> remembering_side() {
  LineWithChamber<double> side;
  LineParameters<double> parameters;
  parameters.length_m = 5;
  parameters.diameter_m = 6.1e-3;
  side.configure(parameters, {1.257e-3, 2e-5, 50}, {}, 10);
  LineEffects<double> effects;
  effects.frequency_dependent_losses.share = 1;
  side.line().set_effects(effects);
  return side;
}
}  // namespace

TEST_CASE("wall memory: the weights are those of laminar layers from slow to fast") {
  double worst_slow = 0, worst = 0;
  for (double w = 0.3; w < 1e4; w *= 1.05) {
    const Complex exact = exact_weight({0, w});
    const double error = std::abs(fitted_weight({0, w}) - exact) / std::abs(exact);
    worst = std::max(worst, error);
    if (w < 2e3) worst_slow = std::max(worst_slow, error);
  }
  CHECK(worst_slow < 0.0051);
  CHECK(worst < 0.0205);
}

TEST_CASE("wall memory: a change held for long is forgotten, one that goes on is answered by the sum of m/n") {
  const double tau = 1e-3;
  const Layer layer(tau, 0.0);
  WallMemory<double> memory;
  double sum = 0;
  for (int k = 0; k < 4000; ++k) {  // du/dt = 1 per tau
    sum = memory.kept() + layer.answer * tau;
    memory.advance(layer, tau);
  }
  CHECK(sum == Approx(fitted_weight(0).real()).epsilon(1e-6));
  for (int k = 0; k < 4000; ++k) {
    sum = memory.kept();
    memory.advance(layer, 0);
  }
  CHECK(std::abs(sum) < 1e-12);
}

TEST_CASE("wall memory: what it remembers of a jump is the weighting function, shortened where turbulence renews") {
  const double tau = 1e-5;
  for (const double renewal : {0.0, 500.0}) {
    const Layer layer(tau, renewal);
    WallMemory<double> memory;
    memory.advance(layer, 1);  // spread over one step
    double sum = 0;
    for (int k = 1; k <= 1000; ++k) {
      sum = memory.kept();
      memory.advance(layer, 0);
    }
    double expected = 0;
    for (std::size_t i = 0; i < Layer::terms; ++i)
      expected += Layer::weight[i] * std::exp(-(Layer::decay[i] + renewal) * 1000 * tau);
    CHECK(sum == Approx(expected).epsilon(0.01));
  }
}

TEST_CASE("wall memory: no step is too long for it, and what is no number leaves no trace") {
  WallMemory<double> memory;
  Layer before(1.0, 0.0);
  for (int k = 0; k < 200; ++k) {
    const Layer layer(k % 2 == 0 ? 1e3 : 1e-8, 0.0);
    memory.change_layer(before, layer);
    CHECK(layer.answer >= 0);
    CHECK(std::abs(memory.kept()) < 1e5);
    memory.advance(layer, 1.0);
    before = layer;
  }
  memory.advance(before, std::numeric_limits<double>::quiet_NaN());
  memory.mend();
  CHECK(memory.kept() == 0);
  memory.advance(before, 1.0);
  CHECK(memory.kept() > 0);
}

TEST_CASE("wall memory: steps of another length remember the same") {
  const Layer coarse(1e-3, 0.0), fine(2.5e-4, 0.0);
  WallMemory<double> once, changed;
  for (int k = 0; k < 300; ++k) {
    once.advance(coarse, 1e-3 * std::sin(0.1 * k));
    changed.advance(coarse, 1e-3 * std::sin(0.1 * k));
  }
  changed.change_layer(coarse, fine);
  for (int k = 0; k < 100; ++k) {
    once.advance(coarse, 0);
    for (int part = 0; part < 4; ++part) changed.advance(fine, 0);
  }
  CHECK(changed.kept() == Approx(once.kept()).epsilon(0.02));
}

TEST_CASE("wall memory: a line with it finds back from a velocity that is no number") {
  LineWithChamber<double> side = remembering_side(), beside = remembering_side();
  side.reset(470e3, 293, 0.15);
  beside.reset(470e3, 293, 0.15);
  side.begin_period(1e-3);
  side.line().set_face_velocity(5, std::numeric_limits<double>::quiet_NaN());
  double most = 0, error = 0;
  for (int k = 0; k < 4000; ++k) {
    const double port_Pa = 470e3 + 20e3 * std::sin(0.05 * k);
    for (LineWithChamber<double>* one : {&side, &beside}) one->begin_period(1e-3);
    const double flow = side.step_prescribed(port_Pa, 0.15).port_mass_flow_kgps,
                 expected = beside.step_prescribed(port_Pa, 0.15).port_mass_flow_kgps;
    if (k < 3000) continue;
    most = std::max(most, std::abs(expected));
    error = std::max(error, std::abs(flow - expected));
  }
  CHECK(error < 1e-3 * most);
}

TEST_CASE("wall memory: a line at rest stays at rest, and one that is set to rest has forgotten") {
  LineWithChamber<double> side = remembering_side();
  const auto flow_at_rest = [&] {
    double most = 0;
    for (int k = 0; k < 100; ++k) {
      const int n = side.begin_period(1e-3);
      for (int i = 0; i < n; ++i)
        most = std::max(most, std::abs(side.step_prescribed(470e3, 0.15).port_mass_flow_kgps));
    }
    return most;
  };
  side.reset(470e3, 293, 0.15);
  CHECK(flow_at_rest() < 1e-15);
  for (int k = 0; k < 300; ++k) {
    side.begin_period(1e-3);
    side.step_prescribed(k % 20 < 10 ? 600e3 : 400e3, 0.15);
  }
  side.reset(470e3, 293, 0.15);
  CHECK(flow_at_rest() < 1e-15);
}
