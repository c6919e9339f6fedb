// The gas of a cylinder's two sides.
#include "diagnosis/residuals/gas_sides.hpp"

#include <cmath>

namespace pneuservo {

namespace {

bool exchange_gas(const AxisEffects<double>& effects) {
  return effects.piston_leak.area_m2 > 0 || effects.piston_leak_zone.area_m2 > 0 || effects.supply_droop.area_m2 > 0;
}

}  // namespace

SidedCourse::SidedCourse(GasCourse whole) {
  std::array<GasCourse, 2> halves;
  for (const Signal signal : gas_signals) halves[side_of(signal)][signal] = std::move(whole[signal]);
  for (std::size_t side = 0; side < 2; ++side)
    halves_[side] = std::make_shared<const GasCourse>(std::move(halves[side]));
}

bool is_finite(const GasCourse& gas, std::size_t side) {
  return std::isfinite(gas[port_signals[side]].back()) && std::isfinite(gas[chamber_signals[side]].back());
}

GasNumbers gas_numbers(const ImposedRun& run, const ImposedInputs& inputs, bool is_flow_wanted) {
  AxisParameters<double> axis = run.rig->axis;
  const bool are_apart = !is_flow_wanted && !exchange_gas(axis.effects);
  axis.slider = {};
  axis.effects.motion = {};
  GasNumbers out;
  const auto numbers_of = [&](std::size_t side) -> std::vector<double>& {
    return side == 0 || !are_apart ? out.of_both : out.of_side[side - 1];
  };
  const auto collect = [&](std::size_t side, const auto& value) {
    numbers_of(side).push_back(static_cast<double>(value));
  };
  const EachNumber<decltype(collect)> collect_all{collect};
  const PerSignal<SensorEffects<double>>& sensors = run.rig->sensor_effects;
  AxisParameters<double>::visit(collect_all, axis);
  SensorEffects<double>::visit(collect_all, sensors[Signal::x]);
  if (!inputs.supply_Pa.empty()) SensorEffects<double>::visit(collect_all, sensors[Signal::p_supply]);
  for (std::size_t side = 1; side <= 2; ++side) {
    SensorEffects<double>::visit(EachNumber<decltype(collect)>{collect, side}, sensors[inputs.start_sensor[side - 1]]);
    numbers_of(side).push_back(run.start_factor[side - 1]);
  }
  return out;
}

ImposedRun side_by_side(const ImposedRun& first, const ImposedRun& second, const ImposedInputs& inputs, Rig& rig) {
  rig = *first.rig;
  const auto take = [](std::size_t side, auto& to, const auto& from) {
    if (side == 2) to = from;
  };
  AxisParameters<double>::visit(EachNumber<decltype(take)>{take}, rig.axis, second.rig->axis);
  const Signal sensor = inputs.start_sensor[1];
  rig.sensor_effects[sensor] = second.rig->sensor_effects[sensor];
  return {&rig, {first.start_factor[0], second.start_factor[1]}};
}

}  // namespace pneuservo
