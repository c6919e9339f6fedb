// Natural frequency and damping of a line from recorded pressures at both of its ends.
#include "acoustics/line_identification.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>

#include <Eigen/Dense>
#include <unsupported/Eigen/FFT>

namespace pneuservo {
namespace {

using Complex = std::complex<double>;
constexpr int unknowns = 4;
using Unknowns = Eigen::Matrix<double, unknowns, 1>;  // log of length, losses, volume over the belief; gain less one
constexpr std::size_t fewest_rows = 64;
// Beyond three times the first resonance a lumped sensor volume and the fittings say more than the line.
constexpr double highest_over_first = 3.0;

/// One frequency of the recording: changes of both pressures over what a difference makes of white noise.
struct Bin {
  Complex s;
  Complex in_Pa, out_Pa;
};

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Rows at each end that are taken for rest: enough to leave a tenth of their noise in a recording of 10 000 rows.
std::size_t rows_at_rest(std::size_t rows) { return std::max<std::size_t>(rows / 100, 1); }

/// Spectrum of the differences between rows: a pressure that begins and ends at rest has no step at its ends then. Each
/// end is its mean, for a step of the noise between the ends would look like a slow change.
std::vector<Complex> spectrum_of_changes(std::vector<double> values) {
  const auto rest = static_cast<std::ptrdiff_t>(rows_at_rest(values.size()));
  const auto still = [&](auto begin, auto end) {
    std::fill(begin, end, std::accumulate(begin, end, 0.0) / static_cast<double>(rest));
  };
  still(values.begin(), values.begin() + rest);
  still(values.end() - rest, values.end());
  std::vector<double> changes(values.size() - 1);
  for (std::size_t i = 0; i < changes.size(); ++i) changes[i] = values[i + 1] - values[i];
  std::vector<Complex> out;
  Eigen::FFT<double> fft;
  fft.fwd(out, changes);
  return out;
}

std::vector<Bin> bins_of(const LinePressures& pressures, double highest_Hz) {
  const std::vector<Complex> in = spectrum_of_changes(pressures.in_Pa), out = spectrum_of_changes(pressures.out_Pa);
  const double rows = static_cast<double>(in.size()), spacing_Hz = 1.0 / (rows * pressures.period_s);
  std::vector<Bin> bins;
  for (std::size_t k = 1; k < in.size() / 2 && static_cast<double>(k) * spacing_Hz <= highest_Hz; ++k) {
    const Complex s(0.0, 2.0 * std::numbers::pi * static_cast<double>(k) * spacing_Hz);
    const double scale = 1.0 / (std::sqrt(rows) * std::abs(1.0 - std::exp(-s * pressures.period_s)));
    bins.push_back({s, in[k] * scale * std::exp(s * pressures.in_age_s), out[k] * scale});
  }
  return bins;
}

class LineFit {
 public:
  LineFit(const LineBelief& belief, double pressure_Pa, std::vector<Bin> bins)
      : belief_(belief), pressure_Pa_(pressure_Pa), bins_(std::move(bins)) {}

  LineAcoustics line(const Unknowns& x) const {
    AirParameters<double> air = belief_.air;
    air.viscosity_Pas *= std::exp(x[1]);  // heat conduction follows by the Prandtl number
    return {belief_.length_m * std::exp(x[0]), belief_.diameter_m, pressure_Pa_, air, LineLoss::frequency_dependent};
  }
  LineEnds ends(const Unknowns& x) const {
    LineEnds out = belief_.ends;
    out.volume_out_m3 *= std::exp(x[2]);
    return out;
  }
  Complex transfer(const Unknowns& x, Complex s) const { return (1.0 + x[3]) * pressure_transfer(line(x), ends(x), s); }

  /// Real and imaginary part of what each bin leaves, over the noise that both sensors bring to it; then the beliefs.
  Eigen::VectorXd residuals(const Unknowns& x, double noise_Pa) const {
    const auto n = static_cast<Eigen::Index>(bins_.size());
    Eigen::VectorXd out(2 * n + 2);
    const LineAcoustics at = line(x);
    const LineEnds where = ends(x);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Bin& bin = bins_[static_cast<std::size_t>(k)];
      const Complex h = (1.0 + x[3]) * pressure_transfer(at, where, bin.s);
      // Of a complex number's two parts each has half the variance.
      const Complex left = (bin.out_Pa - h * bin.in_Pa) / (noise_Pa * std::sqrt(0.5 * (1.0 + std::norm(h))));
      out[2 * k] = left.real();
      out[2 * k + 1] = left.imag();
    }
    out[2 * n] = x[2] / belief_.relative_volume;
    out[2 * n + 1] = x[3] / belief_.relative_gain;
    return out;
  }

