// Backend `replay`.
#include "replay/replay_backend.hpp"

#include <cmath>

#include <pneuservo/loop/fault.hpp>

namespace pneuservo {
namespace {
constexpr const char* column_names[10] = {
    "x_m",         "p1_port_Pa", "p2_port_Pa",         "p1_chamber_Pa",      "p2_chamber_Pa",
    "p_supply_Pa", "x_true_m",   "p1_chamber_true_Pa", "p2_chamber_true_Pa", "fault"};
}  // namespace

ReplayBackend::ReplayBackend(Recording recording, double period_s) : recording_(std::move(recording)) {
  recording_.require({"x_m", "p1_port_Pa", "p2_port_Pa"});
  for (const char* name : column_names) columns_.push_back(recording_.has(name) ? &recording_.column(name) : nullptr);
  for (double t : recording_.t_s()) ticks_.push_back(std::llround(t / period_s));
}

bool ReplayBackend::read(std::int64_t tick, Measurement& measurement) noexcept {
  while (next_ < ticks_.size() && ticks_[next_] < tick) ++next_;
  if (next_ >= ticks_.size()) return false;
  row_ = next_;
  const auto channels = channels_of(measurement);
  for (std::size_t i = 0; i < 6; ++i) {
    if (columns_[i] == nullptr) continue;
    const double value = (*columns_[i])[row_];
    *channels[i] = {value, 0.0, std::isfinite(value) && ticks_[row_] == tick, Origin::replayed};
  }
  measurement.device_faults = device_faults_of(recorded_faults());
  // Digital inputs are not recorded; the faults that they made are.
  const auto line = [&](std::uint64_t fault, LineState when_faulty) {
    return DigitalLine{(recorded_faults() & fault) != 0 ? when_faulty : LineState::absent};
  };
  measurement.digital.emergency_stop = line(fault_emergency_stop, LineState::on);
  measurement.digital.valve_power = line(fault_valve_power, LineState::off);
  measurement.digital.limit_low = line(fault_limit_switch, LineState::unreadable);
  return true;
}

std::uint64_t ReplayBackend::recorded_faults() const noexcept {
  if (columns_[9] == nullptr) return 0;
  const double bits = (*columns_[9])[row_];
  const bool readable = bits >= 0.0 && bits < 9007199254740992.0;  // 2^53: whole in a double
  return readable ? static_cast<std::uint64_t>(bits) : 0;
}

bool ReplayBackend::write(std::int64_t, const Command&) noexcept {
  return (recorded_faults() & fault_output_missed) == 0;
}

Origins ReplayBackend::origins() const {
  Origins all{.command = Origin::replayed};
  for (std::size_t i = 0; i < 6; ++i) all.channels[i] = columns_[i] == nullptr ? Origin::absent : Origin::replayed;
  return all;
}

Truth ReplayBackend::truth() const noexcept {
  const auto value = [&](std::size_t i) { return columns_[i] == nullptr ? std::nan("") : (*columns_[i])[row_]; };
  return {value(6), value(7), value(8)};
}

}  // namespace pneuservo
