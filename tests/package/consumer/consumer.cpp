// Lets the installed estimator settle at constant port pressures and prints both chamber pressures in Pa.
#include <cstdio>

#include <pneuservo/estimator/pipeline_estimator.hpp>

int main() {
  pneuservo::EstimatorParameters parameters;
  parameters.supply.pressure_Pa = 700000.0;
  parameters.line_1.length_m = parameters.line_2.length_m = 10.0;
  parameters.line_1.diameter_m = parameters.line_2.diameter_m = 0.00765;
  parameters.cylinder.stroke_m = 0.3;
  parameters.cylinder.area_1_m2 = 1.257e-3;
  parameters.cylinder.area_2_m2 = 1.056e-3;
  parameters.cylinder.dead_volume_1_m3 = parameters.cylinder.dead_volume_2_m3 = 2.0e-5;
  parameters.cylinder.wall_heat_W_per_m2K = 50.0;
  parameters.period_s = 0.001;
  parameters.cells_per_m = 1.0;

  pneuservo::PipelineEstimator estimator;
  estimator.configure(parameters);
  // The first second at other pressures, so that the result has come through the lines.
  pneuservo::EstimatorOutput output;
  for (int tick = 0; tick < 10000; ++tick) {
    const bool moved = tick >= 1000;
    output = estimator.step({moved ? 470000.0 : 400000.0, moved ? 540200.0 : 600000.0, 0.0, 0.0});
  }
  std::printf("%.1f %.1f\n", output.chamber_pressure_Pa[0], output.chamber_pressure_Pa[1]);
  return output.valid[0] && output.valid[1] ? 0 : 1;
}
