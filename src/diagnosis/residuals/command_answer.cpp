// The quick answer of a port's pressure to the steps of the command.
#include "diagnosis/residuals/command_answer.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace pneuservo {

namespace {

/// Directions in which the command hardly moves (as a share of the strongest) say nothing.
constexpr double least_direction = 1e-3;
constexpr Eigen::Index fewest_windows = 50;
constexpr double least_step_V = 1e-5;  ///< root mean square of the command's quick part

/// I - P: takes a parabola out of a window.
Eigen::MatrixXd without_parabola() {
  constexpr auto n = static_cast<Eigen::Index>(CommandAnswer::window);
  Eigen::MatrixXd powers(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(n) - 1.0;
    powers.row(i) << 1.0, t, t * t;
  }
  const Eigen::MatrixXd normal = powers.transpose() * powers;
  return Eigen::MatrixXd::Identity(n, n) - powers * normal.ldlt().solve(powers.transpose());
}

}  // namespace

CommandAnswer::CommandAnswer(const std::vector<double>& command, const std::vector<char>& used) {
  for (std::size_t at = latest; at + window <= command.size(); at += window)
    if (std::all_of(used.begin() + static_cast<std::ptrdiff_t>(at),
                    used.begin() + static_cast<std::ptrdiff_t>(at + window), [](char is) { return is != 0; }))
      first_.push_back(at);
  const auto windows = static_cast<Eigen::Index>(first_.size());
  if (windows < fewest_windows) return;
  constexpr auto n = static_cast<Eigen::Index>(window), lags = static_cast<Eigen::Index>(latest);
  const Eigen::MatrixXd quick = without_parabola();
  Eigen::MatrixXd earlier(windows * n, lags);
  for (Eigen::Index w = 0; w < windows; ++w) {
    Eigen::MatrixXd here(n, lags);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index lag = 0; lag < lags; ++lag)
        here(i, lag) =
            command[first_[static_cast<std::size_t>(w)] + static_cast<std::size_t>(i - lag - 1 + lags) - latest];
    earlier.middleRows(w * n, n) = quick * here;
  }
  const Eigen::MatrixXd normal = earlier.transpose() * earlier;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solved(normal);
  const double strongest = solved.eigenvalues()(lags - 1);
  if (strongest < least_step_V * least_step_V * static_cast<double>(windows * n)) return;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < lags; ++i)
    if (solved.eigenvalues()(i) > least_direction * strongest) kept.push_back(i);
  const Eigen::VectorXd scale = solved.eigenvalues()(kept).array().sqrt().inverse().matrix();
  basis_ = earlier * solved.eigenvectors()(Eigen::all, kept) * scale.asDiagonal();
}

Eigen::VectorXd CommandAnswer::of(const std::vector<double>& signal) const {
  Eigen::VectorXd samples(basis_.rows());
  for (std::size_t w = 0; w < first_.size() && basis_.cols() > 0; ++w)
    for (std::size_t i = 0; i < window; ++i) samples(static_cast<Eigen::Index>(w * window + i)) = signal[first_[w] + i];
  return basis_.transpose() * samples;
}

Eigen::VectorXd CommandAnswer::turn_along(const std::vector<Eigen::VectorXd>& possible) {
  if (possible.empty()) return Eigen::VectorXd::Zero(rows());
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(rows(), rows());
  for (const Eigen::VectorXd& one : possible) spread += one * one.transpose() / static_cast<double>(possible.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solved(spread);
  basis_ *= solved.eigenvectors();
  return solved.eigenvalues().cwiseMax(0.0).cwiseSqrt();
}

double CommandAnswer::quick_part(const std::vector<double>& signal) const {
  const Eigen::MatrixXd quick = without_parabola();
  double sum = 0;
  for (const std::size_t first : first_)
    sum += (quick * Eigen::Map<const Eigen::VectorXd>(signal.data() + first, quick.cols())).squaredNorm();
  return first_.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(first_.size() * (window - 3)));
}

}  // namespace pneuservo
