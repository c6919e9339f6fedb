// The force balance against sliders whose drive force is known exactly, and its kernels against polynomials.
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include <pneuservo/elements/slider.hpp>

#include "config/rig_parameters.hpp"
#include "diagnosis/residuals/force_balance.hpp"

using namespace pneuservo;

namespace {

constexpr double period_s = 0.001;

Rig slider_rig() {
  Rig rig;
  rig.axis.slider.mass_kg = 2.0;
  rig.axis.slider.payload_kg = 0.5;
  rig.axis.slider.viscous_friction_Ns_per_m = 40.0;
  return rig;
}

struct Record {
  std::vector<double> position_m, force_N, gauge_Pa;
};

/// A slider that follows a sine with rests, driven by a stiff controller; forces are smooth within a millisecond.
Record recorded(const Rig& rig, double duration_s = 6.0) {
  Slider<double> slider;
  slider.configure(rig.axis.slider, rig.axis.effects.motion, 1.0, 0.0);
  const int substeps = 50;
  double force = 0;
  Record record;
  const int rows = static_cast<int>(duration_s / period_s);
  for (int row = 0; row < rows; ++row) {
    record.position_m.push_back(slider.position());
    const double gauge = 4e5 + 2e5 * std::sin(2.0 * row * period_s);
    record.gauge_Pa.push_back(gauge);
    record.force_N.push_back(force);
    for (int sub = 0; sub < substeps; ++sub) {
      const double t = (row + static_cast<double>(sub) / substeps) * period_s;
      const double phase = std::fmod(t, 2.0);
      const double wanted = phase < 1.5 ? 0.04 * (1 - std::cos(2 * M_PI * phase / 1.5)) : 0.0;
      const double asked = 4e4 * (wanted - slider.position()) - 500 * slider.velocity();
      force += (asked - force) * (period_s / substeps) / 0.004;
      slider.step(period_s / substeps, force, {gauge});
    }
  }
  return record;
}

double rms_residual(const ForceBalance& balance, const Record& record, const Rig& rig) {
  const std::vector<double> drive = balance.kernel().apply(record.force_N, 0);
  const std::vector<double> needed = balance.required_force(rig, drive, record.gauge_Pa);
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < needed.size(); ++i)
    if (balance.usable()[i]) {
      sum += (needed[i] - drive[i]) * (needed[i] - drive[i]);
      ++count;
    }
  return std::sqrt(sum / count);
}

}  // namespace

TEST_CASE("Gaussian kernels are exact on polynomials and have no lag") {
  const GaussianKernel kernel(0.005, period_s);
  std::vector<double> line, parabola, cubic;
  for (int i = 0; i < 200; ++i) {
    const double t = i * period_s;
    line.push_back(2 + 3 * t);
    parabola.push_back(1 + t + 5 * t * t);
    cubic.push_back(t * t * t);
  }
  const double t = 100 * period_s;
  CHECK(kernel.apply(line, 0)[100] == Approx(2 + 3 * t).epsilon(1e-12));
  CHECK(kernel.apply(line, 1)[100] == Approx(3).epsilon(1e-12));
  CHECK(kernel.apply(parabola, 1)[100] == Approx(1 + 10 * t).epsilon(1e-10));
  CHECK(kernel.apply(parabola, 2)[100] == Approx(10).epsilon(1e-9));
  CHECK(kernel.apply(cubic, 2)[100] == Approx(6 * t).epsilon(1e-9));
  CHECK(kernel.apply(cubic, 3)[100] == Approx(6).epsilon(1e-7));
}

TEST_CASE("the gain of white noise is that of the kernel") {
  const GaussianKernel kernel(0.005, period_s);
  // A Gaussian of sigma n samples leaves 1/sqrt(2 sqrt(pi) n) of white noise.
  CHECK(kernel.noise_gain(0, 1) == Approx(1 / std::sqrt(2 * std::sqrt(M_PI) * 5)).epsilon(1e-4));
  // Its second derivative sqrt(3/(8 sqrt(pi) n^5))/T^2.
  CHECK(kernel.noise_gain(2, 1) == Approx(std::sqrt(3 / (8 * std::sqrt(M_PI) * 3125.0)) * 1e6).epsilon(1e-3));
  CHECK(kernel.noise_gain(0, 10) < kernel.noise_gain(0, 1));
}

