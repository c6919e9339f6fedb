// The controllers' feedback as sampled linear systems.
#include "design/sampled_laws.hpp"

#include <cmath>

#include <pneuservo/control/motion_observer.hpp>
#include <pneuservo/control/ppd2.hpp>

namespace pneuservo {

StateSpace ppd2_law(const Ppd2Parameters& p, double period_s) {
  const DiscreteObserver observer = discretise(observer_gains(p), period_s);
  Eigen::MatrixXd phi(3, 3);
  Eigen::VectorXd g0(3), g1(3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto row = static_cast<std::size_t>(i);
    for (Eigen::Index j = 0; j < 3; ++j) phi(i, j) = observer.phi[row][static_cast<std::size_t>(j)];
    g0(i) = observer.g0[row];
    g1(i) = observer.g1[row];
  }
  // States: z_k - G1 y_k, which needs no earlier sample, and the integral of -e.
  const bool on_error = p.observer == ObserverInput::error;
  Eigen::RowVectorXd gains(3);
  gains << (on_error ? -p.position_gain_V_per_m : 0.0), -p.velocity_gain_Vs_per_m, -p.acceleration_gain_Vs2_per_m;
  const double integral = p.integral_gain_V_per_m_s;
  StateSpace law{Eigen::MatrixXd::Zero(4, 4), Eigen::MatrixXd::Zero(4, 4), Eigen::MatrixXd::Zero(1, 4),
                 Eigen::MatrixXd::Zero(1, 4)};
  law.A.topLeftCorner(3, 3) = phi;
  law.A(3, 3) = 1.0;
  law.B.block(0, 0, 3, 1) = phi * g1 + g0;
  law.B(3, 3) = period_s;
  law.C.leftCols(3) = gains;
  law.C(0, 3) = integral;
  law.D(0, 0) = gains.dot(g1.transpose());
  law.D(0, 3) = p.position_gain_V_per_m + integral * period_s;
  if (on_error) {  // position and integral take the observer's first state, z_0 + g1 y
    law.A(3, 0) = -period_s;
    law.B(3, 0) = -period_s * g1(0);
    law.C(0, 0) -= integral * period_s;
    law.D(0, 0) -= integral * period_s * g1(0);
  } else {
    law.B(3, 0) = -period_s;
    law.D(0, 0) -= p.position_gain_V_per_m + integral * period_s;
  }
  if (integral > 0.0) return law;
  return {law.A.topLeftCorner(3, 3), law.B.topRows(3), law.C.leftCols(3), law.D};
}

StateSpace pd_force_law(const PdForceParameters& p, double mass_kg, double friction_Ns_per_m, double period_s) {
  // States: filtered velocity, position of the sample before, integral of the force error.
  const double a = p.velocity_filter_s > 0.0 ? -std::expm1(-period_s / p.velocity_filter_s) : 1.0;
  Eigen::RowVectorXd error_state(3), error_input(4);  // e_F of states and (x, v, a, reference)
  error_state << -p.velocity_gain_Ns_per_m * (1.0 - a), p.velocity_gain_Ns_per_m * a / period_s, 0.0;
  error_input << -p.position_gain_N_per_m - p.velocity_gain_Ns_per_m * a / period_s, -friction_Ns_per_m, -mass_kg,
      p.position_gain_N_per_m;
  StateSpace law{Eigen::MatrixXd::Zero(3, 3), Eigen::MatrixXd::Zero(3, 4), Eigen::MatrixXd::Zero(1, 3),
                 Eigen::MatrixXd::Zero(1, 4)};
  law.A(0, 0) = 1.0 - a;
  law.A(0, 1) = -a / period_s;
  law.B(0, 0) = a / period_s;
  law.B(1, 0) = 1.0;
  law.A.row(2) = period_s * error_state;
  law.A(2, 2) = 1.0;
  law.B.row(2) = period_s * error_input;
  const double gain = p.force_gain_V_per_N + p.force_integral_V_per_Ns * period_s;
  law.C = gain * error_state;
  law.C(0, 2) = p.force_integral_V_per_Ns;
  law.D = gain * error_input;
  if (p.force_integral_V_per_Ns > 0.0) return law;
  return {law.A.topLeftCorner(2, 2), law.B.topRows(2), law.C.leftCols(2), law.D};
}

Ppd2Gains as_ppd2_gains(const PdForceParameters& p, double mass_kg, double friction_Ns_per_m) {
  const double f = p.force_gain_V_per_N;
  return {f * p.position_gain_N_per_m, f * (p.velocity_gain_Ns_per_m + friction_Ns_per_m), f * mass_kg};
}

PdForceParameters as_pd_force(PdForceParameters p, const Ppd2Gains& gains, double mass_kg, double friction_Ns_per_m) {
  p.force_gain_V_per_N = gains.acceleration_Vs2_per_m / mass_kg;
  p.position_gain_N_per_m = gains.position_V_per_m / p.force_gain_V_per_N;
  p.velocity_gain_Ns_per_m = gains.velocity_Vs_per_m / p.force_gain_V_per_N - friction_Ns_per_m;
  return p;
}

StateSpace sampled_law(const PdForceParameters& p, const MovedMass& moved, double period_s) {
  return pd_force_law(p, moved.mass_kg, moved.friction_Ns_per_m, period_s);
}
StateSpace sampled_law(const Ppd2Parameters& p, const MovedMass&, double period_s) { return ppd2_law(p, period_s); }

Ppd2Gains linear_gains(const PdForceParameters& p, const MovedMass& moved) {
  return as_ppd2_gains(p, moved.mass_kg, moved.friction_Ns_per_m);
}
Ppd2Gains linear_gains(const Ppd2Parameters& p, const MovedMass&) {
  return {p.position_gain_V_per_m, p.velocity_gain_Vs_per_m, p.acceleration_gain_Vs2_per_m};
}

void set_linear_gains(PdForceParameters& p, const Ppd2Gains& gains, const MovedMass& moved) {
  p = as_pd_force(p, gains, moved.mass_kg, moved.friction_Ns_per_m);
}
void set_linear_gains(Ppd2Parameters& p, const Ppd2Gains& gains, const MovedMass&) {
  p.position_gain_V_per_m = gains.position_V_per_m;
  p.velocity_gain_Vs_per_m = gains.velocity_Vs_per_m;
  p.acceleration_gain_Vs2_per_m = gains.acceleration_Vs2_per_m;
}

std::optional<NamedGain> unusable_gain(const PdForceParameters& p, const Ppd2Gains& gains, const MovedMass& moved) {
  if (gains.acceleration_Vs2_per_m <= 0.0)
    return NamedGain{"force_gain_V_per_N", gains.acceleration_Vs2_per_m / moved.mass_kg, "V/N"};
  if (p.velocity_gain_Ns_per_m < 0.0) return NamedGain{"velocity_gain_Ns_per_m", p.velocity_gain_Ns_per_m, "N s/m"};
  if (gains.velocity_Vs_per_m < 0.0) return NamedGain{"velocity_gain_Vs_per_m", gains.velocity_Vs_per_m, "V s/m"};
  return std::nullopt;
}
std::optional<NamedGain> unusable_gain(const Ppd2Parameters&, const Ppd2Gains& gains, const MovedMass&) {
  if (gains.velocity_Vs_per_m < 0.0) return NamedGain{"velocity_gain_Vs_per_m", gains.velocity_Vs_per_m, "V s/m"};
  if (gains.acceleration_Vs2_per_m < 0.0)
    return NamedGain{"acceleration_gain_Vs2_per_m", gains.acceleration_Vs2_per_m, "V s2/m"};
  return std::nullopt;
}

void drop_integral(PdForceParameters& p) { p.force_integral_V_per_Ns = 0.0; }
void drop_integral(Ppd2Parameters& p) { p.integral_gain_V_per_m_s = 0.0; }

std::vector<NamedGain> own_gains(const PdForceParameters& p) {
  return {{"position_gain_N_per_m", p.position_gain_N_per_m, "N/m"},
          {"velocity_gain_Ns_per_m", p.velocity_gain_Ns_per_m, "N s/m"},
          {"force_gain_V_per_N", p.force_gain_V_per_N, "V/N"}};
}
std::vector<NamedGain> own_gains(const Ppd2Parameters&) { return {}; }

}  // namespace pneuservo
