// Pulses of two on/off valves: when the coils are on.
#include <pneuservo/control/pulse_width.hpp>

#include <algorithm>
#include <cmath>

namespace pneuservo {
namespace {

constexpr double rounding = 1e-6;  // of a quotient of times

// A pulse as long as the switching time would hang on a rounding: the shortest one is longer.
long least_ticks(const PulsedValveParameters& valve, double period_s) noexcept {
  return static_cast<long>(std::floor(valve.switching_time_on_s / period_s + rounding)) + 1;
}
long gap_ticks(const PulsedValveParameters& valve, double period_s) noexcept {
  return static_cast<long>(std::ceil(valve.switching_time_off_s / period_s - rounding));
}

}  // namespace

double PulseWidth::shortest_carrier_s(const PulsedValveParameters& valve, double period_s) noexcept {
  return static_cast<double>(least_ticks(valve, period_s) + gap_ticks(valve, period_s)) * period_s;
}

void PulseWidth::configure(const ValveParameters<double>& valve, double period_s) noexcept {
  valve_ = *valve.on_off;
  command_max_V_ = valve.command_max_V;
  period_s_ = period_s;
  carrier_ticks_ = std::lround(valve_.carrier_period_s / period_s);
  least_ticks_ = least_ticks(valve_, period_s);
  most_ticks_ = carrier_ticks_ - gap_ticks(valve_, period_s);
  reset();
}

void PulseWidth::reset() noexcept {
  tick_ = on_ticks_ = 0;
  sign_ = 1.0;
  rest_s_ = 0.0;
}

double PulseWidth::step(double mean_V) noexcept {
  if (tick_ == 0) begin(mean_V / command_max_V_);
  const bool on = tick_ < on_ticks_;
  tick_ = tick_ + 1 == carrier_ticks_ ? 0 : tick_ + 1;
  return on ? sign_ * command_max_V_ : 0.0;
}

// What the coil was on beyond its pulse, or off within it, is owed to the next pulses.
void PulseWidth::skip(long periods) noexcept {
  const bool is_on = on_ticks_ > 0 && (tick_ == 0 ? on_ticks_ == carrier_ticks_ : tick_ <= on_ticks_);
  const long within = tick_ == 0 ? 0 : std::min(periods, carrier_ticks_ - tick_);
  const long wanted = std::clamp(on_ticks_ - tick_, 0L, within);
  rest_s_ -= sign_ * static_cast<double>((is_on ? periods : 0L) - wanted) * period_s_;
  tick_ = periods > within ? 0 : (tick_ + within) % carrier_ticks_;
  if (tick_ == 0 && is_on) on_ticks_ = carrier_ticks_;  // the coil is on as the next carrier period begins
}

// By which the pulse lengthens the opening, its end after the coil is off included. A coil that was on to the end of
// the last carrier period goes on with the pulse that it has.
double PulseWidth::open_s(long ticks, bool goes_on) const noexcept {
  if (ticks == 0) return 0.0;
  const double shift_s = goes_on ? 0.0 : valve_.switching_time_off_s - valve_.switching_time_on_s;
  return static_cast<double>(ticks) * period_s_ + shift_s;
}

void PulseWidth::begin(double share) noexcept {
  const double wanted_s = std::clamp(share, -1.0, 1.0) * valve_.carrier_period_s + rest_s_;
  const bool turns = wanted_s * sign_ < 0.0, goes_on = on_ticks_ == carrier_ticks_ && !turns;
  if (turns) sign_ = -sign_;
  const double size_s = std::fabs(wanted_s);
  const long nearest = 1 + std::lround((size_s - open_s(1, goes_on)) / period_s_);
  const long between = std::clamp(nearest, goes_on ? 1L : least_ticks_, most_ticks_);
  on_ticks_ = 0;
  for (const long ticks : {between, carrier_ticks_})
    if (std::fabs(open_s(ticks, goes_on) - size_s) < std::fabs(open_s(on_ticks_, goes_on) - size_s)) on_ticks_ = ticks;
  rest_s_ = sign_ * (size_s - open_s(on_ticks_, goes_on));
}

}  // namespace pneuservo
