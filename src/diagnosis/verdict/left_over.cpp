// What is left of a mismatch: size by channel, a line in its spectrum, the element whose pattern it has.
#include "diagnosis/verdict/left_over.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>

#include "record/reader.hpp"

namespace pneuservo {

namespace {

constexpr double lowest_line_Hz = 3, highest_line_Hz = 45;
constexpr std::size_t median_lines = 41;
constexpr double moving_share = 0.05;  ///< of the top speed: slower counts as rest
constexpr double shortest_period_m = 1e-3, least_periodic_share = 0.05;
constexpr double stretch_s = 0.03;  ///< within which a pattern keeps its size

struct Series {
  std::vector<double> time_s, value, sigma;
};

/// Up to where a sine is told from a slower one: rows are means of samples, and above half their rate nothing is.
double highest_told_Hz(const std::vector<double>& time_s) {
  return std::min(highest_line_Hz, 0.5 / median_step_s(time_s));
}

/// Rows of one channel and recording.
std::map<std::pair<int, int>, Series> series_of(const std::vector<ResidualRow>& rows, const Eigen::VectorXd& residual) {
  std::map<std::pair<int, int>, Series> out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].over_recording) continue;
    Series& series = out[{rows[i].channel, rows[i].recording}];
    series.time_s.push_back(rows[i].time_s);
    series.value.push_back(residual(static_cast<Eigen::Index>(i)));
    series.sigma.push_back(rows[i].sigma);
  }
  return out;
}

/// Squared amplitude of the best sine at each of some evenly spaced frequencies; the mean is taken off first. The phase
/// of a row is turned on from one frequency to the next, which spares most sines.
std::vector<double> powers(const Series& series, const std::vector<double>& frequencies) {
  const auto rows = static_cast<double>(series.value.size());
  double mean = 0;
  for (const double value : series.value) mean += value / rows;
  std::vector<double> in_phase(frequencies.size(), 0.0), across(frequencies.size(), 0.0);
  const double step = frequencies.size() > 1 ? frequencies[1] - frequencies[0] : 0.0;
  for (std::size_t i = 0; i < series.value.size(); ++i) {
    const double value = series.value[i] - mean, angle = 2 * M_PI * frequencies[0] * series.time_s[i];
    const double turn_cos = std::cos(2 * M_PI * step * series.time_s[i]),
                 turn_sin = std::sin(2 * M_PI * step * series.time_s[i]);
    double c = value * std::cos(angle), s = value * std::sin(angle);
    for (std::size_t k = 0; k < frequencies.size(); ++k) {
      in_phase[k] += c;
      across[k] += s;
      const double next = c * turn_cos - s * turn_sin;
      s = s * turn_cos + c * turn_sin;
      c = next;
    }
  }
  std::vector<double> out;
  for (std::size_t k = 0; k < frequencies.size(); ++k)
    out.push_back(4.0 / (rows * rows) * (in_phase[k] * in_phase[k] + across[k] * across[k]));
  return out;
}

double running_median(const std::vector<double>& values, std::size_t at) {
  const std::size_t half = median_lines / 2;
  const std::size_t from = at - std::min(at, half), to = std::min(values.size(), at + half + 1);
  std::vector<double> window(values.begin() + static_cast<std::ptrdiff_t>(from),
                             values.begin() + static_cast<std::ptrdiff_t>(to));
  std::nth_element(window.begin(), window.begin() + static_cast<std::ptrdiff_t>(window.size() / 2), window.end());
  return window[window.size() / 2];
}

}  // namespace

