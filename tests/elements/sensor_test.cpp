// Sensor: order of lag, gain, offset, noise and quantum; exact lag; independent, repeatable noise.
#include <catch2/catch.hpp>

#include <pneuservo/elements/sensor.hpp>

using namespace pneuservo;

namespace {
Sensor make_sensor(const SensorEffects<double>& effects, double quantum, double noise, std::uint64_t stream = 0) {
  Sensor sensor;
  sensor.configure(effects, quantum, noise, 1e-3, Random(42, stream));
  return sensor;
}
}  // namespace

TEST_CASE("sensor: a perfect one reads the value itself") {
  Sensor sensor = make_sensor({}, 0.0, 0.0);
  for (const double x : {0.0, -1.25, 470123.456}) CHECK(sensor.read(x) == x);
}

TEST_CASE("sensor: gain before offset before quantum") {
  SensorEffects<double> e;
  e.sensor_gain.gain = 2.0;
  e.sensor_offset.offset = 0.26;
  Sensor sensor = make_sensor(e, 0.5, 0.0);
  CHECK(sensor.read(1.0) == 2.5);   // 2.26
  CHECK(sensor.read(-1.0) == -1.5); // -1.74
  CHECK(sensor.read(1.5) == 3.5);   // 3.26
}

TEST_CASE("sensor: the lag is exact for a ramp between samples, whatever the period") {
  for (const double period : {1e-4, 1e-3, 1e-2}) {
    SensorLagFilter lag;
    lag.configure(0.005, period);
    lag.reset(0.0);
    for (int k = 1; k <= 50; ++k) {
      const double t = k * period;
      CHECK(lag.step(t) == Approx(t - 0.005 * (1.0 - std::exp(-t / 0.005))).margin(1e-14));
    }
  }
}

TEST_CASE("sensor: noise repeats with the seed and differs between the channels") {
  Sensor a = make_sensor({}, 0.0, 1.0, 0), b = make_sensor({}, 0.0, 1.0, 0), c = make_sensor({}, 0.0, 1.0, 1);
  double same = 0.0, other = 0.0;
  for (int k = 0; k < 100; ++k) {
    const double x = a.read(0.0);
    same += std::fabs(x - b.read(0.0));
    other += std::fabs(x - c.read(0.0));
  }
  CHECK(same == 0.0);
  CHECK(other > 10.0);
}
