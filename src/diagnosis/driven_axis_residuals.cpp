// Residuals of an axis whose drive force is known: the force balance alone.
#include "diagnosis/driven_axis_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "diagnosis/held_out.hpp"

namespace pneuservo {

namespace {

/// What the balance itself gets wrong around reversals and in time steps; of the largest recorded force, and at least.
constexpr double floor_share = 5e-4, least_floor_N = 0.02;
constexpr double rest_noises = 2;  ///< of the drive: what any rest balances, so that no friction gains by noise
constexpr std::size_t force_sensor = 6;

double sensor_noise(double noise, double quantum) { return std::hypot(noise, quantum / std::sqrt(12.0)); }

/// The rows on an even grid; NaN where one is missing.
std::vector<double> on_grid(const std::vector<double>& time_s, const std::vector<double>& values, double period_s) {
  const auto count = static_cast<std::size_t>(std::llround((time_s.back() - time_s.front()) / period_s)) + 1;
  std::vector<double> out(count, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < time_s.size(); ++i)
    out[static_cast<std::size_t>(std::llround((time_s[i] - time_s.front()) / period_s))] = values[i];
  return out;
}

std::vector<double> drive_force(const Rig& rig, const Recording& recording) {
  if (recording.has("F_N")) return recording.column("F_N");
  if (!recording.has("u_V") || rig.drive.force_per_volt_N_per_V == 0)
    throw InputError(fmt::format("{}: found no column F_N, expected the drive force of '{}' (or u_V, with "
                                 "slider.force_per_volt_N_per_V in the config)",
                                 recording.path, rig.name));
  std::vector<double> force = recording.column("u_V");
  for (double& value : force) value *= rig.drive.force_per_volt_N_per_V;
  return force;
}

}  // namespace

DrivenAxisResiduals::DrivenAxisResiduals(const Rig& rig, const std::vector<Recording>& recordings) {
  channels_.push_back({"F", "N", 0, least_floor_N});
  for (const Recording& recording : recordings) add_recording(rig, recording);
  double largest = 0;
  for (const Part& part : parts_)
    for (const double force : part.drive_N) largest = std::max(largest, std::abs(force));
  ResidualChannel& channel = channels_.front();
  channel.floor = std::max(least_floor_N, floor_share * largest);
  const double force_noise = sensor_noise(rig.sensors.force.noise_N, rig.sensors.force.quantum_N);
  const double mass = rig.axis.slider.mass_kg + rig.axis.slider.payload_kg;
  const auto noise_of = [&](const Part& part, std::size_t count) {
    return std::hypot(part.balance.force_noise(mass, count), force_noise * part.balance.kernel().noise_gain(0, count));
  };
  channel.noise = noise_of(parts_.front(), 1);
  for (std::size_t i = 0; i < bins_.size(); ++i)
    rows_[i].sigma = std::hypot(noise_of(parts_[bins_[i].part], bins_[i].count),
                                channel.floor * std::sqrt(floor_correlation_s / residual_bin_s));
}

void DrivenAxisResiduals::add_recording(const Rig& rig, const Recording& recording) {
  const std::vector<double>& time_s = recording.t_s();
  const double period_s = rig.period_s;
  const std::vector<double> position = on_grid(time_s, recording.column("x_m"), period_s);
  std::vector<double> force = on_grid(time_s, drive_force(rig, recording), period_s);
  if (position.size() < 2000 * 0.001 / period_s)
    throw InputError(fmt::format("{}: found {:.2f} s, expected at least 2 s to compare", recording.path,
                                 static_cast<double>(position.size()) * period_s));
  Part part{
      ForceBalance(position, period_s, sensor_noise(rig.sensors.position.noise_m, rig.sensors.position.quantum_m)),
      {},
      {},
      {},
      {}};
  // Held over the period: around a row the mean of its own force and the one before it.
  std::vector<double> middle(force.size());
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (!std::isfinite(force[i])) force[i] = i > 0 ? force[i - 1] : 0.0;
    middle[i] = 0.5 * (force[i] + force[i > 0 ? i - 1 : 0]);
  }
  part.drive_N = part.balance.kernel().apply(middle, 0);
  part.drive_rate_Nps = part.balance.kernel().apply(middle, 1);
  part.usable = part.balance.usable();
  const std::vector<char> stops = part.balance.near_end_stop(rig.axis.cylinder.stroke_m);
  for (std::size_t i = 0; i < stops.size(); ++i) part.usable[i] = part.usable[i] && !stops[i];
  for (std::size_t i = 0; i < force.size(); ++i)
    part.time_s.push_back(time_s.front() + static_cast<double>(i) * period_s);
  const auto bin = std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(residual_bin_s / period_s)));
  for (std::size_t first = 0; first + bin <= force.size(); first += bin) {
    const auto from = part.usable.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::any_of(from, from + static_cast<std::ptrdiff_t>(bin), [](char usable) { return !usable; })) continue;
    const std::size_t center = first + bin / 2;
    bins_.push_back({parts_.size(), first, bin});
    rows_.push_back({0, static_cast<int>(parts_.size()), part.time_s[center], part.balance.position_m()[center],
                     part.balance.velocity_mps()[center], part.drive_N[center], 1.0, is_held_out(part.time_s[center])});
  }
  parts_.push_back(std::move(part));
}

