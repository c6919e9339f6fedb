// One number of a hypothesis that a fit may move, in units of its prior's standard deviation.
#include "diagnosis/search/free_parameter.hpp"

#include "config/rig_parameters.hpp"

namespace pneuservo {

Hypothesis with_parameters(const Hypothesis& base, const std::vector<FreeParameter>& parameters,
                           const std::vector<double>& z) {
  Hypothesis hypothesis = base;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const FreeParameter& parameter = parameters[i];
    const double value = parameter.value(z[i]);
    if (parameter.signed_overlap) hypothesis.rig.axis.effects.valve.valve_dead_band.width_V = value;
    else if (parameter.start_factor < 0) set_parameter(hypothesis.rig, parameter.path, value);
    else hypothesis.start_factors.at(static_cast<std::size_t>(parameter.start_factor)) = value;
  }
  return hypothesis;
}

}  // namespace pneuservo
