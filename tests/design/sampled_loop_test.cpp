// The sampled loop of the servo table against golden numbers; margins and steps that are known in closed form.
#include <catch2/catch.hpp>

#include <numbers>

#include <pneuservo/control/motion_observer.hpp>

#include "design/sampled_laws.hpp"
#include "design/sampled_loop.hpp"
#include "design/table_models.hpp"

using namespace pneuservo;
using namespace pneuservo::test;
using Complex = std::complex<double>;

namespace {

Ppd2Parameters law_of(const Ppd2Gains& gains, ObserverInput input, double observer_rad_per_s) {
  Ppd2Parameters p;
  p.position_gain_V_per_m = gains.position_V_per_m;
  p.velocity_gain_Vs_per_m = gains.velocity_Vs_per_m;
  p.acceleration_gain_Vs2_per_m = gains.acceleration_Vs2_per_m;
  p.observer = input;
  if (observer_rad_per_s > 0.0) p.observer_rad_per_s = observer_rad_per_s;
  else p.observer_gains = std::vector<double>{530.5, 140739.9, 1.85e7};  // as printed
  return p;
}

SampledLoop table_loop(const TableCase& one, const Ppd2Gains& gains, ObserverInput input, double observer_rad_per_s) {
  return {held(continuous_axis(golden_axis(one)), table_period_s, 0.0),
          ppd2_law(law_of(gains, input, observer_rad_per_s), table_period_s), table_period_s};
}

LoopMargins margins(const SampledLoop& loop) {
  return margins_of([&](double f) { return loop.open(f); }, 0.5 / loop.period_s);
}

void check_pole(const std::vector<Complex>& poles, Complex golden) {
  double nearest = 1e300;
  for (const Complex& pole : poles)
    nearest =
        std::min(nearest, std::max(std::fabs(pole.real() - golden.real()), std::fabs(pole.imag() - golden.imag())));
  INFO("pole " << golden.real() << " + " << golden.imag() << "j");
  CHECK(nearest < 0.16);
}

/// x' = u, u = -gain x, sampled: one pole at 1 - gain T.
SampledLoop integrator(double gain, double period_s, double delay_s) {
  StateSpace plant{Eigen::MatrixXd::Zero(1, 1), Eigen::MatrixXd::Ones(1, 1), Eigen::MatrixXd::Ones(1, 1),
                   Eigen::MatrixXd::Zero(1, 1)};
  StateSpace law{Eigen::MatrixXd::Zero(1, 1), Eigen::MatrixXd::Zero(1, 2), Eigen::MatrixXd::Zero(1, 1),
                 Eigen::MatrixXd::Zero(1, 2)};
  law.D << -gain, gain;
  return {held(plant, period_s, delay_s), law, period_s};
}

}  // namespace

TEST_CASE("a sampled integrator: pole, margin and step in closed form") {
  const double T = 0.01, gain = 40.0;
  const SampledLoop loop = integrator(gain, T, 0.0);
  const auto poles = loop.poles();
  REQUIRE(poles.size() == 1);  // the law's unused state stands at z = 0
  CHECK(poles[0].real() == Approx(std::log(1.0 - gain * T) / T));
  // z + gain T - 1 leaves the unit circle at gain T = 2, at half the sampling rate, which the scan ends before.
  CHECK(loop.poles(1.999 / (gain * T))[0].real() < 0.0);
  CHECK(loop.poles(2.001 / (gain * T))[0].real() > 0.0);
  const StepResponse step = step_response(loop, 0.5);
  for (std::size_t k = 0; k < 20; ++k)
    CHECK(step.y[k] == Approx(1.0 - std::pow(1.0 - gain * T, static_cast<double>(k))).margin(1e-12));
  CHECK(step.overshoot == 0.0);
  CHECK(step.settling_s == Approx(T * std::ceil(std::log(0.02) / std::log(1.0 - gain * T))));
}

TEST_CASE("a delayed integrator: gain margin pi/(2 w T_d), phase margin from the delay") {
  const double T = 2e-4, delay = 0.01, gain = 50.0;
  const LoopMargins m = margins(integrator(gain, T, delay));
  const double dead = delay + 0.5 * T;  // the hold counts half a period
  CHECK(m.gain_up == Approx(std::numbers::pi / (2.0 * dead * gain)).epsilon(1e-4));
  CHECK(m.phase_deg == Approx(90.0 - gain * dead * 180.0 / std::numbers::pi).margin(0.01));
  CHECK(m.phase_Hz == Approx(gain / (2.0 * std::numbers::pi)).epsilon(1e-4));
  CHECK(m.gain_down == 0.0);
}

