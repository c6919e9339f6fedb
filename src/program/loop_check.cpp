// What the loop of a config is worth before it moves anything.
#include "program/loop_check.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <pneuservo/loop/axis_loop.hpp>

#include "config/input_error.hpp"
#include "design/axis_design.hpp"
#include "design/sampled_laws.hpp"
#include "improve/simulated_run.hpp"
#include "loop/motion_limits.hpp"
#include "loop/safety_grade.hpp"
#include "loop/told_payload.hpp"
#include "pass/command_pass.hpp"
#include "program/pressure_check.hpp"
#include "program/rig_options.hpp"
#include "record/import.hpp"
#include "report/motion_verdict.hpp"

namespace pneuservo {
namespace {

using Level = FindingLevel;
constexpr double near_end_share = 0.8;     // of half the stroke: beyond lies what no reference should use
constexpr double rest_s = 4.0;             // judged over its second half: ten periods of 5 Hz
constexpr double longest_reference_s = 20.0;  // judged of it
constexpr double nudge_m = 4e-4;           // below the tolerance of the approach: the loop starts with a step
constexpr const char* gain_remedy =
    "lower the gains, or the payload, until 'pneuservo design' shows a gain margin of 2 and a phase margin of 30 deg";

struct Place {
  double position_m = 0.0;
  bool is_reached = false;  ///< by the reference
};

std::string place_words(double position_m, double payload_kg) {
  return fmt::format("at x = {:.4g} mm with a payload of {:g} kg", 1e3 * position_m, payload_kg);
}

/// Both ends and the middle of the reference's way, and near both ends of the stroke.
std::vector<Place> places_of(const Rig& rig) {
  const ReferenceExtremes way = Reference(rig.reference, load_reference_positions).extremes(0, rig.duration_s);
  const double near_end_m = near_end_share * 0.5 * rig.axis.cylinder.stroke_m;
  std::vector<Place> out{{0.5 * (way.minimum + way.maximum), true}};
  if (way.maximum - way.minimum > 1e-6) {
    out.push_back({way.minimum, true});
    out.push_back({way.maximum, true});
  }
  if (way.minimum > -near_end_m) out.push_back({-near_end_m, false});
  if (way.maximum < near_end_m) out.push_back({near_end_m, false});
  return out;
}

std::vector<double> payloads_of(const Rig& rig) {
  std::vector<double> out{rig.axis.slider.payload_kg};
  if (rig.limits.payload_max_kg.value_or(0.0) > out[0]) out.push_back(*rig.limits.payload_max_kg);
  return out;
}

Rig at_place(Rig rig, double position_m, double payload_kg) {
  rig.initial.position_m = position_m;
  rig.axis.slider.payload_kg = payload_kg;
  return rig;
}

struct Survey {
  std::optional<LoopPoint> unstable, unstable_beyond, weakest;  ///< where the reference goes, beyond it; least margin
  int points = 0;
};

Survey survey(const Rig& rig, bool with_margins) {
  Survey out;
  for (const Place& place : places_of(rig))
    for (const double payload_kg : payloads_of(rig)) {
      if (!place.is_reached && !with_margins) continue;
      const LoopPoint point = loop_point(at_place(rig, place.position_m, payload_kg), with_margins);
      ++out.points;
      std::optional<LoopPoint>& unstable = place.is_reached ? out.unstable : out.unstable_beyond;
      if (!point.is_stable && !unstable) unstable = point;
      if (point.is_stable && (!out.weakest || point.margins.gain_up < out.weakest->margins.gain_up))
        out.weakest = point;
    }
  return out;
}

std::string instability(const LoopPoint& point) {
  return fmt::format("unstable {}: it swings at {:.3g} Hz", place_words(point.position_m, point.payload_kg),
                     point.weakest_Hz);
}

std::string fall_words(const LoopMargins& margins) {
  return margins.gain_down > 0.0 && margins.gain_down < 1.0
             ? fmt::format(", and would be stable below {:.3g} of its gain", margins.gain_down)
             : "";
}

void grade_margins(const Rig& rig, std::vector<Finding>& findings) {
  if (!has_linear_law(rig.controller)) return;
  const Survey found = survey(rig, true);
  if (found.unstable) {
    findings.push_back({Level::unsafe, "loop margins",
                        instability(*found.unstable) + fall_words(found.unstable->margins), gain_remedy});
    return;
  }
  const LoopMargins& margins = found.weakest->margins;
  const std::string down = margins.gain_down > 0.0 ? fmt::format(" and fall to {:.3g}", margins.gain_down) : "";
  const std::string what = fmt::format(
      "gain may grow by {:.3g} (at {:.3g} Hz){}, phase margin {:.3g} deg; the least of {} operating points, {}",
      margins.gain_up, margins.gain_up_Hz, down, margins.phase_deg, found.points,
      place_words(found.weakest->position_m, found.weakest->payload_kg));
  if (found.unstable_beyond)
    findings.push_back(
        {Level::acceptable, "loop margins",
         instability(*found.unstable_beyond) + ", where the reference does not go; of the stable points " + what,
         "keep the reference away from the end stops, or lower the gains"});
  else if (margins.gain_up < least_gain_margin || margins.phase_deg < least_phase_margin_deg ||
           margins.gain_down > 1.0 / least_gain_margin)
    findings.push_back({Level::acceptable, "loop margins", what, gain_remedy});
  else findings.push_back({Level::good, "loop margins", what, ""});
}

Rig resting(Rig rig, double position_m) {
  rig.reference = ReferenceSpec{};
  rig.reference.frequency_Hz = 1.0;
  rig.reference.center_m = position_m;
  rig.initial.position_m = position_m > 0.0 ? position_m - nudge_m : position_m + nudge_m;
  rig.duration_s = rest_s;
  rig.evaluation.reset();
  return rig;
}

/// A swing that the approach takes for being there is hunting; a larger one is a motion of its own.
Level swing_level(const MotionVerdict& verdict) {
  return verdict.oscillation_m > AxisLoop::approach_tolerance_m ? Level::unsafe : Level::acceptable;
}

Finding rest_finding(const RunResult& run, bool is_reached, const std::string& where) {
  const MotionVerdict& verdict = run.verdict;
  Level level = Level::good;
  std::string what = "it settles " + where;
  if (!verdict.fault.empty()) {
    level = Level::bad;
    what = fmt::format("{} a resting axis ends by the fault {}", where, verdict.fault);
  }
  if (verdict.oscillates || verdict.touched_end_stop) {
    level = verdict.touched_end_stop ? Level::unsafe : swing_level(verdict);
    what = fmt::format("it does not settle {}.{}", where, trouble_words(verdict));
  }
  if (level > Level::acceptable && !is_reached) level = Level::acceptable;
  return {level, "loop at rest", what + (is_reached || level == Level::good ? "" : " (beyond the reference)"),
          level == Level::good ? "" : gain_remedy};
}

Finding reference_finding(const RunResult& run, const std::string& where) {
  const MotionVerdict& verdict = run.verdict;
  const std::string share = share_words(verdict);
  const std::string what = fmt::format("{}: {}, {} at most{}{}.{}", where, following_words(verdict),
                                       length_words(run.metrics.max_position_error_m), share.empty() ? "" : ", ", share,
                                       trouble_words(verdict));
  const char* topic = "loop in motion";
  if (!verdict.fault.empty())
    return {Level::bad, topic,
            fmt::format("{} the run ends by the fault {}.{}", where, verdict.fault, trouble_words(verdict)),
            "run the config in simulated time and look at its report"};
  Level level = Level::good;
  const auto at_least = [&](bool holds, Level other) { level = holds ? std::max(level, other) : level; };
  at_least(verdict.following == Following::lags, Level::acceptable);
  at_least(verdict.following == Following::does_not_follow, Level::bad);
  at_least(verdict.oscillates, swing_level(verdict));
  at_least(verdict.touched_end_stop, Level::unsafe);
  const char* remedy = verdict.oscillates ? gain_remedy
                                          : "choose a slower reference, a feedforward, or higher gains as far as the "
                                            "margins allow";
  return {level, topic, what, level == Level::good ? "" : remedy};
}

/// The worst of the findings of one topic; the first of equal ones.
void keep_worst(std::optional<Finding>& worst, Finding finding) {
  if (!worst || finding.level > worst->level) worst = std::move(finding);
}

void grade_simulation(const Rig& rig, std::vector<Finding>& findings) {
  std::optional<Finding> rest, motion;
  double seconds = 0.0;
  Rig moving = rig;
  moving.duration_s = std::min(rig.duration_s, longest_reference_s);
  if (moving.evaluation && moving.evaluation->to_s > moving.duration_s) moving.evaluation.reset();
  for (const double payload_kg : payloads_of(rig)) {
    for (const Place& place : places_of(rig)) {
      keep_worst(rest, rest_finding(simulated_run(resting(rig, place.position_m), payload_kg), place.is_reached,
                                    place_words(place.position_m, payload_kg)));
      seconds += rest_s;
    }
    keep_worst(motion, reference_finding(simulated_run(moving, payload_kg),
                                         fmt::format("with a payload of {:g} kg", payload_kg)));
    seconds += moving.duration_s;
  }
  if (rest->level == Level::good) rest->what = fmt::format("it settles at {} positions", places_of(rig).size());
  rest->what += fmt::format(" ({:g} s simulated in all)", seconds);
  findings.push_back(std::move(*rest));
  findings.push_back(std::move(*motion));
}

/// The limits of the supervised motion as a run would take them, stated or derived.
Finding motion_limits_finding(const MotionPrediction& found) {
  const MotionLimits& limits = found.limits;
  const auto number = [](double value, double scale, const char* unit) {
    return std::isfinite(value) ? fmt::format("{:.3g} {}", scale * value, unit) : std::string("not checked");
  };
  const std::string source = found.machines > 0
                                 ? fmt::format(", derived from {} drawn machines that differ by {:.3g} mm at most",
                                               found.machines, 1e3 * found.spread_m)
                                 : "";
  const std::string what =
      fmt::format("deviation {}, of the speed {}, speed {}, stall {}{}", number(limits.deviation_m, 1e3, "mm"),
                  number(limits.speed_deviation_mps, 1.0, "m/s"), number(limits.speed_mps, 1.0, "m/s"),
                  number(limits.stall_force_N, 1.0, "N"), source);
  if (found.scattered)
    return {Level::acceptable, "motion limits", what + "; permitted machines may exceed the deviation",
            "lower limits.payload_max_kg or limits.dry_friction_max_N, or damp the loop"};
  return {Level::good, "motion limits", what, ""};
}

/// What payload that nobody stated ends the motion, by simulation.
Finding unknown_payload_finding(const std::vector<ToldPayload>& payloads) {
  std::string untold, told;
  std::vector<std::map<std::string, double>> figures;
  for (const ToldPayload& one : payloads) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    figures.push_back({{"payload_kg", one.payload_kg},
                       {"after_s", one.after_s.value_or(none)},
                       {"off_m", one.after_s ? one.off_m : none}});
    if (!one.after_s) untold += fmt::format("{}{:g}", untold.empty() ? "" : ", ", one.payload_kg);
    else
      told += fmt::format("{}{:g} kg after {:.2f} s, {:.1f} mm off", told.empty() ? "" : "; ", one.payload_kg,
                          *one.after_s, 1e3 * one.off_m);
  }
  std::string what;
  if (!untold.empty()) what = fmt::format("a payload of {} kg cannot be told", untold);
  if (!told.empty())
    what +=
        fmt::format("{}found at the latest, counted from 1 mm off the prediction: {}", what.empty() ? "" : "; ", told);
  if (!told.empty()) return {Level::good, "unknown payload", what, "", std::move(figures)};
  return {Level::acceptable, "unknown payload", what, "keep other loads off the slider, or state tighter limits",
          std::move(figures)};
}

void tell_supervised_motion(const Rig& rig, std::vector<Finding>& findings) {
  const Reference reference(rig.reference, load_reference_positions);
  const MotionPrediction found = predict_motion(rig, reference);
  findings.push_back(motion_limits_finding(found));
  findings.push_back(unknown_payload_finding(told_payloads(rig, reference, found)));
}

}  // namespace

