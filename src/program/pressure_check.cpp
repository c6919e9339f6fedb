// What the loop of a pressure rig is worth before it runs.
#include "program/pressure_check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <pneuservo/control/pressure_pi.hpp>
#include <pneuservo/control/pressure_reference.hpp>
#include <pneuservo/control/pulse_width.hpp>

#include "backends.hpp"
#include "config/pressure_checks.hpp"
#include "loop/runner.hpp"
#include "report/pressure_metrics.hpp"
#include "report/table.hpp"

namespace pneuservo {
namespace {

using Level = FindingLevel;

constexpr double longest_simulation_s = 30.0;
constexpr double large_overshoot_share = 0.1;

/// The loop's sensitivity and the gain that has it.
struct Margins {
  double gain_per_s = 0.0, highest_per_s = 0.0, sensitivity = 0.0;
  bool is_stated = false;
};

Margins margins_of(const Rig& rig) {
  const Reference none;
  const LawSetup setup{rig.axis, rig.period_s, none, rig.duration_s, {}, &rig.volume};
  const std::optional<double> stated = rig.controller.of<PressurePi>().gain_per_s;
  Margins out;
  const PressureSource source = rig.controller.of<PressurePi>().pressure_source;
  PressureGains gains = pressure_gains(setup, source);
  out.highest_per_s = gains.gain_per_s;
  out.is_stated = stated.has_value();
  out.gain_per_s = gains.gain_per_s = stated.value_or(out.highest_per_s);
  out.sensitivity = pressure_sensitivity(setup, source, gains);
  return out;
}

Finding margins_finding(const Rig& rig) {
  const Margins found = margins_of(rig);
  const std::string what =
      fmt::format("gain {} 1/s, {}; largest sensitivity {}", figure(found.gain_per_s),
                  found.is_stated ? fmt::format("stated (highest with margin: {} 1/s)", figure(found.highest_per_s))
                                  : "derived from hose, valve and period",
                  std::isfinite(found.sensitivity) ? figure(found.sensitivity) : "beyond every bound");
  const char* remedy = "lower controller.gain_per_s, or leave it out: it is then derived";
  if (!std::isfinite(found.sensitivity)) return {Level::unsafe, "loop margins", what + ": unstable", remedy};
  if (found.sensitivity > PressurePi::most_sensitivity * 1.01) return {Level::acceptable, "loop margins", what, remedy};
  return {Level::good, "loop margins", what, ""};
}

Finding flow_finding(const Rig& rig) {
  const ReferenceExtremes range = PressureReference(rig.pressure_reference).range_Pa(rig.duration_s);
  const double fills = valve_fills_Pa_per_s(rig, range.maximum), empties = valve_empties_Pa_per_s(rig, range.minimum);
  std::string what = fmt::format("fills at {} kPa/s at the highest pressure of the reference, empties at {} kPa/s "
                                 "at the lowest, without the hose's drop",
                                 figure(1e-3 * fills), figure(1e-3 * empties));
  if (rig.axis.valve.on_off) {
    PulseWidth pulses;
    pulses.configure(rig.axis.valve, rig.period_s);
    const double fastest =
        std::max(valve_fills_Pa_per_s(rig, range.minimum), valve_empties_Pa_per_s(rig, range.maximum));
    what += fmt::format("; the shortest pulse opens for {} ms and moves the pressure by {} kPa at most",
                        figure(1e3 * pulses.least_open_s()), figure(1e-3 * fastest * pulses.least_open_s()));
  }
  const PressureReferenceParameters& live = rig.pressure_reference;
  if (live.kind == PressureReferenceKind::live && live.rate_Pa_per_s > std::min(fills, empties))
    return {Level::acceptable, "valve flow",
            what + ", less than reference.rate_Pa_per_s: there the pressure comes late",
            "lower the rate, move the range away from supply and atmosphere, or take a larger valve"};
  return {Level::good, "valve flow", what, ""};
}

Finding simulation_finding(Rig rig) {
  rig.duration_s = std::min(rig.duration_s, longest_simulation_s);
  if (rig.evaluation && rig.evaluation->to_s > rig.duration_s) rig.evaluation.reset();
  const auto backend = make_backend("sim", rig);
  backend->configure();
  const RunOutcome outcome = run_loop(rig, *backend, RunSettings{});
  const double start_s = outcome.moves.empty() ? 0.0 : outcome.moves.front().start_s;
  const PressureMetrics m = evaluate_pressure(rig, outcome.rows, start_s);
  const char* topic = "loop in simulation";
  if (!outcome.faults.empty())
    return {Level::bad, topic,
            "ends by the fault " + outcome.faults.front().substr(0, outcome.faults.front().find(':')),
            "run the config in simulated time and look at its report"};
  if (m.steps.empty())
    return {
        Level::good, topic,
        fmt::format("error {} kPa rms, {} kPa at most", figure(1e-3 * m.rms_error_Pa), figure(1e-3 * m.max_error_Pa)),
        ""};
  const std::string beyond =
      fmt::format("{} steps, {} % overshoot", m.steps.size(), figure(100.0 * m.max_overshoot_share));
  if (!std::isfinite(m.max_settling_s))
    return {Level::bad, topic, beyond + ", one or more never settle", "give the steps more time, or a larger valve"};
  const bool is_large = m.max_overshoot_share > large_overshoot_share;
  return {is_large ? Level::acceptable : Level::good, topic,
          fmt::format("{}, settled after {} s and {} kPa off at most in the second half of each", beyond,
                      figure(m.max_settling_s), figure(1e-3 * m.max_settled_error_Pa)),
          is_large ? "lower controller.gain_per_s or rate_max_Pa_per_s" : ""};
}

}  // namespace

std::vector<Finding> grade_pressure_loop(const Rig& rig) {
  return {margins_finding(rig), flow_finding(rig), simulation_finding(rig)};
}

std::string unstable_pressure_words(const Rig& rig) {
  const Margins found = margins_of(rig);
  if (std::isfinite(found.sensitivity)) return "";
  return fmt::format("the loop is unstable with controller.gain_per_s of {} (highest with margin: {})",
                     figure(found.gain_per_s), figure(found.highest_per_s));
}

}  // namespace pneuservo
