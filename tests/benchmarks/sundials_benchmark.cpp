// One line with its chamber against SUNDIALS on the same grid: ARKODE (explicit Runge-Kutta) and CVODE (Adams).
#include <vector>

#include "sundials_line.hpp"

namespace pneuservo::bench {
namespace {

constexpr int cells = 10;

void line_against_sundials(benchmark::State& state) {
  std::vector<double> converged, by_line, by_runge_kutta, by_adams;
  Integrator(Method::adams, 1e-9, cells).run(converged);
  Integrator runge_kutta(Method::explicit_runge_kutta, 1e-4, cells), adams(Method::adams, 1e-4, cells);
  double line_us = 1e9, runge_kutta_us = 1e9, adams_us = 1e9;
  for (int batch = 0; batch < 60; ++batch) {
    for (int i = 0; i < 5; ++i) line_us = std::min(line_us, run_line(by_line, cells));
    runge_kutta_us = std::min(runge_kutta_us, runge_kutta.run(by_runge_kutta));
    adams_us = std::min(adams_us, adams.run(by_adams));
  }
  state.counters["line_us_per_period"] = line_us;
  state.counters["arkode_explicit_us_per_period"] = runge_kutta_us;
  state.counters["cvode_adams_us_per_period"] = adams_us;
  state.counters["times_faster_than_sundials"] = std::min(runge_kutta_us, adams_us) / line_us;
  state.counters["line_error_Pa"] = largest_difference(by_line, converged);
  state.counters["arkode_explicit_error_Pa"] = largest_difference(by_runge_kutta, converged);
  state.counters["cvode_adams_error_Pa"] = largest_difference(by_adams, converged);
  report(state, line_us * 1e3);
}
BENCHMARK(line_against_sundials)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

}  // namespace
}  // namespace pneuservo::bench
