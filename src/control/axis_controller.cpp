// The law of a config, configured.
#include <utility>

#include <pneuservo/control/axis_controller.hpp>

namespace pneuservo {

void AxisController::configure(const ControllerParameters& parameters, const AxisParameters<double>& axis,
                               double period_s, const Reference& reference, double duration_s,
                               std::shared_ptr<const PassTable> pass, const ElasticVolumeParameters<double>* volume) {
  source_ = parameters.pressures().value_or(PressureSource::valve);
  with_law(parameters.kind, [&]<class L>(LawTag<L>) {
    law_.emplace<L>().configure(parameters.of<L>(),
                                LawSetup{axis, period_s, reference, duration_s, std::move(pass), volume});
  });
}

}  // namespace pneuservo
