// Force that a supposed slider needs for a recorded motion: m a + B v + friction + load, all smoothed alike.
#include "diagnosis/residuals/force_balance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/coupled_load.hpp>
#include <pneuservo/elements/slider.hpp>

namespace pneuservo {

namespace {

constexpr double noisy_position_m = 20e-6;
constexpr double end_stop_margin_m = 0.5e-3;
constexpr std::uint32_t error_draws = 16;  ///< the rms of one row's reading errors is then known to a sixth
constexpr double rounding_mps = 1e-9;  ///< of a position that stands

double kernel_sigma(double noise_m, double shortest_s) {
  return std::max(noise_m > noisy_position_m ? 0.008 : 0.005, shortest_s);
}

/// Marks `reach` samples on both sides of every marked one.
std::vector<char> widened(const std::vector<char>& marks, std::size_t reach) {
  std::vector<char> out(marks.size(), 0);
  for (std::size_t i = 0; i < marks.size(); ++i)
    if (marks[i])
      std::fill(out.begin() + static_cast<std::ptrdiff_t>(i - std::min(i, reach)),
                out.begin() + static_cast<std::ptrdiff_t>(std::min(marks.size(), i + reach + 1)), 1);
  return out;
}

/// Largest less smallest value within `reach` samples of each one.
std::vector<double> range_around(const std::vector<double>& values, std::size_t reach) {
  std::vector<double> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(i - std::min(i, reach)),
               end = values.begin() + static_cast<std::ptrdiff_t>(std::min(values.size(), i + reach + 1));
    const auto [least, most] = std::minmax_element(first, end);
    out[i] = *most - *least;
  }
  return out;
}

/// Within so many sigma the range of the smoothed acceleration shows erf(range_sigmas / sqrt 2) of a jump.
constexpr double range_sigmas = 2;
/// Speed below which the slider may stand or turn: of rest, or that of a slider that begins or ends its rest. There the
/// acceleration jumps, and smoothing puts the speed off by sigma / sqrt(2 pi) times the jump.
std::vector<double> slow_speeds(const std::vector<double>& a, double rest_mps, double sigma_s, double period_s) {
  const double shown = std::erf(range_sigmas / std::numbers::sqrt2);
  const double seconds = sigma_s / std::sqrt(2 * std::numbers::pi) / shown;
  std::vector<double> out = range_around(a, static_cast<std::size_t>(std::ceil(range_sigmas * sigma_s / period_s)));
  for (double& speed : out) speed = std::max(rest_mps, seconds * speed);
  return out;
}

/// Direction of the motion at each sample, 1 or -1; 0 where friction may hold or turn.
std::vector<double> directions(const std::vector<double>& v, const std::vector<double>& slow_mps) {
  std::vector<double> out(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) out[i] = std::abs(v[i]) < slow_mps[i] ? 0.0 : v[i] > 0 ? 1.0 : -1.0;
  for (std::size_t i = 1; i < v.size(); ++i)
    if (v[i - 1] * v[i] <= 0) out[i - 1] = out[i] = 0.0;
  return out;
}

/// A load on a coupling, carried along a sampled motion.
class CarriedLoad {
 public:
  template <class Coupling>
  CarriedLoad(const Coupling& coupling, double period_s)
      : steps_(static_cast<int>(std::ceil(period_s / longest_step_s))), step_s_(period_s / steps_) {
    load_.configure(coupling);
    is_there_ = load_.is_there();
  }
  /// On its carrier, which is at x with speed v one period after the last call. It starts, and starts again where the
  /// motion is astray, at rest in its coupling.
  double force_at(double x, double v, bool is_astray) {
    if (!is_there_) return 0.0;
    if (!is_carried_ || is_astray) load_.reset(x, v);
    else carry(x, v);
    is_carried_ = true;
    x_ = x;
    v_ = v;
    return load_.force();
  }

