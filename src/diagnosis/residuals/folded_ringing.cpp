// Ringing of a line at the sampling rate, which sampling folds down to slow changes of the port pressures.
#include "diagnosis/residuals/folded_ringing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/QR>

namespace pneuservo {

namespace {

constexpr int parts = 16;                   // of a period
constexpr double slowest_period_s = 2e-3;  // of commands whose stairs ring above all that is compared
/// Of a spool, in periods of the command. It lets through the square of it, here 0.25 %: of 1 kPa less than a tenth of
/// the pressures' floor.
constexpr double slowest_spool = 0.05;
// Lengths tried: so many tolerances to both sides, of at least so much where the owner is surer or says nothing.
// At most so much: modes lie closer than that.
constexpr double length_spread = 1.5, least_tolerance = 0.003, most_tolerance = 0.03;
constexpr double two_pi = 2.0 * std::numbers::pi;

/// The stairs of the loop's periods in parts of the recording's.
std::vector<double> stairs(const ImposedInputs& inputs, std::size_t side) {
  std::vector<double> out;
  out.reserve(parts * inputs.samples());
  for (std::size_t k = 0; k < inputs.samples(); ++k)
    for (int i = 0; i < parts; ++i) out.push_back(inputs.command_at(side, k, i * inputs.steps / parts));
  return out;
}

std::vector<double> interpolated(const std::vector<double>& samples) {
  std::vector<double> out;
  out.reserve(parts * samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double rise = k + 1 < samples.size() ? samples[k + 1] - samples[k] : 0.0;
    for (int i = 0; i < parts; ++i) out.push_back(samples[k] + rise * i / parts);
  }
  return out;
}

ImposedInputs in_parts(const ImposedInputs& inputs) {
  ImposedInputs out(inputs);
  out.period_s /= parts;
  out.steps = 1;
  for (std::size_t side = 0; side < (inputs.has_two_valves() ? 2 : 1); ++side)
    out.command_V[side] = stairs(inputs, side);
  out.position_m = interpolated(inputs.position_m);
  out.velocity_mps = interpolated(inputs.velocity_mps);
  for (std::size_t side = 0; side < 2; ++side) {
    out.start_Pa[side] = interpolated(inputs.start_Pa[side]);
    out.start_Pa_per_s[side] = interpolated(inputs.start_Pa_per_s[side]);
  }
  out.supply_Pa = interpolated(inputs.supply_Pa);
  out.supply_Pa_per_s = interpolated(inputs.supply_Pa_per_s);
  out.release *= parts;
  return out;
}

/// Weights of the parts of a period that make the sines' value at its end.
Eigen::RowVectorXd ringing_weights(double stair) {
  const bool has_stair = stair > 1.5 / parts && stair < 1 - 1.5 / parts;  // as a share of the period
  Eigen::MatrixXd basis(parts, has_stair ? 8 : 7);
  for (int i = 0; i < parts; ++i) {
    const double x = (i + 1.0) / parts;
    basis.row(i).head<7>() << std::cos(two_pi * x), std::cos(2 * two_pi * x), std::sin(two_pi * x),
        std::sin(2 * two_pi * x), 1, x, x * x;
    if (has_stair) basis(i, 7) = x > stair ? 1 : 0;
  }
  const Eigen::MatrixXd inverse = basis.completeOrthogonalDecomposition().pseudoInverse();
  return inverse.row(0) + inverse.row(1);
}

/// Ringing at each sample, of a course in parts of a period.
std::vector<double> ringing(const std::vector<double>& whole, const Eigen::RowVectorXd& weights) {
  std::vector<double> out(whole.size() / parts, 0.0);
  for (std::size_t k = 1; k < out.size(); ++k)
    out[k] = weights * Eigen::Map<const Eigen::VectorXd>(&whole[parts * (k - 1) + 1], parts);
  return out;
}

std::vector<double> at_samples(const std::vector<double>& whole) {
  std::vector<double> out(whole.size() / parts);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = whole[parts * k];
  return out;
}

PlantGrid in_parts(const PlantGrid& grid) { return {grid.cells, (grid.substeps + parts - 1) / parts}; }

/// When the stair of a command comes, as a share of the period.
double stair_of(const Rig& rig, double period_s) {
  const double delay = rig.axis.effects.valve.command_delay.delay_s / period_s;
  return delay - std::floor(delay);
}

double length_tolerance(const Rig& owner, const char* path) {
  const auto found = owner.tolerances.find(path);
  return found == owner.tolerances.end() ? least_tolerance : std::clamp(found->second, least_tolerance, most_tolerance);
}

}  // namespace

PossibleRinging possible_ringing(const ImposedInputs& inputs, const Rig& owner, const PlantGrid& grid,
                                 const StopQuestion& stop) {
  const double wave_m = Air<double>(owner.axis.air).sound_speed() * inputs.period_s;
  const auto long_enough = [&](const LineParameters<double>& line) { return line.length_m >= wave_m; };
  const double spool = owner.axis.valve.natural_frequency_Hz * inputs.step_s();
  if (spool > 0 && spool < slowest_spool) return {};
  if (inputs.period_s > slowest_period_s || !(long_enough(owner.axis.line_1) || long_enough(owner.axis.line_2)))
    return {};
  std::array<Rig, imposed_lanes> rigs;
  std::array<ImposedRun, imposed_lanes> runs;
  for (std::size_t i = 0; i < imposed_lanes; ++i) {
    rigs[i] = owner;
    const double z = length_spread * (2.0 * static_cast<double>(i) / (imposed_lanes - 1) - 1.0);
    rigs[i].axis.line_1.length_m *= 1.0 + z * length_tolerance(owner, "line_1.length_m");
    rigs[i].axis.line_2.length_m *= 1.0 + z * length_tolerance(owner, "line_2.length_m");
    runs[i] = {&rigs[i], {}};
  }
  const std::vector<GasCourse> courses = run_imposed(in_parts(inputs), runs, in_parts(grid), stop);
  const Eigen::RowVectorXd weights = ringing_weights(stair_of(owner, inputs.period_s));
  PossibleRinging out;
  for (const GasCourse& whole : courses) {
    if (!std::isfinite(whole[Signal::p1_port].back())) continue;
    PossibleCourse& course = out.emplace_back();
    if (long_enough(owner.axis.line_1)) {
      course.ringing[0] = ringing(whole[Signal::p1_port], weights);
      course.pressure[0] = at_samples(whole[Signal::p1_port]);
    }
    if (long_enough(owner.axis.line_2)) {
      course.ringing[1] = ringing(whole[Signal::p2_port], weights);
      course.pressure[1] = at_samples(whole[Signal::p2_port]);
    }
  }
  return out;
}

}  // namespace pneuservo