std::pair<std::vector<double>, std::vector<double>> DrivenAxisResiduals::forces(const Part& part,
                                                                                const Rig& rig) const {
  const SensorEffects<double>& sensor = rig.sensor_effects[force_sensor];
  std::vector<double> drive = part.drive_N;
  for (std::size_t i = 0; i < drive.size(); ++i)
    drive[i] = (drive[i] + sensor.sensor_lag.time_constant_s * part.drive_rate_Nps[i] - sensor.sensor_offset.offset) /
               sensor.sensor_gain.gain;
  std::vector<double> needed = part.balance.required_force(rig, drive, {}, rest_noises * channels_.front().noise);
  // Compared as the sensor reads: else a gain would shrink residuals against their noise.
  for (std::size_t i = 0; i < drive.size(); ++i) {
    drive[i] *= sensor.sensor_gain.gain;
    needed[i] *= sensor.sensor_gain.gain;
  }
  return {std::move(drive), std::move(needed)};
}

Eigen::MatrixXd DrivenAxisResiduals::residuals(std::span<const Hypothesis> hypotheses) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows_.size()), static_cast<Eigen::Index>(hypotheses.size()));
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    std::vector<std::pair<std::vector<double>, std::vector<double>>> sides;
    for (const Part& part : parts_) sides.push_back(forces(part, hypotheses[h].rig));
    for (std::size_t b = 0; b < bins_.size(); ++b) {
      const Bin& bin = bins_[b];
      double sum = 0;
      for (std::size_t i = bin.first; i < bin.first + bin.count; ++i)
        sum += sides[bin.part].second[i] - sides[bin.part].first[i];
      out(static_cast<Eigen::Index>(b), static_cast<Eigen::Index>(h)) =
          sum / static_cast<double>(bin.count) / rows_[b].sigma;
    }
  }
  return out;
}

std::vector<ChannelMisfit> DrivenAxisResiduals::sample_misfit(const Hypothesis& hypothesis) {
  double fitted = 0, held_out = 0, fitted_count = 0, held_out_count = 0;
  for (const Part& part : parts_) {
    const auto [drive, needed] = forces(part, hypothesis.rig);
    for (std::size_t i = 0; i < drive.size(); ++i) {
      if (!part.usable[i]) continue;
      const double square = (needed[i] - drive[i]) * (needed[i] - drive[i]);
      (is_held_out(part.time_s[i]) ? held_out : fitted) += square;
      ++(is_held_out(part.time_s[i]) ? held_out_count : fitted_count);
    }
  }
  return {{std::sqrt(fitted / std::max(fitted_count, 1.0)), std::sqrt(held_out / std::max(held_out_count, 1.0))}};
}

std::vector<ResidualCourse> DrivenAxisResiduals::courses(const Hypothesis& hypothesis) {
  std::vector<ResidualCourse> out;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const auto [drive, needed] = forces(parts_[p], hypothesis.rig);
    ResidualCourse course{0, static_cast<int>(p), {}, {}, {}};
    for (std::size_t i = 0; i < drive.size(); ++i) {
      if (!parts_[p].usable[i]) continue;
      course.time_s.push_back(parts_[p].time_s[i]);
      course.measured.push_back(drive[i]);
      course.simulated.push_back(needed[i]);
    }
    out.push_back(std::move(course));
  }
  return out;
}

}  // namespace pneuservo
