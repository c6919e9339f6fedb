// A config of a new axis from the numbers of its data sheets.
#include "program/rig_draft.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include <pneuservo/control/flow_feedforward.hpp>

#include "config/input_error.hpp"
#include "config/number_text.hpp"
#include "config/read_rig.hpp"
#include "config/units.hpp"
#include "design/margin_gains.hpp"
#include "improve/simulated_run.hpp"
#include "program/loop_check.hpp"

namespace pneuservo {

namespace {

/// Steps down of gains and motion where the simulation does not bear them out.
constexpr double gain_step_down = 0.8, motion_step_down = 0.8;
constexpr int most_steps = 12;
/// A quarter of what valve and supply allow is still a motion; slower ones are told.
constexpr int most_motion_steps = 6;
/// The motion begins with this share of the speed that empties the smaller chamber, and of the supply's force.
constexpr double speed_share = 0.35, force_share = 0.15;
/// Moves keep this share of the stroke away from either end.
constexpr double end_share = 0.05;
/// Part of the way in which a move reaches its speed: three digits of both numbers are off by 1.5 % at most.
constexpr double reached_share = 0.98;

/// What no data sheet says, from the size of the bore.
struct TypicalNumbers {
  double dead_volume_cm3 = 0.0, viscous_Ns_per_m = 0.0, dry_N = 0.0;
};
TypicalNumbers typical_numbers(const SheetAnswers& answers) {
  const double bore_m = quantity_of(answers, "bore", "m"), area_m2 = bore_area_m2(bore_m);
  return {1e6 * area_m2 * 0.005 + 1.0, 1500.0 * bore_m, 8e3 * area_m2};
}

std::string comment_lines(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& text : lines) out += fmt::format("# {}\n", text);
  return out;
}

/// The number of an answer; empty: not stated.
std::optional<double> stated(const std::string& answer, const char* unit) {
  return read_quantity({"", unit, 0.0, infinite, ""}, answer, {}).value;
}

std::string machine_text(const SheetAnswers& a) {
  const TypicalNumbers typical = typical_numbers(a);
  const std::string hose =
      fmt::format("{{length: {}, diameter: {}}}", answer_of(a, "line-length"), answer_of(a, "line-diameter"));
  std::string out = fmt::format("supply: {{pressure: {}}}\n\nvalve:\n", answer_of(a, "supply"));
  out += fmt::format("  {}\n  {}\n  {}\n  {}\n", sheet_line(a, "signal", "signal"), sheet_line(a, flow_key(a), "flow"),
                     sheet_line(a, "critical_pressure_ratio", "critical-ratio"),
                     sheet_line(a, "natural_frequency", "valve-frequency"));
  out += "  damping_ratio: 0.7               # typical: between resonance and creep\n\n";
  out += "# Valve port 1 to chamber 1, port 2 to chamber 2.\n";
  out += fmt::format("line_1: {}\nline_2: {}\n\n", hose, hose);
  out +=
      "# Chamber 1 pushes to positive x, the rod is on the side of chamber 2; end 1 is where chamber 1 is smallest.\n";
  out += fmt::format("cylinder:\n  {}\n  {}\n  {}\n", sheet_line(a, "bore", "bore"), sheet_line(a, "rod", "rod"),
                     sheet_line(a, "stroke", "stroke"));
  for (const int side : {1, 2})
    out += fmt::format("  {:<32}# typical: 5 mm of the bore and 1 cm3 of port and fitting\n",
                       fmt::format("dead_volume_{}: {:.3g} cm3", side, typical.dead_volume_cm3));
  out += "  wall_heat: 50 W/(m2 K)           # typical: 20 to 100 for moving air in small chambers\n\n";
  out += fmt::format("slider:\n  {}\n  {:<32}# typical: seals, 1.5 N s/m per mm of bore\n\n",
                     sheet_line(a, "mass", "mass"),
                     fmt::format("viscous_friction: {:.3g} N s/m", typical.viscous_Ns_per_m));
  out += fmt::format("effects:\n  {:<50}# typical: 0.08 bar on the piston\n",
                     fmt::format("coulomb_friction: {{force: {:.3g} N}}", typical.dry_N));
  if (quantity_of(a, "incline", "rad") != 0.0 || !a.of("incline").empty())
    out += fmt::format("  constant_force: {{incline: {}}}\n", answer_of(a, "incline"));
  out += fmt::format(
      "\nsensors:\n  position:\n    {}\n  port_pressure:\n    {}\n    {}\n    {:<30}# typical: 0.03 % of 10 bar\n\n",
      sheet_line(a, "quantum", "position-step"), sheet_line(a, "range", "pressure-range"),
      sheet_line(a, "bits", "pressure-bits"), "noise: 300 Pa");
  return out;
}

constexpr const char* tolerances = R"(# One standard deviation of what stands above; typical values are known badly.
tolerances:
  slider.mass_kg: 2 %
  slider.viscous_friction_Ns_per_m: 50 %
  valve.area_per_volt_m2_per_V: 10 %
  valve.critical_pressure_ratio: 15 %
  line_1.length_m: 1 %
  line_1.diameter_m: 2 %
  line_2.length_m: 1 %
  line_2.diameter_m: 2 %
  cylinder.dead_volume_1_m3: 50 %
  cylinder.dead_volume_2_m3: 50 %
  cylinder.wall_heat_W_per_m2K: 50 %
  supply.pressure_Pa: 2 %

# Four cells a line at least, in the plant and in the estimator one.
)";