  Eigen::MatrixXd derivatives(const Unknowns& x, double noise_Pa) const {
    constexpr double h = 1e-5;
    Eigen::MatrixXd out(2 * static_cast<Eigen::Index>(bins_.size()) + 2, unknowns);
    for (int i = 0; i < unknowns; ++i) {
      Unknowns high = x, low = x;
      high[i] += h;
      low[i] -= h;
      out.col(i) = (residuals(high, noise_Pa) - residuals(low, noise_Pa)) / (2.0 * h);
    }
    return out;
  }

  /// Levenberg and Marquardt from x on, with the noise as it stands.
  void descend(Unknowns& x, double noise_Pa) const {
    double damping = 1e-3, cost = residuals(x, noise_Pa).squaredNorm();
    for (int step = 0; step < 60 && damping < 1e8; ++step) {
      const Eigen::MatrixXd jacobian = derivatives(x, noise_Pa);
      const Eigen::Matrix<double, unknowns, unknowns> normal = jacobian.transpose() * jacobian;
      const Unknowns slope = jacobian.transpose() * residuals(x, noise_Pa);
      const Eigen::Matrix<double, unknowns, unknowns> weighted =
          normal + damping * Eigen::Matrix<double, unknowns, unknowns>(normal.diagonal().asDiagonal());
      const Unknowns change = weighted.ldlt().solve(slope).cwiseMax(-0.3).cwiseMin(0.3);
      const double next = residuals(x - change, noise_Pa).squaredNorm();
      if (!(next < cost)) {
        damping *= 10.0;
        continue;
      }
      x -= change;
      damping = std::max(damping * 0.1, 1e-9);
      if (cost - next < 1e-10 * cost) return;
      cost = next;
    }
  }

  /// Noise that would leave what is left. The beliefs are no samples.
  double noise_left(const Unknowns& x, double noise_Pa) const {
    const Eigen::VectorXd r = residuals(x, noise_Pa);
    const Eigen::Index rows = r.size() - 2;
    return noise_Pa *
           std::sqrt(r.head(rows).squaredNorm() / static_cast<double>(std::max<Eigen::Index>(rows - unknowns, 1)));
  }

  Eigen::Matrix<double, unknowns, unknowns> covariance(const Unknowns& x, double noise_Pa) const {
    const Eigen::MatrixXd jacobian = derivatives(x, noise_Pa);
    return (jacobian.transpose() * jacobian).inverse();
  }

  const std::vector<Bin>& bins() const { return bins_; }

 private:
  LineBelief belief_;
  double pressure_Pa_;
  std::vector<Bin> bins_;
};

/// The best length among many, for a fit descends into the nearest resonance alone.
Unknowns start_of(const LineFit& fit, double noise_Pa) {
  Unknowns best = Unknowns::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (double length = -0.5; length <= 0.5; length += 0.02) {
    Unknowns x = Unknowns::Zero();
    x[0] = length;
    const double cost = fit.residuals(x, noise_Pa).squaredNorm();
    if (cost < least) least = cost, best = x;
  }
  return best;
}

/// Value and error of a function of the unknowns.
template <class Function>
EstimatedNumber estimated(const Function& f, const Unknowns& x,
                          const Eigen::Matrix<double, unknowns, unknowns>& covariance) {
  constexpr double h = 1e-4;
  Unknowns slope;
  for (int i = 0; i < unknowns; ++i) {
    Unknowns high = x, low = x;
    high[i] += h;
    low[i] -= h;
    slope[i] = (f(high) - f(low)) / (2.0 * h);
  }
  return {f(x), std::sqrt(slope.dot(covariance * slope))};
}

/// Means over bands of a twenty-fourth of an octave or one bin.
std::vector<ResponsePoint> response_of(const LineFit& fit, const Unknowns& x, double noise_Pa) {
  std::vector<ResponsePoint> out;
  const std::vector<Bin>& bins = fit.bins();
  for (std::size_t i = 0; i < bins.size();) {
    Complex cross = 0.0;
    double power = 0.0, weighted_Hz = 0.0;
    const double first = bins[i].s.imag();
    for (; i < bins.size() && bins[i].s.imag() <= first * std::exp2(1.0 / 24.0); ++i) {
      cross += bins[i].out_Pa * std::conj(bins[i].in_Pa);
      power += std::norm(bins[i].in_Pa);
      weighted_Hz += std::norm(bins[i].in_Pa) * bins[i].s.imag() / (2.0 * std::numbers::pi);
    }
    if (!(power > 0.0)) continue;
    const double Hz = weighted_Hz / power;
    const Complex fitted = fit.transfer(x, Complex(0.0, 2.0 * std::numbers::pi * Hz));
    out.push_back({Hz, cross / power, fitted, noise_Pa * std::sqrt(0.5 * (1.0 + std::norm(fitted)) / power)});
  }
  return out;
}

/// Share of the input's energy of change in the first and last hundredth of the rows.
double share_at_ends(const std::vector<double>& in_Pa) {
  const std::size_t n = in_Pa.size() - 1, end = rows_at_rest(in_Pa.size());
  double all = 0.0, ends = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double change = (in_Pa[i + 1] - in_Pa[i]) * (in_Pa[i + 1] - in_Pa[i]);
    all += change;
    if (i < end || i >= n - end) ends += change;
  }
  return ends / all;
}