TEST_CASE("golden poles, margins and step with the observer on the error at 1000 rad/s") {
  struct Golden {
    const TableCase& one;
    std::vector<Complex> poles;
    double down, down_Hz, up, up_Hz, phase, overshoot, settling;
  };
  const Golden golden[]{{table_4mm,
                         {{-39.2, 0}, {-17.5, 41.4}, {-376.1, 345.2}, {-69.1, 703.0}, {-979.8, 0}, {-514.6, 870.8}},
                         0.375,
                         5.1,
                         3.897,
                         48.1,
                         36.0,
                         0.124,
                         0.207},
                        {table_8mm,
                         {{-98.7, 0}, {-17.3, 31.3}, {-331.3, 308.2}, {-68.5, 651.7}, {-974.8, 0}, {-516.7, 870.6}},
                         0.293,
                         4.8,
                         2.790,
                         49.4,
                         44.8,
                         0.162,
                         0.242}};
  for (const Golden& g : golden) {
    INFO(g.one.name);
    const SampledLoop loop = table_loop(g.one, g.one.gains_5, ObserverInput::error, 1000.0);
    const auto poles = loop.poles();
    CHECK(poles.size() == 10);
    for (const Complex& pole : g.poles) check_pole(poles, pole);
    const LoopMargins m = margins(loop);
    CHECK(m.gain_down == Approx(g.down).margin(0.0006));
    CHECK(m.gain_down_Hz == Approx(g.down_Hz).margin(0.06));
    CHECK(m.gain_up == Approx(g.up).epsilon(1e-3));
    CHECK(m.gain_up_Hz == Approx(g.up_Hz).margin(0.06));
    CHECK(m.phase_deg == Approx(g.phase).margin(0.06));
    const StepResponse step = step_response(loop, 1.0);
    CHECK(step.overshoot == Approx(g.overshoot).margin(0.0006));
    CHECK(step.settling_s == Approx(g.settling).margin(0.001));
  }
}

TEST_CASE("golden margins by observer frequency") {
  struct Golden {
    double observer_rad_per_s;  // 0: the printed gains of the observer
    double up_4, phase_4, up_8, phase_8;
  };
  const Golden golden[]{
      {0, 1.49, 16, 1.18, 10}, {400, 2.26, 27, 1.73, 28}, {1000, 3.89, 36, 2.79, 45}, {2000, 4.58, 38, 3.10, 49}};
  for (const Golden& g : golden) {
    INFO("observer " << g.observer_rad_per_s << " rad/s");
    const LoopMargins m_4 = margins(
                          table_loop(table_4mm, table_4mm.gains_5, ObserverInput::measured, g.observer_rad_per_s)),
                      m_8 = margins(
                          table_loop(table_8mm, table_8mm.gains_5, ObserverInput::measured, g.observer_rad_per_s));
    CHECK(m_4.gain_up == Approx(g.up_4).margin(0.011));
    CHECK(m_4.phase_deg == Approx(g.phase_4).margin(0.55));
    CHECK(m_8.gain_up == Approx(g.up_8).margin(0.011));
    CHECK(m_8.phase_deg == Approx(g.phase_8).margin(0.55));
  }
  // Ideal derivatives in continuous time: the limit of a fast observer and no hold.
  const auto ideal = [](const TableCase& one) {
    const LinearAxis axis = golden_axis(one);
    return margins_of(
        [&](double f) {
          const Complex s(0.0, 2.0 * std::numbers::pi * f);
          const Ppd2Gains& g = one.gains_5;
          return axis.gain_per_V * value_at({g.position_V_per_m, g.velocity_Vs_per_m, g.acceleration_Vs2_per_m}, s) /
                 value_at(axis.open_loop(), s);
        },
        2500.0);
  };
  CHECK(ideal(table_4mm).gain_up == Approx(4.78).margin(0.008));
  CHECK(ideal(table_4mm).phase_deg == Approx(40.0).margin(0.55));
  CHECK(ideal(table_8mm).gain_up == Approx(2.72).margin(0.006));
  CHECK(ideal(table_8mm).phase_deg == Approx(54.0).margin(0.55));
  // Printed third-order gains with the printed observer: nearly unstable on the 8 mm line.
  const SampledLoop third_4 = table_loop(table_4mm, table_4mm.gains_3, ObserverInput::measured, 0.0),
                    third_8 = table_loop(table_8mm, table_8mm.gains_3, ObserverInput::measured, 0.0);
  CHECK(margins(third_4).gain_up == Approx(1.22).margin(0.006));
  CHECK(margins(third_4).phase_deg == Approx(11.0).margin(0.55));
  CHECK(margins(third_8).gain_up == Approx(1.10).margin(0.006));
  CHECK(margins(third_8).phase_deg == Approx(5.5).margin(0.1));
  check_pole(third_8.poles(), {-5.9, 117.6});
}

