// Injected faults of the sensors.
#include "inject/sample_faults.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace pneuservo {

SampleFaults::SampleFaults(double period_s, const PerSignal<double>& far_out)
    : period_s_(period_s), far_out_(far_out),
      history_(static_cast<std::size_t>(std::ceil(longest_injected_delay_s / period_s)) + 1) {}

void SampleFaults::add(const InjectedFault& fault) {
  if (fault.kind == InjectedKind::reversed_encoder || fault.kind == InjectedKind::exchanged_hoses ||
      fault.kind == InjectedKind::exchanged_ports)
    wiring_.push_back(fault);
  const std::string_view target = fault.kind == InjectedKind::encoder_jump ? "x" : std::string_view(fault.target);
  const std::optional<Signal> signal = signal_named(target);
  if (!signal) return;
  Spoiled spoiled{fault, *signal, {}};
  if (newest_tick_) spoiled.kept = shown_[*signal];  // one that comes while samples are taken
  faults_.push_back(spoiled);
}

void SampleFaults::reset() {
  newest_tick_.reset();
  for (Spoiled& spoiled : faults_) spoiled.spent = false, spoiled.kept.reset(), spoiled.count = 0;
}

void SampleFaults::apply(std::int64_t tick, double t_s, Measurement& measured) noexcept {
  rewire(t_s, measured);
  remember(tick, measured);
  for (Spoiled& spoiled : faults_) {
    Channel& sample = measured.channel[spoiled.signal];
    if (spoiled.fault.is_on(t_s)) spoil(spoiled, sample);
    else spoiled.kept = sample.value;
  }
  for (const Signal signal : channel_signals) shown_[signal] = measured.channel[signal].value;
}

// Exchanged hoses exchange the ports under their sensors: what sensor 1 shows belongs to chamber 2.
void SampleFaults::rewire(double t_s, Measurement& measured) const noexcept {
  for (const InjectedFault& fault : wiring_) {
    if (!fault.is_on(t_s)) continue;
    if (Channel& x = measured.channel[Signal::x]; fault.kind == InjectedKind::reversed_encoder) x.value = -x.value;
    else std::swap(measured.channel[Signal::p1_port], measured.channel[Signal::p2_port]);
  }
}

void SampleFaults::remember(std::int64_t tick, const Measurement& measured) noexcept {
  PerSignal<double> now;
  for (const Signal signal : channel_signals) now[signal] = measured.channel[signal].value;
  if (!newest_tick_) std::fill(history_.begin(), history_.end(), now);  // stands for all before it
  // A tick that was skipped has no sample of its own: it repeats the one before, so that slots count periods.
  const std::int64_t slots = static_cast<std::int64_t>(history_.size());
  const std::int64_t passed = std::clamp<std::int64_t>(tick - newest_tick_.value_or(tick), 1, slots);
  const PerSignal<double> before = history_[newest_];
  for (std::int64_t i = 1; i <= passed; ++i) {
    newest_ = newest_ + 1 == history_.size() ? 0 : newest_ + 1;
    history_[newest_] = i < passed ? before : now;
  }
  newest_tick_ = tick;
}

void SampleFaults::spoil(Spoiled& spoiled, Channel& sample) noexcept {
  const double value = spoiled.fault.value.value_or(0.0);
  switch (spoiled.fault.kind) {
    case InjectedKind::drop: sample.valid = sample.valid && !spoiled.fault.takes(spoiled.count++); break;
    case InjectedKind::not_a_number: sample.value = std::nan(""); break;
    case InjectedKind::freeze:
      if (!spoiled.kept) spoiled.kept = sample.value;  // frozen from the first sample on
      sample.value = *spoiled.kept;
      break;
    case InjectedKind::encoder_jump:
    case InjectedKind::bias: sample.value += value; break;
    case InjectedKind::spike:
      if (!spoiled.spent) sample.value += value;
      spoiled.spent = true;
      break;
    case InjectedKind::spikes: sample.value += spoiled.count++ % 3 == 0 ? value : 0.0; break;
    case InjectedKind::saturate: sample.value = spoiled.fault.value.value_or(far_out_[spoiled.signal]); break;
    case InjectedKind::delay: delay(value, spoiled.signal, sample); break;
    default: break;
  }
}

void SampleFaults::delay(double delay_s, Signal signal, Channel& sample) const noexcept {
  const double periods = std::min(std::round(delay_s / period_s_), static_cast<double>(history_.size() - 1));
  const auto back = static_cast<std::size_t>(std::max(periods, 0.0));
  sample.value = history_[(newest_ + history_.size() - back) % history_.size()][signal];
  sample.age_s += static_cast<double>(back) * period_s_;
}

}  // namespace pneuservo
