// Residuals of freely simulated rigs over uneven rows.
#include "diagnosis/residuals/sampled_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "diagnosis/recordings/held_out.hpp"
#include "diagnosis/residuals/gas_runs.hpp"

namespace pneuservo {

namespace {

constexpr double rows_a_recording = 1000;

/// Mean of some samples of a course.
double mean_of(const std::vector<double>& values, const std::vector<std::size_t>& samples) {
  double sum = 0;
  for (const std::size_t k : samples) sum += values[k];
  return sum / static_cast<double>(samples.size());
}

/// Time that rows cover: a step far beyond the usual one covers no more than ten of those, so that a night between two
/// rows does not stretch what is compared.
double covered_s(const std::vector<double>& time_s) {
  constexpr double most_steps = 10;
  const double usual = median_step_s(time_s);
  double sum = 0, longest = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    sum += time_s[i] - time_s[i - 1];
    longest = std::max(longest, time_s[i] - time_s[i - 1]);
  }
  if (longest < 0.5 * sum || !(longest > most_steps * usual)) return sum;
  return sum - longest + most_steps * usual;
}

/// For how long the model's own error stays alike: what is simulated freely adds up its error, which changes with what
/// is recorded, not with the rows. `share` of one way from low to high or back, a way being half of the range at least:
/// less than any of twelve real recordings showed (docs/physics/diagnosis-method.md).
double error_alike_s(const std::vector<double>& values, double span_s) {
  constexpr double share = 0.02;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const double value : values)
    if (std::isfinite(value)) lowest = std::min(lowest, value), highest = std::max(highest, value);
  const double way = 0.5 * (highest - lowest);
  double ways = 0, low = highest, high = lowest;
  int direction = 0;  // of the way that is being gone; 0: none yet
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
    const int next = direction <= 0 && value - low >= way ? 1 : direction >= 0 && high - value >= way ? -1 : 0;
    if (next == 0) continue;
    direction = next;
    low = high = value;
    ++ways;
  }
  return std::max(floor_correlation_s, share * span_s / std::max(1.0, ways));
}

}  // namespace

void SampledResiduals::declare(std::vector<ResidualChannel> channels, std::vector<SampledRecording> recordings,
                               int jobs) {
  channels_ = std::move(channels);
  recordings_ = std::move(recordings);
  jobs_ = jobs;
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    const SampledRecording& recording = recordings_[r];
    const double start = recording.time_s.front(), span = covered_s(recording.time_s);
    const double bin_s = std::max(residual_bin_s, span / rows_a_recording);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      if (recording.measured[c].empty()) continue;
      const double alike_s = error_alike_s(recording.measured[c], span);
      std::map<std::pair<long, char>, std::vector<std::size_t>> bins;
      for (std::size_t k = 0; k < recording.time_s.size(); ++k)
        if (std::isfinite(recording.measured[c][k]))
          bins[{std::lround(std::floor((recording.time_s[k] - start) / bin_s)), recording.held_out[k]}].push_back(k);
      for (auto& [key, samples] : bins) {
        ResidualRow row{static_cast<int>(c), static_cast<int>(r)};
        row.time_s = mean_of(recording.time_s, samples);
        row.position_m = mean_of(recording.position_m, samples);
        row.velocity_mps = mean_of(recording.velocity_mps, samples);
        row.command_V = mean_of(recording.command, samples);
        // The model's own error stays alike for a while, and counts once in that.
        const double noise = channels_[c].noise / std::sqrt(static_cast<double>(samples.size()));
        const auto sigma_of_error = [&](double for_s) {
          return std::hypot(noise, channels_[c].floor * std::sqrt(std::max(1.0, for_s / bin_s)));
        };
        row.sigma = sigma_of_error(floor_correlation_s);
        row.alike_rows = std::pow(sigma_of_error(alike_s) / row.sigma, 2);
        row.held_out = key.second != 0;
        rows_.push_back(row);
        stretches_.push_back({c, r, std::move(samples)});
      }
    }
  }
}

Eigen::MatrixXd SampledResiduals::residuals(std::span<const Hypothesis> hypotheses) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows_.size()), static_cast<Eigen::Index>(hypotheses.size()));
  in_parallel(hypotheses.size(), jobs_, [&](std::size_t h) {
    std::vector<std::vector<std::vector<double>>> courses;
    courses.reserve(recordings_.size());
    for (std::size_t r = 0; r < recordings_.size(); ++r) courses.push_back(simulated(hypotheses[h], r));
    auto column = out.col(static_cast<Eigen::Index>(h));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Stretch& s = stretches_[i];
      column(static_cast<Eigen::Index>(i)) = (mean_of(courses[s.recording][s.channel], s.samples) -
                                              mean_of(recordings_[s.recording].measured[s.channel], s.samples)) /
                                             rows_[i].sigma;
    }
    if (!column.allFinite()) column.setConstant(std::numeric_limits<double>::quiet_NaN());
  });
  return out;
}

std::vector<ChannelMisfit> SampledResiduals::sample_misfit(const Hypothesis& hypothesis) {
  std::vector<std::array<double, 2>> squares(channels_.size()), counts(channels_.size());
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    const SampledRecording& recording = recordings_[r];
    const auto courses = simulated(hypothesis, r);
    for (std::size_t c = 0; c < channels_.size(); ++c)
      for (std::size_t k = 0; k < recording.measured[c].size(); ++k) {
        if (!std::isfinite(recording.measured[c][k])) continue;
        const std::size_t held_out = recording.held_out[k] != 0;
        squares[c][held_out] += std::pow(courses[c][k] - recording.measured[c][k], 2);
        counts[c][held_out] += 1;
      }
  }
  std::vector<ChannelMisfit> out;
  out.reserve(channels_.size());
  for (std::size_t c = 0; c < channels_.size(); ++c)
    out.push_back({std::sqrt(squares[c][0] / std::max(1.0, counts[c][0])),
                   std::sqrt(squares[c][1] / std::max(1.0, counts[c][1]))});
  return out;
}

std::vector<ResidualCourse> SampledResiduals::courses(const Hypothesis& hypothesis) {
  std::vector<ResidualCourse> out;
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    const auto courses = simulated(hypothesis, r);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      ResidualCourse course{static_cast<int>(c), static_cast<int>(r), {}, {}, {}};
      for (std::size_t k = 0; k < recordings_[r].measured[c].size(); ++k) {
        if (!std::isfinite(recordings_[r].measured[c][k])) continue;
        course.time_s.push_back(recordings_[r].time_s[k]);
        course.measured.push_back(recordings_[r].measured[c][k]);
        course.simulated.push_back(courses[c][k]);
      }
      if (!course.time_s.empty()) out.push_back(std::move(course));
    }
  }
  return out;
}

}  // namespace pneuservo