 private:
  // Along the cubic through both ends.
  void carry(double x, double v) {
    const double period_s = steps_ * step_s_, way = x - x_;
    double last_x = x_, last_v = v_;
    for (int i = 1; i <= steps_; ++i) {
      const double s = static_cast<double>(i) / steps_, s2 = s * s, s3 = s2 * s;
      const double next_x = x_ + (3 * s2 - 2 * s3) * way + period_s * ((s - 2 * s2 + s3) * v_ + (s3 - s2) * v);
      const double next_v = 6 * (s - s2) * way / period_s + (1 - 4 * s + 3 * s2) * v_ + (3 * s2 - 2 * s) * v;
      load_.step(step_s_, last_x, last_v, next_x, next_v);
      last_x = next_x;
      last_v = next_v;
    }
  }
  static constexpr double longest_step_s = 5e-4;  ///< swings of 100 Hz are then 1 % too slow, of 10 Hz none

  CoupledLoad<double> load_;
  int steps_;
  double step_s_, x_ = 0, v_ = 0;
  bool is_there_ = false, is_carried_ = false;
};

/// Means over `count` neighbours from each sample on; NaN where one of them is not marked.
std::vector<double> means_of(std::span<const double> values, std::span<const char> is_marked, std::size_t count) {
  std::vector<double> out(values.size(), std::numeric_limits<double>::quiet_NaN());
  double sum = 0;
  std::size_t marked = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i], marked += is_marked[i] != 0;
    if (i >= count) sum -= values[i - count], marked -= is_marked[i - count] != 0;
    if (marked == count) out[i + 1 - count] = sum / static_cast<double>(count);
  }
  return out;
}

double mean_product(std::span<const double> a, std::span<const double> b) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::isfinite(a[i])) sum += a[i] * b[i], ++count;
  return count > 0 ? sum / count : 0.0;
}

/// A free swing a e^-bt cos wt + c e^-bt sin wt on `load_N` in these samples, where `error_N` is what it leaves
/// without. Least squares over the judged samples, neighbours within `alike` counted once, with a prior: a load swings
/// at its start as it does later.
void add_free_swing(const ElasticLoad<double>& load, double period_s, std::span<const double> error_N,
                    std::span<const char> is_judged, std::size_t alike, double usual_N, std::span<double> load_N) {
  const double w = 2 * std::numbers::pi * load.natural_frequency_Hz;
  const std::complex<double> turn = std::exp(
      period_s * w *
      std::complex<double>(-load.damping_ratio, std::sqrt(std::max(0.0, 1 - load.damping_ratio * load.damping_ratio))));
  Eigen::Matrix2d h = Eigen::Matrix2d::Zero();
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  double square = 0, count = 0;
  std::complex<double> swing = 1.0;
  for (std::size_t i = 0; i < error_N.size(); ++i, swing *= turn) {
    if (!is_judged[i]) continue;
    const Eigen::Vector2d way(swing.real(), swing.imag());
    h += way * way.transpose();
    g += way * error_N[i];
    square += error_N[i] * error_N[i];
    ++count;
  }
  if (count == 0 || usual_N == 0) return;
  h.diagonal().array() += static_cast<double>(alike) * square / count / (usual_N * usual_N);
  const Eigen::Vector2d start = h.ldlt().solve(g);
  swing = 1.0;
  for (double& force : load_N) {
    force += start.x() * swing.real() + start.y() * swing.imag();
    swing *= turn;
  }
}

/// Dry friction along a sampled motion: the share of it that has built up where it is sheared before it slides.
class BuiltUpFriction {
 public:
  struct Limits {
    double least_N, most_N;
  };
  BuiltUpFriction(const Slider<double>& slider, double way_m) : slider_(slider), way_m_(way_m) {}
  /// The way from the sample before; where the motion is astray, and without presliding, nothing is kept of before.
  void go(double dx_m, bool is_astray) { kept_ = is_astray || way_m_ == 0 ? 0.0 : std::exp(-std::abs(dx_m) / way_m_); }
  /// In motion in a direction, 1 or -1 [N].
  double sliding_N(double direction, double speed, double x, const SliderSurroundings<double>& around) {
    share_ = direction + kept_ * (share_ - direction);
    return 0.5 * (1.0 + share_) * slider_.dry_friction(speed, 1.0, x, around) -
           0.5 * (1.0 - share_) * slider_.dry_friction(speed, -1.0, x, around);
  }
  /// What it can be where the slider may stand or turn, by its law at that speed; the motion goes on from where it
  /// balances what is left.
  Limits resting_N(double left_N, double speed, double x, const SliderSurroundings<double>& around) {
    const double least_N = -std::abs(slider_.dry_friction(speed, -1.0, x, around)),
                 most_N = std::abs(slider_.dry_friction(speed, 1.0, x, around));
    const double balance_N = std::clamp(left_N, least_N, most_N);
    if (most_N > least_N) share_ = (2.0 * balance_N - least_N - most_N) / (most_N - least_N);
    return {least_N, most_N};
  }

