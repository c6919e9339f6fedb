// Minimum of a function of several variables without derivatives (Nelder and Mead, 1965).
#include "design/nelder_mead.hpp"

#include <algorithm>
#include <cmath>

namespace pneuservo {

namespace {

using Value = std::function<double(const std::vector<double>&)>;
constexpr int steps_max = 4000, restarts_max = 20;

std::vector<double> between(const std::vector<double>& a, const std::vector<double>& b, double share) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] + share * (b[i] - a[i]);
  return out;
}

std::vector<Minimum> simplex_around(const Value& value, const std::vector<double>& start, double relative_step) {
  std::vector<Minimum> simplex{{start, value(start)}};
  for (std::size_t i = 0; i < start.size(); ++i) {
    std::vector<double> corner = start;
    corner[i] += corner[i] == 0.0 ? relative_step : relative_step * corner[i];
    simplex.push_back({corner, value(corner)});
  }
  return simplex;
}

/// One step: reflect the worst corner, expand, contract, or shrink all towards the best.
void move(const Value& value, std::vector<Minimum>& simplex) {
  const std::size_t n = simplex.size() - 1;
  std::vector<double> centre(n, 0.0);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i) centre[i] += simplex[k].at[i] / static_cast<double>(n);
  Minimum& worst = simplex[n];
  const auto along = [&](double share) {
    const std::vector<double> at = between(centre, worst.at, share);
    return Minimum{at, value(at)};
  };
  const Minimum reflected = along(-1.0);
  if (reflected.value < simplex[0].value) {
    const Minimum expanded = along(-2.0);
    worst = expanded.value < reflected.value ? expanded : reflected;
    return;
  }
  if (reflected.value < simplex[n - 1].value) {
    worst = reflected;
    return;
  }
  const Minimum contracted = along(reflected.value < worst.value ? -0.5 : 0.5);
  if (contracted.value < std::min(worst.value, reflected.value)) {
    worst = contracted;
    return;
  }
  for (std::size_t k = 1; k <= n; ++k) {
    simplex[k].at = between(simplex[0].at, simplex[k].at, 0.5);
    simplex[k].value = value(simplex[k].at);
  }
}

Minimum one_search(const Value& value, const std::vector<double>& start, double relative_step, double tolerance) {
  std::vector<Minimum> simplex = simplex_around(value, start, relative_step);
  const auto better = [](const Minimum& a, const Minimum& b) { return a.value < b.value; };
  for (int step = 0; step < steps_max; ++step) {
    std::stable_sort(simplex.begin(), simplex.end(), better);
    const double spread = simplex.back().value - simplex.front().value;
    if (spread <= tolerance * std::fabs(simplex.front().value)) break;
    move(value, simplex);
  }
  return *std::min_element(simplex.begin(), simplex.end(), better);
}

}  // namespace

Minimum nelder_mead(const Value& value, const std::vector<double>& start, double relative_step, double tolerance) {
  Minimum best{start, value(start)};
  for (int restart = 0; restart < restarts_max; ++restart) {
    const Minimum found = one_search(value, best.at, relative_step, tolerance);
    const double gained = best.value - found.value;
    if (found.value <= best.value) best = found;
    if (!(gained > 1e-9 * std::fabs(best.value))) break;
  }
  return best;
}

}  // namespace pneuservo
