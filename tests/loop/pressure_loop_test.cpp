// The loop of a pressure rig on its shipped config: figures on other machines than the model, faults, replay.
#include <catch2/catch.hpp>

#include <cmath>
#include <string>
#include <vector>

#include <pneuservo/loop/fault.hpp>
#include <pneuservo/loop/pressure_loop.hpp>
#include <pneuservo/rig/possible_values.hpp>

#include "config/read_rig.hpp"
#include "loop/course.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

Rig shipped(const std::vector<std::string>& sets = {}, const std::string& name = "pressure-3m-4mm") {
  return read_rig(PNEUSERVO_SOURCE_DIR "/config/" + name + ".yaml", sets);
}

/// Rows of a run of so many seconds on the simulated plant; spoil(tick, measurement) comes between plant and loop.
template <class Spoil> std::vector<Row> run(const Rig& rig, double duration_s, Spoil&& spoil) {
  /// The simulated plant behind what a test does to its samples.
  class Spoiled final : public Backend {
   public:
    Spoiled(const Rig& machine, Spoil& change)
        : plant_(machine, SimBackend::Has::sensors_of_the_config), spoil_(change) {}
    void configure() override { plant_.configure(); }
    void activate() override { plant_.activate(); }
    bool read(std::int64_t tick, Measurement& measurement) noexcept override {
      const bool goes_on = plant_.read(tick, measurement);
      spoil_(tick, measurement, plant_);
      return goes_on;
    }
    bool write(std::int64_t tick, const Command& command) noexcept override { return plant_.write(tick, command); }
    void deactivate() noexcept override { plant_.deactivate(); }
    Truth truth() const noexcept override { return plant_.truth(); }
    Origins origins() const override { return plant_.origins(); }
    std::string name() const override { return "sim"; }

   private:
    SimBackend plant_;
    Spoil& spoil_;
  };
  Spoiled backend(rig, spoil);
  PressureLoop loop;
  loop.configure(rig);
  backend.configure();
  backend.activate();
  std::vector<Row> rows;
  for (std::int64_t tick = 0; static_cast<double>(tick) * rig.period_s < duration_s; ++tick) {
    loop.pass(backend, tick, 0, nullptr, nullptr);
    rows.push_back(loop.row());
  }
  backend.deactivate();
  return rows;
}

std::vector<Row> run(const Rig& rig, double duration_s) {
  return run(rig, duration_s, [](std::int64_t, Measurement&, SimBackend&) noexcept {});
}

/// Largest of these over all steps of the reference.
struct Figures {
  double overshoot_share = 0.0, settled_error_Pa = 0.0, estimation_error_Pa = 0.0;
  int steps = 0;
};

Figures figures_of(const std::vector<Row>& rows) {
  constexpr double settled_after_s = 1.5, estimator_settles_s = 0.1;
  Figures out;
  double from_Pa = Row::none, step_s = 0.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const Row& row = rows[i];
    if (row.p_ref_Pa != rows[i - 1].p_ref_Pa && std::isfinite(rows[i - 1].p_ref_Pa)) {
      from_Pa = rows[i - 1].p_ref_Pa;
      step_s = row.t_s;
      ++out.steps;
    }
    if (row.t_s > estimator_settles_s)
      out.estimation_error_Pa =
          std::max(out.estimation_error_Pa, std::fabs(row.p1_estimated_Pa - row.p1_chamber_true_Pa));
    if (!std::isfinite(from_Pa)) continue;
    const double beyond_Pa = row.p1_chamber_true_Pa - row.p_ref_Pa, height_Pa = row.p_ref_Pa - from_Pa;
    out.overshoot_share = std::max(out.overshoot_share, beyond_Pa / height_Pa);
    if (row.t_s > step_s + settled_after_s) out.settled_error_Pa = std::max(out.settled_error_Pa, std::fabs(beyond_Pa));
  }
  return out;
}

std::uint64_t faults_of(const std::vector<Row>& rows) { return rows.back().fault; }

}  // namespace

