// What a config leaves out of its own supervision.
#include "loop/safety_grade.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <fmt/format.h>

namespace pneuservo {
namespace {

using Level = FindingLevel;

/// Parts are proven at 1.5 times their largest working pressure and burst from 4 times on (ISO 4414, ISO 1402 hoses).
constexpr double proof_pressure_ratio = 1.5, burst_pressure_ratio = 4.0;
/// Energy grows with the square of speed: four times the reference's speed is sixteen times its energy.
constexpr double far_above = 4.0;
/// A share of air that is not explained: beyond the whole there is nothing to compare.
constexpr double whole = 1.0;

class SafetyGrades {
 public:
  SafetyGrades(const Rig& rig, const LoadPositions& load) : rig_(rig), half_m_(0.5 * rig.axis.cylinder.stroke_m) {
    if (!rig.is_pneumatic()) return;
    const Reference reference(rig.reference, load);
    const ReferenceExtremes way = reference.extremes(0, rig.duration_s), speed = reference.extremes(1, rig.duration_s);
    reach_m_ = std::max(std::fabs(way.minimum), std::fabs(way.maximum));
    peak_mps_ = std::max(std::fabs(speed.minimum), std::fabs(speed.maximum));
  }

  void grade_motion_limits() {
    const LimitParameters& limits = rig_.limits;
    const double stroke_m = 2.0 * half_m_, force_N = largest_force_N(), ballistic_mps = ballistic_speed_mps(rig_);
    if (limits.deviation_m)
      off_if(*limits.deviation_m == 0.0 || *limits.deviation_m >= stroke_m, "deviation_m", *limits.deviation_m, "m",
             "no distance from the predicted motion ends the run",
             "leave it out: it is derived from the config's own simulation");
    if (limits.speed_deviation_mps)
      off_if(*limits.speed_deviation_mps == 0.0 || *limits.speed_deviation_mps >= ballistic_mps, "speed_deviation_mps",
             *limits.speed_deviation_mps, "m/s", "an obstacle is found late, by the way alone",
             "leave it out: it is derived from the config's own simulation");
    if (limits.stall_force_N)
      off_if(*limits.stall_force_N == 0.0 || *limits.stall_force_N >= force_N, "stall_force_N", *limits.stall_force_N,
             "N", fmt::format("an axis that pushes against an obstacle goes on pushing, with up to {:.0f} N", force_N),
             "leave it out: it is derived from the config's own simulation");
    if (limits.end_stop_contact == EndStopContact::allowed)
      add(Level::unsafe, "limits.end_stop_contact", "allowed: running onto an end stop ends nothing",
          "say fault, unless the machine is built to run onto its stops");
    if (limits.speed_mps) {
      off_if(*limits.speed_mps >= ballistic_mps, "speed_mps", *limits.speed_mps, "m/s",
             fmt::format("the air cannot make this slider faster than {:.3g} m/s", ballistic_mps),
             "leave it out: it is derived from the reference");
      if (*limits.speed_mps < ballistic_mps && peak_mps_ > 0.0 && *limits.speed_mps > far_above * peak_mps_)
        add(Level::acceptable, "limits.speed_mps",
            fmt::format("{:g} m/s is {:.3g} times the reference's {:.3g} m/s", *limits.speed_mps,
                        *limits.speed_mps / peak_mps_, peak_mps_),
            fmt::format("state {:.2g}, twice what the reference needs, or leave it out", 2.0 * peak_mps_));
    }
    off_if(limits.position_margin_m >= half_m_, "position_margin_m", limits.position_margin_m, "m",
           "a position far outside the cylinder counts as one", "state some millimetres");
  }

