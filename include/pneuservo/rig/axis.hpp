// Parameters of one pneumatic cylinder axis on any scalar: what plant, estimator and diagnosis share.
#pragma once
#include <pneuservo/elements/air.hpp>
#include <pneuservo/elements/effects.hpp>
#include <pneuservo/elements/parameters.hpp>

namespace pneuservo {

/// One parameter set of the physical axis; each lane of a packed scalar may carry another one.
template <class S> struct AxisParameters {
  AirParameters<S> air;
  SupplyParameters<S> supply;
  ValveParameters<S> valve;
  LineParameters<S> line_1, line_2;
  CylinderParameters<S> cylinder;
  SliderParameters<S> slider;
  AxisEffects<S> effects;

  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"air", "", 0, 0, "gas and surroundings", Presence::optional}, p.air...);
    v(Field{"supply", "", 0, 0, "pressure supply"}, p.supply...);
    v(Field{"valve", "", 0, 0, "five-port proportional valve"}, p.valve...);
    v(Field{"line_1", "", 0, 0, "pipeline from valve port 1 to chamber 1"}, p.line_1...);
    v(Field{"line_2", "", 0, 0, "pipeline from valve port 2 to chamber 2"}, p.line_2...);
    v(Field{"cylinder", "", 0, 0, "double-acting cylinder"}, p.cylinder...);
    v(Field{"slider", "", 0, 0, "moving mass"}, p.slider...);
    v(Field{"effects", "", 0, 0, "known physics beside the nominal model, by name", Presence::optional}, p.effects...);
  }
};

}  // namespace pneuservo
