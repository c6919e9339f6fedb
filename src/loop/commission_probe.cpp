// The motions of the commissioning.
#include "loop/commission_probe.hpp"

#include <algorithm>
#include <cmath>

#include "loop/air_force.hpp"
#include "loop/commission.hpp"

namespace pneuservo {
namespace {

constexpr double mean_s = 0.3;            // of a rest's end: 300 samples of 1 ms
constexpr double longest_rest_s = 3.0;    // an air bearing swings for longer; what it does then is in the drift
constexpr double standing_m = 1e-4;
constexpr double smoothing_s = 0.02;
constexpr double speed_s = 0.02;
constexpr double seen_m = 2e-4;           // of motion
constexpr double answer_of_noise = 6.0;   // standard deviations: by chance once in 5e8 samples
constexpr double answer_Pa = 2e3;         // of both ports alike, what no wave is needed for
constexpr double settling_s = 0.1;        // of the record after the valve is closed
constexpr double after_answer_s = 0.2;    // of the ramp that had passed before the answer was seen
constexpr double blocked_share = 0.4;     // of the stiffness of the shut-in air

/// Sums of a rest's samples over its last mean_s: a ring is not needed, the rest ends a whole window after it began.
class RestSums {
 public:
  void restart() { *this = {}; }
  void add(const Measurement& measured, double t_s) {
    for (const Signal i : channel_signals) {
      const Channel& channel = measured.channel[i];
      if (channel.origin == Origin::absent) continue;
      if (!channel.valid || !std::isfinite(channel.value)) {
        ++bad_[i];
        continue;
      }
      if (count_[i] == 0) first_[i] = channel.value;
      const double d = channel.value - first_[i];
      ++count_[i], sum_[i] += d, square_[i] += d * d;
      if (i == Signal::x) t_ += t_s, tt_ += t_s * t_s, tx_ += t_s * d;
    }
  }
  RestState result() const {
    RestState out;
    out.count = count_, out.bad = bad_;
    for (const Signal i : channel_signals) {
      if (count_[i] == 0) continue;
      const double n = static_cast<double>(count_[i]), mean = sum_[i] / n;
      out.mean[i] = first_[i] + mean;
      out.rms[i] = std::sqrt(std::max(square_[i] / n - mean * mean, 0.0));
    }
    const double n = static_cast<double>(count_[Signal::x]), spread = n * tt_ - t_ * t_;
    if (spread > 0.0) out.drift_mps = (n * tx_ - t_ * sum_[Signal::x]) / spread;
    return out;
  }