TEST_CASE("every law on the slider balances its own motion and no other") {
  struct Law {
    std::string name;
    std::function<void(MotionEffects<double>&)> set;
  };
  const Law law = GENERATE(values<Law>({
      {"nothing", [](auto&) {}},
      {"coulomb", [](auto& e) { e.coulomb_friction.force_N = 6; }},
      {"stribeck", [](auto& e) { e.stribeck_friction = {5, 0.03, 4}; }},
      {"direction", [](auto& e) { e.direction_dependent_friction = {3, 9}; }},
      {"pressure", [](auto& e) { e.pressure_dependent_friction.force_per_pressure_N_per_Pa = 3e-5; }},
      {"zone", [](auto& e) { e.friction_zone = {12, 0.04, 0.01}; }},
      {"drag", [](auto& e) { e.quadratic_drag.coefficient_Ns2_per_m2 = 80; }},
      {"viscous by direction", [](auto& e) { e.direction_dependent_viscous_friction = {30, -20}; }},
      {"viscous", [](auto& e) { e.viscous_friction.coefficient_Ns_per_m = 30; }},
      {"built up along the way", [](auto& e) { e.elastic_friction = {8, 3e-3}; }},
      {"weight on a lever", [](auto& e) { e.gravity_load = {90, 12}; }},
      {"constant", [](auto& e) { e.constant_force.force_N = -7; }},
      {"spring", [](auto& e) { e.spring_load = {120, 0.02}; }},
      {"elastic load", [](auto& e) { e.elastic_load = {1.5, 6, 0.05}; }},
  }));
  INFO(law.name);
  Rig rig = slider_rig();
  law.set(rig.axis.effects.motion);
  const Record record = recorded(rig);
  const ForceBalance balance(record.position_m, period_s, {});
  const double own = rms_residual(balance, record, rig);
  CHECK(own < 0.35);
  if (law.name != "nothing") {
    const double without = rms_residual(balance, record, slider_rig());
    CHECK(without > 6 * own);
  }
}

TEST_CASE("dry friction that builds up before it slides balances its own motion better than friction that jumps") {
  Rig sheared = slider_rig();
  sheared.axis.effects.motion.coulomb_friction.force_N = 8;
  Rig jumping = sheared;
  sheared.axis.effects.motion.presliding.way_m = 1e-3;
  const Record record = recorded(sheared), other = recorded(jumping);
  const ForceBalance balance(record.position_m, period_s, {}), others(other.position_m, period_s, {});
  const double own = rms_residual(balance, record, sheared);
  CHECK(own < 0.35);
  CHECK(rms_residual(balance, record, jumping) > 3 * own);
  CHECK(rms_residual(others, other, jumping) < 0.35);
  // A way that shrinks to nothing is friction that jumps: no step on the way there.
  sheared.axis.effects.motion.presliding.way_m = 1e-9;
  CHECK(rms_residual(balance, record, sheared) == Approx(rms_residual(balance, record, jumping)).epsilon(1e-3));
}

TEST_CASE("what follows a gap asks for the same force of a swinging load as the whole recording does") {
  Rig rig = slider_rig();
  rig.axis.effects.motion.elastic_load = {1.0, 11, 0.05};
  const Record whole = recorded(rig);
  const auto first = static_cast<std::size_t>(GENERATE(200, 450, 2300));  // the carrier is moving there
  CAPTURE(first);
  const auto behind = [&](const std::vector<double>& column) {
    return std::vector<double>(column.begin() + static_cast<std::ptrdiff_t>(first), column.end());
  };
  const std::vector<double> position_m = behind(whole.position_m), gauge_Pa = behind(whole.gauge_Pa);
  const ForceBalance all(whole.position_m, period_s, {}), part(position_m, period_s, {});
  const std::vector<double> drive = all.kernel().apply(whole.force_N, 0),
                            drive_behind = part.kernel().apply(behind(whole.force_N), 0);
  const std::vector<double> needed = all.required_force(rig, drive, whole.gauge_Pa),
                            needed_behind = part.required_force(rig, drive_behind, gauge_Pa);
  double apart_N = 0;
  for (std::size_t i = 0; i < position_m.size(); ++i)
    if (part.usable()[i] && all.usable()[i + first])
      apart_N = std::max(apart_N, std::abs(needed_behind[i] - needed[i + first]));
  CHECK(apart_N < 0.3);  // carried from the very edge: 1.4 to 1.9 N
}

