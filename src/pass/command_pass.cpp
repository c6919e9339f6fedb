// The command pass: stages of the learning, the table, the verdict.
#include "pass/command_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <pneuservo/elements/sensor.hpp>
#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/loop/motion_twin.hpp>

#include "config/input_error.hpp"
#include "pass/force_learning.hpp"

namespace pneuservo {
namespace {

/// Runs up to a cut-off frequency.
struct Stage {
  double cut_off_Hz;
  int runs;
};
/// First what every line follows, then with the first two resonances of 10 m: reversals of 20 N of friction on the nine
/// lines cost 0.13 to 0.28 mm with 40 Hz, 0.21 to 0.31 mm with 25 Hz.
constexpr Stage stages[] = {{12.0, 8}, {40.0, 8}};
/// Near its limit 10 m of 4.15 mm takes two or three rounds; all else takes one.
constexpr int most_rounds = 3;
/// Part of the law's force gain that stays in the loop: it holds the mean force while the rest is learned.
constexpr double feedback_share = 0.25;
/// As large as the commands that are learned, and well within the valve's range; its edges are not alike about the
/// middle.
double pulse_V(const Rig& rig) { return std::min(1.0, 0.2 * rig.axis.valve.command_max_V); }
constexpr double response_s = 2.0;

std::vector<double> asked_of(const std::vector<LedTick>& ticks) {
  std::vector<double> asked_V(ticks.size());
  for (std::size_t i = 0; i < ticks.size(); ++i) asked_V[i] = ticks[i].asked_V;
  return asked_V;
}

/// The force that is left, faded out where nothing is used any more.
std::vector<double> left_of(const std::vector<LedTick>& ticks, const PassMotion& motion) {
  const std::size_t end = motion.first() + motion.used();
  const double fade = static_cast<double>(ticks.size() - end);
  std::vector<double> left_N(ticks.size());
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double beyond = i < end ? 0.0 : static_cast<double>(i - end) / fade;
    left_N[i] = (ticks[i].wanted_N - ticks[i].force_N) * 0.5 * (1.0 + std::cos(M_PI * beyond));
  }
  return left_N;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

void judge(const Rig& rig, const std::vector<double>& slow_left_N, CommandPass& pass) {
  pass.largest_command_V = pass.left_N = 0.0;
  bool finite = true;
  std::size_t limited = 0;
  for (std::size_t i = 0; i < pass.ticks.size(); ++i) {
    const double command_V = std::fabs(pass.ticks[i].u_V);
    finite = finite && std::isfinite(command_V) && std::isfinite(slow_left_N[i]);
    pass.largest_command_V = std::max(pass.largest_command_V, command_V);
    if (command_V >= rig.axis.valve.command_max_V) ++limited;
    pass.left_N = std::max(pass.left_N, std::fabs(slow_left_N[i]));
  }
  pass.limited_share = static_cast<double>(limited) / static_cast<double>(pass.ticks.size());
  pass.feasible = finite && limited == 0 && pass.left_N <= most_left_N;
}

/// A round of all stages from the axis' last run on; counts the runs. Leaves the axis' last run at the best command.
void learn(LedAxis& axis, const PassMotion& motion, ForceLearning& learning, const GoesOn& goes_on, std::size_t& runs) {
  std::vector<double> command_V = asked_of(axis.ticks()), best_V = command_V;
  double best_N = std::numeric_limits<double>::infinity();
  const auto left_by = [&](const std::vector<double>& command) {
    ++runs;
    const std::vector<double> left_N = left_of(axis.run(motion, command), motion);
    if (const double now_N = rms(left_N); now_N < best_N) best_N = now_N, best_V = command;
    return left_N;
  };
  for (const Stage& stage : stages) {
    learning.begin_stage(stage.cut_off_Hz);
    for (int i = 0; i < stage.runs; ++i) {
      if (goes_on && !goes_on()) return;
      command_V = learning.next(command_V, left_by(command_V));
    }
  }
  left_by(command_V);
  left_by(best_V);
}

/// The largest share from 1/16 on, by sixteenths, of which `is_feasible` holds; 0: of none that was tried.
template <class F> double largest_share(F&& is_feasible) {
  int known = 0;
  for (int step = 8; step > 0; step /= 2)
    if (is_feasible((known + step) / 16.0)) known += step;
  return known / 16.0;
}

/// Cuts a long run where the reference rests, or after whole periods of it; returns the ticks that then repeat.
std::size_t shorten(Rig& rig, const Reference& reference) {
  const double periods = rig.duration_s / rig.period_s, most = static_cast<double>(most_pass_ticks);
  if (periods <= most) return 1;
  const Reference::Repetition again = reference.repetition();
  const double begin = std::ceil(again.from_s / rig.period_s), period = std::round(again.period_s / rig.period_s);
  const bool rests = again.period_s == 0.0;
  // The pressures need some periods to come to their own repetition.
  constexpr double least_periods = 3.0, settling_s = 1.0, rounding = 1e-9;
  const double fitting = rests ? 0.0 : std::floor((most - begin) / period);
  const double ticks = rests ? begin + std::round(settling_s / rig.period_s) : begin + fitting * period;
  const bool is_whole = std::fabs(again.period_s / rig.period_s - period) <= rounding * period;
  const bool learns = rig.controller.of<PdForce>().learns();  // tick by tick over the whole move
  if (learns || !(ticks <= most) || !(rests || (is_whole && fitting >= least_periods)))
    throw std::invalid_argument(fmt::format(
        "a command pass: found a run of {:.0f} periods, expected at most {} (duration_s), or a reference that "
        "repeats after a whole number of them, three times or more within those, without controller.learning",
        periods, most_pass_ticks));
  rig.duration_s = ticks * rig.period_s;
  return rests ? 1 : static_cast<std::size_t>(period);
}

/// Sensors without noise behind the loop's correction, and the estimator behind them.
class Shown {
 public:
  Shown(const Rig& rig, const PerSignal<double>& first, bool by_estimator)
      : estimates_(by_estimator && rig.controller.pressures() == PressureSource::estimated),
        ports_(rig.controller.pressures() == PressureSource::valve), aged_(rig.simulation.input_age_periods > 0) {
    const bool estimated = !rig.controller.takes_chambers();
    for (const Signal signal : channel_signals) {
      const bool of_port = estimated && is_chamber(signal);
      sensors_[signal].configure(
          behind_correction(rig.sensor_effects[of_port ? port_signals[side_of(signal)] : signal]), 0.0, 0.0,
          rig.period_s, Random());
      sensors_[signal].reset(first[signal]);
    }
    if (estimates_) estimator_.configure(estimator_parameters(rig));
    last_ = first;
  }
  PassRow row(const LedTick& tick, double v_mps, double previous_V) {
    PerSignal<double> now;
    for (const Signal signal : channel_signals) now[signal] = sensors_[signal].read(tick.values[signal]);
    const PerSignal<double> seen = aged_ ? std::exchange(last_, now) : now;
    PassRow row{.asked_V = tick.asked_V, .x_m = seen[Signal::x], .supply_Pa = seen[Signal::p_supply]};
    const auto& [side_1, side_2] = ports_ || estimates_ ? port_signals : chamber_signals;
    row.p1_Pa = seen[side_1], row.p2_Pa = seen[side_2];
    row.port_1_Pa = seen[Signal::p1_port], row.port_2_Pa = seen[Signal::p2_port];
    if (!estimates_) return row;
    const EstimatorOutput estimate = estimator_.step({row.p1_Pa, row.p2_Pa, row.x_m, v_mps, previous_V});
    row.p1_Pa = estimate.chamber_pressure_Pa[0], row.p2_Pa = estimate.chamber_pressure_Pa[1];
    return row;
  }

