// What commands are about: the place of an axis or the pressure of a pressure rig, with the keys that say so.
#pragma once
#include <string_view>

#include <pneuservo/core/field.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Keys with their units in requests, answers and status, and the shown unit.
struct CommandedQuantity {
  Field target, way, rate;  ///< of requests: of move_to and follow, of move_by, of moves and jog
  std::string_view answer_target;
  std::string_view measured, set_point, set_point_rate;  ///< of status
  std::string_view rate_option, shown_name, shown_unit;  ///< of `pneuservo command`
  double shown = 1.0;                                    ///< in the shown unit over SI
};

inline constexpr CommandedQuantity commanded_position{
    .target = {"position_m", "m", -10, 10, ""},
    .way = {"way_m", "m", 0, 10, ""},
    .rate = {"speed_mps", "m/s", 0, 100, ""},
    .answer_target = "target_m",
    .measured = "x_m",
    .set_point = "x_ref_m",
    .set_point_rate = "v_ref_mps",
    .rate_option = "--speed",
    .shown_name = "x",
    .shown_unit = "mm",
    .shown = 1e3,
};
inline constexpr CommandedQuantity commanded_pressure{
    .target = {"pressure_Pa", "Pa", 1e4, 2e6, ""},
    .way = {"change_Pa", "Pa", 0, 2e6, ""},
    .rate = {"rate_Pa_per_s", "Pa/s", 0, 1e9, ""},
    .answer_target = "target_Pa",
    .measured = "p_Pa",
    .set_point = "p_ref_Pa",
    .set_point_rate = "p_ref_Pa_per_s",
    .rate_option = "--rate",
    .shown_name = "p",
    .shown_unit = "kPa",
    .shown = 1e-3,
};

/// What the protocol knows of a rig that is served.
struct CommandedRig {
  explicit CommandedRig(const Rig& rig)
      : quantity(rig.controls_pressure() ? commanded_pressure : commanded_position),
        limits(rig.controls_pressure() ? live_limits(rig.pressure_reference) : live_limits(rig.reference)),
        period_s(rig.period_s), atmosphere_Pa(rig.axis.air.atmosphere_Pa) {
    for (const Signal signal : channel_signals) has_sensor[signal] = rig.has_sensor(signal);
  }
  bool is_pressure() const noexcept { return &quantity == &commanded_pressure; }

  const CommandedQuantity& quantity;
  LiveLimits limits;
  double period_s, atmosphere_Pa;
  PerSignal<bool> has_sensor;
};

}  // namespace pneuservo