TEST_CASE("a load that swings where a recording begins is carried on from there, and no swing is found without one") {
  Rig rig = slider_rig();
  rig.axis.effects.motion.elastic_load = {1.5, 6, 0.02};
  Record record = recorded(rig);
  const auto rows = static_cast<std::ptrdiff_t>(GENERATE(300, 700, 2900));
  INFO(rows << " rows are missing at the beginning");
  for (std::vector<double>* column : {&record.position_m, &record.force_N, &record.gauge_Pa})
    column->erase(column->begin(), column->begin() + rows);
  const ForceBalance balance(record.position_m, period_s, {});
  const double own = rms_residual(balance, record, rig);
  CHECK(own < 0.35);
  Rig slower = rig;
  slower.axis.effects.motion.elastic_load.natural_frequency_Hz = 5;
  CHECK(rms_residual(balance, record, slower) > 2.5 * own);
  // A mass too small to swing so far does not.
  Rig small = slider_rig();
  const double without = rms_residual(balance, record, small);
  small.axis.effects.motion.elastic_load = {1e-3, 6, 0.02};
  CHECK(rms_residual(balance, record, small) > 0.99 * without);
}

TEST_CASE("a slider that is held never reads as missing friction, whatever the force below breakaway") {
  Rig rig = slider_rig();
  rig.axis.effects.motion.coulomb_friction.force_N = 10;
  Record record;
  for (int i = 0; i < 2000; ++i) {
    record.position_m.push_back(0.02);
    record.force_N.push_back(8 * std::sin(0.003 * i));
    record.gauge_Pa.push_back(0);
  }
  const ForceBalance balance(record.position_m, period_s, {});
  CHECK(rms_residual(balance, record, rig) < 0.01);
  rig.axis.effects.motion.coulomb_friction.force_N = 4;  // cannot hold 8 N
  CHECK(rms_residual(balance, record, rig) > 1.5);
}

TEST_CASE("a turn in which friction holds for a while, or hardly, is balanced by the slider that made it") {
  // The slider stands for 114, 53, 7 and 0.8 ms in each turn; at 30 N it does not.
  Rig rig = slider_rig();
  rig.axis.effects.motion.coulomb_friction.force_N = 4;
  const double amplitude_N = GENERATE(8.0, 12.0, 20.0, 22.0, 30.0), noise_m = GENERATE(0.0, 5e-6);
  CAPTURE(amplitude_N, noise_m);
  Slider<double> slider;
  slider.configure(rig.axis.slider, rig.axis.effects.motion, 1.0, 0.0);
  Record record;
  constexpr int substeps = 50;
  for (int row = 0; row < 6000; ++row) {
    const double step_m = noise_m * std::sqrt(12.0);
    record.position_m.push_back(step_m > 0 ? step_m * std::round(slider.position() / step_m) : slider.position());
    const auto force_at = [&](double t_s) { return amplitude_N * std::sin(2 * M_PI * t_s); };
    record.force_N.push_back(force_at(row * period_s));
    record.gauge_Pa.push_back(0);
    for (int sub = 0; sub < substeps; ++sub)
      slider.step(period_s / substeps, force_at((row + (sub + 0.5) / substeps) * period_s), {});
  }
  const ForceBalance balance(record.position_m, period_s, {noise_m * std::sqrt(12.0), 0});
  const double noise_N = balance.force_noise(rig, balance.reading_noise(1)), own = rms_residual(balance, record, rig);
  CHECK(own < 0.03 + 1.1 * noise_N);  // friction put at the turn of the smoothed speed misses 0.08 to 0.28 N
  for (const double other_N : {3.6, 4.4}) {
    rig.axis.effects.motion.coulomb_friction.force_N = other_N;
    CHECK(rms_residual(balance, record, rig) > own + 0.05);
  }
}