  void grade_times() {
    const LimitParameters& limits = rig_.limits;
    // A speed limit that cannot act is told by itself.
    const double ballistic_mps = ballistic_speed_mps(rig_), usual_mps = std::min(2.0 * peak_mps_, ballistic_mps);
    const double stated_mps = limits.speed_mps.value_or(usual_mps);
    const double speed_mps = stated_mps < ballistic_mps ? stated_mps : usual_mps;
    travel("lateness_s", limits.lateness_s, limits.lateness_s, speed_mps, "a late loop");
    travel("age_periods", limits.age_periods, limits.age_periods * rig_.period_s, speed_mps, "an old position");
    // In a run shorter than the usual rest nothing can rest for long.
    const double longest_s = std::max(rig_.duration_s, LimitParameters{}.checks_rest_s);
    off_if(limits.checks_rest_s == 0.0 || limits.checks_rest_s > longest_s, "checks_rest_s", limits.checks_rest_s, "s",
           "cross-checks may rest for the whole run", "state 1 s or so");
    off_if(limits.bad_share >= whole, "bad_share", limits.bad_share, "", "a channel may be bad for ever",
           "state 0.1 or so");
    off_if(limits.missed_share >= whole, "missed_share", limits.missed_share, "",
           "the loop may miss its slots for ever", "state 0.1 or so");
  }

  void grade_air_limits() {
    const LimitParameters& limits = rig_.limits;
    const double supply_Pa = rig_.axis.supply.pressure_Pa, gauge_Pa = supply_Pa - rig_.axis.air.atmosphere_Pa;
    off_if(limits.flow_mismatch_share == 0.0 || limits.flow_mismatch_share >= whole, "flow_mismatch_share",
           limits.flow_mismatch_share, "", "a stuck valve, a leak and a wrong sensor are not looked for",
           "state 0.15 or so");
    off_if(limits.chamber_mismatch_Pa == 0.0 || limits.chamber_mismatch_Pa >= gauge_Pa, "chamber_mismatch_Pa",
           limits.chamber_mismatch_Pa, "Pa", "sensors of the chambers are not compared with the estimate",
           "state 15000 Pa or so");
    off_if(limits.supply_share == 0.0, "supply_share", limits.supply_share, "", "a supply that is lost ends nothing",
           "state 0.5 or so");
    if (!limits.pressure_Pa) return;
    const double ratio = *limits.pressure_Pa / supply_Pa;
    off_if(ratio >= burst_pressure_ratio, "pressure_Pa", *limits.pressure_Pa, "Pa",
           fmt::format("{:.3g} times the supply, where hoses may burst", ratio), "leave it out: 1.4 times the supply");
    if (ratio > proof_pressure_ratio && ratio < burst_pressure_ratio)
      add(Level::acceptable, "limits.pressure_Pa",
          fmt::format("{:g} Pa is {:.3g} times the supply, above what its parts are proven at", *limits.pressure_Pa,
                      ratio),
          "leave it out: 1.4 times the supply");
  }

  void grade_devices() {
    if (!rig_.hal || !rig_.hal->has_devices()) return;
    const HalParameters& hal = *rig_.hal;
    const GpioParameters lines = hal.gpio.value_or(GpioParameters{});
    lacks(!lines.emergency_stop, Level::unsafe, "emergency stop", "hal.gpio.emergency_stop",
          "nobody's hand ends the motion through this program");
    lacks(!lines.enable, Level::unsafe, "enable output", "hal.gpio.enable",
          "nothing beside the valve's command takes the air away on a fault");
    lacks(!has_readback(), Level::unsafe, "readback of the valve's command", "a readback of hal.channels.u",
          "a command that does not arrive is not seen");
    const bool has_slider = rig_.is_pneumatic();
    lacks(has_slider && (!lines.limit_low || !lines.limit_high), Level::acceptable, "limit switch at each end",
          "hal.gpio.limit_low and limit_high", "a wrong zero of the encoder is not seen before the end stop");
    lacks(!lines.valve_power, Level::acceptable, "signal of the valve's supply", "hal.gpio.valve_power",
          "a valve without supply is seen by its missing air alone");
    lacks(hal.channels.is_absent(Signal::p_supply), Level::acceptable, "supply sensor", "hal.channels.p_supply",
          "a lost supply is seen by its missing air alone");
    lacks(has_slider && std::ranges::any_of(chamber_signals, [&](Signal one) { return hal.channels.is_absent(one); }),
          Level::acceptable, "sensor in each chamber", "hal.channels.p1_chamber and p2_chamber",
          "the estimate has nothing to be compared with");
  }

