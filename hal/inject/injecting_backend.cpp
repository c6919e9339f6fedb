// The backend sim with faults injected on purpose.
#include "inject/injecting_backend.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuservo {
namespace {

/// Half a period: a time in a config that is a whole number of periods shall fall on its tick.
double time_of(std::int64_t tick, double period_s) noexcept { return (static_cast<double>(tick) + 0.5) * period_s; }

}  // namespace

InjectingBackend::InjectingBackend(const Rig& rig, const std::vector<InjectedFault>& faults, const std::string& origin)
    : rig_(rig), plant_(rig), plant_faults_(rig) {
  for (const InjectedFault& fault : faults) {
    require_injectable(fault, InjectionPlace::sim, rig, origin);
    plant_faults_.add(fault);
    const auto channel = std::find(channel_names.begin(), channel_names.end(), fault.target);
    const bool position = fault.kind == InjectedKind::encoder_jump;
    faults_.push_back({fault, position ? 0 : static_cast<std::size_t>(channel - channel_names.begin())});
  }
}

void InjectingBackend::configure() {
  plant_.configure();
  history_.assign(static_cast<std::size_t>(std::ceil(longest_delay_s / rig_.period_s)) + 1, {});
  newest_ = 0;
  bus_off_since_s_ = -1.0;
  for (Injected& injected : faults_) injected.spent = false, injected.kept = std::nan("");
}

bool InjectingBackend::bus_is_off(double t_s) const noexcept {
  return std::any_of(faults_.begin(), faults_.end(), [&](const Injected& injected) {
    return injected.fault.kind == InjectedKind::bus_off && injected.fault.is_on(t_s);
  });
}

Origins InjectingBackend::origins() const {
  Origins all = plant_.origins();
  all.lines[0] = Origin::simulated;  // read() gives the emergency stop
  return all;
}

bool InjectingBackend::read(std::int64_t tick, Measurement& measurement) noexcept {
  const double t_s = time_of(tick, rig_.period_s);
  plant_.read(tick, measurement);
  plant_faults_.apply(t_s, plant_);
  const auto channels = channels_of(measurement);
  newest_ = newest_ + 1 == history_.size() ? 0 : newest_ + 1;
  for (std::size_t i = 0; i < channels.size(); ++i) history_[newest_][i] = channels[i]->value;
  measurement.digital.emergency_stop.state = LineState::off;
  for (Injected& injected : faults_) {
    const bool of_channel = injected.channel < channels.size();
    if (!injected.fault.is_on(t_s)) {
      if (of_channel) injected.kept = channels[injected.channel]->value;
      continue;
    }
    if (of_channel) spoil(injected, *channels[injected.channel]);
    if (injected.fault.kind == InjectedKind::emergency_stop) measurement.digital.emergency_stop.state = LineState::on;
  }
  if (bus_is_off(t_s)) {
    for (Channel* channel : channels) channel->valid = false;
    measurement.device_faults |= device_bus_off;
  }
  return true;
}

void InjectingBackend::spoil(Injected& injected, Channel& sample) noexcept {
  const double value = injected.fault.value.value_or(0.0);
  switch (injected.fault.kind) {
    case InjectedKind::drop: sample.valid = false; break;
    case InjectedKind::not_a_number: sample.value = std::nan(""); break;
    case InjectedKind::freeze: sample.value = injected.kept; break;
    case InjectedKind::encoder_jump:
    case InjectedKind::bias: sample.value += value; break;
    case InjectedKind::spike:
      if (!injected.spent) sample.value += value;
      injected.spent = true;
      break;
    case InjectedKind::saturate: sample.value = injected.fault.value.value_or(1e9); break;
    case InjectedKind::delay: {
      const double periods = std::min(std::round(value / rig_.period_s), static_cast<double>(history_.size() - 1));
      const auto back = static_cast<std::size_t>(std::max(periods, 0.0));
      sample.value = history_[(newest_ + history_.size() - back) % history_.size()][injected.channel];
      sample.age_s += static_cast<double>(back) * rig_.period_s;
      break;
    }
    default: break;
  }
}

bool InjectingBackend::write(std::int64_t tick, const Command& command) noexcept {
  const double t_s = time_of(tick, rig_.period_s);
  if (!bus_is_off(t_s)) {
    bus_off_since_s_ = -1.0;
    return plant_.write(tick, plant_faults_.command(t_s, command));
  }
  // The device keeps the last command until its own watchdog gives the substitute output.
  if (bus_off_since_s_ < 0.0) bus_off_since_s_ = t_s;
  const double watchdog_s = rig_.hal && rig_.hal->can ? rig_.hal->can->watchdog_s : CanBusParameters{}.watchdog_s;
  if (t_s - bus_off_since_s_ > watchdog_s) {
    const auto safe_V = safe_commands_V(rig_);
    plant_.write(tick, {safe_V[0], safe_V[1]});
  }
  return false;
}

std::vector<std::string> InjectingBackend::notes() const {
  std::vector<std::string> lines;
  for (const Injected& injected : faults_) {
    const InjectedFault& fault = injected.fault;
    std::string line = fmt::format("t = {} s: injected {}", fault.start_s, text_of(fault.kind).name);
    if (!fault.target.empty()) line += " of " + fault.target;
    if (fault.value) line += fmt::format(", {:g}", *fault.value);
    if (std::isfinite(fault.duration_s)) line += fmt::format(", for {} s", fault.duration_s);
    lines.push_back(line);
  }
  return lines;
}

}  // namespace pneuservo
