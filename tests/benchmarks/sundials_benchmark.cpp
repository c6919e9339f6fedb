// One line with its chamber against SUNDIALS on the same grid: ARKODE (explicit Runge-Kutta) and CVODE (Adams).
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <pneuservo/elements/line_with_chamber.hpp>

#include "bench_tools.hpp"
#include "continuous_line.hpp"

namespace pneuservo::bench {
namespace {

constexpr int cells = 10, periods = 1000;
constexpr double period_s = 1e-3, start_Pa = 470e3;

/// Port pressure sample k: two sines, 30 kPa together, as in a working axis.
double port_Pa(int k) {
  const double t = k * period_s;
  return start_Pa + 20e3 * std::sin(6.283185307179586 * t) + 10e3 * std::sin(31.0 * t);
}
LineParameters<double> line_parameters() { return nominal_axis().line_1; }
ChamberGeometry<double> chamber_geometry() { return {1.257e-3, 2e-5, 50.0}; }

void check(int flag, const char* what) {
  if (flag < 0) throw std::runtime_error(std::string(what) + " failed with " + std::to_string(flag));
}

enum class Method { explicit_runge_kutta, adams };

/// Chamber pressure at every sample by an integrator of SUNDIALS. Like an estimator it gets a port sample each period
/// and owes the chamber pressure at its end, so it stops there; it keeps its step size and history.
class Integrator {
 public:
  Integrator(Method method, double relative_tolerance)
      : method_(method), model_(line_parameters(), chamber_geometry(), cells) {
    if (SUNContext_Create(nullptr, &context_) != 0) throw std::runtime_error("SUNContext_Create failed");
    state_ = N_VNew_Serial(model_.size(), context_);
    tolerance_ = N_VNew_Serial(model_.size(), context_);
    double* const absolute =
        N_VGetArrayPointer(tolerance_);  // relative to the quantities' sizes: kg/m3, Pa, m/s, kg, J
    for (int i = 0; i < cells; ++i)
      absolute[i] = relative_tolerance * 5.0, absolute[cells + i] = relative_tolerance * 5e5;
    for (int j = 0; j <= cells; ++j) absolute[2 * cells + j] = relative_tolerance * 10.0;
    absolute[3 * cells + 1] = relative_tolerance * 1e-3;
    absolute[3 * cells + 2] = relative_tolerance * 250.0;
    model_.start(start_Pa, N_VGetArrayPointer(state_));
    if (method == Method::adams) {
      memory_ = CVodeCreate(CV_ADAMS, context_);
      check(CVodeInit(memory_, &Integrator::derivative, 0.0, state_), "CVodeInit");
      check(CVodeSVtolerances(memory_, relative_tolerance, tolerance_), "CVodeSVtolerances");
      check(CVodeSetUserData(memory_, this), "CVodeSetUserData");
      check(CVodeSetMaxNumSteps(memory_, 100000), "CVodeSetMaxNumSteps");
      solver_ = SUNNonlinSol_FixedPoint(state_, 0, context_);
      check(CVodeSetNonlinearSolver(memory_, solver_), "CVodeSetNonlinearSolver");
    } else {
      memory_ = ERKStepCreate(&Integrator::derivative, 0.0, state_, context_);
      check(ERKStepSVtolerances(memory_, relative_tolerance, tolerance_), "ERKStepSVtolerances");
      check(ERKStepSetUserData(memory_, this), "ERKStepSetUserData");
      check(ERKStepSetMaxNumSteps(memory_, 100000), "ERKStepSetMaxNumSteps");
    }
  }
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;
  ~Integrator() {
    if (method_ == Method::adams) CVodeFree(&memory_);
    else ERKStepFree(&memory_);
    if (solver_ != nullptr) SUNNonlinSolFree(solver_);
    N_VDestroy(state_);
    N_VDestroy(tolerance_);
    SUNContext_Free(&context_);
  }

  /// From the start; returns the time of a period [us].
  double run(std::vector<double>& chamber_Pa) {
    chamber_Pa.assign(1, start_Pa);
    model_.start(start_Pa, N_VGetArrayPointer(state_));
    if (method_ == Method::adams) check(CVodeReInit(memory_, 0.0, state_), "CVodeReInit");
    else check(ERKStepReInit(memory_, &Integrator::derivative, 0.0, state_), "ERKStepReInit");
    const double start = now_ns();
    double reached = 0.0;
    for (int k = 0; k < periods; ++k) {
      const double from = k * period_s, to = (k + 1) * period_s;
      model_.set_port(from, to, port_Pa(k), port_Pa(k + 1));
      if (method_ == Method::adams) {
        check(CVodeSetStopTime(memory_, to), "CVodeSetStopTime");
        check(CVode(memory_, to, state_, &reached, CV_NORMAL), "CVode");
      } else {
        check(ERKStepSetStopTime(memory_, to), "ERKStepSetStopTime");
        check(ERKStepEvolve(memory_, to, state_, &reached, ARK_NORMAL), "ERKStepEvolve");
      }
      chamber_Pa.push_back(model_.chamber_pressure_Pa(to, N_VGetArrayPointer(state_)));
    }
    return (now_ns() - start) * 1e-3 / periods;
  }

 private:
  static int derivative(realtype t, N_Vector y, N_Vector dy, void* self) {
    static_cast<Integrator*>(self)->model_.derivative(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy));
    return 0;
  }
  Method method_;
  ContinuousLine model_;
  SUNContext context_ = nullptr;
  N_Vector state_ = nullptr, tolerance_ = nullptr;
  void* memory_ = nullptr;
  SUNNonlinearSolver solver_ = nullptr;
};

/// The product's line and chamber on the same grid and inputs.
double run_line(std::vector<double>& chamber_Pa) {
  LineWithChamber<double> side;
  side.configure(line_parameters(), chamber_geometry(), AirParameters<double>{}, cells);
  side.reset(start_Pa, 293.0, ContinuousLine::distance_m(0.0));
  chamber_Pa.assign(1, start_Pa);
  chamber_Pa.reserve(periods + 1);
  const double start = now_ns();
  double before = port_Pa(0);
  for (int k = 0; k < periods; ++k) {
    const int n = side.begin_period(period_s);
    const double now = port_Pa(k + 1);
    for (int i = 0; i < n; ++i)
      side.step_prescribed(before + (i + 0.5) / n * (now - before),
                           ContinuousLine::distance_m((k + (i + 1.0) / n) * period_s));
    before = now;
    chamber_Pa.push_back(side.chamber().pressure());
  }
  return (now_ns() - start) * 1e-3 / periods;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest_Pa = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest_Pa = std::max(largest_Pa, std::fabs(a[i] - b[i]));
  return largest_Pa;
}

void line_against_sundials(benchmark::State& state) {
  std::vector<double> converged, by_line, by_runge_kutta, by_adams;
  Integrator(Method::adams, 1e-9).run(converged);
  Integrator runge_kutta(Method::explicit_runge_kutta, 1e-4), adams(Method::adams, 1e-4);
  double line_us = 1e9, runge_kutta_us = 1e9, adams_us = 1e9;
  for (int batch = 0; batch < 60; ++batch) {
    for (int i = 0; i < 5; ++i) line_us = std::min(line_us, run_line(by_line));
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