  void grade_areas() {
    const auto& cylinder = rig_.axis.cylinder;
    if (!(cylinder.area_2_m2 > cylinder.area_1_m2)) return;
    add(Level::acceptable, "cylinder areas",
        fmt::format("area_2_m2 is {:.3g} times area_1_m2: the rod would have to be on the side of chamber 1",
                    cylinder.area_2_m2 / cylinder.area_1_m2),
        "check both areas, bore less rod, and which side the rod is on");
  }

  std::vector<Finding> take() { return std::move(findings_); }

 private:
  void add(Level level, std::string topic, std::string what, std::string remedy) {
    findings_.push_back({level, std::move(topic), std::move(what), std::move(remedy)});
  }
  void off_if(bool is_off, const char* key, double value, const char* unit, const std::string& means,
              const char* remedy) {
    if (!is_off) return;
    add(Level::unsafe, std::string("limits.") + key,
        fmt::format("switched off by {:g}{}{}: {}", value, *unit != '\0' ? " " : "", unit, means), remedy);
  }
  void lacks(bool does, Level level, const char* what, const char* key, const char* means) {
    if (does) add(level, what, fmt::format("there is none: {}", means), fmt::format("wire one and state {}", key));
  }
  /// How far the axis goes before the limit of a time acts.
  void travel(const char* key, double value, double time_s, double speed_mps, const char* what) {
    const double way_m = speed_mps * time_s, room_m = half_m_ - reach_m_;
    const std::string topic = std::string("limits.") + key;
    const std::string said =
        fmt::format("{:g}: {} lets the axis go {:.3g} mm at {:.3g} m/s", value, what, 1e3 * way_m, speed_mps);
    const std::string remedy =
        fmt::format("state less than {:.2g}", value * std::max(room_m, 1e-3) / std::max(way_m, 1e-9));
    if (way_m >= 2.0 * half_m_) add(Level::unsafe, topic, said + ", which is the whole stroke", remedy);
    else if (way_m > room_m && room_m > 0.0)
      add(Level::acceptable, topic, fmt::format("{}; the end stop is {:.3g} mm from the reference", said, 1e3 * room_m),
          remedy);
    else add(Level::good, topic, said, "");
  }
  double largest_force_N() const {
    const auto& cylinder = rig_.axis.cylinder;
    return (rig_.axis.supply.pressure_Pa - rig_.axis.air.atmosphere_Pa) *
           std::max(cylinder.area_1_m2, cylinder.area_2_m2);
  }
  bool has_readback() const {
    const HalChannels& channels = rig_.hal->channels;
    // Of the sources that an output may have, those that know a readback.
    const auto of_source = [](const auto& source) {
      if constexpr (requires { source->readback.has_value(); }) return source && source->readback.has_value();
      else return false;
    };
    const auto reads_back = [&](const ChannelParameters<VoltageKeys>& u) {
      return of_source(u.comedi) || of_source(u.iio) || of_source(u.can);
    };
    return rig_.has_two_outputs() ? reads_back(channels.u1) && reads_back(channels.u2) : reads_back(channels.u);
  }

  const Rig& rig_;
  double half_m_, reach_m_ = 0.0, peak_mps_ = 0.0;
  std::vector<Finding> findings_;
};

}  // namespace

double ballistic_speed_mps(const Rig& rig) {
  const auto& cylinder = rig.axis.cylinder;
  const double force_N =
      (rig.axis.supply.pressure_Pa - rig.axis.air.atmosphere_Pa) * std::max(cylinder.area_1_m2, cylinder.area_2_m2);
  return std::sqrt(2.0 * std::max(force_N, 0.0) * cylinder.stroke_m / rig.axis.slider.mass_kg);
}

std::vector<Finding> grade_safety(const Rig& rig, const LoadPositions& load) {
  if (rig.valves() == 0) return {};
  SafetyGrades grades(rig, load);
  if (rig.is_pneumatic()) {
    grades.grade_motion_limits();
    grades.grade_times();
  }
  grades.grade_air_limits();
  grades.grade_devices();
  if (rig.is_pneumatic()) grades.grade_areas();
  return grades.take();
}

}  // namespace pneuservo