TEST_CASE("steps of 1 bar behind 3 m of 4 mm to 0.5 l without a far sensor, on other machines than the model") {
  // Plants of eight cells a metre, four times the estimator's; parameters at and beyond what the config's tolerances
  // say, with the sensors' noise.
  const std::vector<std::string> machines{
      "{line_1.diameter_m: -0.01, volume.volume_m3: 0.04, valve.area_per_volt_m2_per_V: -0.06, line_1.length_m: 0.01}",
      "{line_1.diameter_m: 0.01, volume.volume_m3: -0.04, valve.area_per_volt_m2_per_V: 0.06, supply.pressure_Pa: "
      "-0.01}",
      "{line_1.diameter_m: -0.01, volume.wall_heat_W_per_K: 0.5, valve.critical_pressure_ratio: 0.1, "
      "supply.pressure_Pa: 0.01}"};
  int seed = 11;
  for (const std::string& machine : machines) {
    const Rig rig = shipped({"deviations=" + machine, "simulation.cells_per_m=8", "seed=" + std::to_string(seed++)});
    INFO(machine);
    const Figures found = figures_of(run(rig, rig.duration_s));
    CHECK(found.steps == 5);
    CHECK(found.overshoot_share <= 0.03);
    CHECK(found.settled_error_Pa <= 5e3);
    CHECK(found.estimation_error_Pa <= 1e3);
  }
}

TEST_CASE("two on/off valves reach the same, on other machines than the model") {
  const std::vector<std::string> machines{
      "{line_1.diameter_m: -0.01, volume.volume_m3: 0.04, valve.area_max_m2: -0.1, line_1.length_m: 0.01}",
      "{line_1.diameter_m: 0.01, volume.volume_m3: -0.04, valve.area_max_m2: 0.1, supply.pressure_Pa: -0.01}",
      "{on_off_valves.switching_time_on_s: 0.1, on_off_valves.switching_time_off_s: -0.1, line_1.diameter_m: -0.01}"};
  int seed = 21;
  for (const std::string& machine : machines) {
    const Rig rig = shipped({"deviations=" + machine, "simulation.cells_per_m=8", "seed=" + std::to_string(seed++)},
                            "pressure-on-off-3m-4mm");
    INFO(machine);
    const std::vector<Row> rows = run(rig, rig.duration_s);
    const Figures found = figures_of(rows);
    CHECK(faults_of(rows) == 0);
    CHECK(found.steps == 5);
    CHECK(found.overshoot_share <= 0.03);
    CHECK(found.settled_error_Pa <= 5e3);
    CHECK(found.estimation_error_Pa <= 1e3);
    for (const Row& row : rows) REQUIRE((row.u_V == 0.0 || std::fabs(row.u_V) == 24.0));
  }
}

TEST_CASE("the waves of pulses need more cells than the default has") {
  const Rig rig =
      shipped({"estimator.cells_per_m=2", "simulation.cells_per_m=8", "duration_s=3"}, "pressure-on-off-3m-4mm");
  CHECK(figures_of(run(rig, rig.duration_s)).estimation_error_Pa > 1e3);
}

TEST_CASE("a volume that grows with its pressure is estimated and held, too") {
  // 0.1 l a bar: at 6 bar the volume has doubled.
  const Rig rig = shipped({"volume.compliance_m3_per_Pa=1e-9", "simulation.cells_per_m=8", "duration_s=10.9"});
  const std::vector<Row> rows = run(rig, rig.duration_s);
  CHECK(faults_of(rows) == 0);
  const Figures found = figures_of(rows);
  CHECK(found.overshoot_share <= 0.03);
  CHECK(found.estimation_error_Pa <= 1.5e3);
  CHECK(rows.back().p1_chamber_true_Pa == Approx(rows.back().p_ref_Pa).margin(5e3));
}

TEST_CASE("at rest the valve closes and the air stays") {
  const Rig rig = shipped({"reference={kind: steps, times_s: [0], pressures_Pa: [300000]}", "duration_s=3"});
  const std::vector<Row> rows = run(rig, 3.0);
  double air_kg = 0.0;
  for (const Row& row : rows) {
    CHECK(std::fabs(row.p1_chamber_true_Pa - 3e5) < 1e3);
    air_kg += row.mass_flow_1_kgps * rig.period_s;
  }
  // What flowed into the volume by the estimate is less than 0.1 % of what is in it, 1.8 g.
  CHECK(std::fabs(air_kg) < 1.8e-6);
}

