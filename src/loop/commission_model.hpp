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

/// The rig's own plant from the probe's state of rest under the probe's commands, of which the valve takes `dead_V` for
/// nothing. Whatever load holds the slider at rest in the probe (gravity, a sensor's zero) holds it in the model.
ModelAnswer model_answer(const Rig& rig, const Probe& probe, double dead_V);

/// Least squares of measured = scale * model, and the sums that join several fits.
struct AnswerFit {
  double scale = 0.0, measured_model = 0.0, model_square = 0.0;
  double error_square = 0.0;  ///< that is left
};
AnswerFit fit_answer(const std::vector<double>& measured, const std::vector<double>& model);

/// The dead part of the probe's command with which `measured` (position, or force by the ports) is explained best [V].
double find_dead_V(const Rig& rig, const Probe& probe, const std::vector<double>& measured,
                   std::vector<double> ModelAnswer::* of_model);

}  // namespace pneuservo