 private:
  const Slider<double>& slider_;
  double way_m_, kept_ = 0, share_ = 0;
};

/// Position or one of its derivatives as the true slider had it: y = gain lag(x) + offset turned round.
double undo(const SensorEffects<double>& sensor, double value, double next_derivative, bool is_position) {
  const double lagged = value + sensor.sensor_lag.time_constant_s * next_derivative;
  return (lagged - (is_position ? sensor.sensor_offset.offset : 0.0)) / sensor.sensor_gain.gain;
}

}  // namespace

ForceBalance::ForceBalance(std::span<const double> position_m, double period_s, const SensorResolution& resolution,
                           double least_periods)
    : period_s_(period_s), sensor_(resolution),
      kernel_(kernel_sigma(resolution.rms(), least_periods * period_s), period_s),
      fast_kernel_(std::max(0.6 * kernel_.sigma_s(), 1.5 * period_s), period_s) {
  const std::vector<double> position = held_over_gaps(position_m);
  for (int order = 0; order < 4; ++order) derivative_[order] = kernel_.apply(position, order);
  for (int order = 0; order < 3; ++order) fast_[order] = fast_kernel_.apply(position, order);
  std::vector<char> is_missing(position.size(), 0);
  for (std::size_t i = 0; i < position.size(); ++i) is_missing[i] = !std::isfinite(position_m[i]);
  is_astray_ = widened(is_missing, kernel_.reach());
  const auto edge = static_cast<std::ptrdiff_t>(std::min(kernel_.reach(), is_astray_.size()));
  std::fill_n(is_astray_.begin(), edge, 1);
  std::fill_n(is_astray_.rbegin(), edge, 1);
  // Friction is smoothed once more after the fast kernel has made its velocity: reach of both at the ends.
  const std::size_t reach = kernel_.reach() + fast_kernel_.reach();
  usable_ = widened(is_missing, reach);
  for (std::size_t i = 0; i < usable_.size(); ++i) usable_[i] = !usable_[i] && i >= reach && i + reach < usable_.size();
  double top = 0;
  for (std::size_t i = 0; i < usable_.size(); ++i)
    if (usable_[i]) top = std::max(top, std::abs(derivative_[1][i]));
  // Four standard deviations of white noise, and the whole of one step of an encoder whose noise is all steps.
  const double noise_speed = sensor_.rms() * std::max(4 * fast_kernel_.noise_gain(1, 1),
                                                      std::sqrt(12.0) * fast_kernel_.largest_weight() / period_s);
  const double rest_mps = std::max({0.005 * top, noise_speed, rounding_mps});
  edge_mps_ = slow_speeds(fast_[2], rest_mps, fast_kernel_.sigma_s(), period_s);
  direction_ = directions(fast_[1], edge_mps_);
  std::vector<char> is_sliding(direction_.size());
  for (std::size_t i = 0; i < is_sliding.size(); ++i) is_sliding[i] = direction_[i] != 0;
  const std::vector<char> sees_sliding = widened(is_sliding, kernel_.reach());
  for (std::size_t i = 0; i < edge_mps_.size(); ++i)
    if (!sees_sliding[i]) edge_mps_[i] = 0;
  std::vector<double> turns(is_sliding.size());
  std::transform(is_sliding.begin(), is_sliding.end(), turns.begin(), [](char slides) { return slides ? 0.0 : 1.0; });
  turn_share_ = kernel_.apply(turns, 0);
  hold_out([](std::size_t) { return false; });
}

