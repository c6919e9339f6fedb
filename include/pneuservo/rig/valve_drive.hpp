// The drive of a simulated servo valve: spool, coil, spool sensor and the inner loop at a period of its own.
#pragma once
#include <cmath>

#include <pneuservo/control/spool_loop.hpp>
#include <pneuservo/elements/spool_mass.hpp>

namespace pneuservo {

/// What a drive is asked for. The spool is the thesis' (Table 2.3).
struct ValveDriveParameters {
  SpoolLoopParameters loop;
  double command_max_V = 1.0;    ///< moves the spool by spool_stroke_m
  double spool_quantum_m = 0.0;  ///< of the spool's sensor; 0: exact
};
inline constexpr double spool_stroke_m = 0.75e-3;  ///< to either side (thesis 2.1.2)

/// Follows a command as the lag of 2.17 does, one tick late. Plain data.
class ValveDrive {
 public:
  /// Cold.
  void configure(const ValveDriveParameters& parameters) noexcept {
    m_per_V_ = spool_stroke_m / parameters.command_max_V;
    quantum_m_ = parameters.spool_quantum_m;
    period_s_ = parameters.loop.period_s;
    loop_.configure(parameters.loop);
    spool_.configure({});
    coil_V_ = 0.0;
  }
  /// One tick of its loop under a command [V]: the spool's mean over it, as a command [V]. HOT.
  double step(double command_V) noexcept {
    const double before_m = spool_.position_m(), speed_mps = spool_.velocity_mps();
    const double seen_m = quantum_m_ > 0.0 ? quantum_m_ * std::nearbyint(before_m / quantum_m_) : before_m;
    const double next_V = loop_.step(seen_m, m_per_V_ * command_V);
    spool_.step(coil_V_, 0.0, period_s_);
    // Under one acceleration the mean of a tick is its start, half its way at that speed and a sixth of the change.
    const double change_mps = spool_.velocity_mps() - speed_mps;
    coil_V_ = next_V;
    return (before_m + period_s_ * (0.5 * speed_mps + change_mps / 6.0)) / m_per_V_;
  }
  double spool_m() const noexcept { return spool_.position_m(); }

 private:
  SpoolLoop loop_;
  SpoolMass<double> spool_;
  double m_per_V_ = 0.0, quantum_m_ = 0.0, period_s_ = 0.0, coil_V_ = 0.0;
};

}  // namespace pneuservo