std::vector<Finding> grade_simulated_loop(const Rig& rig) {
  std::vector<Finding> findings;
  grade_simulation(rig, findings);
  return findings;
}

std::vector<Finding> grade_loop(const Rig& rig) {
  std::vector<Finding> findings;
  if (rig.controls_pressure()) return grade_pressure_loop(rig);
  if (!rig.is_pneumatic()) return findings;
  grade_margins(rig, findings);
  try {
    tell_supervised_motion(rig, findings);
    grade_simulation(rig, findings);
  } catch (const std::invalid_argument& error) {  // a law that cannot follow the reference
    findings.push_back(
        {Level::bad, "loop in motion", error.what(), "change the reference or what the law needs for it"});
  }
  return findings;
}

std::string unstable_loop_words(const Rig& rig) {
  if (rig.controls_pressure()) return unstable_pressure_words(rig);
  if (!rig.is_pneumatic() || !has_linear_law(rig.controller)) return "";
  const Survey found = survey(rig, false);
  return found.unstable ? "the loop is " + instability(*found.unstable) : "";
}

void require_reference_in_stroke(const std::string& config, const Rig& rig) {
  if (!needs_file(rig.reference)) return;  // refused where the config is read
  const ReferenceExtremes way = Reference(rig.reference, load_reference_positions).extremes(0, rig.duration_s);
  const double half_m = 0.5 * rig.axis.cylinder.stroke_m, far_m = std::max(way.maximum, -way.minimum);
  if (far_m > half_m * (1.0 + 1e-12))
    throw InputError(fmt::format("{}: reference.path: found a position {:.6g} m from mid-stroke, expected at most half "
                                 "of cylinder.stroke_m ({:g} m)",
                                 config, far_m, half_m));
}

void heed_pass(const std::string& config, Rig& rig) {
  const std::string why = heed_missing_pass(config, rig, load_reference_positions);
  if (!why.empty()) std::cerr << fmt::format("{}: {}; it goes on with the formula\n", config, why);
}

void heed_loop(const std::string& config, const Rig& rig, bool on_devices, const AllowedRisks& allowed) {
  if (on_devices && !(rig.hal && rig.hal->bench))
    for (const Finding& finding : grade_safety(rig, load_reference_positions))
      if (finding.level == Level::unsafe && finding.topic.starts_with("limits."))
        throw InputError(fmt::format("{}: {}: {}; expected a limit that can act: {}", config, finding.topic,
                                     finding.what, finding.remedy));
  const std::string words = unstable_loop_words(rig);
  if (words.empty()) return;
  if (on_devices && !allowed.unstable_loop)
    throw InputError(fmt::format("{}: controller: {}; expected a stable one ('pneuservo check {}' judges it), or "
                                 "--allow-unstable",
                                 config, words, config));
  std::cerr << fmt::format("warning: {}: {}; 'pneuservo check {}' judges it\n", config, words, config);
}

}  // namespace pneuservo
