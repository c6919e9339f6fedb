// Natural frequency and damping identified from pressures that exact theory and the simulated line make.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/line_with_chamber.hpp>
#include <unsupported/Eigen/FFT>

#include "acoustics/line_identification.hpp"
#include "acoustics/simulated_line.hpp"
#include "core/test_seed.hpp"

using namespace pneuservo;

namespace {

using Complex = std::complex<double>;

/// A swept sine about a mean pressure, with rest before and behind.
std::vector<double> sweep(double period_s, double highest_Hz, double amplitude_Pa, std::size_t rows) {
  std::vector<double> out(rows, 2.5e5);
  const double duration_s = 0.7 * static_cast<double>(rows) * period_s;
  const std::size_t begin = rows / 10;
  for (std::size_t i = 0; i < static_cast<std::size_t>(0.7 * static_cast<double>(rows)); ++i) {
    const double t = static_cast<double>(i) * period_s, share = t / duration_s;
    const double phase = 2.0 * std::numbers::pi * (1.0 * t + 0.5 * (highest_Hz - 1.0) * t * share);
    out[begin + i] += amplitude_Pa * std::sin(phase) * std::sin(std::numbers::pi * share);
  }
  return out;
}

/// What exact theory makes of the pressure at the other end.
std::vector<double> through(const LineAcoustics& line, const LineEnds& ends, const std::vector<double>& in_Pa,
                            double period_s) {
  const double rest_Pa = in_Pa.front();
  std::vector<double> changes(in_Pa.size());
  for (std::size_t i = 0; i < in_Pa.size(); ++i) changes[i] = in_Pa[i] - rest_Pa;
  std::vector<Complex> spectrum;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, changes);
  const std::size_t n = spectrum.size();
  for (std::size_t k = 1; k <= n / 2; ++k) {
    const Complex s(0.0, 2.0 * std::numbers::pi * static_cast<double>(k) / (static_cast<double>(n) * period_s));
    spectrum[k] *= pressure_transfer(line, ends, s);
    spectrum[n - k] = std::conj(spectrum[k]);
  }
  fft.inv(changes, spectrum);
  for (double& value : changes) value += rest_Pa;
  return changes;
}

void add_noise(Random& random, double rms_Pa, std::vector<double>& values) {
  for (double& value : values) value += rms_Pa * std::sqrt(12.0) * (random.uniform() - 0.5);
}

}  // namespace

TEST_CASE("twelve lines are identified within 1 % of their frequency and 5 % of their damping") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  Random random(seed);
  for (const double length_m : {0.5, 1.0, 2.0, 5.0})
    for (const double diameter_m : {0.004, 0.006, 0.008}) {
      LineEnds ends{0.0, random.uniform(2e-5, 3e-4)};
      const LineAcoustics line(length_m, diameter_m, 2.5e5, {}, LineLoss::frequency_dependent);
      const LineResonance true_one = first_resonance(line, ends);
      const double period_s = std::min(1e-3, 0.08 / true_one.natural_frequency_Hz);
      LinePressures p{sweep(period_s, 2.5 * true_one.natural_frequency_Hz, 5e3, 6000), {}, period_s};
      p.out_Pa = through(line, ends, p.in_Pa, period_s);
      add_noise(random, 40.0, p.in_Pa);
      add_noise(random, 40.0, p.out_Pa);
      // The owner errs by a tenth in length and volume.
      LineBelief belief{length_m * random.uniform(0.9, 1.1), diameter_m, {}, ends};
      belief.ends.volume_out_m3 *= random.uniform(0.9, 1.1);
      const LineIdentification found = identify_line(p, belief);
      CAPTURE(length_m, diameter_m, ends.volume_out_m3, found.loss_ratio.value, found.noise_Pa);
      CHECK(found.natural_frequency_Hz.value == Approx(true_one.natural_frequency_Hz).epsilon(0.01));
      CHECK(found.damping_ratio.value == Approx(true_one.damping_ratio).epsilon(0.05));
      CHECK(std::fabs(found.natural_frequency_Hz.value - true_one.natural_frequency_Hz) <
            5.0 * found.natural_frequency_Hz.standard_error);
      CHECK(std::fabs(found.damping_ratio.value - true_one.damping_ratio) < 5.0 * found.damping_ratio.standard_error);
      // The spread of as many normal numbers: two of each frequency.
      const double numbers =
          2.0 * (found.highest_Hz - found.lowest_Hz) * period_s * static_cast<double>(p.in_Pa.size());
      CAPTURE(numbers);
      CHECK(found.noise_Pa == Approx(40.0).epsilon(5.0 / std::sqrt(2.0 * numbers)));
    }
}

TEST_CASE("the chamber's wall leads from adiabatic to isothermal") {
  const LineAcoustics line(1.0, 0.004, 2.5e5, {}, LineLoss::none);
  const Complex s(0.0, 30.0);
  const Complex isothermal = chamber_admittance(line, {0.0, 1e-4}, s);
  CHECK(std::abs(chamber_admittance(line, {0.0, 1e-4, 1e9}, s) / isothermal - 1.0) < 1e-6);
  CHECK(std::abs(chamber_admittance(line, {0.0, 1e-4, 0.0}, s) * 1.4 / isothermal - 1.0) < 1e-12);
}

