// Residuals of an axis whose drive force is known: the force balance alone.
#include "diagnosis/residuals/driven_axis_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "diagnosis/recordings/even_samples.hpp"
#include "diagnosis/recordings/held_out.hpp"

namespace pneuservo {

namespace {

/// What the balance itself gets wrong around reversals and in time steps, of the largest recorded force.
constexpr double floor_share = 5e-4;
constexpr double no_force_N = 1e-9;  ///< floor of a force that is zero throughout
/// Fitted rows of all recordings: twice the numbers of the largest explanation, three names of three numbers.
constexpr std::ptrdiff_t least_rows = 18;
constexpr double turn_share = 0.5;            ///< of the usual speed
constexpr double least_bin_periods = 5;       ///< rows of slowly sampled recordings are longer than residual_bin_s

double row_length_s(double interval_s) { return std::max(residual_bin_s, least_bin_periods * interval_s); }
std::size_t row_samples(double interval_s) {
  return static_cast<std::size_t>(std::llround(row_length_s(interval_s) / interval_s));
}

/// A seal is dragged along elastically where the motion turns, which no friction of the vocabulary is: beside pistons
/// only samples of at least half the usual speed are judged, beyond the smoothing's reach of slower ones.
void leave_out_turns(const std::vector<double>& velocity_mps, std::size_t reach, std::vector<char>& usable) {
  std::vector<double> speeds;
  for (std::size_t i = 0; i < usable.size(); ++i)
    if (usable[i]) speeds.push_back(std::abs(velocity_mps[i]));
  if (speeds.empty()) return;
  const auto usual = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
  std::nth_element(speeds.begin(), usual, speeds.end());
  const double least = turn_share * *usual;
  std::vector<char> kept = usable;
  for (std::size_t i = 0; i < usable.size(); ++i)
    if (std::abs(velocity_mps[i]) < least)
      std::fill(kept.begin() + static_cast<std::ptrdiff_t>(i - std::min(i, reach)),
                kept.begin() + static_cast<std::ptrdiff_t>(std::min(usable.size(), i + reach + 1)), 0);
  usable = std::move(kept);
}

/// For how much of the time between two rows the force of a row acts: a period of the loop where it is a command held
/// over that, all of it where it is said to be held, none where it was read at its instant.
double held_share(const Rig& rig, const Recording& recording, double interval_s) {
  const Sampling stated = source_of(recording, recording.has("F_N") ? "F_N" : "u_V").sampling;
  if (stated != Sampling::unstated) return stated == Sampling::held ? 1.0 : 0.0;
  return std::min(1.0, rig.period_s / interval_s);
}

/// Behind each row, as a force over one interval: a jump between two rows that are read at their instants lies anywhere
/// between them, equally likely. What the steps on both sides make too is no jump.
std::vector<double> jumps_of(const std::vector<double>& force, double unknown_share) {
  std::vector<double> out(force.size(), 0.0);
  const auto step = [&](std::size_t i) { return std::abs(force[i + 1] - force[i]); };
  for (std::size_t i = 1; i + 2 < force.size() && unknown_share > 0; ++i)
    out[i] = unknown_share / std::sqrt(12.0) * std::max(0.0, step(i) - 0.5 * (step(i - 1) + step(i + 1)));
  return out;
}

/// Pistons need no other drive: without a force sensor the pressures' force is all that moves the slider.
bool has_force(const Rig& rig, const Recording& recording) {
  return !rig.has_pistons() || recording.has("F_N") || rig.drive.force_per_volt_N_per_V != 0;
}

std::vector<double> drive_force(const Rig& rig, const Recording& recording) {
  if (recording.has("F_N")) return recording.column("F_N");
  if (!has_force(rig, recording)) return std::vector<double>(recording.t_s().size(), 0.0);
  if (!recording.has("u_V") || rig.drive.force_per_volt_N_per_V == 0)
    throw InputError(
        fmt::format("{}: found no column F_N, expected the drive force of '{}' (or u_V, with "
                    "slider.force_per_volt_N_per_V in the config); `pneuservo import` shows what the file has",
                    recording.path, rig.name));
  std::vector<double> force = recording.column("u_V");
  for (double& value : force) value *= rig.drive.force_per_volt_N_per_V;
  return force;
}

/// The drive's mean around each row: what was held before it counts for `before` of a row.
std::vector<double> mean_around(const std::vector<double>& force_N, double before) {
  std::vector<double> out(force_N);
  for (std::size_t i = 1; i < out.size(); ++i) out[i] -= before * (force_N[i] - force_N[i - 1]);
  return out;
}

}  // namespace

DrivenAxisResiduals::DrivenAxisResiduals(const Rig& rig, const std::vector<Recording>& recordings) {
  channels_.push_back({"F", "N", 0, no_force_N});
  channels_.back().is_balance =
      std::none_of(recordings.begin(), recordings.end(), [&](const Recording& r) { return has_force(rig, r); });
  has_held_out_ = any_held_out(recordings);
  for (const Recording& recording : recordings) add_recording(rig, recording);
  const auto fitted = std::count_if(rows_.begin(), rows_.end(), [](const ResidualRow& row) { return !row.held_out; });
  if (fitted < least_rows)
    throw InputError(fmt::format("{}: found {} rows of {:.3g} s to compare, expected at least {}: a longer motion, or "
                                 "rows closer together",
                                 recordings.front().path, fitted, row_length_s(parts_.front().interval_s), least_rows));
  double largest = 0;
  for (const Part& part : parts_)
    for (std::size_t i = 0; i < part.drive_N.size(); ++i)
      if (part.usable[i])
        largest = std::max({largest, std::abs(part.drive_N[i]), std::abs(piston_force(part, rig, i).first)});
  ResidualChannel& channel = channels_.front();
  channel.floor = std::max(no_force_N, floor_share * largest);
  const auto noise_of_pressure = [&](std::size_t side) {
    const double area = side == 0 ? rig.axis.cylinder.area_1_m2 : rig.axis.cylinder.area_2_m2;
    return area * rig.sensors.chamber_pressure.rms_Pa();
  };
  const double force_noise =
      std::hypot(channel.is_balance ? 0.0 : rig.sensors.force.rms_N(), noise_of_pressure(0), noise_of_pressure(1));
  const RecordedRigs rigs(rig, parts_);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Part& part = parts_[p];
    channel.noise = std::max(channel.noise, std::hypot(part.balance.force_noise(rigs[p], part.balance.reading_noise(1)),
                                                       force_noise * part.balance.kernel().noise_gain(0, 1)));
    part.reading_noise = part.balance.reading_noise(row_samples(part.interval_s));
    part.reading_noise.owner_N = reading_noise_N(part, rigs[p]);
  }
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    Part& part = parts_[bins_[i].part];
    const double bin_s = part.interval_s * static_cast<double>(bins_[i].count);
    const double noise = std::hypot(part.reading_noise.of_row_N(bins_[i].first),
                                    force_noise * part.balance.kernel().noise_gain(0, bins_[i].count));
    rows_[i].sigma = std::hypot(noise, jump_error_N(bins_[i]),
                                channel.floor * std::sqrt(std::max(1.0, floor_correlation_s / bin_s)));
    part.reading_noise.add_row(bins_[i].first, rows_[i].sigma);
  }
}

