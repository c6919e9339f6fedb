// One number of a hypothesis that a fit may move, in units of its prior's standard deviation.
#include "diagnosis/search/free_parameter.hpp"

namespace pneuservo {

FreeParameter free_number(const Rig& rig, const std::string& path) {
  FreeParameter out;
  out.path = path;
  out.number.emplace(rig, path);
  return out;
}

Hypothesis with_parameters(const Hypothesis& base, const std::vector<FreeParameter>& parameters,
                           const std::vector<double>& z) {
  Hypothesis hypothesis = base;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const FreeParameter& parameter = parameters[i];
    const double value = parameter.value(z[i]);
    if (parameter.start_factor >= 0)
      hypothesis.start_factors.at(static_cast<std::size_t>(parameter.start_factor)) = value;
    else parameter.number.value().set(hypothesis.rig, value);
  }
  return hypothesis;
}

}  // namespace pneuservo