 private:
  bool estimates_, ports_, aged_;
  PerSignal<Sensor> sensors_;
  PerSignal<double> last_;
  PipelineEstimator estimator_;
};

}  // namespace

std::shared_ptr<PassTable> CommandPass::table(const Rig& rig, bool by_estimator) const {
  auto table = std::make_shared<PassTable>();
  table->rows.reserve(ticks.size());
  table->repeats = repeats;
  Shown shown(rig, before.front().values, by_estimator);
  double previous_V = before.front().u_V, previous_x_m = before.front().values[Signal::x];
  const auto row_of = [&](const LedTick& tick) {
    const double x_m = tick.values[Signal::x];
    const PassRow row = shown.row(tick, (x_m - previous_x_m) / rig.period_s, previous_V);
    previous_V = tick.u_V, previous_x_m = x_m;
    return row;
  };
  // Motion that begins at once needs its command before time 0: the first row must not be that of the motion.
  const PassRow rest = row_of(before.front());
  for (std::size_t i = 1; i < before.size(); ++i) row_of(before[i]);
  for (const LedTick& tick : ticks) table->rows.push_back(row_of(tick));
  table->rows.front() = rest;
  return table;
}

CommandPass make_command_pass(const Rig& wanted, const Reference& reference, const MotionScale& scale,
                              const GoesOn& goes_on) {
  if (wanted.valves() != 1) throw std::invalid_argument("a command pass: expected a five-port valve");
  Rig rig = wanted;
  CommandPass pass;
  pass.repeats = shorten(rig, reference);
  const double feedback_V_per_N = feedback_share * rig.controller.of<PdForce>().force_gain_V_per_N;
  LedAxis axis(rig, feedback_V_per_N);
  const PassMotion motion(rig, reference, scale);
  const auto response_ticks = static_cast<std::size_t>(std::llround(response_s / rig.period_s));
  ForceLearning learning(axis.pulse_response(pulse_V(rig), response_ticks), motion.ticks(), rig.period_s);
  axis.run(motion, {});
  const auto used = [&](const auto& all) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(motion.first());
    return std::pair{begin, begin + static_cast<std::ptrdiff_t>(motion.used())};
  };
  for (int round = 0; round < most_rounds && !pass.feasible && !(pass.limited_share > 0.0); ++round) {
    learn(axis, motion, learning, goes_on, pass.runs);
    if (goes_on && !goes_on()) break;
    const std::vector<double> slow_N = learning.below(judged_Hz, left_of(axis.ticks(), motion));
    pass.before.assign(axis.ticks().begin(), used(axis.ticks()).first);
    pass.ticks.assign(used(axis.ticks()).first, used(axis.ticks()).second);
    judge(rig, {used(slow_N).first, used(slow_N).second}, pass);
  }
  return pass;
}