std::string run_text(const SheetAnswers& a, const DraftNumbers& n) {
  const double length_m = std::max(0.01, quantity_of(a, "line-length", "m"));
  const double stroke_mm = 1e3 * quantity_of(a, "stroke", "m"), from_end_mm = end_share * stroke_mm;
  std::string out = comment_lines(n.notes);
  out +=
      fmt::format("controller:\n  kind: pd_force\n  pressure_source: estimated\n  position_gain_N_per_m: {:.4g}\n"
                  "  velocity_gain_Ns_per_m: {:.4g}\n  velocity_filter: 2 ms\n  force_gain_V_per_N: {:.4g}\n"
                  "  flow_feedforward: formula\n  feedforward_lead: {:.3g} ms\n\n",
                  n.position_gain_N_per_m, n.velocity_gain_Ns_per_m, n.force_gain_V_per_N, 1e3 * n.feedforward_lead_s);
  const std::string speed = a.speed.empty() ? fmt::format("{:.3g} m/s", n.speed_mps) : a.speed;
  const std::string acceleration =
      a.acceleration.empty() ? fmt::format("{:.3g} m/s2", n.acceleration_mps2) : a.acceleration;
  out += "# What commands may ask for; `run` plays the hardest motion among them.\nreference:\n  kind: live\n";
  out += fmt::format(
      "  lowest: {:.4g} mm from end 1\n  highest: {:.4g} mm from end 2\n  speed: {}\n  acceleration: {}\n\n",
      from_end_mm, from_end_mm, speed, acceleration);
  out += tolerances;
  out += fmt::format("simulation: {{cells_per_m: {:.3g}}}\nestimator: {{cells_per_m: {:.3g}, flow_correction: 0.2}}\n",
                     std::max(4.0, 4.0 / length_m), std::max(1.0, 1.0 / length_m));
  out += fmt::format("limits: {{payload_max: {}}}\n", answer_of(a, "payload-max"));
  return out;
}

/// The simulated hardest motion with one payload.
struct TrialRun {
  double error_share = infinite;  ///< largest error over the way
  bool is_calm = false;
};
TrialRun trial(const Rig& rig, double payload_kg) {
  const RunResult run = simulated_run(rig, payload_kg);
  const double way_m = rig.reference.highest_m - rig.reference.lowest_m;
  const bool is_calm = run.verdict.fault.empty() && !run.verdict.oscillates && !run.verdict.touched_end_stop;
  return {run.metrics.max_position_error_m / way_m, is_calm};
}
TrialRun worst_trial(const Rig& rig) {
  TrialRun worst = trial(rig, rig.axis.slider.payload_kg);
  if (const double most = rig.limits.payload_max_kg.value_or(0.0); most > rig.axis.slider.payload_kg) {
    const TrialRun loaded = trial(rig, most);
    worst = {std::max(worst.error_share, loaded.error_share), worst.is_calm && loaded.is_calm};
  }
  return worst;
}

bool settles(const Rig& rig) {
  return std::ranges::none_of(grade_simulated_loop(rig), [](const Finding& finding) {
    return finding.topic == "loop at rest" && finding.level > FindingLevel::good;
  });
}

/// Reads, changes and writes the draft until the simulation bears it out.
class Finisher {
 public:
  explicit Finisher(const SheetAnswers& answers) : answers_(answers) {
    choose_motion();
    choose_gains(read());
    slow_down();
  }
  FinishedDraft result() { return {draft_text(answers_, numbers_), std::move(told_), is_fed_}; }

 private:
  Rig read() const { return parse_rig(draft_text(answers_, numbers_), "new-rig"); }