 private:
  PerSignal<double> first_, sum_, square_;
  PerSignal<std::int64_t> count_, bad_;
  double t_ = 0.0, tt_ = 0.0, tx_ = 0.0;
};

/// What ends a probe, tick by tick.
class ProbeWatch {
 public:
  ProbeWatch(const Rig& rig, Probe& probe, double speed_per_volt)
      : rig_(rig), probe_(probe), per_volt_(speed_per_volt), smooth_Pa_(probe.before.port_Pa()),
        smoothing_(-std::expm1(-rig.period_s / smoothing_s)), speed_gain_(-std::expm1(-rig.period_s / speed_s)),
        last_m_(probe.before.mean[Signal::x]) {
    const auto& c = rig.axis.cylinder;
    const double scatter = std::sqrt(0.5 * smoothing_);  // that the smoothing leaves of white noise
    const double noise_N =
        std::hypot(c.area_1_m2 * probe.before.rms[Signal::p1_port], c.area_2_m2 * probe.before.rms[Signal::p2_port]);
    const double quantum_N = std::hypot(c.area_1_m2, c.area_2_m2) * rig.sensors.port_pressure.quantum_Pa;
    answer_N_ = answer_of_noise * scatter * noise_N + quantum_N;
    force_before_N_ = air_force_N(rig, probe.before.port_Pa());
    push_N_ = ProbeLimits::push_Pa * std::max(c.area_1_m2, c.area_2_m2);
    stiffness_N_per_m_ = air_stiffness_N_per_m(rig, probe.before.port_Pa(), probe.before.mean[Signal::x]);
    const double mass_kg = rig.axis.slider.mass_kg + rig.axis.slider.payload_kg;
    swing_s_ = 2.0 * M_PI * std::sqrt(mass_kg / (rig.axis.air.heat_capacity_ratio * stiffness_N_per_m_));
    seen_m_ = seen_m + 6.0 * rig.sensors.position.noise_m + 2.0 * rig.sensors.position.quantum_m;
  }
  /// True: the ramp is over, probe.end says why. `volts`: in force until now.
  bool over(const StepSample& sample, double volts) {
    const double dt = rig_.period_s * static_cast<double>(sample.skipped + 1);
    note(sample, dt, volts);
    const double moved_m = std::fabs(probe_.moved_m), push_N = std::fabs(probe_.force_change_N);
    if (is_too_fast()) return end(ProbeEnd::too_fast);
    if (moved_m + 0.5 * swing_s_ * std::fabs(speed_mps_) >= ProbeLimits::way_m) return end(ProbeEnd::moved);
    if (answered_ && push_N >= push_N_) return end(ProbeEnd::pushed);
    if (!answered_ && (push_N > answer_N_ || common_change_Pa() > answer_Pa)) answered_ = true, answered_V_ = volts;
    if (!answered_) return false;
    const double speed_mps = per_volt_ * (volts - answered_V_) + after_answer_s * ProbeLimits::acceleration_mps2;
    expected_m_ += dt * speed_mps, answered_s_ += dt;
    expected_end_m_ = expected_m_ + 0.5 * swing_s_ * speed_mps;
    if (expected_end_m_ < ProbeLimits::unseen_way_m) return false;
    // A slider that is slow on its air has not had the time to move yet: what it did is told after the pulse.
    if (moved_m > seen_m_ || answered_s_ < 0.5 * swing_s_) return end(ProbeEnd::little);
    return !is_pushed(expected_m_) && end(ProbeEnd::unseen);
  }
  /// After the ramp, while the valve closes and the slider settles.
  void note(const StepSample& sample, double dt, double volts) {
    for (std::size_t i = 0; i < 2; ++i) smooth_Pa_[i] += smoothing_ * (sample.in.port_Pa[i] - smooth_Pa_[i]);
    probe_.force_change_N = air_force_N(rig_, smooth_Pa_) - force_before_N_;
    speed_mps_ += speed_gain_ * ((sample.in.position_m - last_m_) / dt - speed_mps_);
    last_m_ = sample.in.position_m;
    probe_.moved_m = last_m_ - probe_.before.mean[Signal::x];
    probe_.fastest_mps = std::max(probe_.fastest_mps, std::fabs(speed_mps_));
    // A skipped slot repeats the sample, so that an index is a time.
    for (std::int64_t i = 0; i <= sample.skipped; ++i) {
      probe_.position_m.push_back(sample.in.position_m);
      probe_.volts.push_back(volts);
      probe_.port_Pa.push_back(sample.in.port_Pa);
      probe_.chamber_Pa.push_back(sample.in.chamber_Pa);
    }
  }
  bool is_too_fast() const { return std::fabs(speed_mps_) > ProbeLimits::fastest_mps; }
  /// The end of a slow slider's pulse, after the rest: it moved, or the shut-in air pushes it, or neither.
  void tell_end() {
    probe_.moved_m = probe_.after.mean[Signal::x] - probe_.before.mean[Signal::x];
    if (probe_.end != ProbeEnd::little) return;
    probe_.force_change_N = air_force_N(rig_, probe_.after.port_Pa()) - force_before_N_;
    if (std::fabs(probe_.moved_m) <= seen_m_)
      probe_.end = is_pushed(expected_end_m_) ? ProbeEnd::pushed : ProbeEnd::unseen;
  }
  double swing_s() const { return swing_s_; }

 private:
  bool end(ProbeEnd why) {
    probe_.end = why;
    return true;
  }
  bool is_pushed(double way_m) const {
    return std::fabs(probe_.force_change_N) >= blocked_share * stiffness_N_per_m_ * way_m;
  }
  double common_change_Pa() const {
    const auto before = probe_.before.port_Pa();
    return std::max(std::fabs(smooth_Pa_[0] - before[0]), std::fabs(smooth_Pa_[1] - before[1]));
  }