double predicted_error_m(const Rig& rig, const Reference& reference, const CommandPass& pass, FeedforwardSource by) {
  Rig followed = rig;
  followed.controller.of<PdForce>().flow_feedforward = by;
  MotionTwin twin;
  twin.configure(followed, reference, 0.0, by == FeedforwardSource::pass ? pass.table(followed, false) : nullptr);
  twin.set_machine(followed, followed.axis, MotionTwin::simulated_cells(followed));
  const PerSignal<double>& first = pass.before.front().values;
  twin.start(first[Signal::x], {first[Signal::p1_chamber], first[Signal::p2_chamber]}, {0.0, 0.0});
  double most_m = 0.0;
  for (std::size_t i = 0; i + 1 < pass.ticks.size(); ++i) {
    const double t_s = static_cast<double>(i) * rig.period_s;
    ControlInput in;
    in.now = reference.at(t_s);
    in.ahead = reference.at(t_s + twin.law().lead_s());
    in.tick = static_cast<std::int64_t>(i);
    most_m = std::max(most_m, std::fabs(in.now.d[0] - twin.position_m()));
    twin.step(in, rig.axis.supply.pressure_Pa, MotionLimits::unlimited);
  }
  return most_m;
}

std::vector<double> closed_loop_response_m_per_V(const Rig& rig, const Reference& reference, const CommandPass& pass) {
  Rig smooth = rig;
  smooth.axis = smooth_axis(rig.axis);
  const double x_m = reference.at(0.0).d[0], volt = pulse_V(rig);
  ReferenceSpec rest_spec;
  rest_spec.kind = ReferenceKind::waypoints;
  rest_spec.times_s = {0.0, rig.duration_s}, rest_spec.positions_m = {x_m, x_m};
  const Reference resting(rest_spec);
  const PassRow rest = pass.table(rig, false)->rows.front();
  std::vector<double> response(static_cast<std::size_t>(std::llround(response_s / rig.period_s)));
  for (const double added_V : {0.0, volt}) {
    auto table = std::make_shared<PassTable>();
    table->rows = {rest, rest};
    table->rows.front().asked_V += added_V;
    MotionTwin twin;
    twin.configure(smooth, resting, 0.0, table);
    twin.set_machine(smooth, smooth.axis, MotionTwin::simulated_cells(smooth));
    const PerSignal<double>& first = pass.before.front().values;
    twin.start(x_m, {first[Signal::p1_chamber], first[Signal::p2_chamber]}, {rest.asked_V, 0.0});
    for (std::size_t i = 0; i < response.size(); ++i) {
      ControlInput in;
      in.now = in.ahead = resting.at(0.0);
      in.tick = static_cast<std::int64_t>(i);
      response[i] = twin.position_m() - (added_V > 0.0 ? response[i] : 0.0);
      twin.step(in, rig.axis.supply.pressure_Pa, MotionLimits::unlimited);
    }
  }
  for (double& value : response) value /= volt;
  return response;
}

