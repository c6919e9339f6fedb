// The limits of a rig whose breach ends its motion, or its run, in the safe output.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// What the slider may do at an end stop.
enum class EndStopContact { fault, allowed };
inline constexpr std::array<std::string_view, 2> end_stop_contact_names{"fault", "allowed"};

/// Limits whose breach ends the motion in the safe output. What is not stated is derived from the config's own
/// simulation over tolerances, payload and friction (loop/motion_limits.hpp); `pneuservo check` prints it.
struct LimitParameters {
  std::optional<double> speed_mps;
  std::optional<double> deviation_m;
  std::optional<double> speed_deviation_mps;
  std::optional<double> stall_force_N;
  EndStopContact end_stop_contact = EndStopContact::fault;
  std::optional<double> payload_max_kg;
  std::optional<double> dry_friction_max_N;
  double bad_share = 0.1;
  double missed_share = 0.1;
  double checks_rest_s = 1.0;
  double position_margin_m = 0.005;
  std::optional<double> pressure_Pa;
  double supply_share = 0.5;
  std::uint32_t missing_ticks = 0;
  double age_periods = 2.5;
  double lateness_s = 0.1;
  double flow_mismatch_share = 0.15;
  double chamber_mismatch_Pa = 15e3;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    visit_motion(v, p...);
    visit_inputs(v, p...);
  }
  /// Those of a pressure rig, which has no motion.
  template <class V, class... P> static void visit_of_pressure(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    visit_shares(v, p...);
    v(Field{"pressure_Pa", "Pa", 1e4, 1e8,
            "estimated or measured pressure in the volume above it is a fault; default: 1.4 times the supply",
            optional},
      p.pressure_Pa...);
    visit_samples(v, p...);
  }
  /// Limits of the motion, and what they are derived from.
  template <class V, class... P> static void visit_motion(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"speed_mps", "m/s", 1e-3, 100, "measured speed above it is a fault; default: derived", optional},
      p.speed_mps...);
    v(Field{"deviation_m", "m", 0, 10,
            "measured position further than this from the predicted motion is a fault; default: derived; 0: not "
            "checked",
            optional},
      p.deviation_m...);
    v(Field{"speed_deviation_mps", "m/s", 0, 100,
            "measured speed further than this from the predicted one is a fault; default: derived; 0: not checked",
            optional},
      p.speed_deviation_mps...);
    v(Field{"stall_force_N", "N", 0, 1e9,
            "force of the air on a slider that stands above it is a fault; default: derived; 0: not checked", optional},
      p.stall_force_N...);
    v(Field{"end_stop_contact", "", 0, 0, "whether running onto an end stop is a fault", optional,
            end_stop_contact_names},
      p.end_stop_contact...);
    v(Field{"payload_max_kg", "kg", 0, 1e4,
            "largest payload that the derived limits allow for; default: slider.payload_kg", optional},
      p.payload_max_kg...);
    v(Field{"dry_friction_max_N", "N", 0, 1e6,
            "largest dry friction that the derived limits allow for; default: 8 kPa on the larger piston area, "
            "servo_table: 0",
            optional},
      p.dry_friction_max_N...);
  }
  /// Limits of samples, ticks and cross-checks.
  template <class V, class... P> static void visit_inputs(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    visit_shares(v, p...);
    v(Field{"checks_rest_s", "s", 0, 3600,
            "cross-checks that rest longer than this while the axis is active are a fault; 0: not checked", optional},
      p.checks_rest_s...);
    v(Field{"position_margin_m", "m", 0, 1, "measured position further than this beyond an end stop is a fault",
            optional},
      p.position_margin_m...);
    v(Field{"pressure_Pa", "Pa", 1e4, 1e8, "measured pressure above it is a fault; default: 1.4 times the supply",
            optional},
      p.pressure_Pa...);
    visit_samples(v, p...);
  }
  template <class V, class... P> static void visit_shares(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"bad_share", "-", 0, 1,
            "bad samples of a channel above this share of about 0.3 s are a fault; 1: not checked", optional},
      p.bad_share...);
    v(Field{"missed_share", "-", 0, 1, "missed slots above this share of about 0.3 s are a fault; 1: not checked",
            optional},
      p.missed_share...);
  }
  /// Of samples, lateness and the checks of the air.
  template <class V, class... P> static void visit_samples(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"supply_share", "-", 0, 1, "measured supply below this share of supply.pressure_Pa is a fault", optional},
      p.supply_share...);
    v(Field{"missing_ticks", "-", 0, 2, "missing samples in a row that are bridged; one more is a fault", optional},
      p.missing_ticks...);
    v(Field{"age_periods", "-", 0.5, 1000, "an older sample counts as missing", optional}, p.age_periods...);
    v(Field{"lateness_s", "s", 0, 3600, "a tick that comes later is a fault, if it skips a slot of the grid", optional},
      p.lateness_s...);
    v(Field{"flow_mismatch_share", "-", 0, 10,
            "air of the last 0.3 s in a side that valve and position do not explain, as a share; 0: not checked",
            optional},
      p.flow_mismatch_share...);
    v(Field{"chamber_mismatch_Pa", "Pa", 0, 1e7,
            "measured less estimated chamber pressure beyond the estimate's bound; 0: not checked", optional},
      p.chamber_mismatch_Pa...);
  }
};

}  // namespace pneuservo
