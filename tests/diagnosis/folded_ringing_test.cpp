// What a line may ring at the sampling rate: most where a length puts a mode there, nothing under a command at rest.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "diagnosis/cylinder_residuals.hpp"
#include "diagnosis/folded_ringing.hpp"
#include "diagnosis/simulated_recording.hpp"

using namespace pneuservo;
using namespace pneuservo::test;

namespace {

/// A held piston in the middle of its stroke, the valve near its centre under a slow sine of stairs.
ImposedInputs quiet_inputs(double amplitude_V, double period_s) {
  ImposedInputs inputs;
  inputs.period_s = period_s;
  const auto samples = static_cast<std::size_t>(1.5 / period_s);
  for (std::size_t k = 0; k < samples; ++k)
    inputs.command_V.push_back(amplitude_V * std::sin(6.283185307 * 2.0 * static_cast<double>(k) * period_s));
  inputs.position_m.assign(samples, 0.0);
  inputs.velocity_mps.assign(samples, 0.0);
  for (std::size_t side = 0; side < 2; ++side) {
    inputs.start_Pa[side].assign(samples, 5e5);
    inputs.start_Pa_per_s[side].assign(samples, 0.0);
  }
  inputs.release = 1;
  return inputs;
}

/// Largest mean over 10 samples of port 1.
double largest_mean(const PossibleRinging& ringing) {
  double largest = 0;
  for (const auto& sides : ringing)
    for (std::size_t first = 100; first + 10 <= sides[0].size(); first += 10) {
      double sum = 0;
      for (std::size_t k = first; k < first + 10; ++k) sum += sides[0][k];
      largest = std::max(largest, std::abs(sum) / 10);
    }
  return largest;
}

constexpr PlantGrid fine{160, 64};

}  // namespace

TEST_CASE("a line rings with the command's stairs where a mode lies at the sampling rate", "[diagnosis]") {
  // Closed by the valve, open to a chamber of seven times its volume: modes at (2n + 1) c / 4 L, here c = 343 m/s.
  const double quarter_wave_m = 343.1 / (4 * 1000.0);
  const ImposedInputs inputs = quiet_inputs(0.1, 1e-3);
  const double at_mode = largest_mean(possible_ringing(inputs, cylinder_rig(23 * quarter_wave_m, 4.15e-3), fine));
  const double between = largest_mean(possible_ringing(inputs, cylinder_rig(24 * quarter_wave_m, 4.15e-3), fine));
  INFO("at a mode " << at_mode << " Pa, between two " << between << " Pa");
  CHECK(at_mode > 50);
  CHECK(at_mode > 5 * between);
}

TEST_CASE("a wide tolerance of the length finds the mode beside it", "[diagnosis]") {
  const double quarter_wave_m = 343.1 / (4 * 1000.0);
  const ImposedInputs inputs = quiet_inputs(0.1, 1e-3);
  Rig rig = cylinder_rig(24 * quarter_wave_m, 4.15e-3);
  const double narrow = largest_mean(possible_ringing(inputs, rig, fine));
  rig.tolerances = {{"line_1.length_m", 0.028}, {"line_2.length_m", 0.028}};  // 1.5 of them: one quarter wave
  CHECK(largest_mean(possible_ringing(inputs, rig, fine)) > 4 * narrow);
}

TEST_CASE("a command at rest makes no ringing, a slow one none that is folded", "[diagnosis]") {
  const Rig rig = cylinder_rig(2.0, 4.15e-3);
  CHECK(largest_mean(possible_ringing(quiet_inputs(0.0, 1e-3), rig, fine)) < 0.01);
  CHECK(possible_ringing(quiet_inputs(0.1, 5e-3), rig, fine).empty());
}

TEST_CASE("rows of ports allow for the ringing, rows of chambers need not", "[diagnosis]") {
  const Rig rig = cylinder_rig(1.973, 4.15e-3);
  const CylinderResiduals model(rig, {simulated_recording(rig, 4.0, 3, all_pressures)});
  double widest_port = 0, narrowest_port = 1e9, widest_chamber = 0;
  for (const ResidualRow& row : model.rows()) {
    const std::string& channel = model.channels()[static_cast<std::size_t>(row.channel)].name;
    if (row.over_recording || row.time_s < 2.5) continue;  // the start's own error has faded
    if (channel == "p1_port") {
      widest_port = std::max(widest_port, row.sigma);
      narrowest_port = std::min(narrowest_port, row.sigma);
    }
    if (channel == "p1_chamber") widest_chamber = std::max(widest_chamber, row.sigma);
  }
  CHECK(widest_port > 1.3 * widest_chamber);
  CHECK(narrowest_port < 1.1 * widest_chamber);
}
