// Two runs of the model at each frequency, and the sine that takes most of what is left.
#include "diagnosis/residuals/periodic_supply.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <span>
#include <vector>

#include <Eigen/Cholesky>

namespace pneuservo {

namespace {

constexpr double least_periods = 2;  ///< within the longest recording: what turns more slowly is a drift
constexpr double highest_Hz = 15;
/// Of what the longest recording resolves: a sine has its main lobe and the peak of its first side lobe within, and
/// 4.5 % of its power at any frequency beyond.
constexpr double line_width = 1.5;
constexpr double tried_Pa = 1000;  ///< small beside any supply, large beside rounding
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

/// What a sine at one frequency takes of each recording's rows, and with which amplitude. `answers`: of each row, to a
/// cosine (real part) and to a sine.
PeriodicSupply best_sine(double frequency_Hz, const std::vector<std::vector<Eigen::Index>>& recordings,
                         const Eigen::VectorXd& left, const Eigen::VectorXcd& answers) {
  PeriodicSupply out{frequency_Hz, 0, 0, 0};
  double all = 1e-300;
  for (const std::vector<Eigen::Index>& rows : recordings) {
    Eigen::MatrixX2d pattern(static_cast<Eigen::Index>(rows.size()), 2);
    pattern << answers.real()(rows), answers.imag()(rows);
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

/// What sines of the supply would take of what a hypothesis leaves.
class SupplySweep {
 public:
  SupplySweep(FittedRows& rows, const Hypothesis& hypothesis)
      : rows_(rows), hypothesis_(hypothesis), recordings_(rows_of_recordings(rows)), left_(rows({hypothesis}).col(0)),
        time_s_(rows.count()) {
    std::map<int, double> begin_s;
    for (Eigen::Index i = 0; i < rows.count(); ++i) {
      const auto begin = begin_s.emplace(rows.row(i).recording, rows.row(i).time_s).first;
      time_s_(i) = rows.row(i).time_s - begin->second;
    }
  }

  bool is_usable() const { return left_.allFinite(); }

  /// At each of these frequencies, and where they are `step_Hz` apart between two of them; of those that the model
  /// answers to. A row's answer over that of the supply at its time changes little between two frequencies, for gas
  /// remembers a small part of a recording: between them it is the mean of both.
  std::vector<PeriodicSupply> at(const std::vector<double>& frequencies_Hz, double step_Hz = 0) {
    std::vector<PeriodicSupply> sines;
    const Eigen::ArrayXcd half_a_step = (std::complex<double>(0, std::numbers::pi * step_Hz) * time_s_).exp();
    Eigen::VectorXcd before;
    for (std::size_t first = 0; first < frequencies_Hz.size(); first += frequencies_at_once) {
      const std::size_t count = std::min(frequencies_at_once, frequencies_Hz.size() - first);
      const Eigen::MatrixXcd answers = answers_at(std::span(frequencies_Hz).subspan(first, count));
      if (!answers.allFinite() || answers.squaredNorm() == 0) {
        before.resize(0);
        continue;
      }
      for (std::size_t i = 0; i < count; ++i) {
        const double f = frequencies_Hz[first + i];
        const Eigen::VectorXcd here = answers.col(static_cast<Eigen::Index>(i));
        if (step_Hz > 0 && before.size() > 0)
          sines.push_back(best_sine(f - 0.5 * step_Hz, recordings_, left_,
                                    0.5 * (before.array() * half_a_step + here.array() / half_a_step)));
        sines.push_back(best_sine(f, recordings_, left_, here));
        before = here;
      }
    }
    return sines;
  }

 private:
  /// Of each row, to a cosine (real part) and to a sine at each frequency.
  Eigen::MatrixXcd answers_at(std::span<const double> frequencies_Hz) {
    std::vector<Hypothesis> swings;
    for (const double phase : {0.5 * std::numbers::pi, 0.0})
      for (const double f : frequencies_Hz) {
        swings.push_back(hypothesis_);
        swings.back().rig.axis.effects.supply_swing = {tried_Pa, f, phase};
      }
    Eigen::MatrixXd answers = rows_(swings);
    answers.colwise() -= left_;
    const auto count = static_cast<Eigen::Index>(frequencies_Hz.size());
    Eigen::MatrixXcd out(answers.rows(), count);
    out.real() = answers.leftCols(count);
    out.imag() = answers.rightCols(count);
    return out;
  }

  FittedRows& rows_;
  const Hypothesis& hypothesis_;
  std::vector<std::vector<Eigen::Index>> recordings_;
  Eigen::VectorXd left_;
  Eigen::ArrayXd time_s_;  ///< of each row since its recording's first
};

}  // namespace

std::optional<PeriodicSupply> strongest_supply_swing(FittedRows& rows, const Hypothesis& hypothesis) {
  const double longest_s = longest_recording_s(rows.model().rows());
  SupplySweep sweep(rows, hypothesis);
  if (!(longest_s > 0) || !sweep.is_usable()) return std::nullopt;
  const double line_Hz = 1 / longest_s;  // what the longest recording resolves
  std::vector<double> frequencies_Hz;
  for (double f = least_periods * line_Hz; f <= highest_Hz; f += line_Hz) frequencies_Hz.push_back(f);
  const std::vector<PeriodicSupply> sines = sweep.at(frequencies_Hz, line_Hz);
  if (sines.empty()) return std::nullopt;
  PeriodicSupply best = *std::ranges::max_element(sines, {}, &PeriodicSupply::share);
  double next_share = 0;
  for (const PeriodicSupply& sine : sines)
    if (std::abs(sine.frequency_Hz - best.frequency_Hz) > line_width * line_Hz)
      next_share = std::max(next_share, sine.share);
  frequencies_Hz.clear();  // a sine between two of them loses a fifth of its power
  for (int step = -2; step <= 2; ++step) frequencies_Hz.push_back(best.frequency_Hz + step * line_Hz / 6);
  best.share = 0;
  for (const PeriodicSupply& sine : sweep.at(frequencies_Hz))
    if (sine.share > best.share) best = sine;
  best.next_share = next_share;
  return best;
}

}  // namespace pneuservo
