// Gaussian smoothing of sampled signals and its derivatives: symmetric, without lag, exact on polynomials.
#include "diagnosis/residuals/gaussian_kernel.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace pneuservo {

GaussianKernel::GaussianKernel(double sigma_s, double period_s) : sigma_s_(sigma_s) {
  const double sigma = sigma_s / period_s;
  const int reach = static_cast<int>(std::ceil(6 * sigma));
  const int count = 2 * reach + 1;
  // Taps of order n are the Gaussian times a polynomial of degree n (as its n-th derivative is), with coefficients
  // such that the moments of order 0 ... n are 0, ..., 0, n!.
  for (int order = 0; order < 4; ++order) {
    Eigen::MatrixXd moments = Eigen::MatrixXd::Zero(order + 1, order + 1);
    const auto weight = [&](int k) { return std::exp(-0.5 * (k / sigma) * (k / sigma)); };
    for (int k = -reach; k <= reach; ++k)
      for (int i = 0; i <= order; ++i)
        for (int j = 0; j <= order; ++j) moments(i, j) += weight(k) * std::pow(k / sigma, i + j);
    Eigen::VectorXd wanted = Eigen::VectorXd::Zero(order + 1);
    wanted(order) = std::tgamma(order + 1.0) / std::pow(sigma_s, order);
    const Eigen::VectorXd coefficients = moments.colPivHouseholderQr().solve(wanted);
    taps_[order].resize(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      const int k = i - reach;
      double polynomial = 0;
      for (int j = order; j >= 0; --j) polynomial = polynomial * (k / sigma) + coefficients(j);
      taps_[order][static_cast<std::size_t>(i)] = weight(k) * polynomial;
    }
  }
}

std::vector<double> GaussianKernel::apply(std::span<const double> signal, int order) const {
  const std::vector<double>& taps = taps_[order];
  const std::size_t reach = this->reach(), count = signal.size();
  std::vector<double> padded(count + 2 * reach), out(count);
  if (count == 0) return out;
  std::fill_n(padded.begin(), reach, signal.front());
  std::copy(signal.begin(), signal.end(), padded.begin() + static_cast<std::ptrdiff_t>(reach));
  std::fill_n(padded.end() - static_cast<std::ptrdiff_t>(reach), reach, signal.back());
  // Row i of this matrix is what the taps see at sample i: each column begins one sample after the one before.
  using Seen = Eigen::Map<const Eigen::MatrixXd, Eigen::Unaligned, Eigen::OuterStride<>>;
  const auto rows = static_cast<Eigen::Index>(count), columns = static_cast<Eigen::Index>(taps.size());
  Eigen::Map<Eigen::VectorXd>(out.data(), rows).noalias() =
      Seen(padded.data(), rows, columns, Eigen::OuterStride<>(1)) *
      Eigen::Map<const Eigen::VectorXd>(taps.data(), columns);
  return out;
}

double GaussianKernel::noise_gain(int order, std::size_t count) const {
  const std::vector<double>& taps = taps_[order];
  std::vector<double> mean(taps.size() + count - 1, 0.0);
  for (std::size_t shift = 0; shift < count; ++shift)
    for (std::size_t k = 0; k < taps.size(); ++k) mean[k + shift] += taps[k] / static_cast<double>(count);
  double sum = 0;
  for (const double tap : mean) sum += tap * tap;
  return std::sqrt(sum);
}

std::vector<double> held_over_gaps(std::span<const double> signal) {
  std::vector<double> out(signal.begin(), signal.end());
  const auto first = std::find_if(out.begin(), out.end(), [](double value) { return std::isfinite(value); });
  double last = first == out.end() ? 0.0 : *first;
  for (double& value : out) {
    if (!std::isfinite(value)) value = last;
    last = value;
  }
  return out;
}

}  // namespace pneuservo