void require_usable(const LinePressures& p) {
  if (p.in_Pa.size() != p.out_Pa.size())
    throw std::invalid_argument("the two pressures have different numbers of rows");
  if (p.in_Pa.size() < fewest_rows || !(p.period_s > 0.0))
    throw std::invalid_argument("fewer than 64 rows of pressure at both ends");
  for (const auto* values : {&p.in_Pa, &p.out_Pa}) {
    if (!std::ranges::all_of(*values, [](double v) { return std::isfinite(v); }))
      throw std::invalid_argument("a pressure is no finite number");
    const auto [low, high] = std::ranges::minmax(*values);
    if (!(high > low)) throw std::invalid_argument("a pressure does not move");
  }
}

}  // namespace

LineIdentification identify_line(const LinePressures& pressures, const LineBelief& belief) {
  require_usable(pressures);
  LineIdentification out;
  out.mean_pressure_Pa = 0.5 * (mean(pressures.in_Pa) + mean(pressures.out_Pa));
  const LineAcoustics believed(belief.length_m, belief.diameter_m, out.mean_pressure_Pa, belief.air, LineLoss::none);
  out.highest_Hz = std::min(0.4 / pressures.period_s,
                            highest_over_first * first_resonance(believed, belief.ends).natural_frequency_Hz);
  const LineFit fit(belief, out.mean_pressure_Pa, bins_of(pressures, out.highest_Hz));
  if (fit.bins().size() < 8) throw std::invalid_argument("the recording is too short for the line's frequencies");
  out.lowest_Hz = fit.bins().front().s.imag() / (2.0 * std::numbers::pi);

  double noise_Pa = fit.noise_left(Unknowns::Zero(), 1.0);
  Unknowns x = start_of(fit, noise_Pa);
  for (int round = 0; round < 4; ++round) {  // the beliefs' weight depends on the noise, and that on the fit
    fit.descend(x, noise_Pa);
    noise_Pa = std::max(fit.noise_left(x, noise_Pa), 1e-9 * out.mean_pressure_Pa);
  }
  out.noise_Pa = noise_Pa;
  const auto covariance = fit.covariance(x, noise_Pa);
  const auto number = [&](auto&& f) { return estimated(f, x, covariance); };
  out.length_m = number([&](const Unknowns& at) { return belief.length_m * std::exp(at[0]); });
  out.loss_ratio = number([](const Unknowns& at) { return std::exp(at[1]); });
  out.volume_out_m3 = number([&](const Unknowns& at) { return belief.ends.volume_out_m3 * std::exp(at[2]); });
  out.gain = number([](const Unknowns& at) { return 1.0 + at[3]; });
  try {
    out.natural_frequency_Hz =
        number([&](const Unknowns& at) { return first_resonance(fit.line(at), fit.ends(at)).natural_frequency_Hz; });
    out.damping_ratio =
        number([&](const Unknowns& at) { return first_resonance(fit.line(at), fit.ends(at)).damping_ratio; });
  } catch (const std::invalid_argument&) {
    out.resonates = false;
    out.natural_frequency_Hz = out.damping_ratio = {std::nan(""), std::nan("")};
  }
  out.ends_share = share_at_ends(pressures.in_Pa);
  out.response = response_of(fit, x, noise_Pa);
  return out;
}

}  // namespace pneuservo