void DrivenAxisResiduals::add_recording(const Rig& rig, const Recording& recording) {
  const std::vector<double>& time_s = recording.t_s();
  const double interval_s = row_interval_s(recording);
  const EvenSamples even(time_s, interval_s);
  const std::vector<double> position = even.drawn(recording.column("x_m"));
  std::vector<double> force = even.straight(drive_force(rig, recording));
  Part part{ForceBalance(position, interval_s, rig.sensors.resolution(Signal::x)),
            interval_s,
            {},
            {},
            {},
            {},
            {},
            {},
            held_out_of(has_held_out_, recording.is_held_out, time_s.back() - time_s.front()),
            machine_changes(rig, recording)};
  part.usable = part.balance.usable();
  part.balance.hold_out(
      [&](std::size_t i) { return part.held_out(time_s.front() + static_cast<double>(i) * interval_s); });
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (std::isfinite(force[i])) continue;
    part.usable[i] = 0;
    force[i] = i > 0 ? force[i - 1] : 0.0;
  }
  const double held = held_share(rig, recording, interval_s);
  const std::vector<double> middle = mean_around(force, 0.5 * held);
  part.jump_N = jumps_of(force, 1.0 - held);
  part.drive_N = part.balance.kernel().apply(middle, 0);
  part.drive_rate_Nps = part.balance.kernel().apply(middle, 1);
  if (rig.has_pistons()) {
    add_pressures(rig, recording, part);
    leave_out_turns(part.balance.velocity_mps(), part.balance.kernel().reach(), part.usable);
  }
  const std::vector<char> stops = part.balance.near_end_stop(rig.axis.cylinder.stroke_m);
  for (std::size_t i = 0; i < stops.size(); ++i) part.usable[i] = part.usable[i] && !stops[i];
  for (std::size_t i = 0; i < force.size(); ++i)
    part.time_s.push_back(time_s.front() + static_cast<double>(i) * interval_s);
  const std::size_t bin = row_samples(interval_s);
  for (std::size_t first = 0; first + bin <= force.size(); first += bin) {
    const auto from = part.usable.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::any_of(from, from + static_cast<std::ptrdiff_t>(bin), [](char usable) { return !usable; })) continue;
    const std::size_t center = first + bin / 2;
    bins_.push_back({parts_.size(), first, bin});
    rows_.push_back({0, static_cast<int>(parts_.size()), part.time_s[center], part.balance.position_m()[center],
                     part.balance.velocity_mps()[center], part.drive_N[center], 1.0,
                     part.held_out(part.time_s[center])});
  }
  parts_.push_back(std::move(part));
}

