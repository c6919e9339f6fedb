// What the model of a rig does under a probe's command, and how a recorded answer compares with it.
#pragma once
#include <vector>

#include <pneuservo/rig/rig.hpp>

#include "loop/commission_probe.hpp"

namespace pneuservo {

/// Changes from rest, tick by tick: position, force of the air by the port pressures and by the chambers.
struct ModelAnswer {
  std::vector<double> position_m, port_force_N, chamber_force_N;
};

/// The rig's own plant from the probe's state of rest, under the same ramp for so many ticks. Whatever load holds the
/// slider at rest in the probe (gravity, a sensor's zero) holds it in the model.
ModelAnswer model_answer(const Rig& rig, const Probe& probe, std::size_t ticks);

/// Least squares of measured(t) = scale * model(t - shift).
struct AnswerFit {
  double scale = 0.0;
  double shift_s = 0.0;       ///< later than the model
  double measured_model = 0.0, model_square = 0.0;  ///< sums at that shift, to join several fits
};

/// The shift of least error from -lead_s to the end of the record; `model` holds lead_s more than `measured`.
AnswerFit fit_answer(const std::vector<double>& measured, const std::vector<double>& model, double period_s,
                     double lead_s);
/// The same at a given shift.
AnswerFit fit_at(const std::vector<double>& measured, const std::vector<double>& model, double period_s,
                 double shift_s);

}  // namespace pneuservo
