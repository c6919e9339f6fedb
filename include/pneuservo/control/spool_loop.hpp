// A servo valve's inner loop: the spool follows its command as a second-order lag that is chosen, one tick late.
#pragma once
#include <algorithm>
#include <cmath>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// What the loop is asked for and what it drives. Frequencies above 300 Hz lose accuracy at 100 us (docs/physics/
/// spool_loop.md).
struct SpoolLoopParameters {
  double natural_frequency_Hz = 100.0;
  double damping_ratio = 0.7;
  double acceleration_per_volt_mps2_per_V = 223.28;  ///< of the spool with its coil (elements/spool_mass.hpp)
  double period_s = 100e-6;
  double command_max_V = infinite;                   ///< of the coil's amplifier
  double observer_radius = 3.0;                      ///< observer's poles over the spool's frequency

  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"natural_frequency_Hz", "Hz", 50, 300, "of the spool in its loop"}, p.natural_frequency_Hz...);
    v(Field{"damping_ratio", "-", 0.1, 0.99, "of the spool in its loop"}, p.damping_ratio...);
    v(Field{"acceleration_per_volt_mps2_per_V", "m/(s2 V)", 1e-3, 1e6, "of spool and coil", optional},
      p.acceleration_per_volt_mps2_per_V...);
    v(Field{"period_s", "s", 1e-6, 1e-3, "of the loop", optional}, p.period_s...);
    v(Field{"command_max_V", "V", 1e-6, infinite, "range of the coil's command is +- this; .inf: none", optional},
      p.command_max_V...);
    v(Field{"observer_radius", "-", 1, 10, "poles of the observer over the spool's frequency", optional},
      p.observer_radius...);
  }
};

/// u_k = K1 (r - x) - K2 v - K3 (u_{k-1} + d) - d, and what corrects x, v, d by the measured position.
struct SpoolLoopGains {
  double K1_V_per_m = 0.0, K2_Vs_per_m = 0.0, K3 = 0.0;
  double alpha = 0.0, beta_per_s = 0.0, gamma_V_per_m = 0.0;  ///< x += alpha e, v += beta e, d += gamma e
};

/// Two poles where the wanted lag has them, sampled; the pole of the delay at 0: K1 to K3 place them for the state
/// predicted one tick ahead. Observer: three poles on a Butterworth circle of observer_radius w_v. Cold.
inline SpoolLoopGains spool_loop_gains(const SpoolLoopParameters& p) noexcept {
  const double T = p.period_s, kv = p.acceleration_per_volt_mps2_per_V, zeta = p.damping_ratio;
  const double w = 6.283185307179586 * p.natural_frequency_Hz;
  const double a1 = -2.0 * std::exp(-zeta * w * T) * std::cos(w * T * std::sqrt(1.0 - zeta * zeta));
  const double a2 = std::exp(-2.0 * zeta * w * T);
  const double k1 = (1.0 + a1 + a2) / (kv * T * T), k2 = (3.0 + a1 - a2) / (2.0 * kv * T);
  SpoolLoopGains g;
  g.K1_V_per_m = k1;
  g.K2_Vs_per_m = k1 * T + k2;
  g.K3 = 0.5 * k1 * kv * T * T + k2 * kv * T;
  // z^3 + q2 z^2 + q1 z + q0 of the error; position, v T and kv d T^2 make the model's matrix free of numbers.
  const double radius = p.observer_radius * w;
  const double real = std::exp(-radius * T), pair = std::exp(-0.5 * radius * T);
  const double turn = 2.0 * pair * std::cos(radius * T * 0.8660254037844386);  // sum of both of the pair
  const double q2 = -(real + turn), q1 = real * turn + pair * pair, q0 = -real * pair * pair;
  g.alpha = 1.0 + q0;
  const double gamma = q2 + q1 + g.alpha;
  g.beta_per_s = (q2 + 3.0 - g.alpha - 0.5 * gamma) / T;
  g.gamma_V_per_m = gamma / (kv * T * T);
  return g;
}

/// The loop of one valve at its own tick. Plain data.
class SpoolLoop {
 public:
  /// Cold: parameters in the ranges of their fields; resets at 0.
  void configure(const SpoolLoopParameters& parameters) noexcept {
    parameters_ = parameters;
    gains_ = spool_loop_gains(parameters);
    reset(0.0);
  }
  /// At rest there [m], no disturbance known. HOT.
  void reset(double position_m) noexcept {
    x_ = wanted_ = position_m;
    v_ = d_ = u_ = 0.0;
    finite_ = true;
  }
  /// Gains of another lag, from the next tick on; the observer keeps its state. HOT.
  void change(const SpoolLoopGains& gains) noexcept { gains_ = gains; }

  /// Command of the coil [V] from the measured position and the one wanted [m]; it acts from the next tick on, while
  /// that of the tick before acts now. A position that is not a number leaves the observer alone; the command stays
  /// finite. HOT.
  double step(double measured_m, double wanted_m) noexcept {
    finite_ = std::isfinite(measured_m) && std::isfinite(wanted_m);
    if (std::isfinite(measured_m)) {
      const double e = measured_m - x_;
      x_ += gains_.alpha * e;
      v_ += gains_.beta_per_s * e;
      d_ += gains_.gamma_V_per_m * e;
    }
    const double acting = u_ + d_;
    if (std::isfinite(wanted_m)) wanted_ = wanted_m;
    const double next = gains_.K1_V_per_m * (wanted_ - x_) - gains_.K2_Vs_per_m * v_ - gains_.K3 * acting - d_;
    const double T = parameters_.period_s, kv = parameters_.acceleration_per_volt_mps2_per_V;
    x_ += T * (v_ + 0.5 * T * kv * acting);
    v_ += T * kv * acting;
    u_ = std::clamp(next, -parameters_.command_max_V, parameters_.command_max_V);
    return u_;
  }

  const SpoolLoopGains& gains() const noexcept { return gains_; }
  /// Estimates for the next tick.
  double position_m() const noexcept { return x_; }
  double velocity_mps() const noexcept { return v_; }
  /// Disturbing force as a command of the coil [V].
  double disturbance_V() const noexcept { return d_; }
  /// False: the last step had an input that was not a number.
  bool finite() const noexcept { return finite_; }

 private:
  SpoolLoopParameters parameters_{};
  SpoolLoopGains gains_{};
  double x_ = 0.0, v_ = 0.0, d_ = 0.0, u_ = 0.0, wanted_ = 0.0;
  bool finite_ = true;
};

}  // namespace pneuservo