/// Of the mean of the smoothed drive force over a row.
double DrivenAxisResiduals::jump_error_N(const Bin& bin) const {
  const Part& part = parts_[bin.part];
  const std::size_t reach = part.balance.kernel().reach(), count = part.jump_N.size();
  const std::size_t first = bin.first - std::min(bin.first, reach),
                    end = std::min(count, bin.first + bin.count + reach);
  double square = 0;
  for (std::size_t k = first; k < end; ++k) {
    if (part.jump_N[k] == 0) continue;
    double weight = 0;
    for (std::size_t i = bin.first; i < bin.first + bin.count; ++i)
      weight += part.balance.kernel().weight(i > k ? i - k : k - i) / static_cast<double>(bin.count);
    square += weight * weight * part.jump_N[k] * part.jump_N[k];
  }
  return std::sqrt(square);
}

void DrivenAxisResiduals::add_pressures(const Rig& rig, const Recording& recording, Part& part) const {
  const std::array<double, 2> areas{rig.axis.cylinder.area_1_m2, rig.axis.cylinder.area_2_m2};
  for (std::size_t side = 0; side < 2; ++side) {
    if (areas[side] == 0) continue;
    const std::string column = fmt::format("p{}_chamber_Pa", side + 1);
    recording.require({column});
    part.pressure_Pa[side] = part.balance.kernel().apply(
        EvenSamples(recording.t_s(), part.interval_s).straight(recording.column(column)), 0);
    for (std::size_t i = 0; i < part.usable.size(); ++i)
      part.usable[i] = part.usable[i] && std::isfinite(part.pressure_Pa[side][i]);
  }
}

/// Force of the measured pressures on the slider at sample i by this rig, and their gauge sum.
std::pair<double, double> DrivenAxisResiduals::piston_force(const Part& part, const Rig& rig, std::size_t i) const {
  const std::array<double, 2> areas{rig.axis.cylinder.area_1_m2, -rig.axis.cylinder.area_2_m2};
  double force = 0, sum = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    if (part.pressure_Pa[side].empty()) continue;
    const SensorEffects<double>& sensor = rig.sensor_effects[chamber_signals[side]];
    const double gauge = (part.pressure_Pa[side][i] - sensor.sensor_offset.offset) / sensor.sensor_gain.gain -
                         rig.axis.air.atmosphere_Pa;
    if (!std::isfinite(gauge)) continue;  // not usable
    force += areas[side] * gauge;
    sum += std::max(gauge, 0.0);
  }
  return {force, sum};
}

