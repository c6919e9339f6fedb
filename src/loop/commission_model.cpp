// What the model of a rig does under a probe's command.
#include "loop/commission_model.hpp"

#include <algorithm>
#include <cmath>

#include <pneuservo/rig/plant.hpp>

#include "loop/air_force.hpp"

namespace pneuservo {
namespace {

constexpr int coarse = 8, rounds = 3, fine = 4;  // of the search: to a 400th of the range

}  // namespace

ModelAnswer model_answer(const Rig& rig, const Probe& probe, double dead_V) {
  AxisParameters<double> axis = rig.axis;
  const auto start_Pa = probe.before.port_Pa();
  axis.effects.motion.constant_force.force_N = air_force_N(rig, start_Pa);
  const double half_m = 0.5 * axis.cylinder.stroke_m;
  const bool zero_unknown = rig.sensors.position.incremental && !rig.zeros.contains("x");
  const double start_m = zero_unknown ? 0.0 : std::clamp(probe.before.mean[Signal::x], -half_m, half_m);
  AxisPlant<double> plant;
  plant.configure(axis, rig.period_s, rig.simulation.cells_per_m, valve_arrangement(rig));
  plant.reset({start_m, start_Pa[0], start_Pa[1]});
  const double closed_V = rig.safe_output.action == SafeAction::hold ? rig.safe_output.command_V : 0.0;
  const double rest_N = air_force_N(rig, start_Pa);
  ModelAnswer out;
  bool opened = false;
  for (const double volts : probe.volts) {
    const auto port = plant.port_pressure();
    out.position_m.push_back(plant.position() - start_m);
    out.port_force_N.push_back(air_force_N(rig, {low(port), high(port)}) - rest_N);
    out.chamber_force_N.push_back(plant.driving_force() - rest_N);
    const double acting_V = probe.direction * std::max(volts - dead_V, 0.0);
    opened = opened || acting_V != 0.0;
    if (opened) plant.step(closed_V + acting_V, closed_V - acting_V);
  }
  return out;
}

AnswerFit fit_answer(const std::vector<double>& measured, const std::vector<double>& model) {
  AnswerFit out;
  double measured_square = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i)
    out.measured_model += measured[i] * model[i], out.model_square += model[i] * model[i],
        measured_square += measured[i] * measured[i];
  out.scale = out.model_square > 0.0 ? out.measured_model / out.model_square : 0.0;
  out.error_square = measured_square - out.scale * out.measured_model;
  return out;
}

double find_dead_V(const Rig& rig, const Probe& probe, const std::vector<double>& measured,
                   std::vector<double> ModelAnswer::* of_model) {
  double best_V = 0.0, least = -1.0, low_V = 0.0, high_V = 0.95 * probe.end_V;
  int pieces = coarse;
  for (int round = 0; round < rounds; ++round) {
    const double step_V = (high_V - low_V) / pieces;
    for (int i = 0; i <= pieces; ++i) {
      const double dead_V = low_V + i * step_V;
      const double error = fit_answer(measured, model_answer(rig, probe, dead_V).*of_model).error_square;
      if (least < 0.0 || error < least) least = error, best_V = dead_V;
    }
    low_V = std::max(best_V - step_V, 0.0), high_V = std::min(best_V + step_V, 0.95 * probe.end_V);
    pieces = 2 * fine;
  }
  return best_V;
}

}  // namespace pneuservo