  /// Choked flow out of the smaller chamber, and the full supply on the mass; what the owner stated stays. Where the
  /// way is too short for both numbers the one that nobody stated gives way.
  void choose_motion() {
    SheetAnswers machine = answers_;
    machine.speed.clear(), machine.acceleration.clear();
    const Rig rig = parse_rig(draft_text(machine, numbers_), "new-rig");
    const auto& axis = rig.axis;
    const Air<double> air(axis.air);
    const double smaller_m2 = std::min(axis.cylinder.area_1_m2, axis.cylinder.area_2_m2);
    const double fastest =
        air.flow_constant * std::sqrt(air.R * air.temperature_K) * axis.valve.area_max_m2 / smaller_m2;
    const double mass_kg = axis.slider.mass_kg + rig.limits.payload_max_kg.value_or(0.0);
    const double force_N = (axis.supply.pressure_Pa - axis.air.atmosphere_Pa) * smaller_m2;
    const double way_m = rig.reference.highest_m - rig.reference.lowest_m;
    const auto speed_mps = stated(answers_.speed, "m/s"), acceleration_mps2 = stated(answers_.acceleration, "m/s2");
    // Faster than half the way in 0.2 s no hose of some metres answers; beyond it the steps below go down anyhow.
    numbers_.speed_mps = speed_mps.value_or(std::min(speed_share * fastest, way_m / 0.4));
    numbers_.acceleration_mps2 =
        acceleration_mps2.value_or(std::min(force_share * force_N / mass_kg, numbers_.speed_mps / 0.1));
    LiveLimits limits = live_limits(rig.reference);
    limits.speed_mps = numbers_.speed_mps, limits.acceleration_mps2 = numbers_.acceleration_mps2;
    const double too_long = LivePlanner::transition_s(limits) * limits.speed_mps / (reached_share * way_m);
    if (too_long > 1.0 && !speed_mps) numbers_.speed_mps /= std::sqrt(too_long);
    else if (too_long > 1.0 && !acceleration_mps2) numbers_.acceleration_mps2 *= too_long;
    lead(read());
  }
  void lead(const Rig& rig) {
    numbers_.feedforward_lead_s = feedforward_lead_s(rig.axis, numbers_.speed_mps, rig.initial.pressure_1_Pa);
  }

  void take(const MarginGains& gains) {
    numbers_.force_gain_V_per_N = gains.force_gain_V_per_N;
    numbers_.position_gain_N_per_m = gains.position_gain_N_per_m;
    numbers_.velocity_gain_Ns_per_m = gains.velocity_gain_Ns_per_m;
  }
  void choose_gains(const Rig& rig) {
    const auto found = highest_gains(rig);
    if (!found)
      throw InputError(
          fmt::format("new-rig: controller: found no gains with a gain margin of {:g} and a phase margin of {:g} "
                      "deg, expected some; in the way: {}",
                      least_gain_margin, least_phase_margin_deg, obstacle_words(rig, found)));
    take(*found);
    int steps = 0;
    while (steps < most_steps && !settles(read())) numbers_.force_gain_V_per_N *= gain_step_down, ++steps;
    if (steps == most_steps)
      throw InputError(
          fmt::format("new-rig: controller: found a loop that does not settle in simulation at any gain, expected "
                      "one that rests; in the way: {}",
                      obstacle_words(rig, found)));
    const std::string lowered = steps == 0 ? "it settles in simulation as they are"
                                           : fmt::format("lowered to {:.2g} of that, where the simulated axis settles",
                                                         std::pow(gain_step_down, steps));
    numbers_.notes = {
        fmt::format("The highest gains with a gain margin of {:g} and a phase margin of {:g} deg over stroke, "
                    "payload and supply;",
                    least_gain_margin, least_phase_margin_deg),
        lowered + ". New ones after a change: pneuservo design CONFIG --method margins"};
    told_.push_back(fmt::format(
        "gains: {} linear models over stroke, payload and supply keep gain margin {:g} and phase margin {:g} deg; {}",
        found->points, least_gain_margin, least_phase_margin_deg, lowered));
  }

  /// The motion that the owner asked for is judged; one of our own is slowed down until the axis follows.
  void slow_down() {
    const bool is_ours = answers_.speed.empty() && answers_.acceleration.empty();
    TrialRun run = worst_trial(read());
    for (int i = 0; i < most_motion_steps && is_ours && !(run.is_calm && run.error_share <= permitted_share); ++i) {
      numbers_.speed_mps *= motion_step_down;
      numbers_.acceleration_mps2 *= motion_step_down * motion_step_down;
      lead(read());
      run = worst_trial(read());
    }
    is_fed_ = run.is_calm && run.error_share <= permitted_share;
    const Rig rig = read();
    const std::string motion =
        fmt::format("moves of up to {:.3g} m/s and {:.3g} m/s2 over {:.0f} mm: largest error {:.2g} % "
                    "of the way",
                    rig.reference.speed_mps, rig.reference.acceleration_mps2,
                    1e3 * (rig.reference.highest_m - rig.reference.lowest_m), 1e2 * run.error_share);
    if (is_fed_) told_.push_back(motion);
    else
      told_.push_back(fmt::format("{}, more than {:g} %{}: the valve cannot feed it, or the gains are too low; {}",
                                  motion, 1e2 * permitted_share, run.is_calm ? "" : ", and it swings",
                                  obstacle_words(rig, highest_gains(rig))));
  }

  const SheetAnswers& answers_;
  DraftNumbers numbers_;
  std::vector<std::string> told_;
  bool is_fed_ = false;
};

}  // namespace

std::string draft_text(const SheetAnswers& answers, const DraftNumbers& numbers) {
  return draft_head(answers) + machine_text(answers) + run_text(answers, numbers);
}

FinishedDraft finish_draft(const SheetAnswers& answers) { return Finisher(answers).result(); }

}  // namespace pneuservo