  const Rig& rig_;
  Probe& probe_;
  double per_volt_;
  std::array<double, 2> smooth_Pa_;
  double smoothing_, speed_gain_, last_m_, speed_mps_ = 0.0, answer_N_ = 0.0, force_before_N_ = 0.0, push_N_ = 0.0,
                                           seen_m_ = 0.0, answered_V_ = 0.0, answered_s_ = 0.0, expected_m_ = 0.0,
                                           expected_end_m_ = 0.0, swing_s_ = 0.0, stiffness_N_per_m_ = 0.0;
  bool answered_ = false;
};

}  // namespace

RestState rest(SupervisedSteps& steps, double shortest_s) {
  RestSums sums;
  double window_from_s = 0.0, stands_at_m = 0.0, from_m = 1e9, to_m = -1e9;
  steps.run([&](const StepSample& sample) -> StepAnswer {
    const double x = sample.raw.channel[Signal::x].value;
    if (std::isfinite(x)) from_m = std::min(from_m, x), to_m = std::max(to_m, x);
    const bool full = sample.t_s - window_from_s >= mean_s;
    const bool again =
        sample.t_s < shortest_s || (sample.t_s < longest_rest_s && std::fabs(x - stands_at_m) > standing_m);
    if (sample.t_s == 0.0 || (full && again)) sums.restart(), window_from_s = sample.t_s, stands_at_m = x;
    sums.add(sample.raw, sample.t_s);
    const bool whole = sample.t_s - window_from_s >= mean_s && sample.t_s >= shortest_s;
    const bool calm = std::fabs(x - stands_at_m) <= standing_m || !std::isfinite(x) || sample.t_s > longest_rest_s;
    const bool gone = to_m - from_m > ProbeLimits::drift_m && sample.t_s > mean_s;
    return {steps.command(0.0), (whole && calm) || gone};
  });
  RestState out = sums.result();
  out.from_m = from_m, out.to_m = to_m;
  return out;
}

Probe probe(const Rig& rig, SupervisedSteps& steps, int direction, const RestState& before) {
  Probe out;
  out.direction = direction;
  out.before = before;
  const double per_volt = speed_per_volt_mps(rig, before.port_Pa(), direction);
  out.ramp_V_per_s = ProbeLimits::acceleration_mps2 / per_volt;
  const double largest_V = ProbeLimits::largest_share * rig.axis.valve.command_max_V;
  const auto most = static_cast<std::size_t>(2.0 * largest_V / out.ramp_V_per_s / rig.period_s) + 1024;
  out.position_m.reserve(most), out.volts.reserve(most), out.port_Pa.reserve(most), out.chamber_Pa.reserve(most);
  ProbeWatch watch(rig, out, per_volt);
  double volts = 0.0;
  steps.run([&](const StepSample& sample) -> StepAnswer {
    const bool over = watch.over(sample, volts) || volts >= largest_V;
    out.end_V = volts;
    if (!over) volts = std::min(out.ramp_V_per_s * sample.t_s, largest_V);
    return {steps.command(direction * volts), over};
  });
  const double closing_s = out.end == ProbeEnd::too_fast ? 0.0 : watch.swing_s();
  steps.run([&](const StepSample& sample) -> StepAnswer {
    watch.note(sample, rig.period_s * static_cast<double>(sample.skipped + 1), volts);
    if (watch.is_too_fast()) out.end = ProbeEnd::too_fast;
    const bool closes = sample.t_s < closing_s && out.end != ProbeEnd::too_fast;
    volts = closes ? out.end_V * (1.0 - sample.t_s / closing_s) : 0.0;
    return {steps.command(direction * volts), sample.t_s >= closing_s + std::max(0.5 * closing_s, settling_s)};
  });
  out.after = rest(steps, 0.6);
  watch.tell_end();
  for (const double x : out.position_m)
    out.farthest_m = std::max(out.farthest_m, std::fabs(x - before.mean[Signal::x]));
  return out;
}

}  // namespace pneuservo
