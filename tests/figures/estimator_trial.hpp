// An estimator beside the simulated axis: its parameters may differ from the plant's and its start may be wrong.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <pneuservo/control/pd_force.hpp>
#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/rig/rig.hpp>

#include "config/read_rig.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo::figures {

/// The nine lines, as their configs are named.
inline const std::array<std::string, 9> line_names{"2m-7.65mm",  "5m-7.65mm", "10m-7.65mm", "2m-6.10mm", "5m-6.10mm",
                                                   "10m-6.10mm", "2m-4.15mm", "5m-4.15mm",  "10m-4.15mm"};

inline Rig rig_of(const std::string& line, std::vector<std::string> sets = {}) {
  return read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-" + line + ".yaml", sets);
}

/// What differs between estimator and plant, and which pressures close the loop.
struct Trial {
  double diameter_factor = 1.0;  ///< estimator's over the plant's, both lines; stated as uncertainty
  double area_factor = 1.0;      ///< both piston areas; stated as uncertainty
  double valve_factor = 1.0;     ///< area per volt; stated as uncertainty
  std::optional<std::array<double, 2>> start_offset_Pa{};  ///< the estimator's chambers and lines start this far off
  PressureSource feedback = PressureSource::estimated;
};

struct TrialOutcome {
  std::vector<double> error_Pa, bound_Pa;  ///< both chambers, every tick from the second half on
  double largest_error_Pa = 0.0;           ///< in the second half
  double settled_s = 0.0;                  ///< from here on both chambers stay within 2 kPa

  double held_share() const {
    std::size_t held = 0;
    for (std::size_t i = 0; i < error_Pa.size(); ++i) held += error_Pa[i] <= bound_Pa[i] ? 1 : 0;
    return static_cast<double>(held) / static_cast<double>(error_Pa.size());
  }
  /// Median over the ticks of bound over error.
  double median_ratio() const {
    std::vector<double> ratio(error_Pa.size());
    for (std::size_t i = 0; i < ratio.size(); ++i) ratio[i] = bound_Pa[i] / std::max(error_Pa[i], 1e-3);
    const auto middle = ratio.begin() + static_cast<std::ptrdiff_t>(ratio.size() / 2);
    std::nth_element(ratio.begin(), middle, ratio.end());
    return *middle;
  }
  void add(const TrialOutcome& other) {
    error_Pa.insert(error_Pa.end(), other.error_Pa.begin(), other.error_Pa.end());
    bound_Pa.insert(bound_Pa.end(), other.bound_Pa.begin(), other.bound_Pa.end());
    largest_error_Pa = std::max(largest_error_Pa, other.largest_error_Pa);
    settled_s = std::max(settled_s, other.settled_s);
  }
};

inline EstimatorParameters trial_parameters(const Rig& rig, const Trial& trial) {
  EstimatorParameters p = estimator_parameters(rig);
  p.line_1.diameter_m *= trial.diameter_factor;
  p.line_2.diameter_m *= trial.diameter_factor;
  p.cylinder.area_1_m2 *= trial.area_factor;
  p.cylinder.area_2_m2 *= trial.area_factor;
  p.valve.area_per_volt_m2_per_V *= trial.valve_factor;
  p.uncertainty.relative_valve_area = std::fabs(trial.valve_factor - 1.0);
  p.uncertainty.relative_diameter = std::fabs(trial.diameter_factor - 1.0);
  p.uncertainty.relative_area = std::fabs(trial.area_factor - 1.0);
  return p;
}

/// The config's run with `rig`'s plant, sensors and controller.
inline TrialOutcome run_trial(const Rig& rig, const Trial& trial) {
  SimBackend backend(rig);
  backend.configure();
  backend.activate();
  PipelineEstimator estimator;
  estimator.configure(trial_parameters(rig, trial));
  PdForce controller(rig.controller.of<PdForce>(), rig.axis, rig.period_s);
  const Reference reference(rig.reference, {});
  const auto ticks = std::llround(rig.duration_s / rig.period_s);
  TrialOutcome outcome;
  double command_V = 0.0;
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const double t_s = static_cast<double>(tick) * rig.period_s;
    Measurement measured;
    backend.read(tick, measured);
    const Truth truth = backend.truth();
    const EstimatorInput in{measured.channel[Signal::p1_port].value, measured.channel[Signal::p2_port].value,
                            measured.channel[Signal::x].value, controller.state().v_mps, command_V};
    if (tick == 0 && trial.start_offset_Pa)
      estimator.start(in.p1_port_Pa + (*trial.start_offset_Pa)[0], in.p2_port_Pa + (*trial.start_offset_Pa)[1], in.x_m);
    const EstimatorOutput estimate = estimator.step(in);
    const std::array<double, 2> error{std::fabs(estimate.chamber_pressure_Pa[0] - truth.p1_chamber_Pa),
                                      std::fabs(estimate.chamber_pressure_Pa[1] - truth.p2_chamber_Pa)};
    const double larger = std::max(error[0], error[1]);
    if (!(larger <= 2000.0)) outcome.settled_s = t_s + rig.period_s;
    if (2 * tick > ticks) {
      outcome.largest_error_Pa = std::max(outcome.largest_error_Pa, larger);
      for (std::size_t i = 0; i < 2; ++i) {
        outcome.error_Pa.push_back(error[i]);
        outcome.bound_Pa.push_back(estimate.error_bound_Pa[static_cast<Eigen::Index>(i)]);
      }
    }
    const bool sensed = trial.feedback == PressureSource::chamber;
    const double p1 = sensed ? measured.channel[Signal::p1_chamber].value : estimate.chamber_pressure_Pa[0];
    const double p2 = sensed ? measured.channel[Signal::p2_chamber].value : estimate.chamber_pressure_Pa[1];
    command_V = controller.step(measured.channel[Signal::x].value, p1, p2, reference.at(t_s),
                                reference.at(t_s + controller.lead_s()));
    backend.write(tick, {command_V});
  }
  return outcome;
}

}  // namespace pneuservo::figures
