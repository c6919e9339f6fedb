// Rules that find the gains of the PPD2 law from the linear model.
#include "design/gain_rules.hpp"

#include <cmath>

#include "design/itae.hpp"
#include "design/nelder_mead.hpp"

namespace pneuservo {

Ppd2Gains alpha_beta_gains(const LinearAxis& axis, double position_gain_V_per_m, double alpha, double beta) {
  const double w = std::cbrt(position_gain_V_per_m * axis.gain_per_V);
  return {position_gain_V_per_m, (beta * w * w - axis.natural_frequency_squared()) / axis.gain_per_V,
          (alpha * w - axis.damping_per_s) / axis.gain_per_V};
}

Ppd2Gains coefficient_gains(const LinearAxis& axis, double position_gain_V_per_m, double c_1, double c_2) {
  // c_1 = open_1 + K (Kv + n_1 Kp),  c_2 = open_2 + K (Ka + n_1 Kv + n_2 Kp), n the numerator of the lags.
  const Polynomial open = axis.open_loop();
  Polynomial numerator = axis.numerator();
  numerator.resize(3, 0.0);
  const double leading = open.back(), n = static_cast<double>(open.size() - 1), K = axis.gain_per_V;
  const double w = std::pow(position_gain_V_per_m * K / leading, 1.0 / n);
  Ppd2Gains gains{position_gain_V_per_m, 0.0, 0.0};
  gains.velocity_Vs_per_m = (c_1 * std::pow(w, n - 1) * leading - open[1]) / K - numerator[1] * position_gain_V_per_m;
  gains.acceleration_Vs2_per_m = (c_2 * std::pow(w, n - 2) * leading - open[2]) / K -
                                 numerator[1] * gains.velocity_Vs_per_m - numerator[2] * position_gain_V_per_m;
  return gains;
}

std::vector<double> normalised_coefficients(const Polynomial& closed_loop) {
  const double n = static_cast<double>(closed_loop.size() - 1);
  const double w = std::pow(closed_loop.front() / closed_loop.back(), 1.0 / n);
  std::vector<double> out;
  for (std::size_t i = 1; i + 1 < closed_loop.size(); ++i)
    out.push_back(closed_loop[i] / closed_loop.back() / std::pow(w, n - static_cast<double>(i)));
  return out;
}

double itae_of_loop(const LinearAxis& axis, const Ppd2Gains& gains) {
  const Polynomial loop = closed_loop(axis, gains);
  return itae_of_step(scaled(axis.numerator(), loop.front()), loop);
}

Ppd2Gains least_itae_gains(const LinearAxis& axis, double position_gain_V_per_m) {
  const Ppd2Gains start = alpha_beta_gains(axis, position_gain_V_per_m, 2.0, 2.0);
  const Minimum found = nelder_mead(
      [&](const std::vector<double>& gains) { return itae_of_loop(axis, {position_gain_V_per_m, gains[0], gains[1]}); },
      {start.velocity_Vs_per_m, start.acceleration_Vs2_per_m});
  return {position_gain_V_per_m, found.at[0], found.at[1]};
}

}  // namespace pneuservo
