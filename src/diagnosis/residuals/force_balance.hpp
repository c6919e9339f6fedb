// Force that a supposed slider needs for a recorded motion: m a + B v + friction + load, all smoothed alike.
#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "diagnosis/residuals/gaussian_kernel.hpp"
#include "diagnosis/residuals/residual_model.hpp"

namespace pneuservo {

/// Standard deviations of the drive's noise that any rest balances, so that no friction gains by noise.
inline constexpr double rest_noises = 2.0;
/// Of a kernel's sigma, in sampling periods: a force that jumps between rows is spread over it.
inline constexpr double spreading_periods = 2.5;

/// What the position's reading errors are in the means of neighbouring accelerations, and so in the rows of a force.
struct ReadingNoise {
  std::size_t count = 1;  ///< neighbouring values
  /// Mean squares over the recording: of the acceleration's errors, of their product with the jerk's, of the jerk's.
  double acceleration2 = 0, product = 0, jerk2 = 0;
  std::vector<double> acceleration;  ///< rms of the mean from each sample on [m/s2]
  double owner_N = 0;  ///< what it makes of the force on the owner's slider, rms over the recording
  std::vector<double> row_share;  ///< of the squared sigma of each row, on the owner's slider

  /// Of the row from this sample on, on the owner's slider.
  double of_row_N(std::size_t first) const {
    return acceleration2 > 0 ? owner_N * acceleration[first] / std::sqrt(acceleration2) : 0.0;
  }
  void add_row(std::size_t first, double sigma_N) { row_share.push_back(std::pow(of_row_N(first) / sigma_N, 2)); }
  /// Factor on the rows' residuals of a slider that these errors make noise_N of: squares grow by the noise that it
  /// does not follow, so that a load gains nothing by that and keeps what it explains. More than the owner's excuses
  /// nothing, for what is missing lies elsewhere; rows that are held out scale with the others.
  double factor(std::span<const double> residuals, std::span<const ResidualRow> rows, double noise_N) const;
};

/// The motion of one recording. Nothing is simulated: position is differentiated by symmetric Gaussian kernels, and the
/// drive force is smoothed by the same kernel, so that both sides of m dv/dt = F - B v - F_friction - F_load are seen
/// through one window (the weak form of the balance, with the Gaussian as test function).
class ForceBalance {
 public:
  /// position_m: measured, evenly sampled; NaN where there is none. Sigma is 5 ms (8 ms above 20 um of noise, quantum
  /// included), at least `least_periods`.
  ForceBalance(std::span<const double> position_m, double period_s, const SensorResolution& resolution,
               double least_periods = spreading_periods);

  std::size_t samples() const { return usable_.size(); }
  /// Whether the balance can be judged at a sample: not within the kernel's reach of an end or of a missing position.
  const std::vector<char>& usable() const { return usable_; }
  /// Smoothed motion as measured [m, m/s].
  const std::vector<double>& position_m() const { return derivative_[0]; }
  const std::vector<double>& velocity_mps() const { return derivative_[1]; }
  /// The balance's kernel: smooth the drive force with apply(force, 0).
  const GaussianKernel& kernel() const { return kernel_; }
  /// Errors of readings along this motion: an encoder's steps are white noise where it passes many of them in a
  /// kernel's sigma, a slow wave in slow motion, and none at rest.
  ReadingNoise reading_noise(std::size_t count) const;
  /// Standard deviation that the position's reading errors alone give such means of the force that this rig's slider
  /// needs [N]. A load on a coupling does not follow them, and a lagging sensor enlarges them.
  double force_noise(const Rig& rig, const ReadingNoise& noise) const;

  /// Samples that no fit sees: the swing in which a load on a soft coupling begins a stretch is not found from them.
  void hold_out(const std::function<bool(std::size_t)>& is_held_out);
  /// Force [N] that the rig's slider with its motion effects needs at every sample, its position sensor's effects
  /// undone first. drive_N: the smoothed drive force, which friction balances within its limits where the slider may
  /// stand or turn.
  /// gauge_pressure_sum_Pa: max(p1 - p_atm, 0) + max(p2 - p_atm, 0) at every sample; empty without air.
  /// held_N: force that is balanced around there beside friction, for what the drive force is not known to: else a
  /// friction that is not there would gain by the noise.
  /// How a load on a soft coupling swings where a stretch begins no recording tells: it is found with the force.
  std::vector<double> required_force(const Rig& rig, std::span<const double> drive_N,
                                     std::span<const double> gauge_pressure_sum_Pa, double held_N = 0.0) const;
  /// Samples where this rig's slider touches an end stop within the kernel's reach; not to be judged.
  std::vector<char> near_end_stop(double stroke_m) const;

 private:
  /// Of force_noise: with the rig's coupled loads over that of a rigid slider.
  double coupled_noise_share(const Rig& rig, std::size_t count) const;
  /// Along a motion [m], the same ones every time.
  std::vector<double> reading_errors(std::span<const double> motion_m, std::uint32_t draw) const;
  /// The motion without what smoothing once leaves of the steps, which would take part in steps drawn along it.
  std::vector<double> without_steps() const { return kernel_.apply(derivative_[0], 0); }
  /// Root mean square over [first, end) [m/s].
  double usual_speed(std::size_t first, std::size_t end) const;
  /// Beside an elastic load that pulls with load_N.
  std::vector<double> required_beside(const Rig& rig, std::span<const double> drive_N,
                                      std::span<const double> gauge_pressure_sum_Pa, double held_N,
                                      std::span<const double> load_N) const;

  double period_s_;
  SensorResolution sensor_;
  GaussianKernel kernel_, fast_kernel_;
  std::vector<double> derivative_[4];  ///< position and its derivatives, smoothed
  std::vector<double> fast_[3];  ///< the same with the shorter kernel of friction
  std::vector<char> usable_;
  /// Within the kernel's reach of an end or a missing position, where its derivatives are not those of the motion: half
  /// the speed at an end would be a blow on a load that is carried from there.
  std::vector<char> is_astray_;
  std::vector<char> is_judged_;  ///< in motion, usable, seen by fits
  /// Of the motion at each sample, 1 or -1; 0 where it may stand or turn.
  std::vector<double> direction_;
  /// Speed whose friction is its limit there: of the slowest motion beside a turn, of rest where no motion is within
  /// the kernel's reach. Rows that see both would else be free to a friction that is larger at rest.
  std::vector<double> edge_mps_;
  std::vector<double> turn_share_;  ///< of the kernel's weight around each sample, where the motion may stand or turn
};

}  // namespace pneuservo
