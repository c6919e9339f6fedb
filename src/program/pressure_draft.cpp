// A config of a pressure behind a hose from the numbers of its data sheets.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "backends.hpp"
#include "config/pressure_checks.hpp"
#include "config/read_rig.hpp"
#include "config/units.hpp"
#include "loop/runner.hpp"
#include "program/rig_draft.hpp"
#include "report/pressure_metrics.hpp"

namespace pneuservo {
namespace {

/// The range keeps this share of the supply's gauge pressure away from atmosphere and supply, where nothing flows.
constexpr double range_end_share = 0.15;
/// The rate begins with half of what the open valve feeds at the worse end, and goes down where the loop is late.
constexpr double rate_share = 0.5, rate_step_down = 0.8;
constexpr int most_rate_steps = 10;
/// Of a volume's wall to what is around it, moving air inside, at rest outside; a sphere has the least wall.
constexpr double wall_heat_W_per_m2K = 20.0;

/// What is not an answer.
struct PressureNumbers {
  double lowest_Pa = 2e5, highest_Pa = 3e5, rate_Pa_per_s = 1.0;
};

double sphere_m2(double volume_m3) { return std::cbrt(36.0 * std::numbers::pi * volume_m3 * volume_m3); }

std::string valve_text(const SheetAnswers& a) {
  const std::string flow = fmt::format("  {}\n  {}\n", sheet_line(a, flow_key(a), "flow"),
                                       sheet_line(a, "critical_pressure_ratio", "critical-ratio"));
  if (a.switching_on.empty())
    return fmt::format("# A command above 0 fills, below 0 empties.\nvalve:\n  {}\n{}  {}\n"
                       "  damping_ratio: 0.7               # typical: between resonance and creep\n",
                       sheet_line(a, "signal", "signal"), flow, sheet_line(a, "natural_frequency", "valve-frequency"));
  return fmt::format("# One of two on/off valves, open; the one fills, the other one empties.\nvalve:\n"
                     "  {:<32}# typical: the usual coil\n{}on_off_valves:\n  switching_time_on: {}\n"
                     "  switching_time_off: {}\n  {:<32}# typical: 50 pulses a second\n",
                     "command_max: 24 V", flow, a.switching_on, a.switching_off, "carrier_period: 20 ms");
}

std::string draft_text(const SheetAnswers& a, const PressureNumbers& n) {
  const double length_m = std::max(0.01, quantity_of(a, "line-length", "m"));
  const bool pulses = !a.switching_on.empty();
  std::string out =
      draft_head(a) + fmt::format("supply: {{pressure: {}}}\n\n{}\n", answer_of(a, "supply"), valve_text(a));
  out += fmt::format(
      "# From the valve's port to the volume.\nline_1: {{length: {}, diameter: {}}}\n\nvolume:\n  {}\n  {:<32}"
      "# typical: a sphere of this volume, 20 W/(m2 K)\n\n",
      answer_of(a, "line-length"), answer_of(a, "line-diameter"), sheet_line(a, "volume", "volume"),
      fmt::format("wall_heat: {:.3g} W/K", wall_heat_W_per_m2K * sphere_m2(quantity_of(a, "volume", "m3"))));
  out += fmt::format("sensors:\n  port_pressure:\n    {}\n    {}\n    {:<30}# typical: 0.03 % of 10 bar\n\n",
                     sheet_line(a, "range", "pressure-range"), sheet_line(a, "bits", "pressure-bits"), "noise: 300 Pa");
  out += "# The gain follows from hose, volume, valve and period.\ncontroller: {kind: pressure_pi}\n\n";
  out +=
      fmt::format("# What commands may ask for; `run` plays the hardest change among them.\nreference:\n  kind: live\n"
                  "  lowest_Pa: {:.0f}\n  highest_Pa: {:.0f}\n  rate: {}\n# Where the simulated rig begins.\n"
                  "initial: {{pressure_1_Pa: {:.0f}}}\n\n",
                  n.lowest_Pa, n.highest_Pa,
                  a.rate.empty() ? fmt::format("{:.3g} kPa/s", 1e-3 * n.rate_Pa_per_s) : a.rate, n.lowest_Pa);
  out += fmt::format("# One standard deviation of what stands above; typical values are known badly.\ntolerances:\n"
                     "  valve.{}: 10 %\n  line_1.length_m: 1 %\n  line_1.diameter_m: 2 %\n  volume.volume_m3: 2 %\n"
                     "  volume.wall_heat_W_per_K: 50 %\n  supply.pressure_Pa: 2 %\n\n",
                     pulses ? "area_max_m2" : "area_per_volt_m2_per_V");
  // Pulses make waves in the hose (docs/pressure.md).
  out += fmt::format(
      "simulation: {{cells_per_m: {:.3g}}}\nestimator: {{cells_per_m: {:.3g}}}\nsafe_output: {{action: hold}}\n",
      std::max(pulses ? 8.0 : 4.0, 4.0 / length_m), std::max(pulses ? 4.0 : 2.0, 1.0 / length_m));
  return out;
}

/// Largest error of the hardest change over the range; infinite: a fault.
double trial_share(const Rig& rig) {
  const auto backend = make_backend("sim", rig);
  backend->configure();
  const RunOutcome outcome = run_loop(rig, *backend, RunSettings{});
  if (!outcome.faults.empty() || outcome.moves.empty()) return infinite;
  const PressureMetrics found = evaluate_pressure(rig, outcome.rows, outcome.moves.front().start_s);
  return found.max_error_Pa / (rig.pressure_reference.highest_Pa - rig.pressure_reference.lowest_Pa);
}

}  // namespace

FinishedDraft finish_pressure_draft(const SheetAnswers& answers) {
  PressureNumbers numbers;
  const auto read = [&] { return parse_rig(draft_text(answers, numbers), "new-rig"); };
  // What cannot be read is told with its key by the first read.
  const double atmosphere_Pa = Datums{}.atmosphere_Pa,
               gauge_Pa = std::max(quantity_of(answers, "supply", "Pa") - atmosphere_Pa, 1e4);
  numbers.lowest_Pa = atmosphere_Pa + range_end_share * gauge_Pa;
  numbers.highest_Pa = atmosphere_Pa + (1.0 - range_end_share) * gauge_Pa;
  const Rig first = read();
  numbers.rate_Pa_per_s = rate_share * std::min(valve_fills_Pa_per_s(first, numbers.highest_Pa),
                                                valve_empties_Pa_per_s(first, numbers.lowest_Pa));
  double share = trial_share(read());
  for (int i = 0; i < most_rate_steps && answers.rate.empty() && share > permitted_share; ++i) {
    numbers.rate_Pa_per_s *= rate_step_down;
    share = trial_share(read());
  }
  const Rig rig = read();
  FinishedDraft out{draft_text(answers, numbers), {}, share <= permitted_share};
  out.told.push_back(fmt::format(
      "changes of up to {:.3g} kPa/s between {:.0f} and {:.0f} kPa absolute: largest error "
      "{:.2g} % of the range{}",
      1e-3 * rig.pressure_reference.rate_Pa_per_s, 1e-3 * numbers.lowest_Pa, 1e-3 * numbers.highest_Pa, 1e2 * share,
      out.is_fed ? ""
                 : fmt::format(", more than {:g} %: the valve feeds {:.3g} kPa/s at the upper "
                               "and {:.3g} kPa/s at the lower end",
                               1e2 * permitted_share, 1e-3 * valve_fills_Pa_per_s(rig, numbers.highest_Pa),
                               1e-3 * valve_empties_Pa_per_s(rig, numbers.lowest_Pa))));
  return out;
}

}  // namespace pneuservo