TEST_CASE("margins are where the poles cross: the loop at its margin has a pair on the imaginary axis") {
  const SampledLoop loop = table_loop(table_8mm, table_8mm.gains_5, ObserverInput::error, 1000.0);
  const LoopMargins m = margins(loop);
  for (const auto& [gain, Hz] : {std::pair{m.gain_up, m.gain_up_Hz}, {m.gain_down, m.gain_down_Hz}}) {
    double nearest = 1e300;
    for (const Complex& pole : loop.poles(gain))
      nearest = std::min(nearest, std::abs(pole - Complex(0.0, 2.0 * std::numbers::pi * Hz)));
    CHECK(nearest < 1e-6 * 2.0 * std::numbers::pi * Hz);
  }
}

TEST_CASE("the sampled law is the controller: the same command, sample by sample") {
  Ppd2Parameters p = law_of(table_4mm.gains_5, ObserverInput::error, 1000.0);
  p.integral_gain_V_per_m_s = 1e4;
  const StateSpace law = ppd2_law(p, table_period_s);
  MotionObserver observer;
  observer.configure(ObserverGains::butterworth(1000.0), table_period_s);
  observer.step(0.0);
  Eigen::VectorXd state = Eigen::VectorXd::Zero(4), y = Eigen::VectorXd::Zero(4);
  double integral = 0.0;
  for (int k = 1; k < 400; ++k) {
    const double x = 1e-6 * std::sin(0.05 * k) + 2e-7 * std::cos(0.4 * k) - 2e-7;
    observer.step(x);
    integral -= observer.position_m() * table_period_s;
    y(0) = x;
    const double u = (law.C * state + law.D * y)(0);
    const double direct = -p.position_gain_V_per_m * observer.position_m() -
                          p.velocity_gain_Vs_per_m * observer.velocity_mps() -
                          p.acceleration_gain_Vs2_per_m * observer.acceleration_mps2();
    state = law.A * state + law.B * y;
    CHECK(u == Approx(direct + p.integral_gain_V_per_m_s * integral).epsilon(1e-9).margin(1e-14));
  }
}

TEST_CASE("pd_force as a sampled law: what the controller's equations say") {
  PdForceParameters p;
  p.position_gain_N_per_m = 7550.0;
  p.velocity_gain_Ns_per_m = 95.6;
  p.velocity_filter_s = 0.002;
  p.force_gain_V_per_N = 0.00572;
  p.force_integral_V_per_Ns = 0.3;
  const double T = 0.001, m = 2.0, B = 60.0;
  const StateSpace law = pd_force_law(p, m, B, T);
  Eigen::VectorXd state = Eigen::VectorXd::Zero(law.A.rows()), y(4);
  double v = 0.0, x_before = 0.0, I = 0.0;
  const double a = -std::expm1(-T / p.velocity_filter_s);
  for (int k = 0; k < 200; ++k) {
    const double x = 1e-3 * std::sin(0.03 * k), speed = 0.03 * std::cos(0.03 * k),
                 acceleration = -0.9 * std::sin(0.03 * k);
    const double reference = k > 20 ? 2e-3 : 0.0;
    v += a * ((x - x_before) / T - v);
    x_before = x;
    const double e =
        p.position_gain_N_per_m * (reference - x) - p.velocity_gain_Ns_per_m * v - (m * acceleration + B * speed);
    I += T * e;
    y << x, speed, acceleration, reference;
    CHECK((law.C * state + law.D * y)(0) ==
          Approx(p.force_gain_V_per_N * e + p.force_integral_V_per_Ns * I).epsilon(1e-10).margin(1e-12));
    state = law.A * state + law.B * y;
  }
  // Its gains as PPD2 gains, and back.
  const PdForceParameters back = as_pd_force(p, as_ppd2_gains(p, m, B), m, B);
  CHECK(back.position_gain_N_per_m == Approx(p.position_gain_N_per_m));
  CHECK(back.velocity_gain_Ns_per_m == Approx(p.velocity_gain_Ns_per_m));
  CHECK(back.force_gain_V_per_N == Approx(p.force_gain_V_per_N));
}
