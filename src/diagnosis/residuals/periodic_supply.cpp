// Two runs of the model at each frequency, and the sine that they foretell the best of what is left with.
#include "diagnosis/residuals/periodic_supply.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>

namespace pneuservo {

namespace {

constexpr double least_periods = 2;  ///< within the longest recording: what turns more slowly is a drift
constexpr double highest_Hz = 15;
constexpr double steps_per_line = 2;  ///< of the resolution that the longest recording has
constexpr double line_width = 1.5;    ///< of the same: beyond it is another frequency
constexpr double tried_Pa = 1000;     ///< small beside any supply, large beside rounding
constexpr std::size_t frequencies_at_once = 16;

/// Which of the fitted rows belong to each recording.
std::vector<std::vector<Eigen::Index>> rows_of_recordings(const FittedRows& rows) {
  std::map<int, std::vector<Eigen::Index>> of;
  for (Eigen::Index i = 0; i < rows.count(); ++i)
    if (!rows.row(i).over_recording) of[rows.row(i).recording].push_back(i);
  std::vector<std::vector<Eigen::Index>> out;
  for (auto& [recording, indices] : of) out.push_back(std::move(indices));
  return out;
}

double longest_recording_s(const std::vector<ResidualRow>& rows) {
  std::map<int, std::pair<double, double>> ends;
  double longest_s = 0;
  for (const ResidualRow& row : rows) {
    auto& [first, last] = ends.emplace(row.recording, std::pair(row.time_s, row.time_s)).first->second;
    first = std::min(first, row.time_s);
    last = std::max(last, row.time_s);
    longest_s = std::max(longest_s, last - first);
  }
  return longest_s;
}

/// What a sine at one frequency takes of each recording's rows, and with which amplitude.
PeriodicSupply best_sine(double frequency_Hz, const std::vector<std::vector<Eigen::Index>>& recordings,
                         const Eigen::VectorXd& left, const Eigen::MatrixXd& answers) {
  PeriodicSupply out{frequency_Hz, 0, 0, 0};
  double all = 1e-300;
  for (const std::vector<Eigen::Index>& rows : recordings) {
    const Eigen::MatrixXd pattern = answers(rows, Eigen::all);
    const Eigen::VectorXd here = left(rows);
    all += here.squaredNorm();
    const Eigen::Matrix2d a = pattern.transpose() * pattern;
    const Eigen::Vector2d b = -pattern.transpose() * here;  // what the swing does is to cancel what is left
    if (!(a.trace() > 0)) continue;
    const Eigen::Vector2d size = (a + 1e-9 * a.trace() * Eigen::Matrix2d::Identity()).ldlt().solve(b);
    out.share += size.dot(b);
    out.amplitude_Pa += size.squaredNorm() * tried_Pa * tried_Pa / static_cast<double>(recordings.size());
  }
  out.share /= all;
  out.amplitude_Pa = std::sqrt(out.amplitude_Pa);
  return out;
}

/// What a sine at each of these frequencies would take of what is left; of those that the model answers to.
std::vector<PeriodicSupply> sines_at(const std::vector<double>& frequencies_Hz, FittedRows& rows,
                                     const Hypothesis& hypothesis, const Eigen::VectorXd& left) {
  const std::vector<std::vector<Eigen::Index>> recordings = rows_of_recordings(rows);
  std::vector<PeriodicSupply> sines;
  for (std::size_t first = 0; first < frequencies_Hz.size(); first += frequencies_at_once) {
    const std::size_t count = std::min(frequencies_at_once, frequencies_Hz.size() - first);
    std::vector<Hypothesis> swings;
    for (std::size_t i = 0; i < count; ++i)
      for (const bool is_cosine : {true, false}) {
        swings.push_back(hypothesis);
        swings.back().rig.axis.effects.supply_swing = {tried_Pa, frequencies_Hz[first + i],
                                                       is_cosine ? 0.5 * std::numbers::pi : 0.0};
      }
    Eigen::MatrixXd answers = rows(swings);
    answers.colwise() -= left;
    if (!answers.allFinite() || answers.squaredNorm() == 0) continue;
    for (std::size_t i = 0; i < count; ++i)
      sines.push_back(best_sine(frequencies_Hz[first + i], recordings, left,
                                answers.middleCols(2 * static_cast<Eigen::Index>(i), 2)));
  }
  return sines;
}

}  // namespace

std::optional<PeriodicSupply> strongest_supply_swing(FittedRows& rows, const Hypothesis& hypothesis) {
  const double longest_s = longest_recording_s(rows.model().rows());
  const Eigen::VectorXd left = rows({hypothesis}).col(0);
  if (!(longest_s > 0) || !left.allFinite()) return std::nullopt;
  std::vector<double> frequencies_Hz;
  for (double f = least_periods / longest_s; f <= highest_Hz; f += 1 / (steps_per_line * longest_s))
    frequencies_Hz.push_back(f);
  const std::vector<PeriodicSupply> sines = sines_at(frequencies_Hz, rows, hypothesis, left);
  if (sines.empty()) return std::nullopt;
  PeriodicSupply best = *std::ranges::max_element(sines, {}, &PeriodicSupply::share);
  for (const PeriodicSupply& sine : sines)
    if (std::abs(sine.frequency_Hz - best.frequency_Hz) * longest_s > line_width)
      best.next_share = std::max(best.next_share, sine.share);
  frequencies_Hz.clear();  // a sine between two of them loses a fifth of its power
  for (int step = -2; step <= 2; ++step)
    if (step != 0) frequencies_Hz.push_back(best.frequency_Hz + step / (3 * steps_per_line * longest_s));
  for (const PeriodicSupply& sine : sines_at(frequencies_Hz, rows, hypothesis, left))
    if (sine.share > best.share) best = {sine.frequency_Hz, sine.amplitude_Pa, sine.share, best.next_share};
  return best;
}

}  // namespace pneuservo
