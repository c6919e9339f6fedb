// Backend `replay`.
#include "replay/replay_backend.hpp"

#include <cmath>

namespace pneuservo {
namespace {
constexpr const char* column_names[9] = {"x_m",           "p1_port_Pa", "p2_port_Pa", "p1_chamber_Pa",     "p2_chamber_Pa",
                                         "p_supply_Pa", "x_true_m",   "p1_chamber_true_Pa", "p2_chamber_true_Pa"};
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
  Channel* const channels[6] = {&measurement.position_m,           &measurement.port_pressure_1_Pa,    &measurement.port_pressure_2_Pa,
                                &measurement.chamber_pressure_1_Pa, &measurement.chamber_pressure_2_Pa, &measurement.supply_pressure_Pa};
  for (std::size_t i = 0; i < 6; ++i) {
    if (columns_[i] == nullptr) continue;
    const double value = (*columns_[i])[row_];
    *channels[i] = {value, 0.0, std::isfinite(value) && ticks_[row_] == tick, Origin::replayed};
  }
  return true;
}

Truth ReplayBackend::truth() const noexcept {
  const auto value = [&](std::size_t i) { return columns_[i] == nullptr ? std::nan("") : (*columns_[i])[row_]; };
  return {value(6), value(7), value(8)};
}

}  // namespace pneuservo
