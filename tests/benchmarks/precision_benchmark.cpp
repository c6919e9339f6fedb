// Work and precision of a line with its chamber: ours on several grids, ARKODE and CVODE on several grids and
// tolerances, against a converged solution of the equations.
#include <algorithm>
#include <string>
#include <vector>

#include "sundials_line.hpp"

namespace pneuservo::bench {
namespace {

/// From here on nothing is left of the start, where the piston begins to move at once.
constexpr std::size_t judged_from = periods / 2;

/// The chamber's pressure on an infinitely fine grid, from 80 and 160 cells, whose error falls with the cell's square.
struct Converged {
  std::vector<double> chamber_Pa;
  double uncertainty_Pa = 0.0;  ///< what the extrapolation added to 160 cells, at most

  Converged() {
    std::vector<double> coarse;
    Integrator(Method::adams, 1e-8, 80).run(coarse);
    Integrator(Method::adams, 1e-8, 160).run(chamber_Pa);
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      const double added_Pa = (chamber_Pa[k] - coarse[k]) / 3.0;
      chamber_Pa[k] += added_Pa;
      if (k >= judged_from) uncertainty_Pa = std::max(uncertainty_Pa, std::fabs(added_Pa));
    }
  }
};
const Converged& converged() {
  static const Converged solution;
  return solution;
}

/// One way to compute the line, with what it costs and how far off it is.
struct Way {
  double us = infinite, error_Pa = 0.0;
};
/// The shortest of a few runs.
template <class F> Way least_of(int batches, F&& run) {
  Way way;
  std::vector<double> chamber_Pa;
  for (int i = 0; i < batches; ++i) way.us = std::min(way.us, run(chamber_Pa));
  way.error_Pa = largest_difference(chamber_Pa, converged().chamber_Pa, judged_from);
  return way;
}
Way ours(int cells, int substeps) {
  return least_of(40, [&](std::vector<double>& out) { return run_line(out, cells, substeps); });
}
/// From n and 2n sub-steps: the error of first order in the step cancels.
Way extrapolated(int cells, int substeps) {
  std::vector<double> finer_Pa;
  return least_of(40, [&](std::vector<double>& out) {
    const double us = run_line(out, cells, substeps) + run_line(finer_Pa, cells, 2 * substeps);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = 2.0 * finer_Pa[k] - out[k];
    return us;
  });
}
Way theirs(Method method, int cells, double relative_tolerance) {
  Integrator integrator(method, relative_tolerance, cells);
  return least_of(6, [&](std::vector<double>& out) { return integrator.run(out); });
}

/// The cheapest of several ways whose error is at most error_Pa; infinite: none.
double least_us(const std::vector<Way>& ways, double error_Pa) {
  double least = infinite;
  for (const Way& way : ways)
    if (way.error_Pa <= error_Pa) least = std::min(least, way.us);
  return least;
}

void tell(benchmark::State& state, const std::string& name, const Way& way) {
  state.counters[name + "/us"] = way.us;
  state.counters[name + "/Pa"] = way.error_Pa;
}

void line_work_and_precision(benchmark::State& state) {
  std::vector<Way> of_ours, of_theirs;
  for (const int cells : {5, 10, 20, 40, 80})
    for (const int per_ten : {1, 2, 4}) {
      const int substeps = per_ten * std::max(1, cells / 20);
      of_ours.push_back(ours(cells, substeps));
      tell(state, "ours/" + std::to_string(cells) + "/" + std::to_string(substeps), of_ours.back());
    }
  for (const int cells : {5, 10, 20, 40}) {
    const int substeps = std::max(1, cells / 20);
    of_ours.push_back(extrapolated(cells, substeps));
    tell(state, "extrapolated/" + std::to_string(cells) + "/" + std::to_string(substeps), of_ours.back());
  }
  for (const auto& [method, name] :
       {std::pair{Method::explicit_runge_kutta, "arkode"}, std::pair{Method::adams, "cvode"}})
    for (const int cells : {5, 10, 20, 40})
      for (int digits = 2; digits <= 6; ++digits) {
        of_theirs.push_back(theirs(method, cells, std::pow(10.0, -digits)));
        tell(state, std::string(name) + "/" + std::to_string(cells) + "/" + std::to_string(digits), of_theirs.back());
      }
  const double metre_grid_Pa = ours(10, 0).error_Pa;
  state.counters["converged_uncertainty_Pa"] = converged().uncertainty_Pa;
  state.counters["metre_grid_error_Pa"] = metre_grid_Pa;
  state.counters["times_faster_at_that_error"] = least_us(of_theirs, metre_grid_Pa) / least_us(of_ours, metre_grid_Pa);
  state.counters["times_faster_at_a_tenth"] =
      least_us(of_theirs, 0.1 * metre_grid_Pa) / least_us(of_ours, 0.1 * metre_grid_Pa);
  report(state, least_us(of_ours, metre_grid_Pa) * 1e3);
}
BENCHMARK(line_work_and_precision)->Iterations(1)->UseManualTime()->Unit(benchmark::kNanosecond);

}  // namespace
}  // namespace pneuservo::bench
