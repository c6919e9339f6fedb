// Sensors whose gain and offset are known: the loop works with what they have seen, the recording keeps what they show.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <pneuservo/loop/sensor_correction.hpp>

#include "loop/loop_rigs.hpp"
#include "loop/recorded_run.hpp"
#include "record/files.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

struct DrivenAxis {
  std::vector<Row> rows;
  double position_error_m = 0.0;  ///< largest, true, in the second half
  double estimation_error_Pa = 0.0;  ///< rms of chamber 1, in the second half
  std::uint64_t faults = 0;
};

/// The config's run under its own supervision.
DrivenAxis course(const Rig& rig, const std::string& path = TemporaryFolder().file("run.csv.gz")) {
  SimBackend backend(rig);
  DrivenAxis out;
  out.rows = recorded_run(rig, backend, path);
  const std::size_t half = out.rows.size() / 2;
  double squares = 0.0;
  for (std::size_t i = half; i < out.rows.size(); ++i) {
    const Row& row = out.rows[i];
    out.position_error_m = std::max(out.position_error_m, std::fabs(row.x_ref_m - row.x_true_m));
    squares += std::pow(row.p1_estimated_Pa - row.p1_chamber_true_Pa, 2);
  }
  out.estimation_error_Pa = std::sqrt(squares / static_cast<double>(out.rows.size() - half));
  out.faults = out.rows.back().fault;
  return out;
}

Rig sine_rig(const std::string& feedforward, const std::string& known) {
  return config_rig("cylinder-2m-6.10mm",
                    {"duration_s=2", "controller.flow_feedforward=" + feedforward, "effects=" + known});
}

const std::vector<std::string> wrong_sensors{"{'sensor_offset:p1_port': {offset: 20000}}",
                                             "{'sensor_gain:p1_port': {gain: 1.02}}",
                                             "{'sensor_gain:x': {gain: 1.01}, 'sensor_offset:x': {offset: 0.001}}",
                                             "{'sensor_offset:p_supply': {offset: -20000}}"};

}  // namespace

TEST_CASE("an axis whose sensors are known to be wrong is as exact as one whose sensors are right") {
  for (const char* feedforward : {"formula", "pass"}) {
    const DrivenAxis right = course(sine_rig(feedforward, "{}"));
    for (const std::string& known : wrong_sensors) {
      CAPTURE(feedforward, known);
      const DrivenAxis wrong = course(sine_rig(feedforward, known));
      CAPTURE(right.position_error_m, wrong.position_error_m);
      CHECK(wrong.faults == 0);
      CHECK(wrong.position_error_m < 1.1 * right.position_error_m + 1e-5);
      CHECK(wrong.estimation_error_Pa < 1.1 * right.estimation_error_Pa + 10.0);
    }
  }
}

TEST_CASE("a recording keeps what wrong sensors show and replays bit for bit") {
  const TemporaryFolder folder;
  const std::string path = folder.file("wrong.csv.gz");
  const Rig rig = sine_rig("formula", "{'sensor_offset:p1_port': {offset: 20000}, 'sensor_gain:x': {gain: 1.01}}");
  const DrivenAxis recorded = course(rig, path);
  CHECK(recorded.rows.front().measured[Signal::p1_port] == Approx(rig.initial.pressure_1_Pa + 20e3).margin(2e3));
  const Row& last = recorded.rows.back();
  CHECK(last.measured[Signal::x] == Approx(1.01 * last.x_true_m).margin(1e-5));
  const ReplayResult again = replayed(rig, read_recording(path));
  CHECK(again.compared_rows == recorded.rows.size());
  CHECK(again.identical());
}

TEST_CASE("the prediction of a wrong sensor's axis is that of a right one") {
  const DrivenAxis right = course(sine_rig("formula", "{}")), wrong = course(sine_rig("formula", wrong_sensors[0]));
  for (std::size_t i = 0; i < right.rows.size(); i += 100)
    CHECK(wrong.rows[i].x_predicted_m == Approx(right.rows[i].x_predicted_m).margin(2e-5));
}

TEST_CASE("a correction turns gain and offset round and leaves what it does not know") {
  Rig rig = config_rig("cylinder-2m-6.10mm");
  SensorCorrection none;
  none.configure(rig);
  CHECK_FALSE(none.corrects());
  rig.sensor_effects[Signal::x].sensor_lag.time_constant_s = 0.01;
  none.configure(rig);
  CHECK_FALSE(none.corrects());
  SensorEffects<double>& port = rig.sensor_effects[Signal::p1_port];
  port.sensor_gain.gain = 0.5;
  port.sensor_offset.offset = 1e3;
  rig.sensor_effects[Signal::p2_port].sensor_gain.gain = 0.0;
  SensorCorrection some;
  some.configure(rig);
  CHECK(some.corrects());
  CHECK(some.of(Signal::p1_port, 251e3) == 500e3);
  CHECK(some.noise_factor(Signal::p1_port) == 2.0);
  CHECK(some.of(Signal::p2_port, 251e3) == 251e3);
  CHECK(some.noise_factor(Signal::p2_port) == 1.0);
  CHECK(some.of(Signal::x, 0.01) == 0.01);
  CHECK(std::isnan(some.of(Signal::p1_port, std::numeric_limits<double>::quiet_NaN())));
  const SensorEffects<double> left = behind_correction(rig.sensor_effects[Signal::p1_port]);
  CHECK(left.sensor_gain.gain == 1.0);
  CHECK(left.sensor_offset.offset == 0.0);
  CHECK(behind_correction(rig.sensor_effects[Signal::p2_port]).sensor_gain.gain == 0.0);
  CHECK(behind_correction(rig.sensor_effects[Signal::x]).sensor_lag.time_constant_s == 0.01);
}

TEST_CASE("a differential sensor's end of range is judged as it shows it") {
  const Rig rig =
      config_rig("cylinder-2m-6.10mm", {"sensors.differential_pressure={quantum_Pa: 0, noise_Pa: 0, range_Pa: 100000}",
                                        "effects={'sensor_gain:dp1': {gain: 0.5}, 'sensor_gain:dp2': {gain: 2}}"});
  Supervisor supervisor;
  supervisor.configure(rig, false);
  Measurement measured;
  for (const Signal signal : channel_signals) measured.channel[signal] = {600e3, 0.0, true, Origin::simulated};
  measured.channel[Signal::x].value = 0.0;
  measured.channel[Signal::dp1].value = 90e3;
  measured.channel[Signal::dp2].value = 100e3;
  const JudgedInputs in = supervisor.judge(measured, 0);
  CHECK(supervisor.faults() == 0);
  CHECK(in.loss_Pa[0] == 180e3);
  CHECK(std::isnan(in.loss_Pa[1]));
}
