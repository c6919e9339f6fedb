// Injected faults of the sensors.
#include "inject/sample_faults.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace pneuservo {

SampleFaults::SampleFaults(double period_s, const std::array<double, 6>& far_out)
    : period_s_(period_s), far_out_(far_out),
      history_(static_cast<std::size_t>(std::ceil(longest_injected_delay_s / period_s)) + 1) {}

void SampleFaults::add(const InjectedFault& fault) {
  if (fault.kind == InjectedKind::reversed_encoder || fault.kind == InjectedKind::exchanged_hoses ||
      fault.kind == InjectedKind::exchanged_ports)
    wiring_.push_back(fault);
  const std::string_view target = fault.kind == InjectedKind::encoder_jump ? "x" : std::string_view(fault.target);
  const auto found = std::find(channel_names.begin(), channel_names.end(), target);
  if (found == channel_names.end()) return;
  const auto channel = static_cast<std::size_t>(found - channel_names.begin());
  Spoiled spoiled{fault, channel, {}};
  if (newest_tick_) spoiled.kept = shown_[channel];  // one that comes while samples are taken
  faults_.push_back(spoiled);
}

void SampleFaults::reset() {
  newest_tick_.reset();
  for (Spoiled& spoiled : faults_) spoiled.spent = false, spoiled.kept.reset(), spoiled.count = 0;
}

void SampleFaults::apply(std::int64_t tick, double t_s, Measurement& measured) noexcept {
  rewire(t_s, measured);
  const auto channels = channels_of(measured);
  remember(tick, channels);
  for (Spoiled& spoiled : faults_) {
    Channel& sample = *channels[spoiled.channel];
    if (spoiled.fault.is_on(t_s)) spoil(spoiled, sample);
    else spoiled.kept = sample.value;
  }
  for (std::size_t i = 0; i < shown_.size(); ++i) shown_[i] = channels[i]->value;
}

// Exchanged hoses exchange the ports under their sensors: what sensor 1 shows belongs to chamber 2.
void SampleFaults::rewire(double t_s, Measurement& measured) const noexcept {
  for (const InjectedFault& fault : wiring_) {
    if (!fault.is_on(t_s)) continue;
    if (fault.kind == InjectedKind::reversed_encoder) measured.position_m.value = -measured.position_m.value;
    else std::swap(measured.port_pressure_1_Pa, measured.port_pressure_2_Pa);
  }
}

void SampleFaults::remember(std::int64_t tick, const std::array<Channel*, 6>& channels) noexcept {
  std::array<double, 6> now;
  for (std::size_t i = 0; i < now.size(); ++i) now[i] = channels[i]->value;
  if (!newest_tick_) std::fill(history_.begin(), history_.end(), now);  // stands for all before it
  // A tick that was skipped has no sample of its own: it repeats the one before, so that slots count periods.
  const std::int64_t slots = static_cast<std::int64_t>(history_.size());
  const std::int64_t passed = std::clamp<std::int64_t>(tick - newest_tick_.value_or(tick), 1, slots);
  const std::array<double, 6> before = history_[newest_];
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
    case InjectedKind::saturate: sample.value = spoiled.fault.value.value_or(far_out_[spoiled.channel]); break;
    case InjectedKind::delay: delay(value, spoiled.channel, sample); break;
    default: break;
  }
}

void SampleFaults::delay(double delay_s, std::size_t channel, Channel& sample) const noexcept {
  const double periods = std::min(std::round(delay_s / period_s_), static_cast<double>(history_.size() - 1));
  const auto back = static_cast<std::size_t>(std::max(periods, 0.0));
  sample.value = history_[(newest_ + history_.size() - back) % history_.size()][channel];
  sample.age_s += static_cast<double>(back) * period_s_;
}

}  // namespace pneuservo
