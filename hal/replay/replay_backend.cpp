// Backend `replay`.
#include "replay/replay_backend.hpp"

#include <cmath>

#include <pneuservo/loop/fault.hpp>

namespace pneuservo {

ReplayBackend::ReplayBackend(Recording recording, double period_s, std::initializer_list<Signal> needed)
    : recording_(std::move(recording)) {
  std::vector<std::string> columns;
  for (const Signal signal : needed) columns.emplace_back(info(signal).column);
  recording_.require(columns);
  const auto column = [&](std::string_view name) -> Column {
    return recording_.has(name) ? &recording_.column(name) : nullptr;
  };
  for (const Signal signal : channel_signals) measured_[signal] = column(info(signal).column);
  truth_ = {column("x_true_m"), column("p1_chamber_true_Pa"), column("p2_chamber_true_Pa")};
  fault_ = column("fault");
  switches_ = column("switches");
  for (double t : recording_.t_s()) ticks_.push_back(std::llround(t / period_s));
}

bool ReplayBackend::read(std::int64_t tick, Measurement& measurement) noexcept {
  while (next_ < ticks_.size() && ticks_[next_] < tick) ++next_;
  if (next_ >= ticks_.size()) return false;
  row_ = next_;
  for (const Signal signal : channel_signals) {
    if (measured_[signal] == nullptr) continue;
    const double value = (*measured_[signal])[row_];
    measurement.channel[signal] = {value, 0.0, std::isfinite(value) && ticks_[row_] == tick, Origin::replayed};
  }
  measurement.device_faults = device_faults_of(recorded_faults());
  // Digital inputs are not recorded; the faults that they made are.
  const auto line = [&](std::uint64_t fault, LineState when_faulty) {
    return DigitalLine{(recorded_faults() & fault) != 0 ? when_faulty : LineState::absent};
  };
  measurement.digital.emergency_stop = line(fault_emergency_stop, LineState::on);
  measurement.digital.valve_power = line(fault_valve_power, LineState::off);
  measurement.digital.limit_low = line(fault_limit_switch, LineState::unreadable);
  if (switches_ != nullptr) set_switches(measurement.digital, static_cast<std::uint32_t>(recorded_switches()));
  return true;
}

std::uint64_t ReplayBackend::recorded_switches() const noexcept {
  const double bits = (*switches_)[row_];
  return bits >= 0.0 && bits < 16.0 ? static_cast<std::uint64_t>(bits) : 0;
}

std::uint64_t ReplayBackend::recorded_faults() const noexcept {
  if (fault_ == nullptr) return 0;
  const double bits = (*fault_)[row_];
  const bool readable = bits >= 0.0 && bits < 9007199254740992.0;  // 2^53: whole in a double
  return readable ? static_cast<std::uint64_t>(bits) : 0;
}

bool ReplayBackend::write(std::int64_t, const Command&) noexcept {
  return (recorded_faults() & fault_output_missed) == 0;
}

Origins ReplayBackend::origins() const {
  Origins all{.command = Origin::replayed};
  for (const Signal signal : channel_signals)
    all.channels[signal] = measured_[signal] == nullptr ? Origin::absent : Origin::replayed;
  return all;
}

Truth ReplayBackend::truth() const noexcept {
  const auto value = [&](Column column) { return column == nullptr ? std::nan("") : (*column)[row_]; };
  return {value(truth_[0]), value(truth_[1]), value(truth_[2])};
}

}  // namespace pneuservo
