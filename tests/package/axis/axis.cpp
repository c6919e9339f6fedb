// An own axis with an own reference and an own control law: rig, simulated plant and estimator are the library's.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <pneuservo/estimator/pipeline_estimator.hpp>
#include <pneuservo/loop/axis_loop.hpp>

#include "backends.hpp"
#include "config/read_rig.hpp"

using namespace pneuservo;

/// Position and speed of one smooth swing a period.
struct OwnReference {
  double amplitude_m, omega, x_m = 0, v_mps = 0;
  void at(double t_s) {
    x_m = 0.5 * amplitude_m * (1 - std::cos(omega * t_s)), v_mps = 0.5 * amplitude_m * omega * std::sin(omega * t_s);
  }
};

/// Proportional to the errors of position and speed, damped by the chambers' force, with the speed's own flow.
struct OwnLaw {
  double gain_V_per_m = 30, damping_V_per_N = 0.004, flow_V_per_mps, last_m = 0;
  double step(const OwnReference& wanted, double x_m, double force_N, double resting_N) const {
    const double u = gain_V_per_m * (wanted.x_m - x_m) + flow_V_per_mps * wanted.v_mps;
    return std::clamp(u - damping_V_per_N * (force_N - resting_N), -5.0, 5.0);
  }
};

int main(int, char** arguments) {
  const Rig rig = read_rig(arguments[1]);
  const double area_1 = rig.axis.cylinder.area_1_m2, area_2 = rig.axis.cylinder.area_2_m2;
  const auto plant = make_backend("sim", rig);
  PipelineEstimator estimator;
  estimator.configure(estimator_parameters(rig));
  OwnReference reference{0.05, std::numbers::pi};
  // Choked flow out of a chamber a volt: what the speed needs.
  const Air<double> air(rig.axis.air);
  const double speed_per_V =
      air.flow_constant * std::sqrt(air.R * air.temperature_K) * rig.axis.valve.area_per_volt_m2_per_V / area_1;
  OwnLaw law{.flow_V_per_mps = 1.0 / speed_per_V};

  plant->configure();
  plant->activate();
  double worst_m = 0, start_m = 0, v_mps = 0, last_m = 0, command_V = 0;
  for (long tick = 0; tick < std::lround(4.0 / rig.period_s); ++tick) {
    Measurement in;
    if (!plant->read(tick, in)) return 1;
    const double x_m = in.channel[Signal::x].value;
    if (tick == 0) start_m = last_m = x_m;
    v_mps += 0.2 * ((x_m - last_m) / rig.period_s - v_mps), last_m = x_m;
    const auto chambers =
        estimator.step({in.channel[Signal::p1_port].value, in.channel[Signal::p2_port].value, x_m, v_mps, command_V});
    const double force_N = area_1 * chambers.chamber_pressure_Pa[0] - area_2 * chambers.chamber_pressure_Pa[1];
    reference.at(static_cast<double>(tick) * rig.period_s);
    command_V = law.step(reference, x_m - start_m, force_N, (area_1 - area_2) * rig.axis.air.atmosphere_Pa);
    plant->write(tick, {.valve_V = command_V, .enable = true});
    worst_m = std::max(worst_m, std::fabs(reference.x_m - (plant->truth().x_m - start_m)));
  }
  plant->deactivate();
  std::printf("%.2f mm at most from a swing of %.0f mm\n", 1e3 * worst_m, 1e3 * reference.amplitude_m);
}
