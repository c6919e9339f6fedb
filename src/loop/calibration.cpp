// Named steps before the first motion: homing and zeroing.
#include "loop/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include <pneuservo/loop/grid.hpp>
#include <pneuservo/loop/supervisor.hpp>

#include "loop/last_resort.hpp"
#include "loop/realtime_clock.hpp"
#include "loop/realtime_stop.hpp"
#include "loop/runner.hpp"

namespace pneuservo {
namespace {

/// A sensor of either kind may be off by so much before it counts as broken.
constexpr double sensor_tolerance_Pa = 20e3;

/// Calls `tick(k, skipped)` once a period until it says that it is done; false: stopped by a signal. `skipped`: slots
/// missed since the last call.
bool each_period(double period_s, bool real_time, const std::function<bool(std::int64_t, std::int64_t)>& tick) {
  const std::int64_t period_ns = std::llround(period_s * 1e9);
  TimeGrid grid(MonotonicClock::now_ns() + period_ns, period_ns);
  for (std::int64_t k = 0, skipped = 0; !StopRequest::requested(); k += 1 + skipped) {
    if (real_time) MonotonicClock::sleep_until_ns(grid.slot_ns());
    LastResort::note_tick(k);
    if (tick(k, skipped)) return true;
    if (real_time) skipped = grid.advance(MonotonicClock::now_ns());
  }
  return false;
}

/// The safe output at the end, whatever happens in between.
class SafeEnd {
 public:
  SafeEnd(const Rig& rig, Backend& backend)
      : safe_V_(safe_commands_V(rig)), backend_(backend), last_resort_(backend, "", rig.period_s) {
    backend.activate();
  }
  ~SafeEnd() {
    backend_.write(tick + 1, {safe_V_[0], safe_V_[1]});
    backend_.deactivate();
  }
  SafeEnd(const SafeEnd&) = delete;
  SafeEnd& operator=(const SafeEnd&) = delete;
  bool write_safe() noexcept { return backend_.write(tick, {safe_V_[0], safe_V_[1]}); }
  std::int64_t tick = 0;

