// The simulated valve's own drive: the lag that is asked for, and the same table behind it.
#include <catch2/catch.hpp>

#include <cmath>

#include <pneuservo/rig/valve_drive.hpp>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "hal/can_bench.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

const std::string table = PNEUSERVO_SOURCE_DIR "/config/servo-table-0.5m-4mm.yaml";

/// Where the table is after each of 400 periods under a command that swings both valves.
std::vector<double> positions_m(const std::vector<std::string>& sets) {
  SimBackend backend(read_rig(table, sets));
  backend.configure();
  std::vector<double> out;
  Measurement measured;
  for (int tick = 0; tick < 400; ++tick) {
    backend.read(tick, measured);
    out.push_back(backend.truth().x_m);
    const double command_V = 0.3 * std::sin(2.0 * 3.141592653589793 * 10.0 * tick * 2e-4);
    backend.write(tick, {command_V, -command_V});
  }
  return out;
}

}  // namespace

TEST_CASE("a valve's drive follows a step as the lag of 2.17 does, one and a half ticks late") {
  ValveDrive drive;
  ValveDriveParameters parameters;
  parameters.loop.natural_frequency_Hz = 100.0;
  parameters.loop.damping_ratio = 0.7;
  drive.configure(parameters);
  const double w = 2.0 * 3.141592653589793 * 100.0, zeta = 0.7, wd = w * std::sqrt(1.0 - zeta * zeta);
  double worst = 0.0;
  for (int tick = 0; tick < 400; ++tick) {
    // Its mean over the tick stands for the middle of it; its command acts a tick later.
    const double t = (tick - 0.5) * 1e-4,
                 lag = t <= 0.0 ? 0.0
                                : 1.0 - std::exp(-zeta * w * t) * (std::cos(wd * t) + zeta * w / wd * std::sin(wd * t));
    worst = std::max(worst, std::fabs(drive.step(0.5) / 0.5 - lag));
  }
  CHECK(worst < 0.005);
}

TEST_CASE("a table behind valves with their own loop moves as behind the lag, a tick later") {
  const auto lag = positions_m({}), own = positions_m({"simulation.valve_drive_period_s=1e-4"}),
             late = positions_m({"concealed.command_delay.delay_s=1e-4"});
  double moved_m = 0.0, from_lag_m = 0.0, from_late_m = 0.0;
  for (std::size_t i = 0; i < lag.size(); ++i) {
    moved_m = std::max(moved_m, std::fabs(lag[i] - lag[0]));
    from_lag_m = std::max(from_lag_m, std::fabs(own[i] - lag[i]));
    from_late_m = std::max(from_late_m, std::fabs(own[i] - late[i]));
  }
  CAPTURE(moved_m, from_lag_m, from_late_m);
  CHECK(moved_m > 1e-4);
  CHECK(from_late_m < 2e-3 * moved_m);
  CHECK(from_late_m < 0.5 * from_lag_m);
}

TEST_CASE("the device's valve has a loop of its own: the axis over the bus follows as behind the lag") {
  const std::vector<std::string> lag{"duration_s=2", "valve.natural_frequency_Hz=100"};
  std::vector<std::string> own = lag;
  own.push_back("simulation.valve_drive_period_s=1e-4");
  Bench behind_lag(lag), behind_drive(own);
  double moved_m = 0.0, apart_m = 0.0;
  for (int i = 0; i < 2000; ++i) {
    behind_lag.step();
    behind_drive.step();
    moved_m = std::max(moved_m, std::fabs(behind_drive.device.truth().x_m));
    apart_m = std::max(apart_m, std::fabs(behind_drive.device.truth().x_m - behind_lag.device.truth().x_m));
  }
  CAPTURE(moved_m, apart_m);
  CHECK(behind_drive.loop.faults() == 0);
  CHECK(moved_m > 0.05);
  CHECK(apart_m > 0.0);
  CHECK(apart_m < 0.01 * moved_m);
}

TEST_CASE("a drive whose loop cannot be made is refused") {
  CHECK_THROWS_WITH(read_rig(table, {"simulation.valve_drive_period_s=3e-4"}),
                    Catch::Contains("a whole part of period_s"));
  CHECK_THROWS_WITH(read_rig(table, {"simulation.valve_drive_period_s=1e-4", "valve.natural_frequency_Hz=20"}),
                    Catch::Contains("50 to 300 Hz"));
}