TEST_CASE("a simulated line with frequency-dependent losses is identified") {
  constexpr double period_s = 2e-4, volume_m3 = 5e-5, length_m = 2.0, diameter_m = 0.006;
  const std::vector<double> swept = sweep(period_s, 100.0, 1e3, 20000);
  const LinePressures p =
      simulated_pressures({length_m, diameter_m, volume_m3, 40}, period_s, swept.size(), [&](double t_s) {
        return swept[std::min(static_cast<std::size_t>(t_s / period_s + 1e-6), swept.size() - 1)];
      });
  const LineEnds ends{0.0, volume_m3};
  const LineResonance exact =
      first_resonance(LineAcoustics(length_m, diameter_m, 2.5e5, {}, LineLoss::frequency_dependent), ends);
  const LineIdentification found = identify_line(p, {length_m, diameter_m, {}, ends});
  CHECK(found.natural_frequency_Hz.value == Approx(exact.natural_frequency_Hz).epsilon(0.02));
  CHECK(found.damping_ratio.value == Approx(exact.damping_ratio).epsilon(0.15));
}

TEST_CASE("the port of a simulated line is one sub-step older than its chamber") {
  constexpr double period_s = 2e-4, length_m = 0.5, diameter_m = 0.004, volume_m3 = 1.92e-4, rest_Pa = 1.4e5;
  const AirParameters<double> air;
  LineParameters<double> parameters;
  parameters.length_m = length_m;
  parameters.diameter_m = diameter_m;
  LineWithChamber<double> side;
  side.configure(parameters, {1e-3, volume_m3, 1e9}, air, 16);
  LineEffects<double> effects;
  effects.frequency_dependent_losses.share = 1.0;
  side.line().set_effects(effects);
  side.reset(rest_Pa, air.temperature_K, 0.0);
  LinePressures p;
  p.period_s = period_s;
  const std::vector<double> swing = sweep(period_s, 330.0, 1.0, 20000);
  for (std::size_t k = 0; k + 1 < swing.size(); ++k) {
    p.in_Pa.push_back(side.port_pressure());
    p.out_Pa.push_back(side.chamber().pressure());
    const int steps = side.begin_period(period_s);
    p.in_age_s = period_s / steps;
    for (int i = 0; i < steps; ++i) {
      // Two edges of a valve that is nearly shut; steps of its area would ring at what the rows cannot tell.
      const double area_m2 = 1.5e-9 * (swing[k] - 2.5e5 + (swing[k + 1] - swing[k]) * (i + 0.5) / steps);
      side.step_valve({std::max(area_m2, 0.0), std::max(-area_m2, 0.0), 2.5e5, 0.4}, 0.0);
    }
  }
  const LineBelief belief{length_m, diameter_m, air, {0.0, volume_m3}};
  CHECK(identify_line(p, belief).length_m.value == Approx(length_m).epsilon(0.01));
  p.in_age_s = 0.0;
  CHECK(identify_line(p, belief).length_m.value < 0.96 * length_m);
}

TEST_CASE("a vented line is identified from small swings, and not from bars") {
  constexpr double period_s = 1e-3, length_m = 4.0, diameter_m = 0.0034, volume_m3 = 3e-7, rest_Pa = 1.1e5;
  const auto found = [&](double swing_Pa) {
    // A valve that vents with a time constant of 20 ms from 30 ms on, as of the tubes in config/machines/tube.yaml.
    const LinePressures p = simulated_pressures({length_m, diameter_m, volume_m3, 8}, period_s, 600, [&](double t_s) {
      return rest_Pa + swing_Pa * std::exp(-std::max(t_s - 0.03, 0.0) / 0.02);
    });
    return identify_line(p, {length_m, diameter_m, {}, {0.0, volume_m3}});
  };
  const LineIdentification small = found(2e3), large = found(2e5);
  CHECK(small.length_m.value == Approx(length_m).epsilon(0.03));
  CHECK(std::fabs(large.length_m.value / length_m - 1.0) > 0.1);
  CHECK(large.noise_Pa > 300.0 * small.noise_Pa);  // a hundred times the swing leaves more than a hundred times as much
}

TEST_CASE("pressures that say nothing are refused") {
  const LineBelief belief{1.0, 0.004, {}, {0.0, 1e-4}};
  LinePressures p{std::vector<double>(1000, 2e5), std::vector<double>(1000, 2e5), 1e-3};
  CHECK_THROWS_WITH(identify_line(p, belief), "a pressure does not move");
  p.out_Pa.pop_back();
  CHECK_THROWS_WITH(identify_line(p, belief), Catch::Contains("different numbers of rows"));
  CHECK_THROWS_WITH(identify_line({{1.0, 2.0}, {1.0, 2.0}, 1e-3}, belief), Catch::Contains("fewer than 64 rows"));
}