TEST_CASE("the position sensor's gain and lag are undone before the balance") {
  const Rig truth = slider_rig();
  Record record = recorded(truth);
  const double gain = 1.06, lag_s = 0.008;
  std::vector<double> read(record.position_m.size());
  double state = record.position_m[0];
  for (std::size_t i = 0; i < read.size(); ++i) {
    const int inner = 100;
    for (int k = 0; k < inner && i > 0; ++k) {
      const double at =
          record.position_m[i - 1] + (record.position_m[i] - record.position_m[i - 1]) * (k + 0.5) / inner;
      state += (at - state) * (period_s / inner) / lag_s;
    }
    read[i] = gain * state;
  }
  record.position_m = read;
  const ForceBalance balance(record.position_m, period_s, {});
  Rig supposed = truth;
  const double without = rms_residual(balance, record, supposed);
  set_parameter(supposed, "effects.sensor_gain:x.gain", gain);
  set_parameter(supposed, "effects.sensor_lag:x.time_constant_s", lag_s);
  CHECK(rms_residual(balance, record, supposed) < 0.05 * without);
}

TEST_CASE("ends, missing positions and end stops are left out") {
  std::vector<double> position(1000, 0.0);
  position[500] = std::nan("");
  for (int i = 800; i < 880; ++i) position[static_cast<std::size_t>(i)] = 0.1499;
  const ForceBalance balance(position, period_s, {});
  CHECK_FALSE(balance.usable()[10]);
  CHECK_FALSE(balance.usable()[495]);
  CHECK(balance.usable()[300]);
  CHECK_FALSE(balance.usable()[995]);
  const std::vector<char> stops = balance.near_end_stop(0.3);
  CHECK(stops[790]);
  CHECK_FALSE(stops[700]);
}

TEST_CASE("the force's noise is that of the slider that is supposed: a coupled load does not follow the encoder") {
  Rig rigid = slider_rig();
  rigid.axis.slider.viscous_friction_Ns_per_m = 0.0;
  const double noise_m = 15e-6;
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> error(-std::sqrt(3.0) * noise_m, std::sqrt(3.0) * noise_m);
  std::vector<double> true_m, read_m;
  for (int i = 0; i < 20000; ++i) {
    true_m.push_back(0.05 * std::sin(2 * M_PI * 0.7 * i * period_s));
    read_m.push_back(true_m.back() + error(generator));
  }
  const ForceBalance read(read_m, period_s, {0, noise_m}), exact(true_m, period_s, {0, noise_m});
  const std::size_t count = 10;
  const auto seen_noise_N = [&](const Rig& rig) {
    const std::vector<double> nothing(read_m.size(), 0.0);
    const std::vector<double> with = read.required_force(rig, nothing, {}),
                              without = exact.required_force(rig, nothing, {});
    double square = 0, found = 0;
    for (std::size_t first = 500; first + count < with.size() - 500; first += count) {
      double mean = 0;
      for (std::size_t i = first; i < first + count; ++i) mean += (with[i] - without[i]) / static_cast<double>(count);
      square += mean * mean, ++found;
    }
    return std::sqrt(square / found);
  };
  Rig elastic = rigid, loose = rigid, lagging = rigid;
  elastic.axis.effects.motion.elastic_load = {1.5, 11.0, 0.1};
  loose.axis.effects.motion.load_backlash = {1.5, 1e-3, 60.0, 0.3};
  lagging.sensor_effects[Signal::x].sensor_lag.time_constant_s = 0.01;
  const ReadingNoise noise = read.reading_noise(count);
  const double of_rigid_N = read.force_noise(rigid, noise);
  for (const Rig* rig : {&rigid, &elastic, &loose, &lagging})
    CHECK(read.force_noise(*rig, noise) == Approx(seen_noise_N(*rig)).epsilon(0.1));
  // 1.0 of 2.5 kg is left for the noise to shake.
  CHECK(read.force_noise(elastic, noise) == Approx(0.4 * of_rigid_N).epsilon(0.15));
  CHECK(read.force_noise(lagging, noise) > 1.5 * of_rigid_N);
}

