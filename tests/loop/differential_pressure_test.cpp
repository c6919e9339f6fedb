// Differential pressure sensors over the lines: what they show, in the plant, behind their noise and range, recorded,
// replayed and in the force loop.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "loop/faulty_backend.hpp"
#include "loop/loop_rigs.hpp"
#include "loop/recorded_run.hpp"
#include "record/files.hpp"
#include "rig/nominal_axis.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

Rig sensed_rig(const std::string& name, std::vector<std::string> sets) {
  sets.insert(sets.begin(),
              {"sensors.differential_pressure={quantum_Pa: 0, noise_Pa: 100, range_Pa: 50000}", "duration_s=2.5"});
  return config_rig(name, sets);
}

std::vector<Row> rows_of(const Rig& rig) {
  const TemporaryFolder folder;
  SimBackend backend(rig, SimBackend::Has::sensors_of_the_config);
  return recorded_run(rig, backend, folder.file("run.csv.gz"));
}

/// Largest position error of the last second [m].
double largest_error_m(const std::vector<Row>& rows) {
  double largest = 0.0;
  for (const Row& row : rows)
    if (row.t_s > rows.back().t_s - 1.0) largest = std::max(largest, std::fabs(row.x_ref_m - row.x_true_m));
  return largest;
}

}  // namespace

TEST_CASE("differential pressure: at steady flow it is the loss of the friction law") {
  AxisParameters<double> axis = test::nominal_axis(10.0, 0.0061);
  axis.effects.chamber_leak_1.area_m2 = 4e-6;
  AxisPlant<double> plant;
  plant.configure(axis, 1e-3, 4.0);
  plant.reset({0.14, 4.7e5, 4.7e5});
  for (int k = 0; k < 20'000; ++k) plant.step(1.0);  // to the end stop, then what leaks away flows steadily
  const auto shown = true_values(plant);
  const Air<double> air(axis.air);
  const double out_kgps =
      orifice_mass_flow(air, axis.effects.chamber_leak_1.area_m2, axis.valve.critical_pressure_ratio,
                        shown[Signal::p1_chamber], air.temperature_K, air.atmosphere_Pa, air.temperature_K);
  const double flux = out_kgps / axis.line_1.section_m2(), D = axis.line_1.diameter_m;
  const double reynolds = flux * D / axis.air.viscosity_Pas;
  REQUIRE(reynolds > axis.line_1.turbulent_reynolds);
  const double friction = 0.3164 * std::pow(reynolds, -0.25);
  // Isothermal flow: p_1^2 - p_2^2 = lambda L/D (G/A)^2 R T.
  const double squares = friction * axis.line_1.length_m / D * flux * flux * air.R * air.temperature_K;
  const double chamber_Pa = shown[Signal::p1_chamber],
               loss_Pa = std::sqrt(chamber_Pa * chamber_Pa + squares) - chamber_Pa;
  CHECK(loss_Pa > 10e3);
  CHECK(shown[Signal::dp1] == Approx(loss_Pa).epsilon(0.03));
  CHECK(std::fabs(shown[Signal::dp2]) < 1.0);
}

TEST_CASE("differential pressure: the sensor has its own noise, offset and range, and is there where it has a range") {
  Rig rig = sensed_rig("cylinder-10m-6.10mm", {"concealed={sensor_offset:dp2: {offset: 700}}"});
  const auto channels = [](const Rig& of) {
    SimBackend backend(of, SimBackend::Has::sensors_of_the_config);
    backend.configure();
    std::vector<Measurement> out(2000);
    for (std::size_t k = 0; k < out.size(); ++k) {
      backend.write(static_cast<std::int64_t>(k), {});
      backend.read(static_cast<std::int64_t>(k), out[k]);
    }
    return out;
  };
  double sum = 0.0, squares = 0.0, other = 0.0;
  const auto rest = channels(rig);
  for (const Measurement& at : rest) {
    sum += at.channel[Signal::dp1].value, squares += std::pow(at.channel[Signal::dp1].value, 2);
    other += at.channel[Signal::dp2].value;
  }
  const auto n = static_cast<double>(rest.size());
  CHECK(std::fabs(sum / n) < 10.0);
  CHECK(std::sqrt(squares / n) == Approx(100.0).epsilon(0.06));
  CHECK(other / n == Approx(700.0).margin(10.0));
  rig.sensors.differential_pressure.range_Pa = 150.0;
  const auto clipped = channels(rig);
  const auto at_end = std::ranges::count_if(
      clipped, [](const Measurement& at) { return std::fabs(at.channel[Signal::dp1].value) == 150.0; });
  CHECK(static_cast<double>(at_end) / n == Approx(0.134).margin(0.03));  // beyond 1.5 standard deviations
  CHECK(std::ranges::all_of(clipped, [](const Measurement& at) { return at.channel[Signal::dp2].value <= 150.0; }));
  rig.sensors.differential_pressure.range_Pa = 0.0;
  for (const Measurement& at : channels(rig)) REQUIRE(at.channel[Signal::dp1].origin == Origin::absent);
}

TEST_CASE("differential pressure: recorded, read and replayed bit for bit, with a range that the flow passes") {
  const Rig rig = sensed_rig("cylinder-10m-6.10mm", {"controller.pressure_source=differential",
                                                     "sensors.differential_pressure.range_Pa=15000"});
  const TemporaryFolder folder;
  const std::string path = folder.file("run.csv.gz");
  SimBackend backend(rig, SimBackend::Has::sensors_of_the_config);
  const std::vector<Row> rows = recorded_run(rig, backend, path);
  REQUIRE(rows.back().fault == 0);
  const Recording recording = read_recording(path);
  REQUIRE(recording.has("dp1_Pa"));
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    REQUIRE(recording.column("dp1_Pa")[i] == rows[i].measured[Signal::dp1]);
    beyond += std::fabs(rows[i].measured[Signal::dp2]) >= 15000.0 ? 1 : 0;
  }
  REQUIRE(beyond > rows.size() / 20);
  REQUIRE(beyond < rows.size());
  const ReplayResult replay = replayed(rig, recording);
  CHECK(replay.rows.size() == rows.size());
  CHECK(replay.identical());
}

