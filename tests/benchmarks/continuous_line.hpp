// The line's staggered grid and its chamber left continuous in time: the right-hand side for an ODE solver.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include <pneuservo/elements/chamber.hpp>
#include <pneuservo/elements/pipe_friction.hpp>

namespace pneuservo::bench {

/// y = rho_i [kg/m3], p_i [Pa] (i = 0..N-1), u_j [m/s] (j = 0..N), chamber mass [kg] and internal energy [J].
/// The same grid, face values and correlations as Line and Chamber; written plainly, for one line, without guards.
class ContinuousLine {
 public:
  ContinuousLine(const LineParameters<double>& line, const ChamberGeometry<double>& chamber, int cells)
      : cells_(cells), chamber_(chamber), friction_(line, air_), diameter_(line.diameter_m), dx_(line.length_m / cells),
        area_(line.section_m2()), mass_flux_(static_cast<std::size_t>(cells) + 1), pressure_flux_(mass_flux_),
        friction_heat_(mass_flux_), nusselt_(mass_flux_) {}

  int size() const noexcept { return 3 * cells_ + 3; }
  /// Port pressure linear from p_0 at t_0 to p_1 at t_1; piston at s(t) = s_mean + s_swing sin(w t).
  void set_port(double t_0, double t_1, double p_0, double p_1) noexcept {
    t_0_ = t_0;
    p_0_ = p_0;
    slope_ = (p_1 - p_0) / (t_1 - t_0);
  }
  static double distance_m(double t) noexcept { return 0.15 + 0.08 * std::sin(6.283185307179586 * t); }
  static double speed_mps(double t) noexcept { return 0.08 * 6.283185307179586 * std::cos(6.283185307179586 * t); }

  void start(double pressure_Pa, double* y) const noexcept {
    const double T = air_.temperature_K;
    for (int i = 0; i < cells_; ++i) y[i] = pressure_Pa / (air_.R * T), y[cells_ + i] = pressure_Pa;
    std::fill(y + 2 * cells_, y + 3 * cells_ + 1, 0.0);
    const double volume = chamber_.volume_m3(distance_m(0.0));
    y[3 * cells_ + 1] = pressure_Pa * volume / (air_.R * T);
    y[3 * cells_ + 2] = pressure_Pa * volume / (air_.kappa - 1.0);
  }
  double chamber_pressure_Pa(double t, const double* y) const noexcept {
    return (air_.kappa - 1.0) * y[3 * cells_ + 2] / chamber_.volume_m3(distance_m(t));
  }

  void derivative(double t, const double* y, double* dy) noexcept {
    const int n = cells_;
    const double *rho = y, *p = y + n, *u = y + 2 * n;
    const double port = p_0_ + slope_ * (t - t_0_), volume = chamber_.volume_m3(distance_m(t));
    const double m = y[3 * n + 1], U = y[3 * n + 2], p_ch = (air_.kappa - 1.0) * U / volume, T_ch = U / (m * air_.cv);
    const double T_s = air_.temperature_K;
    double enthalpy_flux = 0.0;
    for (int j = 0; j <= n; ++j) {
      const bool forward = u[j] > 0.0;
      double density, gradient, du, p_face, s_up;
      if (j == 0) {
        density = forward ? port / (air_.R * T_s) : rho[0];
        gradient = 2.0 * (p[0] - port);
        du = forward ? 0.0 : u[1] - u[0];
        p_face = forward ? port : limited(port, p[0]);
        s_up = forward ? inflow(T_s, u[0]) : rho[0] / p[0];
      } else if (j == n) {
        density = u[n] < 0.0 ? p_ch / (air_.R * T_ch) : rho[n - 1];
        gradient = 2.0 * (p_ch - p[n - 1]);
        du = forward ? u[n] - u[n - 1] : 0.0;
        p_face = u[n] < 0.0 ? p_ch : limited(p_ch, p[n - 1]);
        s_up = u[n] < 0.0 ? inflow(T_ch, u[n]) : rho[n - 1] / p[n - 1];
        const double h = u[n] < 0.0 ? air_.cp * T_ch : air_.cp * p[n - 1] / (rho[n - 1] * air_.R) + 0.5 * u[n] * u[n];
        enthalpy_flux = s_up * p_face * u[n] * h;
      } else {
        density = 0.5 * (rho[j - 1] + rho[j]);
        gradient = p[j] - p[j - 1];
        du = forward ? u[j] - u[j - 1] : u[j + 1] - u[j];
        const int up = forward ? j - 1 : j;
        p_face = limited(0.5 * (p[j - 1] + p[j]), p[up]);
        s_up = rho[up] / p[up];
      }
      const auto friction = friction_(density * std::fabs(u[j]) * diameter_ / air_.viscosity_Pas);
      const double f = air_.viscosity_Pas * friction.lambda_reynolds / (2.0 * diameter_ * diameter_);
      nusselt_[static_cast<std::size_t>(j)] = friction.nusselt;
      friction_heat_[static_cast<std::size_t>(j)] = f * u[j] * u[j];
      pressure_flux_[static_cast<std::size_t>(j)] = p_face * u[j];
      mass_flux_[static_cast<std::size_t>(j)] = s_up * p_face * u[j];
      dy[2 * n + j] = -(u[j] * du + gradient / density) / dx_ - f * u[j] / density;
    }
    for (int i = 0; i < n; ++i) {
      const auto l = static_cast<std::size_t>(i), r = l + 1;
      const double T = p[i] / (rho[i] * air_.R);
      const double wall = 2.0 * (nusselt_[l] + nusselt_[r]) * Air<double>::conductivity(T) / (diameter_ * diameter_);
      dy[i] = -(mass_flux_[r] - mass_flux_[l]) / dx_;
      dy[n + i] = -(pressure_flux_[r] - pressure_flux_[l] + (air_.kappa - 1.0) * p[i] * (u[i + 1] - u[i])) / dx_ +
                  (air_.kappa - 1.0) * (0.5 * (friction_heat_[l] + friction_heat_[r]) + wall * (T_s - T));
    }
    dy[3 * n + 1] = area_ * mass_flux_[static_cast<std::size_t>(n)];
    dy[3 * n + 2] = area_ * enthalpy_flux - p_ch * chamber_.area_m2 * speed_mps(t) +
                    chamber_.wall_heat_W_per_m2K * chamber_.wall_area_m2(distance_m(t)) * (T_s - T_ch);
  }

 private:
  static double limited(double centred, double upwind) noexcept {
    return upwind + clamp(centred - upwind, -0.1 * upwind, 0.1 * upwind);
  }
  double inflow(double stagnation_K, double u) const noexcept {
    return 1.0 / (air_.R * (stagnation_K - 0.5 * u * u / air_.cp));
  }

  int cells_;
  Air<double> air_;
  ChamberGeometry<double> chamber_;
  PipeFriction<double> friction_;
  double diameter_, dx_, area_;
  double t_0_ = 0.0, p_0_ = 0.0, slope_ = 0.0;
  std::vector<double> mass_flux_, pressure_flux_, friction_heat_, nusselt_;
};

}  // namespace pneuservo::bench
