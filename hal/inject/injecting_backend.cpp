// The backend sim with faults injected on purpose.
#include "inject/injecting_backend.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuservo {
namespace {

/// What a saturated channel shows: no position in m and no pressure in Pa.
constexpr PerSignal<double> far_out = [] {
  PerSignal<double> values;
  values.all.fill(1e9);
  return values;
}();

/// Half a period: a time in a config that is a whole number of periods shall fall on its tick.
double time_of(std::int64_t tick, double period_s) noexcept { return (static_cast<double>(tick) + 0.5) * period_s; }

}  // namespace

InjectingBackend::InjectingBackend(const Rig& rig, const std::vector<InjectedFault>& faults, const std::string& origin)
    : rig_(rig), plant_(rig), plant_faults_(rig), sample_faults_(rig.period_s, far_out), faults_(faults) {
  for (const InjectedFault& fault : faults) {
    require_injectable(fault, InjectionPlace::sim, rig, origin);
    plant_faults_.add(fault);
    sample_faults_.add(fault);
  }
}

void InjectingBackend::configure() {
  plant_.configure();
  sample_faults_.reset();
  bus_off_since_s_ = -1.0;
}

bool InjectingBackend::is_on(InjectedKind kind, double t_s) const noexcept {
  return std::any_of(faults_.begin(), faults_.end(),
                     [&](const InjectedFault& fault) { return fault.kind == kind && fault.is_on(t_s); });
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
  sample_faults_.apply(tick, t_s, measurement);
  measurement.digital.emergency_stop.state = is_on(InjectedKind::emergency_stop, t_s) ? LineState::on : LineState::off;
  if (is_on(InjectedKind::bus_off, t_s)) {
    for (Channel& channel : measurement.channel.all) channel.valid = false;
    measurement.device_faults |= device_bus_off;
  }
  if (is_on(InjectedKind::guard_lost, t_s)) measurement.device_faults |= device_guard_lost;
  return true;
}

bool InjectingBackend::write(std::int64_t tick, const Command& command) noexcept {
  const double t_s = time_of(tick, rig_.period_s);
  if (!is_on(InjectedKind::bus_off, t_s)) {
    bus_off_since_s_ = -1.0;
    return plant_.write(tick, plant_faults_.command(t_s, command));
  }
  // The device keeps the last command until its own watchdog gives the substitute output.
  if (bus_off_since_s_ < 0.0) bus_off_since_s_ = t_s;
  const double watchdog_s = rig_.hal && rig_.hal->can ? rig_.hal->can->watchdog_s : CanBusParameters{}.watchdog_s;
  if (t_s - bus_off_since_s_ > watchdog_s) {
    const auto safe_V = safe_commands_V(rig_);
    plant_.write(tick, {safe_V[0], safe_V[1], false, true});
  }
  return false;
}

std::vector<std::string> InjectingBackend::notes() const {
  std::vector<std::string> lines;
  for (const InjectedFault& fault : faults_) {
    std::string line = fmt::format("t = {} s: injected {}", fault.start_s, text_of(fault.kind).name);
    if (!fault.target.empty()) line += " of " + fault.target;
    if (fault.value) line += fmt::format(", {:g}", *fault.value);
    if (std::isfinite(fault.duration_s)) line += fmt::format(", for {} s", fault.duration_s);
    lines.push_back(line);
  }
  return lines;
}

}  // namespace pneuservo