double ReadingNoise::factor(std::span<const double> residuals, std::span<const ResidualRow> rows,
                            double noise_N) const {
  if (owner_N == 0) return 1.0;
  const double not_followed = std::max(0.0, 1 - std::pow(noise_N / owner_N, 2));
  const bool none_is_fitted =
      std::all_of(rows.begin(), rows.end(), [](const ResidualRow& row) { return row.held_out; });
  double squares = 0, noise = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (rows[i].held_out && !none_is_fitted) continue;
    squares += residuals[i] * residuals[i];
    noise += row_share[i] * not_followed;
  }
  return squares > 0 ? std::sqrt(1 + noise / squares) : 1.0;
}

std::vector<double> ForceBalance::reading_errors(std::span<const double> motion_m, std::uint32_t draw) const {
  Random random(1, draw);
  const double off_m = random.uniform(0.0, sensor_.quantum);
  std::vector<double> out(samples());
  for (std::size_t i = 0; i < samples(); ++i) {
    const double at_m = motion_m[i] + off_m, seen_m = at_m + sensor_.noise * random.normal();
    out[i] = (sensor_.quantum > 0 ? sensor_.quantum * std::round(seen_m / sensor_.quantum) : seen_m) - at_m;
  }
  return out;
}

ReadingNoise ForceBalance::reading_noise(std::size_t count) const {
  ReadingNoise out;
  out.count = count;
  std::vector<double> squares(samples(), 0.0);
  const std::vector<double> motion_m = without_steps();
  for (std::uint32_t draw = 0; draw < error_draws && sensor_.rms() > 0; ++draw) {
    const std::vector<double> error = reading_errors(motion_m, draw);
    const std::vector<double> acceleration = means_of(kernel_.apply(error, 2), usable_, count),
                              jerk = means_of(kernel_.apply(error, 3), usable_, count);
    out.acceleration2 += mean_product(acceleration, acceleration) / error_draws;
    out.product += mean_product(acceleration, jerk) / error_draws;
    out.jerk2 += mean_product(jerk, jerk) / error_draws;
    for (std::size_t i = 0; i < samples(); ++i)
      if (std::isfinite(acceleration[i])) squares[i] += acceleration[i] * acceleration[i] / error_draws;
  }
  // Neighbours within the kernel have the same noise: their mean is known better than that of one row's draws.
  out.acceleration = kernel_.apply(squares, 0);
  for (double& value : out.acceleration) value = std::sqrt(std::max(value, 0.0));
  return out;
}

double ForceBalance::force_noise(const Rig& rig, const ReadingNoise& noise) const {
  const SensorEffects<double>& sensor = rig.sensor_effects[Signal::x];
  const double rigid_kg = rig.axis.slider.mass_kg + rig.axis.slider.payload_kg,
               tau_s = sensor.sensor_lag.time_constant_s;
  const double rigid_N = rigid_kg / sensor.sensor_gain.gain *
                         std::sqrt(noise.acceleration2 + 2 * tau_s * noise.product + tau_s * tau_s * noise.jerk2);
  const MotionEffects<double>& effects = rig.axis.effects.motion;
  if (rigid_N == 0 || (effects.elastic_load.mass_kg == 0 && effects.load_backlash.mass_kg == 0)) return rigid_N;
  return rigid_N * coupled_noise_share(rig, noise.count);
}