std::pair<std::vector<double>, std::vector<double>> DrivenAxisResiduals::forces(const Part& part,
                                                                                const Rig& rig) const {
  look_for_stop(stop_);
  const SensorEffects<double>& sensor = rig.sensor_effects[Signal::F];
  std::vector<double> drive = part.drive_N;
  for (std::size_t i = 0; i < drive.size(); ++i)
    drive[i] = (drive[i] + sensor.sensor_lag.time_constant_s * part.drive_rate_Nps[i] - sensor.sensor_offset.offset) /
               sensor.sensor_gain.gain;
  std::vector<double> pistons(drive.size(), 0.0), gauge_sum(rig.has_pistons() ? drive.size() : 0);
  for (std::size_t i = 0; i < gauge_sum.size(); ++i) {
    std::tie(pistons[i], gauge_sum[i]) = piston_force(part, rig, i);
    drive[i] += pistons[i];
  }
  std::vector<double> needed =
      part.balance.required_force(rig, drive, gauge_sum, rest_noises * channels_.front().noise);
  for (std::size_t i = 0; i < drive.size(); ++i) {
    drive[i] -= pistons[i];
    needed[i] -= pistons[i];
  }
  // Compared as the sensor reads: else a gain would shrink residuals against their noise.
  for (std::size_t i = 0; i < drive.size(); ++i) {
    drive[i] *= sensor.sensor_gain.gain;
    needed[i] *= sensor.sensor_gain.gain;
  }
  return {std::move(drive), std::move(needed)};
}

/// Of a row, as the force's sensor reads it.
double DrivenAxisResiduals::reading_noise_N(const Part& part, const Rig& rig) const {
  return rig.sensor_effects[Signal::F].sensor_gain.gain * part.balance.force_noise(rig, part.reading_noise);
}

Eigen::MatrixXd DrivenAxisResiduals::residuals(std::span<const Hypothesis> hypotheses) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows_.size()), static_cast<Eigen::Index>(hypotheses.size()));
  for (std::size_t h = 0; h < hypotheses.size(); ++h) {
    const RecordedRigs rigs(hypotheses[h].rig, parts_);
    double* column = out.col(static_cast<Eigen::Index>(h)).data();
    for (std::size_t p = 0, b = 0; p < parts_.size(); ++p) {
      const Part& part = parts_[p];
      const auto [drive, needed] = forces(part, rigs[p]);
      const std::span residuals(column + b, part.reading_noise.row_share.size());
      for (double& residual : residuals) {
        const Bin& bin = bins_[b];
        double sum = 0;
        for (std::size_t i = bin.first; i < bin.first + bin.count; ++i) sum += needed[i] - drive[i];
        residual = sum / static_cast<double>(bin.count) / rows_[b++].sigma;
      }
      const std::span rows = std::span(rows_).subspan(b - residuals.size(), residuals.size());
      const double factor = part.reading_noise.factor(residuals, rows, reading_noise_N(part, rigs[p]));
      for (double& residual : residuals) residual *= factor;
    }
  }
  return out;
}

std::vector<ChannelMisfit> DrivenAxisResiduals::sample_misfit(const Hypothesis& hypothesis) {
  double fitted = 0, held_out = 0, fitted_count = 0, held_out_count = 0;
  const RecordedRigs rigs(hypothesis.rig, parts_);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const Part& part = parts_[p];
    const auto [drive, needed] = forces(part, rigs[p]);
    for (std::size_t i = 0; i < drive.size(); ++i) {
      if (!part.usable[i]) continue;
      const double square = (needed[i] - drive[i]) * (needed[i] - drive[i]);
      const bool kept = part.held_out(part.time_s[i]);
      (kept ? held_out : fitted) += square;
      ++(kept ? held_out_count : fitted_count);
    }
  }
  return {{std::sqrt(fitted / std::max(fitted_count, 1.0)), std::sqrt(held_out / std::max(held_out_count, 1.0))}};
}

std::vector<ResidualCourse> DrivenAxisResiduals::courses(const Hypothesis& hypothesis) {
  const RecordedRigs rigs(hypothesis.rig, parts_);
  std::vector<ResidualCourse> out;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const auto [drive, needed] = forces(parts_[p], rigs[p]);
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
