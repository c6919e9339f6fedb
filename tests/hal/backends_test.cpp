// Backends: the simulated plant repeats itself from its seed and passes skipped slots; replay gives what was recorded.
#include <catch2/catch.hpp>

#include <cmath>

#include <pneuservo/loop/fault.hpp>

#include "backends.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "record/files.hpp"
#include "replay/replay_backend.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

namespace {

Rig a_rig(const std::vector<std::string>& sets = {}) {
  return read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/cylinder-2m-6.10mm.yaml", sets);
}

SimBackend sim(const Rig& rig) {
  SimBackend backend(rig);
  backend.configure();
  backend.activate();
  return backend;
}

/// Port 1 over ticks [0, n) with a command of 1 V.
std::vector<double> port_1(SimBackend backend, int n) {
  std::vector<double> values;
  for (int tick = 0; tick < n; ++tick) {
    Measurement m;
    backend.read(tick, m);
    backend.write(tick, {1.0});
    values.push_back(m.channel[Signal::p1_port].value);
  }
  return values;
}

}  // namespace

TEST_CASE("sim: the same seed gives the same noise, another one another") {
  REQUIRE(port_1(sim(a_rig()), 200) == port_1(sim(a_rig()), 200));
  REQUIRE(port_1(sim(a_rig()), 200) != port_1(sim(a_rig({"seed=2"})), 200));
}

TEST_CASE("sim: skipped slots pass with the last command") {
  const Rig rig = a_rig({"sensors.port_pressure.noise_Pa=0"});
  SimBackend all = sim(rig), some = sim(rig);
  Measurement a, b;
  for (int tick = 0; tick <= 50; ++tick) {
    all.read(tick, a);
    all.write(tick, {1.0});
  }
  some.read(0, b);
  some.write(0, {1.0});
  some.read(50, b);
  REQUIRE(b.channel[Signal::p1_port].value == a.channel[Signal::p1_port].value);
  REQUIRE(some.truth().x_m == all.truth().x_m);
  REQUIRE(b.channel[Signal::x].valid);
  REQUIRE(b.channel[Signal::x].origin == Origin::simulated);
}

TEST_CASE("replay: rows as they were recorded, holes are invalid, absent columns stay absent, the end is an end") {
  const TemporaryFolder folder;
  const std::string path =
      put_gzip(folder.file("r.csv.gz"), "# format: pneuservo-recording/1\n# rig: r\n# period_s: 0.001\n"
                                        "t_s,x_m,p1_port_Pa,p2_port_Pa,fault\n0,0.1,4e5,5e5,0\n0.001,,4e5,5e5,0\n"
                                        "0.004,0.2,4e5,5e5," +
                                            std::to_string(fault_output_missed) + "\n");
  ReplayBackend backend(read_recording(path), 1e-3);
  backend.configure();
  backend.activate();
  REQUIRE(backend.rows() == 3);
  Measurement m;
  REQUIRE(backend.read(0, m));
  REQUIRE((m.channel[Signal::x].valid && m.channel[Signal::x].value == 0.1));
  REQUIRE(backend.write(0, {}));
  REQUIRE(backend.read(1, m));
  REQUIRE_FALSE(m.channel[Signal::x].valid);
  REQUIRE(m.channel[Signal::p2_port].valid);
  REQUIRE(m.channel[Signal::p1_chamber].origin == Origin::absent);
  REQUIRE(backend.read(4, m));
  REQUIRE(m.channel[Signal::x].value == 0.2);
  REQUIRE_FALSE(backend.write(4, {}));  // it could not be written then either
  REQUIRE(std::isnan(backend.truth().x_m));
  REQUIRE_FALSE(backend.read(5, m));
}

TEST_CASE("replay: a recording without what the loop reads is refused") {
  const TemporaryFolder folder;
  const std::string path = put_gzip(folder.file("r.csv.gz"), "t_s,x_m\n0,0.1\n");
  REQUIRE_THROWS_WITH(ReplayBackend(read_recording(path), 1e-3), Catch::Contains("p1_port_Pa, p2_port_Pa are missing"));
}

TEST_CASE("an unknown backend is refused by name") {
  REQUIRE_THROWS_AS(make_backend("nonsense", a_rig()), InputError);
  REQUIRE_THROWS_WITH(make_backend("nonsense", a_rig()), Catch::Contains("nonsense") && Catch::Contains("sim"));
  const Rig wired = read_rig(std::string(PNEUSERVO_SOURCE_DIR) + "/config/can/cylinder-10m-7.65mm.yaml");
  for (const std::string& name : backend_names()) REQUIRE(make_backend(name, wired)->name() == name);
}

TEST_CASE("sim: the plant has the config's deviations, the config keeps what it believes") {
  const Rig believed = a_rig({"deviations.valve.area_per_volt_m2_per_V=-0.03"});
  Rig real = a_rig();
  real.axis.valve.area_per_volt_m2_per_V *= 0.97;
  CHECK(believed.axis.valve.area_per_volt_m2_per_V == a_rig().axis.valve.area_per_volt_m2_per_V);
  CHECK(port_1(sim(believed), 200) == port_1(sim(real), 200));
  CHECK(port_1(sim(believed), 200) != port_1(sim(a_rig()), 200));
}