double ForceBalance::coupled_noise_share(const Rig& rig, std::size_t count) const {
  const SensorEffects<double>& sensor = rig.sensor_effects[Signal::x];
  const MotionEffects<double>& effects = rig.axis.effects.motion;
  const std::vector<double> error = reading_errors(without_steps(), 0);
  std::array<std::vector<double>, 4> off;
  for (int order = 0; order < 4; ++order) off[static_cast<std::size_t>(order)] = kernel_.apply(error, order);
  std::array<std::vector<double>, 3> fast_off;
  for (int order = 0; order < 3; ++order) fast_off[static_cast<std::size_t>(order)] = fast_kernel_.apply(error, order);
  // A load on a spring is linear; a loose one is carried along the motion with its errors and without.
  CarriedLoad load(effects.elastic_load, period_s_), loose(effects.load_backlash, period_s_), other = loose;
  const double coupled_kg = effects.elastic_load.mass_kg + effects.load_backlash.mass_kg,
               rigid_kg = rig.axis.slider.mass_kg + rig.axis.slider.payload_kg;
  std::vector<double> blow_N(samples()), force_N(samples()), rigid_N(samples());
  for (std::size_t i = 0; i < samples(); ++i) {
    const auto at = [&](double more) {
      return std::array{undo(sensor, fast_[0][i] + more * fast_off[0][i], fast_[1][i] + more * fast_off[1][i], true),
                        undo(sensor, fast_[1][i] + more * fast_off[1][i], fast_[2][i] + more * fast_off[2][i], false)};
    };
    const auto with = at(1.0), without = at(0.0);
    blow_N[i] = loose.force_at(with[0], with[1], is_astray_[i]) - other.force_at(without[0], without[1], is_astray_[i]);
    const double acceleration = undo(sensor, off[2][i], off[3][i], false);
    rigid_N[i] = rigid_kg * acceleration;
    force_N[i] = (rigid_kg - coupled_kg) * acceleration - load.force_at(undo(sensor, off[0][i], off[1][i], false),
                                                                        undo(sensor, off[1][i], off[2][i], false),
                                                                        is_astray_[i]);
  }
  blow_N = kernel_.apply(blow_N, 0);
  for (std::size_t i = 0; i < samples(); ++i) force_N[i] -= blow_N[i];
  rigid_N = means_of(rigid_N, usable_, count);
  force_N = means_of(force_N, usable_, count);
  const double all = mean_product(rigid_N, rigid_N);
  return all > 0 ? std::sqrt(mean_product(force_N, force_N) / all) : 1.0;
}

std::vector<char> ForceBalance::near_end_stop(double stroke_m) const {
  std::vector<char> marks(samples(), 0);
  for (std::size_t i = 0; i < samples(); ++i)
    marks[i] = std::abs(derivative_[0][i]) > 0.5 * stroke_m - end_stop_margin_m;
  return widened(marks, kernel_.reach() + fast_kernel_.reach());
}

void ForceBalance::hold_out(const std::function<bool(std::size_t)>& is_held_out) {
  is_judged_.resize(samples());
  for (std::size_t i = 0; i < samples(); ++i) is_judged_[i] = usable_[i] && direction_[i] != 0 && !is_held_out(i);
}

std::vector<double> ForceBalance::required_force(const Rig& rig, std::span<const double> drive_N,
                                                 std::span<const double> gauge_pressure_sum_Pa, double held_N) const {
  const ElasticLoad<double>& load = rig.axis.effects.motion.elastic_load;
  std::vector<double> load_N(samples(), 0.0);
  if (load.mass_kg == 0) return required_beside(rig, drive_N, gauge_pressure_sum_Pa, held_N, load_N);
  // Its spring is linear: carried along the smoothed motion it pulls with its smoothed force.
  const SensorEffects<double>& sensor = rig.sensor_effects[Signal::x];
  CarriedLoad carried(load, period_s_);
  std::vector<double> swings_N(samples());
  for (std::size_t i = 0; i < samples(); ++i) {
    load_N[i] = carried.force_at(undo(sensor, derivative_[0][i], derivative_[1][i], true),
                                 undo(sensor, derivative_[1][i], derivative_[2][i], false), is_astray_[i]);
    swings_N[i] = load_N[i] + load.mass_kg * undo(sensor, derivative_[2][i], derivative_[3][i], false);
  }
  std::vector<double> error_N = required_beside(rig, drive_N, gauge_pressure_sum_Pa, held_N, load_N);
  for (std::size_t i = 0; i < samples(); ++i) error_N[i] -= drive_N[i];
  double square = 0, count = 0;
  for (std::size_t i = 0; i < samples(); ++i)
    if (usable_[i]) square += swings_N[i] * swings_N[i], ++count;
  const double usual_N = std::sqrt(square / std::max(count, 1.0)), all_mps = usual_speed(0, samples());
  for (std::size_t first = 0, end = 0; first < samples(); first = end + 1) {
    for (end = first; end < samples() && !is_astray_[end];) ++end;
    // A load swings with its carrier: where that begins slowly or at rest, so does the load.
    const double start_mps = usual_speed(first, std::min(end, first + kernel_.reach()));
    const double share = all_mps > 0 ? std::min(1.0, start_mps / all_mps) : 0.0;
    add_free_swing(load, period_s_, std::span(error_N).subspan(first, end - first),
                   std::span(is_judged_).subspan(first, end - first), kernel_.reach(), share * usual_N,
                   std::span(load_N).subspan(first, end - first));
  }
  return required_beside(rig, drive_N, gauge_pressure_sum_Pa, held_N, load_N);
}

