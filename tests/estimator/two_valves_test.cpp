// The flow correction knows what each of two valves was given.
#include <catch2/catch.hpp>

#include <cmath>

#include <pneuservo/estimator/pipeline_estimator.hpp>

using namespace pneuservo;

namespace {

/// Both sides are alike, so that equal commands at equal ports make equal chambers.
EstimatorParameters alike() {
  EstimatorParameters p;
  p.line_1.length_m = p.line_2.length_m = 2.0;
  p.line_1.diameter_m = p.line_2.diameter_m = 0.004;
  p.cylinder.stroke_m = 0.1;
  p.cylinder.area_1_m2 = p.cylinder.area_2_m2 = 1e-3;
  p.cylinder.dead_volume_1_m3 = p.cylinder.dead_volume_2_m3 = 2e-5;
  p.supply_pressure_Pa = 7e5;
  p.valve.command_max_V = 5.0;
  p.valve.area_per_volt_m2_per_V = 1e-6;
  p.valve.area_max_m2 = 5e-6;
  p.arrangement = ValveArrangement::three_port_pair;
  p.flow_correction = 0.3;
  return p;
}

EstimatorOutput after(double first_V, double second_V) {
  PipelineEstimator estimator;
  estimator.configure(alike());
  EstimatorOutput out;
  for (int k = 0; k < 400; ++k) {
    const double port_Pa = 4e5 + 2e4 * std::sin(0.05 * k);
    out = estimator.step({port_Pa, port_Pa, 0.0, 0.0, first_V, second_V});
  }
  return out;
}

}  // namespace

TEST_CASE("two valves with one command have alike sides, with opposite commands they have not") {
  const EstimatorOutput alike_ones = after(1.0, 1.0), opposite = after(1.0, -1.0);
  CHECK(alike_ones.chamber_pressure_Pa[0] == alike_ones.chamber_pressure_Pa[1]);
  CHECK(opposite.chamber_pressure_Pa[0] != opposite.chamber_pressure_Pa[1]);
  CHECK(opposite.chamber_pressure_Pa[0] == alike_ones.chamber_pressure_Pa[0]);
}

TEST_CASE("a command alone is that of one valve for both sides") {
  const EstimatorOutput one = after(1.0, std::nan("")), opposite = after(1.0, -1.0);
  CHECK(one.chamber_pressure_Pa[1] == opposite.chamber_pressure_Pa[1]);
}
