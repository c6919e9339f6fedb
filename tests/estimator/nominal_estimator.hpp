// The estimator of an axis whose parameters are all known, that tests and benchmarks start from.
#pragma once
#include <pneuservo/estimator/pipeline_estimator.hpp>

#include "rig/nominal_axis.hpp"

namespace pneuservo::test {

inline EstimatorParameters nominal_estimator(const AxisParameters<double>& axis = nominal_axis()) {
  EstimatorParameters p;
  p.air = axis.air;
  p.supply_pressure_Pa = axis.supply.pressure_Pa;
  p.line_1 = axis.line_1;
  p.line_2 = axis.line_2;
  p.cylinder = axis.cylinder;
  return p;
}

}  // namespace pneuservo::test
