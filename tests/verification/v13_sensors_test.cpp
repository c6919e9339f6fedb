// V13: sensors: lag, gain, offset, quantisation, noise.
#include <pneuservo/elements/sensor.hpp>

#include "gas_rig.hpp"

using namespace verification;

namespace {
constexpr double period = 1e-3;
constexpr std::uint64_t seed = 20260412;

Sensor sensor_of(double quantum, double noise, double lag_s = 0.0, double gain = 1.0, double offset = 0.0,
                 std::uint64_t stream = 0, double dt = period) {
  SensorEffects<double> effects;
  effects.sensor_lag.time_constant_s = lag_s;
  effects.sensor_gain.gain = gain;
  effects.sensor_offset.offset = offset;
  Sensor sensor;
  sensor.configure(effects, quantum, noise, dt, Random(seed, stream));
  return sensor;
}

// Errors of a noisy, quantised pressure whose true value drifts so that no phase of the quantum is preferred.
std::vector<double> pressure_errors(std::uint64_t stream) {
  Sensor sensor = sensor_of(100.0, 300.0, 0.0, 1.0, 0.0, stream);
  std::vector<double> out(100000);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double truth = 470000.0 + 0.37 * static_cast<double>(k % 10000);
    out[k] = sensor.read(truth) - truth;
  }
  return out;
}
double mean(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x;
  return sum / static_cast<double>(v.size());
}
double moment(const std::vector<double>& a, const std::vector<double>& b, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = lag; i < a.size(); ++i) sum += a[i] * b[i - lag];
  return sum / static_cast<double>(a.size() - lag);
}

Answer noise_answer(const Check& check) {
  const std::vector<double> e = pressure_errors(0);
  const double variance = moment(e, e, 0);
  if (check.quantity == "rms_total") return std::sqrt(variance);
  if (check.quantity == "mean") return mean(e);
  if (check.quantity == "correlation_between_channels") {
    const std::vector<double> other = pressure_errors(1);
    return moment(e, other, 0) / std::sqrt(variance * moment(other, other, 0));
  }
  if (check.quantity == "autocorrelation_lag_1_to_5") {
    double worst = 0.0;
    for (std::size_t lag = 1; lag <= 5; ++lag)
      if (const double r = moment(e, e, lag) / variance; std::fabs(r) > std::fabs(worst)) worst = r;
    return worst;
  }
  double fourth = 0.0;
  for (const double x : e) fourth += x * x * x * x;
  return fourth / static_cast<double>(e.size()) / (variance * variance) - 3.0;  // kurtosis_excess
}

// Quantisation alone, on a slow ramp.
Answer ramp_answer(const Check& check) {
  Sensor sensor = sensor_of(5e-6, 0.0);
  double sum = 0.0, largest_error = 0.0;
  for (int k = 0; k < 100000; ++k) {
    const double truth = 0.01003 * k * period, e = sensor.read(truth) - truth;
    sum += e * e;
    largest_error = std::max(largest_error, std::fabs(e));
  }
  return check.quantity == "largest_quantisation_error" ? largest_error : std::sqrt(sum / 100000.0);
}

// Amplitude and phase of the lag for a sampled sine, by least squares after the start has died out.
Complex sine_response(double f, double tau, double dt) {
  Sensor sensor = sensor_of(0.0, 0.0, tau, 1.0, 0.0, 0, dt);
  sensor.reset(0.0);
  const long per_second = std::lround(1.0 / dt);
  Complex sum = 0.0;
  for (long k = 0; k < 2 * per_second; ++k) {
    const double t = static_cast<double>(k) * dt, y = sensor.read(std::sin(2.0 * M_PI * f * t));
    if (k >= per_second) sum += y * std::exp(Complex(0.0, -2.0 * M_PI * f * t));
  }
  return sum * 2.0 * dt / Complex(0.0, -1.0);
}

Answer sensor_answer(Resolution resolution, const Check& check) {
  const std::string& q = check.quantity;
  if (q == "quantised") {
    const double gain = check.has("gain") ? check.number("gain") : 1.0,
                 offset = check.has("offset") ? check.number("offset") : 0.0;
    return sensor_of(check.number("quantum"), 0.0, 0.0, gain, offset).read(check.number("x"));
  }
  const double dt = resolution == Resolution::normal ? period : 1e-5;
  if (q == "step_response") {
    SensorLagFilter lag;
    lag.configure(check.number("time_constant_s"), dt);
    lag.reset(0.0, 1.0);
    double y = 0.0;
    for (long k = 0; k < std::lround(check.number("t_s") / dt); ++k) y = lag.step(1.0);
    return y;
  }
  if (q == "ramp_lag") {
    Sensor sensor = sensor_of(0.0, 0.0, check.number("time_constant_s"), 1.0, 0.0, 0, dt);
    sensor.reset(0.0);
    double in = 0.0, out = 0.0;
    for (long k = 1; k <= std::lround(0.2 / dt); ++k)
      in = check.number("slope_Pa_per_s") * static_cast<double>(k) * dt, out = sensor.read(in);
    return in - out;
  }
  if (q == "sine_gain")
    return std::abs(sine_response(check.number("frequency_Hz"), check.number("time_constant_s"), dt));
  if (q == "sine_phase")
    return std::arg(sine_response(check.number("frequency_Hz"), check.number("time_constant_s"), dt)) * 180.0 / M_PI;
  if (q == "rms_quantisation_of_a_slow_ramp" || q == "largest_quantisation_error") return ramp_answer(check);
  return noise_answer(check);
}
}  // namespace

TEST_CASE("V13 sensors", "[V13]") {
  Case v13("V13");
  INFO("seed " << seed);
  for (const auto resolution : {Resolution::normal, Resolution::fine})
    v13.run(resolution, [&](const Check& check) { return sensor_answer(resolution, check); });
}