 private:
  std::array<double, 2> safe_V_;
  Backend& backend_;
  LastResort last_resort_;
};

/// Limits that mean something while the encoder's zero is unknown.
Rig rig_without_zero(Rig rig) {
  rig.limits.position_margin_m = rig.axis.cylinder.stroke_m;
  rig.limits.flow_mismatch_share = rig.limits.chamber_mismatch_Pa = 0.0;
  return rig;
}

/// The command of both valves that pushes to the end.
Command pushing(const Rig& rig, const HomingSettings& settings, double t_s) {
  const double usual_V = HomingSettings::usual_share * rig.axis.valve.command_max_V;
  const double size_V = settings.command_V > 0.0 ? settings.command_V : usual_V;
  const double sign = settings.end == HomingEnd::high ? 1.0 : -1.0;
  const double u = sign * size_V * std::min(t_s / HomingSettings::ramp_s, 1.0);
  return {u, -u, true};
}

}  // namespace

ChannelZero find_home(const Rig& rig, Backend& backend, const HomingSettings& settings) {
  Supervisor supervisor;
  supervisor.configure(rig_without_zero(rig), false);
  SafeEnd run(rig, backend);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  double stands_at_m = none, before_m = none, first_m = none;
  std::int64_t stands_since = -1;
  bool home = false, moved = false;
  const bool whole = each_period(rig.period_s, settings.real_time, [&](std::int64_t tick, std::int64_t skipped) {
    run.tick = tick;
    const double t_s = static_cast<double>(tick) * rig.period_s;
    Measurement measured;
    if (!backend.read(tick, measured)) throw std::runtime_error("homing: the backend ended");
    const JudgedInputs in = supervisor.judge(measured, skipped);
    // A dead stop is what is looked for.
    const std::uint64_t faults = supervisor.faults() & ~std::uint64_t{fault_position_frozen};
    if (faults != 0) throw std::runtime_error("homing: " + fault_words(faults, faults).front());
    if (!std::isfinite(in.position_m)) return !run.write_safe();
    if (stands_since < 0 || std::fabs(in.position_m - stands_at_m) > HomingSettings::standing_m)
      stands_at_m = in.position_m, stands_since = tick;
    const double period_s = rig.period_s * static_cast<double>(skipped + 1);
    if (std::fabs(in.position_m - before_m) > rig.limits.speed_mps.value_or(HomingSettings::fastest_mps) * period_s)
      throw std::runtime_error("homing: the slider is faster than limits.speed_mps: give a smaller command");
    before_m = in.position_m;
    if (std::isnan(first_m)) first_m = in.position_m;
    moved = moved || std::fabs(in.position_m - first_m) > HomingSettings::standing_m;
    home = static_cast<double>(tick - stands_since) * rig.period_s >= HomingSettings::standing_s &&
           t_s > HomingSettings::ramp_s + HomingSettings::standing_s;
    if (home && !moved)
      throw std::runtime_error(
          "homing: the slider did not move: check air and valve, give a larger command, or move it off the stop");
    if (home) return true;
    if (t_s > settings.timeout_s)
      throw std::runtime_error(fmt::format("homing: the slider did not come to rest within {:g} s: give a larger "
                                           "command, check air and valve",
                                           settings.timeout_s));
    const Command command = pushing(rig, settings, t_s);
    supervisor.note_commands({command.valve_V, command.valve_2_V});
    if (!backend.write(tick, command)) throw std::runtime_error("homing: the command could not be written");
    return false;
  });
  if (!whole || !home) throw std::runtime_error("homing: stopped before the end was found");
  const bool high = settings.end == HomingEnd::high;
  const double end_m = (high ? 0.5 : -0.5) * rig.axis.cylinder.stroke_m;
  return {"x", end_m - stands_at_m, fmt::format("{} end at {:.6g} m", high ? "high" : "low", stands_at_m)};
}

std::vector<ChannelZero> find_pressure_zeros(const Rig& rig, Backend& backend, double duration_s, bool real_time) {
  SafeEnd run(rig, backend);
  std::array<double, 6> sum{};
  std::array<std::int64_t, 6> count{};
  const auto ticks = std::max<std::int64_t>(std::llround(duration_s / rig.period_s), 1);
  const bool whole = each_period(rig.period_s, real_time, [&](std::int64_t tick, std::int64_t) {
    run.tick = tick;
    Measurement measured;
    if (!backend.read(tick, measured)) throw std::runtime_error("zeroing: the backend ended");
    const auto channels = channels_of(measured);
    for (std::size_t i = 1; i < channels.size(); ++i)
      if (channels[i]->valid && std::isfinite(channels[i]->value)) sum[i] += channels[i]->value, ++count[i];
    if (!run.write_safe()) throw std::runtime_error("zeroing: the safe output could not be written");
    return tick + 1 >= ticks;
  });
  if (!whole) throw std::runtime_error("zeroing: stopped before its end");
  std::vector<ChannelZero> zeros;
  const double atmosphere_Pa = rig.axis.air.atmosphere_Pa;
  const auto origins = backend.origins().channels;
  for (std::size_t i = 1; i < origins.size(); ++i) {
    if (origins[i] == Origin::absent) continue;
    const std::string name(channel_names[i]);
    if (count[i] == 0) throw std::runtime_error(fmt::format("zeroing: {} gave no value", name));
    const double mean_Pa = sum[i] / static_cast<double>(count[i]);
    const bool absolute = std::fabs(mean_Pa - atmosphere_Pa) <= sensor_tolerance_Pa,
               gauge = std::fabs(mean_Pa) <= sensor_tolerance_Pa;
    if (!absolute && !gauge)
      throw std::runtime_error(
          fmt::format("zeroing: {} shows {:.6g} Pa, expected {:.6g} (absolute) or 0 (gauge) within "
                      "{:g}: vent the lines, check the sensor's scale",
                      name, mean_Pa, atmosphere_Pa, sensor_tolerance_Pa));
    zeros.push_back({name, atmosphere_Pa - mean_Pa, absolute ? "absolute" : "gauge"});
  }
  return zeros;
}

}  // namespace pneuservo
