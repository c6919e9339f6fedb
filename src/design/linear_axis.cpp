// A pneumatic axis as a linear model: slider between air springs behind lags of valve and lines.
#include "design/linear_axis.hpp"

#include <algorithm>
#include <cmath>

namespace pneuservo {

namespace {

bool is_there(const SecondOrderLag& lag) { return lag.natural_frequency_rad_per_s > 0.0; }
Polynomial denominator_of(const SecondOrderLag& lag) {
  return is_there(lag) ? Polynomial{1.0, lag.slope_s(), lag.curvature_s2()} : Polynomial{1.0};
}

}  // namespace

bool LinearAxis::lines_alike() const {
  return lines[0].natural_frequency_rad_per_s == lines[1].natural_frequency_rad_per_s &&
         lines[0].damping_ratio == lines[1].damping_ratio && stiffening[0] == stiffening[1];
}

int LinearAxis::order() const { return 2 + static_cast<int>(lag_denominator().size()); }

Polynomial LinearAxis::numerator() const {
  if (lines_alike()) return {1.0};
  return sum(scaled(denominator_of(lines[1]), weights[0]), scaled(denominator_of(lines[0]), weights[1]));
}

Polynomial LinearAxis::lag_denominator() const {
  const Polynomial first = product(denominator_of(valve), denominator_of(lines[0]));
  return lines_alike() ? first : product(first, denominator_of(lines[1]));
}

Polynomial LinearAxis::open_loop() const {
  // (s^3 + damping s^2) d_1 d_2 + s (k_1 q_1 d_2 + k_2 q_2 d_1), q = 1 + stiffening (d - 1), all behind the valve's
  // lag.
  const auto spring = [this](std::size_t i) {
    Polynomial q = scaled(denominator_of(lines[i]), stiffening[i]);
    q[0] = 1.0;
    return q;
  };
  const Polynomial d_1 = denominator_of(lines[0]), inertia{0.0, 0.0, damping_per_s, 1.0};
  Polynomial open;
  if (lines_alike()) {
    open = sum(product(inertia, d_1), scaled(product({0.0, 1.0}, spring(0)), natural_frequency_squared()));
  } else {
    const Polynomial d_2 = denominator_of(lines[1]);
    const Polynomial springs =
        sum(scaled(product(spring(0), d_2), stiffness_per_s2[0]), scaled(product(spring(1), d_1), stiffness_per_s2[1]));
    open = sum(product(inertia, product(d_1, d_2)), product({0.0, 1.0}, springs));
  }
  return product(open, denominator_of(valve));
}

LinearAxis linear_axis(const LinearServoTable& table) {
  LinearAxis axis;
  axis.gain_per_V = table.gain_per_V;
  axis.stiffness_per_s2.fill(0.5 * table.natural_frequency_squared);
  axis.valve = table.valve;
  axis.lines = {table.line, table.line};
  return axis;
}

LinearAxis without_lags(LinearAxis axis) {
  axis.valve = {};
  axis.lines = {};
  axis.stiffening = {1.0, 1.0};
  return axis;
}

LinearAxis matched_at_low_frequency(const LinearAxis& axis) {
  const Polynomial inverse = series_quotient(axis.lag_denominator(), axis.numerator(), 3);
  LinearAxis out = without_lags(axis);
  if (!(inverse[2] > 0.0)) return out;
  const double frequency = 1.0 / std::sqrt(inverse[2]);
  out.lines[0] = out.lines[1] = {frequency, 0.5 * inverse[1] * frequency};
  const double springs = axis.stiffness_per_s2[0] * axis.stiffening[0] + axis.stiffness_per_s2[1] * axis.stiffening[1];
  out.stiffening.fill(springs / axis.natural_frequency_squared());
  return out;
}

Polynomial closed_loop(const LinearAxis& axis, const Ppd2Gains& gains) {
  const Polynomial law{gains.position_V_per_m, gains.velocity_Vs_per_m, gains.acceleration_Vs2_per_m};
  const Polynomial out = sum(axis.open_loop(), scaled(product(law, axis.numerator()), axis.gain_per_V));
  return scaled(out, 1.0 / out.back());
}

LinearAxis reduced_by_pole_distance(const LinearAxis& axis, const Ppd2Gains& gains) {
  LinearAxis out = without_lags(axis);
  auto poles = roots(closed_loop(axis, gains));
  std::sort(poles.begin(), poles.end(), [](const auto& a, const auto& b) { return a.real() > b.real(); });
  if (poles.size() < 5) return out;
  const double frequency = std::abs(poles[3]);
  out.lines[0] = out.lines[1] = {frequency, -poles[3].real() / frequency};
  return out;
}

std::vector<double> inverse_of_closed_loop(const LinearAxis& axis, const Ppd2Gains& gains) {
  const auto order = static_cast<std::size_t>(axis.order());
  const Polynomial law{gains.position_V_per_m, gains.velocity_Vs_per_m, gains.acceleration_Vs2_per_m};
  const Polynomial loop = sum(axis.open_loop(), scaled(product(law, axis.numerator()), axis.gain_per_V));
  Polynomial series =
      series_quotient(loop, scaled(axis.numerator(), axis.gain_per_V * gains.position_V_per_m), order + 1);
  series.erase(series.begin());
  return series;
}

}  // namespace pneuservo