TEST_CASE("the port alone leaves the drop over the hose in the pressure of the volume, which the estimate does not") {
  const std::vector<std::string> sine{
      "reference={kind: sine, amplitude_Pa: 30000, frequency_Hz: 0.5, center_Pa: 450000}",
      "initial.pressure_1_Pa=450000", "controller.rate_max_Pa_per_s=.inf", "duration_s=8",
      "sensors.chamber_pressure={quantum_Pa: 100, noise_Pa: 300}"};
  const auto error_Pa = [&](const char* source) {
    std::vector<std::string> sets = sine;
    sets.push_back(std::string("controller.pressure_source=") + source);
    const std::vector<Row> rows = run(shipped(sets), 8.0);
    CHECK(faults_of(rows) == 0);
    double square = 0.0;
    for (std::size_t i = rows.size() / 2; i < rows.size(); ++i)
      square += std::pow(rows[i].p1_chamber_true_Pa - rows[i].p_ref_Pa, 2);
    return std::sqrt(square / (0.5 * static_cast<double>(rows.size())));
  };
  const double valve = error_Pa("valve"), estimated = error_Pa("estimated"), chamber = error_Pa("chamber");
  CHECK(estimated < 0.7 * valve);
  CHECK(std::fabs(estimated - chamber) < 200.0);
}

TEST_CASE("what goes wrong with a pressure rig ends in the safe output with its reason") {
  const Rig rig = shipped();
  const std::int64_t from = 500;
  SECTION("a port sensor that is missing") {
    const auto rows = run(rig, 1.0, [&](std::int64_t tick, Measurement& m, SimBackend&) noexcept {
      if (tick >= from) m.channel[Signal::p1_port].valid = false;
    });
    CHECK(faults_of(rows) == fault_port_pressure_1_missing);
    CHECK(rows.back().u_V == 0.0);
    CHECK(rows[static_cast<std::size_t>(from)].fault != 0);
  }
  SECTION("a supply that has gone") {
    const auto rows = run(rig, 1.0, [&](std::int64_t tick, Measurement&, SimBackend& plant) noexcept {
      if (tick >= from) plant.set_machine(3e5, {0.0, 0.0});
    });
    CHECK((faults_of(rows) & fault_supply_low) != 0);
  }
  SECTION("a volume that leaks") {
    const auto rows = run(rig, 3.0, [&](std::int64_t tick, Measurement&, SimBackend& plant) noexcept {
      if (tick >= from) plant.set_machine(7e5, {1e-6, 0.0});
    });
    CHECK((faults_of(rows) & fault_flow_mismatch_1) != 0);
    CHECK((faults_of(rows) & (fault_flow_mismatch_2 | fault_chamber_mismatch_2)) == 0);
  }
  SECTION("a far sensor that is off") {
    const Rig sensed = shipped({"sensors.chamber_pressure={quantum_Pa: 100, noise_Pa: 300}"});
    const auto rows = run(sensed, 2.0, [&](std::int64_t tick, Measurement& m, SimBackend&) noexcept {
      if (tick >= from)
        m.channel[Signal::p1_chamber].value += 20e3 * std::min(1.0, static_cast<double>(tick - from) / 500.0);
    });
    CHECK(faults_of(rows) == fault_chamber_mismatch_1);
  }
  SECTION("a volume above its limit, which its port may pass") {
    // The step to 400 kPa is allowed, a plant that holds less air than the model overshoots nothing: the limit is
    // lowered by a far sensor that shows too much.
    const Rig sensed = shipped({"sensors.chamber_pressure={quantum_Pa: 100, noise_Pa: 300}",
                                "limits.pressure_Pa=601000", "limits.chamber_mismatch_Pa=0"});
    const auto rows = run(sensed, 2.0, [&](std::int64_t tick, Measurement& m, SimBackend&) noexcept {
      if (tick >= from)
        m.channel[Signal::p1_chamber].value += 400e3 * std::min(1.0, static_cast<double>(tick - from) / 500.0);
    });
    CHECK(faults_of(rows) == fault_pressure_limit);
  }
}

