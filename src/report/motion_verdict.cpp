// What the axis did, as one judgement.
#include <report/motion_verdict.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <loop/rig_grade.hpp>

#include <report/even_signal.hpp>
#include <report/periodic_part.hpp>
#include <report/table.hpp>

namespace pneuservo {
namespace {

/// A swing of the command counts from ten times the noise that the sensors make of it on: a loop that enlarges noise
/// tenfold has a gain margin of 10/9 at most. Never below half a per cent of the valve's range, which hysteresis
/// swallows, and always from 5 % of it on.
constexpr double noise_gain = 10.0, least_range_share = 0.005, largest_range_share = 0.05;
/// The position swings with it by a thousandth of the amplitude, and by more than the encoder's noise.
constexpr double least_amplitude_share = 1e-3, encoder_noises = 3.0;
/// Fewer periods than this tell a swing from a drift no longer, and what halves from the first half to the second dies.
constexpr double fewest_periods = 3.0, dying = 0.5, growing = 1.5;
/// A line that holds less of what is left is noise that the loop colours.
constexpr double least_line_share = 0.1;
constexpr double longest_stretch_s = 30.0, longest_lag_s = 0.5, lag_step_s = 1e-3;
constexpr double explained_by_lag = 0.9;  // of the position's variance, or the lag is not told
constexpr std::size_t lag_points = 2000;

struct Stretch {
  RowColumn position = Signal::x;
  double encoder_m = 0.0;  ///< what the position cannot show
  std::vector<Row> rows;  ///< from the window's start; after a fault, from the run's start to it
  std::size_t first = 0;  ///< of `rows` in the run
};

double encoder_m(const Rig& rig, bool is_true) {
  return is_true ? 1e-6 : rig.sensors.position.quantum_m + encoder_noises * rig.sensors.position.noise_m;
}

Stretch stretch_of(const Rig& rig, const RunResult& run) {
  Stretch out;
  if (run.metrics.position_is_true) out.position = &Row::x_true_m;
  out.encoder_m = rig.sensors.position.quantum_m + rig.sensors.position.noise_m;
  double from_s = run.faults.empty() && std::isfinite(run.metrics.from_s) ? run.metrics.from_s : 0.0;
  if (!run.rows.empty()) from_s = std::max(from_s, run.rows.back().t_s - run.start_s - longest_stretch_s);
  for (std::size_t i = 0; i < run.rows.size() && run.rows[i].fault == 0; ++i) {
    if (run.rows[i].t_s < run.start_s + from_s - 1e-9) continue;
    if (out.rows.empty()) out.first = i;
    out.rows.push_back(run.rows[i]);
  }
  return out;
}

void judge_following(const RunResult& run, const Stretch& stretch, MotionVerdict& out) {
  double lowest = Metrics::none, highest = Metrics::none;
  for (const Row& row : run.rows) {
    const double t_s = row.t_s - run.start_s;
    if (t_s < run.metrics.from_s - 1e-9 || t_s > run.metrics.to_s + 1e-9) continue;
    lowest = std::fmin(lowest, row.x_ref_m);
    highest = std::fmax(highest, row.x_ref_m);
  }
  out.amplitude_m = 0.5 * (highest - lowest);
  if (!std::isfinite(run.metrics.max_position_error_m) || !std::isfinite(out.amplitude_m)) return;
  if (out.amplitude_m <= encoder_noises * stretch.encoder_m) {
    out.following = Following::rests;
    return;
  }
  out.error_share = run.metrics.max_position_error_m / out.amplitude_m;
  out.following = out.error_share <= follows_share ? Following::follows
                  : out.error_share <= lags_share  ? Following::lags
                                                   : Following::does_not_follow;
}

/// x = c + a r(t - lag) by least squares; the lag that explains most.
void find_lag(const std::vector<double>& x, const std::vector<double>& r, double period_s, double longest_s,
              MotionVerdict& out) {
  const std::size_t n = x.size(), history = r.size() - n;
  const std::size_t stride = std::max<std::size_t>(1, n / lag_points);
  double best = explained_by_lag;
  longest_s = std::min(longest_s, 0.5 * static_cast<double>(n) * period_s);
  for (double lag_s = 0.0; lag_s <= longest_s; lag_s += std::max(lag_step_s, period_s)) {
    const auto by = static_cast<std::size_t>(std::llround(lag_s / period_s));
    double count = 0, sx = 0, sr = 0, sxx = 0, srr = 0, sxr = 0;
    for (std::size_t k = 0; k < n; k += stride) {
      const double a = x[k] - x[0], b = r[history + k >= by ? history + k - by : 0] - r[0];
      ++count, sx += a, sr += b, sxx += a * a, srr += b * b, sxr += a * b;
    }
    const double vxx = sxx - sx * sx / count, vrr = srr - sr * sr / count, vxr = sxr - sx * sr / count;
    if (!(vxx > 0.0 && vrr > 0.0 && vxr > 0.0)) continue;
    const double explained = vxr * vxr / (vxx * vrr);
    if (explained <= best) continue;
    best = explained;
    out.lag_s = lag_s;
    out.amplitude_ratio = vxr / vrr;
  }
}

void collect_lines(const ReferenceSpec& spec, std::vector<double>& lines_Hz) {
  if (spec.kind == ReferenceKind::sine) lines_Hz.push_back(spec.frequency_Hz);
  for (const auto& component : spec.components) lines_Hz.push_back(component[1]);
  for (const ReferenceSpec& part : spec.parts) collect_lines(part, lines_Hz);
}

/// The largest swing of the command that noise explains.
double quiet_command_V(const Rig& rig) {
  const double noise_V = rig.controller.is<PdForce>() ? command_noise_rms_V(rig) : 0.0;
  const double range_V = rig.axis.valve.command_max_V;
  return std::clamp(noise_gain * noise_V, least_range_share * range_V, largest_range_share * range_V);
}

void judge_oscillation(const Rig& rig, const RunResult& run, const Stretch& stretch, MotionVerdict& out) {
  const RowColumn command = rig.valves() == 2 ? &Row::u1_V : &Row::u_V;
  const EvenSignal x = even_signal(stretch.rows, stretch.position), u = even_signal(stretch.rows, command);
  const std::vector<Row> with_history(
      run.rows.begin(), run.rows.begin() + static_cast<std::ptrdiff_t>(stretch.first + stretch.rows.size()));
  EvenSignal r = even_signal(with_history, &Row::x_ref_m);
  if (x.values.size() < 2 || r.values.size() < x.values.size()) return;
  std::vector<double> lines_Hz;
  collect_lines(rig.reference, lines_Hz);
  // A single sine tells lags apart up to half its period.
  find_lag(x.values, r.values, x.period_s,
           lines_Hz.size() == 1 ? std::min(longest_lag_s, 0.5 / lines_Hz[0]) : longest_lag_s, out);
  if (u.values.size() != x.values.size()) return;
  const std::vector<double> left_m = left_over(x.values, r.values, x.period_s, lines_Hz);
  const PeriodicPart swing = periodic_part(left_over(u.values, r.values, x.period_s, lines_Hz), x.period_s);
  const double length_s = static_cast<double>(x.values.size()) * x.period_s;
  const double swing_m = line_amplitude(left_m, swing.frequency_Hz * x.period_s);
  const double least_m = std::max(encoder_noises * stretch.encoder_m,
                                  std::isfinite(out.amplitude_m) ? least_amplitude_share * out.amplitude_m : 0.0);
  out.oscillates = swing.frequency_Hz * length_s >= fewest_periods && swing.share >= least_line_share &&
                   swing.growth >= dying && swing.amplitude > quiet_command_V(rig) && swing_m > least_m;
  if (!out.oscillates) return;
  out.oscillation_Hz = swing.frequency_Hz;
  out.oscillation_m = swing_m;
  out.oscillation_V = std::min(swing.amplitude, rig.axis.valve.command_max_V);
  out.oscillation_fills_range = swing.amplitude >= rig.axis.valve.command_max_V;
  out.oscillation_grows = swing.growth > growing;
}

/// Contact counts where the slider came to the stop, not where it started there or where the reference goes to it. A
/// blow lies between two samples: the sample before and its speed tell where the slider went.
void judge_end_stop(const Rig& rig, const RunResult& run, RowColumn position, MotionVerdict& out) {
  const double near_m = encoder_m(rig, run.metrics.position_is_true), half_m = 0.5 * rig.axis.cylinder.stroke_m;
  bool was_away = false;
  for (std::size_t i = 2; i < run.rows.size(); ++i) {
    const double x_m = position.of(run.rows[i]), asked_m = run.rows[i].x_ref_m;
    const double before_m = position.of(run.rows[i - 1]), step_m = before_m - position.of(run.rows[i - 2]);
    const double reached_m = std::fabs(x_m) > std::fabs(before_m + step_m) ? x_m : before_m + step_m;
    if (!std::isfinite(reached_m)) continue;
    const bool at_stop = std::fabs(reached_m) >= half_m - near_m;
    const bool asked =
        std::isfinite(asked_m) && asked_m * reached_m > 0.0 && std::fabs(asked_m) >= half_m - 10.0 * near_m;
    if (at_stop && was_away && !asked) {
      if (!out.touched_end_stop) {
        out.end_stop_m = std::copysign(half_m, reached_m);
        out.end_stop_s = run.rows[i].t_s - run.rows.front().t_s;
      }
      out.touched_end_stop = true;
      out.end_stop_speed_mps =
          std::fmax(out.end_stop_speed_mps, std::fabs(step_m) / (run.rows[i - 1].t_s - run.rows[i - 2].t_s));
    }
    was_away = !at_stop;
  }
}

}  // namespace

std::string length_words(double value_m) {
  const double size = std::fabs(value_m);
  return size < 1e-4 ? figure(value_m * 1e6) + " µm" : figure(value_m * 1e3) + " mm";
}

MotionVerdict judge_motion(const Rig& rig, const RunResult& run) {
  MotionVerdict out;
  if (!run.faults.empty()) out.fault = run.faults.front().substr(0, run.faults.front().find(':'));
  const Stretch stretch = stretch_of(rig, run);
  judge_following(run, stretch, out);
  judge_oscillation(rig, run, stretch, out);
  judge_end_stop(rig, run, stretch.position, out);
  return out;
}

std::string following_words(const MotionVerdict& verdict) {
  switch (verdict.following) {
    case Following::follows: return "the axis follows its reference";
    case Following::lags:
      return std::isfinite(verdict.lag_s) ? "the axis lags behind its reference" : "the axis strays from its reference";
    case Following::does_not_follow: return "the axis does not follow its reference";
    case Following::rests:
      return verdict.oscillates ? "the axis does not come to rest" : "the axis rests with its reference";
    case Following::not_judged: break;
  }
  return "the run was too short to be judged";
}

std::string share_words(const MotionVerdict& verdict) {
  if (!std::isfinite(verdict.error_share)) return "";
  std::string text = fmt::format("{} % of the amplitude of {}", figure(100.0 * verdict.error_share),
                                 length_words(verdict.amplitude_m));
  const bool tells_lag = verdict.following == Following::lags || verdict.following == Following::does_not_follow;
  if (tells_lag && std::isfinite(verdict.lag_s))
    text += fmt::format("; it comes {} ms late with {} of the amplitude", figure(1e3 * verdict.lag_s),
                        figure(verdict.amplitude_ratio));
  return text;
}

std::string trouble_words(const MotionVerdict& verdict, std::string_view subject) {
  std::string text;
  if (verdict.oscillates)
    text += fmt::format(" {} oscillates at {} Hz{}: the position by ±{}, the command by ±{} V{}.", subject,
                        figure(verdict.oscillation_Hz), verdict.oscillation_grows ? ", growing" : "",
                        length_words(verdict.oscillation_m), figure(verdict.oscillation_V),
                        verdict.oscillation_fills_range ? ", its whole range" : "");
  if (verdict.touched_end_stop)
    text +=
        fmt::format(" {} touched the end stop at {} {} s after the start, with {} m/s at most.", subject,
                    length_words(verdict.end_stop_m), figure(verdict.end_stop_s), figure(verdict.end_stop_speed_mps));
  return text;
}

std::string_view verdict_word(const MotionVerdict& verdict) {
  if (!verdict.fault.empty()) return "fault";
  if (verdict.touched_end_stop) return "end_stop";
  if (verdict.oscillates) return "oscillates";
  return following_names[static_cast<std::size_t>(verdict.following)];
}

}  // namespace pneuservo
