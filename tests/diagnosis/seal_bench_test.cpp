// Diagnosis of a seal on a test bench: friction that rises with pressure, alone and beside a constant part, with
// remainders that have no name.
#include <algorithm>
#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "config/read_rig.hpp"
#include "core/run_length.hpp"
#include "diagnosis/diagnose.hpp"

using namespace pneuservo;

namespace {

constexpr const char* bench = R"(format: pneuservo-rig/1
name: seal
rig: driven_axis
period_s: 0.01
slider: {mass_kg: 0.3, viscous_friction_Ns_per_m: 0.0, stroke_m: 0.2, force_max_N: 500.0}
cylinder: {area_2_m2: 5.0e-4}
sensors:
  position: {quantum_m: 4.0e-6, noise_m: 1.0e-5}
  force: {quantum_N: 0.015, noise_N: 0.05}
  chamber_pressure: {quantum_Pa: 100.0, noise_Pa: 250.0}
controller: {kind: pd_force, position_gain_N_per_m: 1.0, velocity_gain_Ns_per_m: 1.0, velocity_filter_s: 0.0}
reference: {kind: cruise, start_m: 0.0, end_m: 0.041, speed_mps: 0.01, ramp_s: 0.1}
tolerances: {cylinder.area_2_m2: 0.01}
)";

constexpr double atmosphere_Pa = 101325, speed_mps = 0.01, way_m = 0.04;

struct Seal {
  double constant_N = 0;
  double rising_N_per_Pa = 0;  ///< with the gauge pressure of the one chamber
};

/// Force beside the seal's: an Ornstein-Uhlenbeck process, and a sine.
struct Remainder {
  double wandering_N = 0, memory_s = 0.5, shaking_N = 0, frequency_Hz = 20;
};

/// There and back four times at one pressure.
Recording run_at(double gauge_Pa, const Seal& seal, const Remainder& remainder, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Recording out;
  out.path = "made here";
  out.period_s = 0.01;
  out.names = {"t_s", "x_m", "F_N", "p2_chamber_Pa"};
  out.values.resize(4);
  double wandering_N = remainder.wandering_N * normal(generator);
  const double kept = std::exp(-out.period_s / remainder.memory_s), lap_s = 2 * way_m / speed_mps;
  for (std::size_t row = 0; row < 3200; ++row) {
    const double time_s = out.period_s * static_cast<double>(row), at_s = std::fmod(time_s, lap_s);
    const bool is_inwards = at_s < lap_s / 2;
    const double pressure_Pa = gauge_Pa * (1 + 0.02 * std::sin(2 * M_PI * time_s / 3));
    const double friction_N = seal.constant_N + seal.rising_N_per_Pa * pressure_Pa;
    wandering_N = kept * wandering_N + std::sqrt(1 - kept * kept) * remainder.wandering_N * normal(generator);
    const double shaking_N = remainder.shaking_N * std::sin(2 * M_PI * remainder.frequency_Hz * time_s);
    out.values[0].push_back(time_s);
    out.values[1].push_back(speed_mps * (is_inwards ? at_s : lap_s - at_s) + 1e-5 * normal(generator));
    out.values[2].push_back(5.0e-4 * pressure_Pa + (is_inwards ? friction_N : -friction_N) + wandering_N + shaking_N +
                            0.05 * normal(generator));
    out.values[3].push_back(pressure_Pa + atmosphere_Pa + 250 * normal(generator));
  }
  out.line_numbers.resize(out.values.front().size());
  return out;
}

Diagnosis diagnosis_of(const Seal& seal, const Remainder& remainder, unsigned seed) {
  return diagnose(parse_rig(bench, "seal"),
                  {run_at(1e5, seal, remainder, seed), run_at(3e5, seal, remainder, seed + 100),
                   run_at(7e5, seal, remainder, seed + 200)});
}

std::vector<std::string> names_of(const Diagnosis& found) {
  std::vector<std::string> names;
  for (const DiagnosisAnswer& answer : found.answers) names.push_back(answer.effect);
  std::sort(names.begin(), names.end());
  return names;
}

const std::vector<Remainder> remainders{{}, {.wandering_N = 0.8}, {.shaking_N = 2.0}};

}  // namespace

TEST_CASE("the constant part of a seal's friction is named beside the one that rises with pressure", "[long]") {
  const auto seed = GENERATE(from_range(test::and_in_the_long_run({1u}, {2u})));
  const std::size_t kind = GENERATE(0u, 1u, 2u);
  const Diagnosis found = diagnosis_of({2.0, 1.8e-5}, remainders[kind], seed);
  CAPTURE(seed, kind, found.sentence);
  REQUIRE(names_of(found) == std::vector<std::string>{"coulomb_friction", "pressure_dependent_friction"});
  for (const DiagnosisAnswer& answer : found.answers) {
    const double expected = answer.effect == "coulomb_friction" ? 2.0 : 2 * 1.8e-5;  // of both chambers' mean
    CHECK(answer.parameters.front().value == Approx(expected).epsilon(0.15));
  }
}

TEST_CASE("friction that only rises with pressure has no second name, whatever else is left", "[long]") {
  const auto seed = GENERATE(from_range(test::and_in_the_long_run({1u}, {2u, 3u})));
  const std::size_t kind = GENERATE(0u, 1u, 2u);
  const Diagnosis found = diagnosis_of({0.0, 2.2e-5}, remainders[kind], seed);
  CAPTURE(seed, kind, found.sentence);
  CHECK(names_of(found) == std::vector<std::string>{"pressure_dependent_friction"});
}