namespace {

/// Errs by more than with the formula; empty where it does not.
std::string unfollowed_words(const Rig& rig, const Reference& reference, const CommandPass& pass) {
  const double by_pass_m = predicted_error_m(rig, reference, pass, FeedforwardSource::pass),
               by_formula_m = predicted_error_m(rig, reference, pass, FeedforwardSource::formula),
               noise_m = most_left_N / rig.controller.of<PdForce>().position_gain_N_per_m;
  if (by_pass_m <= by_formula_m + noise_m) return "";
  return fmt::format("this loop does not follow the pass that the lines can carry: on the model it errs by {:.3g} mm, "
                     "with the formula by {:.3g} mm",
                     1e3 * by_pass_m, 1e3 * by_formula_m);
}

/// What of the reference is not feasible.
std::string missing_words(const Rig& rig, const CommandPass& pass) {
  std::string found = fmt::format("{:.2g} N of the force are missing", pass.left_N);
  if (pass.limited_share > 0.0)
    found = fmt::format("the command is at its limit of {:g} V for {:.2g} % of the time and {}",
                        rig.axis.valve.command_max_V, 100.0 * pass.limited_share, found);
  return "the lines cannot carry the reference: " + found;
}

/// The same and what the lines can do instead: eight passes.
std::string instead_words(const Rig& rig, const Reference& reference, const CommandPass& pass) {
  const auto feasible = [&](const MotionScale& scale) { return make_command_pass(rig, reference, scale).feasible; };
  const double speed = largest_share([&](double share) { return feasible({.speed = share}); });
  const double size = largest_share([&](double share) { return feasible({.size = share}); });
  const std::string instead = speed > 0.0 && size > 0.0
                                  ? fmt::format("at {:.2f} of its speed or {:.2f} of its way they can", speed, size)
                                  : std::string("at a sixteenth of its speed or way they cannot either");
  return missing_words(rig, pass) + "; " + instead;
}

}  // namespace

std::string refusal_words(const Rig& rig, const Reference& reference, const CommandPass& pass, PassWords words) {
  if (pass.feasible) return unfollowed_words(rig, reference, pass);
  return words == PassWords::full ? instead_words(rig, reference, pass) : missing_words(rig, pass);
}

PassTables pass_tables(const Rig& rig, const Reference& reference, PassWords words) {
  if (!rig.controller.wants_pass()) return {};
  if (rig.reference.kind == ReferenceKind::live) return {std::make_shared<PassTable>(), std::make_shared<PassTable>()};
  const CommandPass pass = make_command_pass(rig, reference);
  if (const std::string why = refusal_words(rig, reference, pass, words); !why.empty())
    throw std::invalid_argument(fmt::format("controller.flow_feedforward: found pass, but {}; expected {}", why,
                                            pass.feasible ? "formula, or a reference that begins slower"
                                                          : "a slower or shorter reference, or formula"));
  const std::shared_ptr<PassTable> law = pass.table(rig, true);
  if (rig.controller.of<PdForce>().learns()) law->response_m_per_V = closed_loop_response_m_per_V(rig, reference, pass);
  return {law, pass.table(rig, false)};
}

PassOrFormula pass_or_formula(Rig& rig, const Reference& reference, PassWords words) {
  if (!rig.controller.wants_pass()) return {};
  PdForceParameters& law = rig.controller.of<PdForce>();
  if (law.without_pass == WithoutPass::refuse) return {pass_tables(rig, reference), ""};
  try {
    return {pass_tables(rig, reference, words), ""};
  } catch (const std::invalid_argument& error) {
    law.flow_feedforward = FeedforwardSource::formula;
    return {{}, error.what()};
  }
}

std::string heed_missing_pass(const std::string& config, Rig& rig, const LoadPositions& load) {
  if (!rig.controller.wants_pass()) return "";
  if (rig.reference.kind == ReferenceKind::live) {
    rig.controller.of<PdForce>().flow_feedforward = FeedforwardSource::formula;
    return "reference.kind live: a pass is made for each move of an axis that is served, not for the trial motion";
  }
  try {
    return pass_or_formula(rig, Reference(rig.reference, load), PassWords::full).why;
  } catch (const std::invalid_argument& error) { throw InputError(config + ": " + error.what()); }
}

}  // namespace pneuservo
