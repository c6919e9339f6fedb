// What the model of a rig does under a probe's command.
#include "loop/commission_model.hpp"

#include <algorithm>
#include <cmath>

#include <pneuservo/rig/plant.hpp>

#include "loop/air_force.hpp"

namespace pneuservo {
namespace {

/// A later shift leaves too little of an answer in the record to tell scale from shift.
constexpr double least_overlap_s = 0.15;

struct Sums {
  double measured_model = 0.0, model_square = 0.0, measured_square = 0.0;
};

Sums sums_at(const std::vector<double>& measured, const std::vector<double>& model, std::int64_t shift) {
  Sums out;
  const auto n = static_cast<std::int64_t>(measured.size()), have = static_cast<std::int64_t>(model.size());
  for (std::int64_t i = 0; i < n; ++i) {
    const std::int64_t at = i - shift;
    const double y = measured[static_cast<std::size_t>(i)];
    const double m = at < 0 || at >= have ? 0.0 : model[static_cast<std::size_t>(at)];
    out.measured_model += y * m, out.model_square += m * m, out.measured_square += y * y;
  }
  return out;
}

AnswerFit fit_of(const Sums& sums, double shift_s) {
  const double scale = sums.model_square > 0.0 ? sums.measured_model / sums.model_square : 0.0;
  return {scale, shift_s, sums.measured_model, sums.model_square};
}

}  // namespace

ModelAnswer model_answer(const Rig& rig, const Probe& probe, std::size_t ticks) {
  AxisParameters<double> axis = rig.axis;
  const auto start_Pa = probe.before.port_Pa();
  axis.effects.motion.constant_force.force_N = air_force_N(rig, start_Pa);
  const double half_m = 0.5 * axis.cylinder.stroke_m;
  const bool zero_unknown = rig.sensors.position.incremental && !rig.zeros.contains("x");
  const double start_m = zero_unknown ? 0.0 : std::clamp(probe.before.mean[0], -half_m, half_m);
  AxisPlant<double> plant;
  plant.configure(axis, rig.period_s, rig.simulation.cells_per_m, valve_arrangement(rig));
  plant.reset({start_m, start_Pa[0], start_Pa[1]});
  const double closed_V = rig.safe_output.action == SafeAction::hold ? rig.safe_output.command_V : 0.0;
  const double rest_N = air_force_N(rig, start_Pa);
  ModelAnswer out;
  for (std::size_t i = 0; i < ticks; ++i) {
    const auto port = plant.port_pressure();
    out.position_m.push_back(plant.position() - start_m);
    out.port_force_N.push_back(air_force_N(rig, {low(port), high(port)}) - rest_N);
    out.chamber_force_N.push_back(plant.driving_force() - rest_N);
    const double volts = probe.direction * probe.ramp_V_per_s * rig.period_s * static_cast<double>(i);
    plant.step(closed_V + volts, closed_V - volts);
  }
  return out;
}

AnswerFit fit_at(const std::vector<double>& measured, const std::vector<double>& model, double period_s,
                 double shift_s) {
  return fit_of(sums_at(measured, model, std::llround(shift_s / period_s)), shift_s);
}

AnswerFit fit_answer(const std::vector<double>& measured, const std::vector<double>& model, double period_s,
                     double lead_s) {
  const std::int64_t n = static_cast<std::int64_t>(measured.size()), lead = std::llround(lead_s / period_s);
  const std::int64_t last = std::max<std::int64_t>(n - std::llround(least_overlap_s / period_s), 1);
  AnswerFit best;
  double least = -1.0;
  for (std::int64_t shift = -lead; shift < last; shift += std::max<std::int64_t>(1, n / 300)) {
    const Sums sums = sums_at(measured, model, shift);
    const double gain = sums.model_square > 0.0 ? sums.measured_model * sums.measured_model / sums.model_square : 0.0;
    if (gain > least) least = gain, best = fit_of(sums, static_cast<double>(shift) * period_s);
  }
  return best;
}

}  // namespace pneuservo