TEST_CASE("the reference begins with the first values, at the longest start of a run at the latest") {
  const Rig rig = shipped();
  const auto latest = std::llround(longest_start_s(rig) / rig.period_s);
  for (const std::int64_t first : {latest, latest + 1}) {
    const auto rows =
        run(rig, longest_start_s(rig) + 0.01, [&](std::int64_t tick, Measurement& m, SimBackend&) noexcept {
          if (tick < first) m.channel[Signal::p1_port].valid = false;
        });
    CAPTURE(first, latest);
    CHECK(faults_of(rows) == (first > latest ? fault_port_pressure_1_missing : 0));
    CHECK(std::isfinite(rows[static_cast<std::size_t>(latest)].p_ref_Pa) == (first == latest));
    CHECK(!std::isfinite(rows[static_cast<std::size_t>(latest) - 1].p_ref_Pa));
  }
}

TEST_CASE("the vent empties the volume after a fault, and the row tells its state") {
  const Rig rig = shipped({"safe_output.action=vent"});
  const auto rows = run(rig, 4.0, [](std::int64_t tick, Measurement& m, SimBackend&) noexcept {
    if (tick == 500) m.digital.emergency_stop.state = LineState::on;
  });
  CHECK(faults_of(rows) == fault_emergency_stop);
  CHECK(rows.back().u_V == -5.0);
  CHECK(rows.back().p1_chamber_true_Pa < 1.1e5);
  CHECK(std::isnan(rows.back().p_ref_Pa));
}

TEST_CASE("a valve whose overlap, curve and exhaust edge the config knows is held as one without") {
  const Rig rig = shipped({"effects={valve_dead_band: {width_V: 0.2}, valve_asymmetry: {exhaust_ratio: 0.6}, "
                           "valve_curve: {near_middle: -0.5, wide_open: 0.3}}",
                           "simulation.cells_per_m=8", "duration_s=4.9"});
  const std::vector<Row> rows = run(rig, rig.duration_s);
  CHECK(faults_of(rows) == 0);
  const Figures found = figures_of(rows);
  CHECK(found.steps == 2);
  CHECK(found.overshoot_share <= 0.03);
  CHECK(found.settled_error_Pa <= 5e3);
}

TEST_CASE("the limit of the volume is none of the port, and an axis has one for both") {
  const Rig rig = shipped({"limits.pressure_Pa=601000"});
  CHECK(chamber_pressure_limit_Pa(rig) == 601e3);
  CHECK(port_pressure_limit_Pa(rig) == Approx(1.4 * rig.axis.supply.pressure_Pa));
  CHECK(chamber_pressure_limit_Pa(shipped()) == port_pressure_limit_Pa(shipped()));
  const Rig axis = read_rig(PNEUSERVO_SOURCE_DIR "/config/cylinder-2m-4.15mm.yaml", {"limits.pressure_Pa=900000"});
  CHECK(port_pressure_limit_Pa(axis) == 9e5);
  CHECK(chamber_pressure_limit_Pa(axis) == 9e5);
}

TEST_CASE("a pressure rig fills no column that its recording leaves out") {
  const Row row = run(shipped(), 0.5).back();
  Row::visit(
      [](std::string_view name, const auto& value) {
        CAPTURE(name);
        if (signal_of_column(name)) return;  // recorded where there is a sensor
        if constexpr (std::is_same_v<decltype(value), const double&>)
          if (std::isfinite(value)) CHECK(is_column_of(name, true));
      },
      row);
  CHECK(is_column_of("p_ref_Pa", true));
  CHECK_FALSE(is_column_of("p_ref_Pa", false));
  CHECK_FALSE(is_column_of("x_ref_m", true));
  CHECK(is_column_of("x_ref_m", false));
  CHECK(is_column_of("t_s", true));
}
