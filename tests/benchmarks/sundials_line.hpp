// One line with its chamber under one course of port pressures: by SUNDIALS on a grid left continuous in time, and by
// ours.
#pragma once
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <pneuservo/elements/line_with_chamber.hpp>

#include "bench_tools.hpp"
#include "continuous_line.hpp"

namespace pneuservo::bench {

inline constexpr int periods = 1000;
inline constexpr double period_s = 1e-3, start_Pa = 470e3;

/// Port pressure sample k: two sines, 30 kPa together, as in a working axis.
inline double port_Pa(int k) {
  const double t = k * period_s;
  return start_Pa + 20e3 * std::sin(6.283185307179586 * t) + 10e3 * std::sin(31.0 * t);
}
inline LineParameters<double> line_parameters() { return nominal_axis().line_1; }
inline ChamberGeometry<double> chamber_geometry() { return {1.257e-3, 2e-5, 50.0}; }

inline void check(int flag, const char* what) {
  if (flag < 0) throw std::runtime_error(std::string(what) + " failed with " + std::to_string(flag));
}

enum class Method { explicit_runge_kutta, adams };

/// Chamber pressure at every sample by an integrator of SUNDIALS. Like an estimator it gets a port sample each period
/// and owes the chamber pressure at its end, so it stops there; it keeps its step size and history.
class Integrator {
 public:
  Integrator(Method method, double relative_tolerance, int cells)
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
      check(CVodeSetMaxNumSteps(memory_, 1000000), "CVodeSetMaxNumSteps");
      solver_ = SUNNonlinSol_FixedPoint(state_, 0, context_);
      check(CVodeSetNonlinearSolver(memory_, solver_), "CVodeSetNonlinearSolver");
    } else {
      memory_ = ERKStepCreate(&Integrator::derivative, 0.0, state_, context_);
      check(ERKStepSVtolerances(memory_, relative_tolerance, tolerance_), "ERKStepSVtolerances");
      check(ERKStepSetUserData(memory_, this), "ERKStepSetUserData");
      check(ERKStepSetMaxNumSteps(memory_, 1000000), "ERKStepSetMaxNumSteps");
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

/// The product's line and chamber on the same grid and inputs; 0: as many sub-steps as it takes by itself. Returns the
/// time of a period [us].
inline double run_line(std::vector<double>& chamber_Pa, int cells, int substeps = 0) {
  LineWithChamber<double> side;
  side.configure(line_parameters(), chamber_geometry(), AirParameters<double>{}, cells);
  side.fix_substeps(substeps);
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

/// Of the samples from `first` on.
inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t first = 0) {
  double largest_Pa = 0.0;
  for (std::size_t i = first; i < a.size(); ++i) largest_Pa = std::max(largest_Pa, std::fabs(a[i] - b[i]));
  return largest_Pa;
}

}  // namespace pneuservo::bench