double ForceBalance::usual_speed(std::size_t first, std::size_t end) const {
  double square = 0;
  for (std::size_t i = first; i < end; ++i) square += derivative_[1][i] * derivative_[1][i];
  return end > first ? std::sqrt(square / static_cast<double>(end - first)) : 0.0;
}

std::vector<double> ForceBalance::required_beside(const Rig& rig, std::span<const double> drive_N,
                                                  std::span<const double> gauge_pressure_sum_Pa, double held_N,
                                                  std::span<const double> load_N) const {
  const SensorEffects<double>& sensor = rig.sensor_effects[Signal::x];
  const MotionEffects<double>& effects = rig.axis.effects.motion;
  Slider<double> slider;
  slider.configure(rig.axis.slider, effects, 1.0, 0.0);
  CarriedLoad loose_load(effects.load_backlash, period_s_);
  const ElasticFriction<double>& bristles = effects.elastic_friction;
  BuiltUpFriction dry(slider, effects.presliding.way_m);
  double bristle_N = 0, last_x = 0;
  std::vector<double> smooth_part(samples()), least_abrupt(samples()), slack(samples(), 0.0);
  for (std::size_t i = 0; i < samples(); ++i) {
    slider.set_time(static_cast<double>(i) * period_s_);
    const double x = undo(sensor, derivative_[0][i], derivative_[1][i], true);
    const double v = undo(sensor, derivative_[1][i], derivative_[2][i], false);
    const double a = undo(sensor, derivative_[2][i], derivative_[3][i], false);
    const double x_fast = undo(sensor, fast_[0][i], fast_[1][i], true);
    const double v_fast = undo(sensor, fast_[1][i], fast_[2][i], false);
    const SliderSurroundings<double> around{gauge_pressure_sum_Pa.empty() ? 0.0 : gauge_pressure_sum_Pa[i]};
    smooth_part[i] = slider.mass() * a + slider.damping_coefficient(0.0, 0.0) * v - slider.less_load(load_N[i], x);
    if (bristles.force_N != 0) bristle_N = i == 0 || is_astray_[i] ? 0 : bristles.carried(bristle_N, x_fast - last_x);
    dry.go(x_fast - last_x, is_astray_[i] || i == 0);
    last_x = x_fast;
    const double blow_N =
        loose_load.force_at(x_fast, v_fast, is_astray_[i]) - bristle_N;  // as short as friction's steps
    if (const double direction = direction_[i]; direction != 0) {
      const double speed = std::abs(v_fast);
      least_abrupt[i] = -blow_N + dry.sliding_N(direction, speed, x_fast, around) +
                        (slider.damping_coefficient(speed, direction) - slider.damping_coefficient(0.0, 0.0)) * v_fast;
    } else {
      const auto [least_N, most_N] = dry.resting_N(drive_N[i] - smooth_part[i] + blow_N, edge_mps_[i], x_fast, around);
      least_abrupt[i] = -blow_N + least_N;
      slack[i] = most_N - least_N;
    }
  }
  // Where friction is only known within limits, so is its smoothed course: what the drive asks within them, it is.
  const std::vector<double> least = kernel_.apply(least_abrupt, 0), more = kernel_.apply(slack, 0);
  double largest_N = 0;  // friction that the drive never overcomes would let nothing move
  for (std::size_t i = 0; i < samples(); ++i)
    if (usable_[i]) largest_N = std::max(largest_N, std::abs(drive_N[i]));
  std::vector<double> needed(samples());
  for (std::size_t i = 0; i < samples(); ++i) {
    const double held = std::min(held_N, turn_share_[i] * largest_N), from = smooth_part[i] + least[i];
    needed[i] = std::clamp(drive_N[i], from - held, from + std::max(more[i], 0.0) + held);
  }
  return needed;
}

}  // namespace pneuservo
