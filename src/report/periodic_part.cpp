// The periodic part of a signal that a reference does not explain.
#include <report/periodic_part.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

namespace pneuservo {
namespace {

constexpr std::size_t fewest_samples = 64;
constexpr double span_s = 0.6;         // over which a loop answers its reference
constexpr int lags = 16;
constexpr int harmonics = 9;           // of a sine: more are below the noise
constexpr double ridge = 1e-9;         // relative: lags of a smooth reference are nearly dependent
constexpr int line_bins = 2;           // half width of a line behind a Hann window

using Vector = Eigen::VectorXd;

/// Columns that explain a signal, one a row of its samples.
class PeriodicExplanation {
 public:
  PeriodicExplanation(const std::vector<double>& reference, std::size_t history, double period_s)
      : history_(static_cast<Eigen::Index>(history)), n_(static_cast<Eigen::Index>(reference.size()) - history_),
        period_s_(period_s), time_(Vector::LinSpaced(n_, 0.0, 1.0)) {
    position_ = Eigen::Map<const Vector>(reference.data(), history_ + n_);
    speed_ = Vector::Zero(history_ + n_);
    speed_.tail(history_ + n_ - 1) = position_.tail(history_ + n_ - 1) - position_.head(history_ + n_ - 1);
    if (const double scale = position_.cwiseAbs().maxCoeff(); scale > 0.0) position_ /= scale;
    moves_ = speed_.cwiseAbs().maxCoeff() > 0.0;
    if (moves_) speed_ /= speed_.cwiseAbs().maxCoeff();
  }

  /// A constant and a trend.
  void add_trend() {
    columns_.emplace_back(Vector::Ones(n_));
    columns_.push_back(time_);
  }
  /// Reference and speed at even lags, and at every fourth of them products of both.
  void add_reference() {
    for (int i = 0; i < lags && moves_; ++i) {
      const Vector r = lagged(position_, i), v = lagged(speed_, i);
      for (const Vector& column : {r, v}) columns_.push_back(column);
      if (i % 4 != 0) continue;
      const Vector size = v.cwiseAbs(), square = r.cwiseProduct(r);
      for (const Vector& column : {size, Vector(v.cwiseProduct(size)), square, Vector(r.cwiseProduct(v)),
                                   Vector(square.cwiseProduct(r)), Vector(square.cwiseProduct(v))})
        columns_.push_back(column);
    }
  }
  void add_harmonics(double line_Hz) {
    const double length_s = static_cast<double>(n_ - 1) * period_s_;
    for (int h = 1; h <= harmonics; ++h) {
      const auto angle = 2.0 * std::numbers::pi * h * line_Hz * length_s * time_.array();
      columns_.emplace_back(angle.cos());
      columns_.emplace_back(angle.sin());
    }
  }
  Eigen::MatrixXd matrix() const {
    Eigen::MatrixXd out(n_, static_cast<Eigen::Index>(columns_.size()));
    for (std::size_t i = 0; i < columns_.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = columns_[i];
    return out;
  }

 private:
  /// What stood before the history counts as its first value.
  Vector lagged(const Vector& x, int lag) const {
    const auto by = static_cast<Eigen::Index>(std::llround(lag * span_s / (lags - 1) / period_s_));
    Vector out(n_);
    for (Eigen::Index k = 0; k < n_; ++k) out(k) = x(std::max<Eigen::Index>(0, history_ + k - by));
    return out;
  }

  Eigen::Index history_, n_;
  double period_s_;
  Vector time_, position_, speed_;
  bool moves_ = false;
  std::vector<Vector> columns_;
};

double rms(std::span<const double> values) {
  double square = 0.0;
  for (const double value : values) square += value * value;
  return values.empty() ? 0.0 : std::sqrt(square / static_cast<double>(values.size()));
}

}  // namespace

std::vector<double> left_over(const std::vector<double>& signal, const std::vector<double>& reference, double period_s,
                              const std::vector<double>& lines_Hz) {
  const std::size_t n = signal.size();
  if (n < fewest_samples || reference.size() < n) return std::vector<double>(n, 0.0);
  PeriodicExplanation explanation(reference, reference.size() - n, period_s);
  explanation.add_trend();
  explanation.add_reference();
  for (const double line_Hz : lines_Hz) explanation.add_harmonics(line_Hz);
  const Eigen::MatrixXd base = explanation.matrix();
  const Eigen::Map<const Vector> y(signal.data(), static_cast<Eigen::Index>(n));
  Eigen::MatrixXd normal = base.transpose() * base;
  normal.diagonal().array() += ridge * normal.diagonal().array() + 1e-30;
  const Vector left = y - base * normal.ldlt().solve(base.transpose() * y);
  return {left.data(), left.data() + n};
}

double line_amplitude(std::span<const double> signal, double turns_per_sample) {
  std::complex<double> sum = 0.0;
  double weights = 0.0;
  const auto n = static_cast<double>(signal.size());
  for (std::size_t k = 0; k < signal.size(); ++k) {
    const auto at = static_cast<double>(k);
    const double weight = 1.0 - std::cos(2.0 * std::numbers::pi * (at + 0.5) / n);
    sum += weight * signal[k] * std::polar(1.0, -2.0 * std::numbers::pi * turns_per_sample * at);
    weights += weight;
  }
  return weights > 0.0 ? 2.0 * std::abs(sum) / weights : 0.0;
}

PeriodicPart periodic_part(const std::vector<double>& left, double period_s) {
  PeriodicPart out;
  const std::size_t n = left.size();
  if (n < fewest_samples) return out;
  std::vector<double> windowed(n);
  for (std::size_t k = 0; k < n; ++k) {
    windowed[k] =
        left[k] * (1.0 - std::cos(2.0 * std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(n)));
  }
  out.left_rms = rms(left);
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, windowed);
  const std::size_t half = n / 2;
  std::size_t peak = 0;
  double total = 0.0;
  for (std::size_t i = 1; i < half; ++i) {
    total += std::norm(spectrum[i]);
    if (i >= 2 && (peak == 0 || std::norm(spectrum[i]) > std::norm(spectrum[peak]))) peak = i;
  }
  if (!(total > 0.0)) return out;
  double in_line = 0.0;
  for (std::size_t at = peak; at < half; at += peak)
    for (std::size_t i = at - std::min<std::size_t>(at - 1, line_bins); i <= std::min(at + line_bins, half - 1); ++i)
      if (at == peak || i > at - peak + line_bins) in_line += std::norm(spectrum[i]);
  out.share = std::min(1.0, in_line / total);
  // Between the bins: the centre of the line's three largest.
  double moment = 0.0, weight = 0.0;
  for (std::size_t i = peak - 1; i <= peak + 1; ++i) {
    moment += static_cast<double>(i) * std::norm(spectrum[i]);
    weight += std::norm(spectrum[i]);
  }
  const double turns = moment / weight / static_cast<double>(n);
  out.frequency_Hz = turns / period_s;
  out.amplitude = line_amplitude(left, turns);
  const std::span<const double> all(left);
  const double first = rms(all.first(n / 2)), last = rms(all.last(n / 2));
  out.growth = first > 0.0 ? last / first : 0.0;
  return out;
}

}  // namespace pneuservo