std::vector<ChannelLevel> channel_levels(const std::vector<ResidualRow>& rows, std::size_t channels,
                                         const Eigen::VectorXd& residual) {
  std::vector<ChannelLevel> levels(channels);
  std::vector<double> product(channels, 0), square(channels, 0);
  std::vector<int> last(channels, -1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].over_recording) continue;
    const auto channel = static_cast<std::size_t>(rows[i].channel);
    const double value = residual(static_cast<Eigen::Index>(i));
    ChannelLevel& level = levels[channel];
    (rows[i].held_out ? level.held_out : level.fitted) += value * value;
    ++(rows[i].held_out ? level.held_out_rows : level.fitted_rows);
    if (last[channel] >= 0 && rows[static_cast<std::size_t>(last[channel])].recording == rows[i].recording)
      product[channel] += value * residual(last[channel]);
    square[channel] += value * value;
    level.sigma += rows[i].sigma * rows[i].sigma;
    last[channel] = static_cast<int>(i);
  }
  for (std::size_t c = 0; c < channels; ++c) {
    ChannelLevel& level = levels[c];
    if (level.fitted_rows > 0) level.fitted = std::sqrt(level.fitted / static_cast<double>(level.fitted_rows));
    if (level.held_out_rows > 0) level.held_out = std::sqrt(level.held_out / static_cast<double>(level.held_out_rows));
    level.sigma =
        std::sqrt(level.sigma / std::max<double>(1, static_cast<double>(level.fitted_rows + level.held_out_rows)));
    level.correlation = square[c] > 0 ? product[c] / square[c] : 0;
  }
  return levels;
}

bool is_everywhere(const std::vector<ResidualChannel>& channels, const std::vector<ChannelLevel>& levels,
                   double limit) {
  bool side[2] = {};
  for (std::size_t c = 0; c < levels.size(); ++c) {
    if (levels[c].fitted <= limit) continue;
    if (channels[c].name.starts_with("p1")) side[0] = true;
    if (channels[c].name.starts_with("p2")) side[1] = true;
  }
  return side[0] && side[1];
}

std::optional<SpectralLine> strongest_line(const std::vector<ResidualRow>& rows, const Eigen::VectorXd& residual) {
  std::optional<SpectralLine> best;
  for (const auto& [key, series] : series_of(rows, residual)) {
    if (series.value.size() < 100) continue;
    const double length_s = series.time_s.back() - series.time_s.front();
    if (length_s < 2) continue;
    std::vector<double> frequencies;
    const auto lines =
        static_cast<std::size_t>(std::max(0.0, 2 * length_s * (highest_told_Hz(series.time_s) - lowest_line_Hz)));
    frequencies.reserve(lines);
    for (std::size_t i = 0; i < lines; ++i)
      frequencies.push_back(lowest_line_Hz + 0.5 * static_cast<double>(i) / length_s);
    if (frequencies.empty()) continue;
    const std::vector<double> power = powers(series, frequencies);
    for (std::size_t i = 0; i < power.size(); ++i) {
      const double ratio = power[i] / std::max(running_median(power, i), 1e-300);
      if (best && ratio <= best->ratio) continue;
      const double sigma = series.sigma[series.sigma.size() / 2];
      best = SpectralLine{key.first, frequencies[i], std::sqrt(power[i]) * sigma, ratio};
    }
  }
  return best;
}

std::optional<SpectralLine> line_in_motion(const std::vector<ResidualRow>& rows, const Eigen::VectorXd& residual,
                                           int channel) {
  std::map<int, Series> moving;  // of each recording
  double top = 0, total = 0, longest_s = 0, sigma = 1;
  std::size_t count = 0;
  for (const ResidualRow& row : rows) top = std::max(top, std::abs(row.velocity_mps));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].channel != channel || std::abs(rows[i].velocity_mps) < moving_share * top) continue;
    Series& series = moving[rows[i].recording];
    const double value = residual(static_cast<Eigen::Index>(i));
    series.time_s.push_back(rows[i].time_s);
    series.value.push_back(value);
    longest_s = std::max(longest_s, series.time_s.back() - series.time_s.front());
    total += value * value;
    sigma = rows[i].sigma;
    ++count;
  }
  if (count < 100 || !(longest_s > 0)) return std::nullopt;
  SpectralLine best{channel, 0, 0, 0};
  double highest_Hz = highest_line_Hz;
  for (const auto& [recording, series] : moving) highest_Hz = std::min(highest_Hz, highest_told_Hz(series.time_s));
  const int lines = static_cast<int>(4 * longest_s * (highest_Hz - lowest_line_Hz));
  for (int line = 0; line < lines; ++line) {
    const double frequency = lowest_line_Hz + 0.25 * line / longest_s;
    double taken = 0, squares = 0;
    for (const auto& [recording, series] : moving) {
      Eigen::Matrix2d a = Eigen::Matrix2d::Zero();
      Eigen::Vector2d b = Eigen::Vector2d::Zero();
      for (std::size_t i = 0; i < series.value.size(); ++i) {
        const double phase = 2 * M_PI * frequency * series.time_s[i];
        const Eigen::Vector2d sine(std::cos(phase), std::sin(phase));
        a += sine * sine.transpose();
        b += sine * series.value[i];
      }
      const Eigen::Vector2d amplitude = (a + 1e-9 * Eigen::Matrix2d::Identity()).ldlt().solve(b);
      taken += amplitude.dot(b);
      squares += amplitude.squaredNorm() * static_cast<double>(series.value.size()) / static_cast<double>(count);
    }
    if (taken <= best.ratio * total) continue;
    best = {channel, frequency, std::sqrt(squares) * sigma, taken / std::max(total, 1e-300)};
  }
  return best;
}

