// The quick answer of a port's pressure to the steps of the command.
#include "diagnosis/residuals/command_answer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace pneuservo {

namespace {

/// Directions in which the command hardly moves (as a share of the strongest) say nothing.
constexpr double least_direction = 1e-3;
constexpr std::size_t fewest_places = 1000;  ///< chance makes two directions of so many alike by 3 %
constexpr double least_step_V = 1e-5;  ///< root mean square of the command's quick part

using Weights = std::array<double, CommandAnswer::window>;

/// Of the samples 1, 2, ... away on one side: the least-squares parabola through them at the sample itself.
Weights parabola_weights() {
  constexpr auto n = static_cast<Eigen::Index>(CommandAnswer::window);
  Eigen::MatrixXd powers(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = static_cast<double>(i + 1) / static_cast<double>(n);
    powers.row(i) << 1.0, t, t * t;
  }
  const Eigen::VectorXd weights =
      powers * (powers.transpose() * powers).ldlt().solve(Eigen::Vector3d::Unit(0));  // the parabola at t = 0
  Weights out;
  std::copy(weights.data(), weights.data() + n, out.begin());
  return out;
}

const Weights& weights() {
  static const Weights all = parabola_weights();
  return all;
}

}  // namespace

CommandAnswer::CommandAnswer(const std::vector<double>& command, const std::vector<char>& used) {
  std::size_t run = 0;  // samples from `at` on that may be looked at
  for (std::size_t at = command.size(); at-- > latest + window;) {
    run = used[at] ? run + 1 : 0;
    if (run > window) places_.push_back(at);
  }
  std::reverse(places_.begin(), places_.end());
  if (places_.size() < fewest_places) return;
  const Weights& weight = weights();
  std::vector<double> quick(command.size(), 0.0);
  for (std::size_t k = window; k < command.size(); ++k) {
    quick[k] = command[k];
    for (std::size_t i = 0; i < window; ++i) quick[k] -= weight[i] * command[k - 1 - i];
  }
  constexpr auto lags = static_cast<Eigen::Index>(latest);
  Eigen::MatrixXd earlier = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(command.size()), lags);
  for (const std::size_t k : places_)
    for (Eigen::Index lag = 0; lag < lags; ++lag) {
      const double value = quick[k - 1 - static_cast<std::size_t>(lag)];
      const auto at = static_cast<Eigen::Index>(k);
      earlier(at, lag) += value;
      for (std::size_t i = 0; i < window; ++i) earlier(at + 1 + static_cast<Eigen::Index>(i), lag) -= weight[i] * value;
    }
  const Eigen::MatrixXd normal = earlier.transpose() * earlier;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solved(normal);
  const double strongest = solved.eigenvalues()(lags - 1);
  if (strongest < least_step_V * least_step_V * static_cast<double>(places_.size())) return;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < lags; ++i)
    if (solved.eigenvalues()(i) > least_direction * strongest) kept.push_back(i);
  const Eigen::VectorXd scale = solved.eigenvalues()(kept).array().sqrt().inverse().matrix();
  for (Eigen::Index k = 0; k < earlier.rows(); ++k)
    if (earlier.row(k).any()) looked_at_.push_back(static_cast<std::size_t>(k));
  basis_ = earlier(looked_at_, Eigen::all) * solved.eigenvectors()(Eigen::all, kept) * scale.asDiagonal();
}

Eigen::VectorXd CommandAnswer::of(const std::vector<double>& signal) const {
  if (basis_.cols() == 0) return {};
  Eigen::VectorXd there(basis_.rows());
  for (std::size_t i = 0; i < looked_at_.size(); ++i) there(static_cast<Eigen::Index>(i)) = signal[looked_at_[i]];
  return basis_.transpose() * there;
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
  const Weights& weight = weights();
  double sum = 0, gain = 1;
  for (const double one : weight) gain += one * one;
  for (const std::size_t k : places_) {
    double quick = signal[k];
    for (std::size_t i = 0; i < window; ++i) quick -= weight[i] * signal[k + 1 + i];
    sum += quick * quick / gain;
  }
  return places_.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(places_.size()));
}

}  // namespace pneuservo
