// The loop's calls handed to the law in use.
#include <pneuservo/control/axis_controller.hpp>

namespace pneuservo {

void AxisController::configure(const ControllerParameters& parameters, const AxisParameters<double>& axis,
                               double period_s, const Reference& reference, double duration_s) {
  kind_ = parameters.kind;
  if (kind_ == ControllerKind::pd_force) {
    source_ = parameters.pd_force.pressure_source;
    pd_force_.configure(parameters.pd_force, axis, period_s);
    return;
  }
  source_ = PressureSource::valve;
  ppd2_.configure(parameters.ppd2, axis, period_s, reference, duration_s);
}

void AxisController::reset(const std::array<double, 2>& previous_V) noexcept {
  if (kind_ == ControllerKind::pd_force) pd_force_.reset(previous_V[0]);
  else ppd2_.reset(previous_V);
}

ControlOutput AxisController::step(const ControlInput& in) noexcept {
  if (kind_ == ControllerKind::pd_force) {
    const double u = pd_force_.step(in.x_m, in.pressure_Pa[0], in.pressure_Pa[1], in.now, in.ahead);
    const PdForceState& s = pd_force_.state();
    return {{u, 0.0}, s.v_mps, s.limit != limit_none, s.fault == controller_healthy};
  }
  const std::array<double, 2>& u = ppd2_.step({in.x_m, in.port_Pa, in.now, in.ahead, in.tick});
  const Ppd2State& s = ppd2_.state();
  return {u, s.speed_mps, s.limit[0] != limit_none || s.limit[1] != limit_none, s.finite};
}

void AxisController::skip(std::int64_t periods) noexcept {
  if (kind_ == ControllerKind::pd_force) pd_force_.skip(periods);
  else ppd2_.skip(periods);
}

double AxisController::lead_s() const noexcept {
  return kind_ == ControllerKind::pd_force ? pd_force_.lead_s() : ppd2_.lead_s();
}

double AxisController::rest_s(bool moved, const std::array<double, 2>& port_Pa) const noexcept {
  return kind_ == ControllerKind::pd_force ? 0.0 : ppd2_.rest_s(moved, port_Pa);
}

}  // namespace pneuservo