TEST_CASE("differential pressure: it closes the force loop as an exact chamber sensor does, without any model") {
  const auto error_m = [](std::vector<std::string> sets) {
    sets.push_back("controller.flow_feedforward=formula");
    const auto rows = rows_of(sensed_rig("cylinder-10m-6.10mm", sets));
    REQUIRE(rows.back().fault == 0);
    return largest_error_m(rows);
  };
  const double differential = error_m({"controller.pressure_source=differential"}),
               noisy = error_m({"controller.pressure_source=chamber", "sensors.chamber_pressure.noise_Pa=10000"}),
               exact = error_m({"controller.pressure_source=chamber"});
  CHECK(differential < 1.1 * exact);
  CHECK(differential < noisy);
}

TEST_CASE("differential pressure: a sensor that is missing, far off or stuck ends the run with its fault") {
  const Rig rig = sensed_rig("cylinder-10m-6.10mm", {"controller.pressure_source=differential",
                                                     "sensors.differential_pressure.range_Pa=100000"});
  // Where it shows most, so that a stuck sensor is far off half a period later.
  std::int64_t largest_at = 0;
  const auto healthy = rows_of(rig);
  for (std::int64_t tick = 1000; tick < 1900; ++tick) {
    const auto loss_Pa = [&](std::int64_t at) {
      return std::fabs(healthy[static_cast<std::size_t>(at)].measured[Signal::dp2]);
    };
    if (largest_at == 0 || loss_Pa(tick) > loss_Pa(largest_at)) largest_at = tick;
  }
  const auto first_fault = [&](Failure failure) {
    FaultyBackend backend(rig);
    AxisLoop loop;
    loop.configure(rig);
    backend.configure();
    backend.activate();
    backend.failure = failure;
    for (std::int64_t tick = 0; tick < 2400 && loop.faults() == 0; ++tick)
      loop.pass(backend, tick, 0, nullptr, nullptr);
    return loop.first_faults();
  };
  constexpr std::int64_t ever = 1'000'000;
  CHECK(first_fault({Signal::dp1, FailureMode::dropped_out, ever, 0}) == 0);
  CHECK(first_fault({Signal::dp1, FailureMode::dropped_out, 700, ever}) == fault_differential_pressure_1_missing);
  CHECK(first_fault({Signal::dp2, FailureMode::out_of_range, 700, ever}) == fault_differential_pressure_2_missing);
  CHECK(first_fault({Signal::dp1, FailureMode::jumped, 700, ever, 30e3}) == fault_chamber_mismatch_1);
  CHECK(first_fault({Signal::dp2, FailureMode::frozen, largest_at, ever}) == fault_chamber_mismatch_2);
}

TEST_CASE("differential pressure: the law is refused without such a sensor") {
  CHECK_THROWS_WITH(config_rig("cylinder-10m-6.10mm", {"controller.pressure_source=differential"}),
                    Catch::Contains("sensors.differential_pressure"));
}
