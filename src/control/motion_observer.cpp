// Ramp-invariant discretisation of the observer.
#include <pneuservo/control/motion_observer.hpp>

#include "control/matrix_exponential.hpp"

namespace pneuservo {

DiscreteObserver discretise(const ObserverGains& gains, double period_s) noexcept {
  // States x, v T, a T^2 in units of time T: entries alike in size, so that the small ones keep their digits.
  const double T = period_s;
  const std::array<double, 3> l{gains.l1 * T, gains.l2 * T * T, gains.l3 * T * T * T};
  const std::array<double, 3> size{1.0, T, T * T};
  SquareMatrix<5> m{};  // x, v T, a T^2, y, change of y over the period
  for (std::size_t i = 0; i < 3; ++i) {
    m[i][0] = -l[i];
    m[i][3] = l[i];
  }
  m[0][1] = m[1][2] = m[3][4] = 1.0;
  const SquareMatrix<5> e = exponential(m);
  DiscreteObserver out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) out.phi[i][j] = e[i][j] * size[j] / size[i];
    out.g1[i] = e[i][4] / size[i];
    out.g0[i] = (e[i][3] - e[i][4]) / size[i];
  }
  return out;
}

}  // namespace pneuservo