std::optional<SpatialPeriod> strongest_period(const std::vector<ResidualRow>& rows, const Eigen::VectorXd& residual,
                                              int channel) {
  std::vector<double> position, value;
  double lowest = 1e300, highest = -1e300, top = 0, total = 0, sigma = 1;
  for (const ResidualRow& row : rows) top = std::max(top, std::abs(row.velocity_mps));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].channel != channel || std::abs(rows[i].velocity_mps) < 0.02 * top) continue;
    position.push_back(rows[i].position_m);
    value.push_back(residual(static_cast<Eigen::Index>(i)));
    lowest = std::min(lowest, position.back());
    highest = std::max(highest, position.back());
    sigma = rows[i].sigma;
  }
  const double way = highest - lowest, count = static_cast<double>(value.size());
  if (value.size() < 100 || !(way > 3 * shortest_period_m)) return std::nullopt;
  double mean = 0;
  for (const double v : value) mean += v / count;
  for (const double v : value) total += (v - mean) * (v - mean);
  SpatialPeriod best;
  double most = 0;
  const int periods = static_cast<int>(4 * (way / shortest_period_m - 3));
  for (int period = 0; period < periods; ++period) {
    const double per_m = (3 + 0.25 * period) / way;
    double in_phase = 0, across = 0;
    for (std::size_t i = 0; i < value.size(); ++i) {
      in_phase += (value[i] - mean) * std::cos(2 * M_PI * per_m * position[i]);
      across += (value[i] - mean) * std::sin(2 * M_PI * per_m * position[i]);
    }
    const double power = 2 / count * (in_phase * in_phase + across * across);
    if (power <= most) continue;
    most = power;
    best = {1 / per_m, std::sqrt(2 * power / count) * sigma, power / std::max(total - count, 1e-300)};
  }
  return best.share > least_periodic_share && best.share <= 1 ? std::optional(best) : std::nullopt;
}

std::vector<ElementPattern> element_patterns(const std::vector<ResidualRow>& rows, const Eigen::VectorXd& residual,
                                             const Eigen::MatrixXd& patterns,
                                             const std::vector<std::string>& elements) {
  std::map<std::pair<int, long>, std::vector<Eigen::Index>> stretches;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (!rows[i].over_recording)
      stretches[{rows[i].recording, std::lround(std::floor(rows[i].time_s / stretch_s))}].push_back(
          static_cast<Eigen::Index>(i));
  std::map<std::string, double> explained;
  const double total = std::max(residual.squaredNorm(), 1e-300);
  for (const auto& [key, members] : stretches) {
    const Eigen::VectorXd here = residual(members);
    std::map<std::string, double> best;
    for (Eigen::Index p = 0; p < patterns.cols(); ++p) {
      const Eigen::VectorXd pattern = patterns.col(p)(members);
      const double norm = pattern.squaredNorm();
      if (!(norm > 1e-20)) continue;
      const double gain = std::pow(pattern.dot(here), 2) / norm;
      double& most = best[elements[static_cast<std::size_t>(p)]];
      most = std::max(most, gain);
    }
    for (const auto& [element, gain] : best) explained[element] += gain / total;
  }
  std::vector<ElementPattern> out;
  out.reserve(explained.size());
  for (const auto& [element, share] : explained) out.push_back({element, share});
  std::stable_sort(out.begin(), out.end(),
                   [](const ElementPattern& a, const ElementPattern& b) { return a.explained > b.explained; });
  return out;
}

}  // namespace pneuservo