TEST_CASE("an encoder's steps are noise in fast motion, a wave in slow motion and nothing at rest") {
  const double step_m = 50e-6, slow_mps = 1.5e-3, fast_mps = 0.2137;
  std::vector<double> true_m, read_m;
  for (int i = 0; i < 12000; ++i) {
    const double v = i < 4000 ? slow_mps : i < 8000 ? fast_mps : 0.0;
    true_m.push_back((true_m.empty() ? 0.0 : true_m.back()) + v * period_s);
    read_m.push_back(step_m * std::round(true_m.back() / step_m));
  }
  const SensorResolution steps{step_m, 0};
  const ForceBalance read(read_m, period_s, steps), exact(true_m, period_s, steps);
  const std::size_t count = 10;
  const ReadingNoise noise = read.reading_noise(count);
  const std::vector<double> nothing(read_m.size(), 0.0);
  Rig rig = slider_rig();
  rig.axis.slider.viscous_friction_Ns_per_m = 0.0;
  const double mass_kg = rig.axis.slider.mass_kg + rig.axis.slider.payload_kg;
  const std::vector<double> with = read.required_force(rig, nothing, {}),
                            without = exact.required_force(rig, nothing, {});
  const auto over = [&](std::size_t from, std::size_t end) {
    double seen = 0, told = 0, found = 0;
    for (std::size_t first = from; first + count < end; first += count, ++found) {
      double mean = 0;
      for (std::size_t i = first; i < first + count; ++i) mean += (with[i] - without[i]) / static_cast<double>(count);
      seen += mean * mean, told += std::pow(mass_kg * noise.acceleration[first], 2);
    }
    return std::array{std::sqrt(seen / found), std::sqrt(told / found)};
  };
  const auto slow = over(200, 3800), fast = over(4200, 7800), rest = over(8200, 11800);
  CHECK(slow[1] == Approx(slow[0]).epsilon(0.2));
  CHECK(fast[1] == Approx(fast[0]).epsilon(0.3));
  CHECK(slow[0] > 3 * fast[0]);
  CHECK(rest[0] < 1e-6);
  CHECK(rest[1] < 1e-6);
}

TEST_CASE("a load that swallows the encoder's noise gains nothing by it, and keeps what it explains") {
  ReadingNoise of_owner;
  of_owner.owner_N = 1;
  of_owner.row_share.assign(100, 0.4);
  std::vector<ResidualRow> rows(100);
  const auto squares = [&](double residual, double followed) {
    const std::vector<double> all(100, residual);
    return 100 * std::pow(residual * of_owner.factor(all, rows, std::sqrt(followed)), 2);
  };
  const double noise = std::sqrt(0.4);
  CHECK(squares(noise, 1.0) == Approx(40));
  CHECK(squares(0.5 * noise, 0.25) == Approx(40));
  CHECK(squares(3.0, 1.0) - squares(2.0, 0.25) == Approx(500 - 30));
  CHECK(squares(noise, 4.0) == Approx(40));  // more noise excuses nothing
  // What no fit sees decides nothing.
  for (std::size_t i = 50; i < rows.size(); ++i) rows[i].held_out = true;
  std::vector<double> all(100, 0.5 * noise);
  const double factor = of_owner.factor(all, rows, 0.5);
  std::fill(all.begin() + 50, all.end(), 30.0);
  CHECK(of_owner.factor(all, rows, 0.5) == factor);
  CHECK(std::pow(factor, 2) == Approx(4));
}
