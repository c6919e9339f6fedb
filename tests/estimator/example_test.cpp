// The example in the header of the estimator, compiled and run exactly as it stands there (cmake/header_example.cmake).
#include <catch2/catch.hpp>

#include <pneuservo/estimator/pipeline_estimator.hpp>

TEST_CASE("the example of the header compiles and estimates") {
  const double p1_port_Pa = 470000.0, p2_port_Pa = 540200.0, x_m = 0.0, v_mps = 0.0;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-variable"
#include "estimator/header_example.inc"
#pragma GCC diagnostic pop
  // `parameters` and `estimator` are the example's. What it configured is what it says: 10 m lines that pass a change
  // of the port pressures on late, and entirely after some seconds.
  REQUIRE(estimator.parameters().line_2.length_m == 10.0);
  const auto step = [&] { return estimator.step({p1_port_Pa + 20e3, p2_port_Pa - 20e3, x_m, v_mps}); };
  pneuservo::EstimatorOutput output;
  for (int k = 0; k < 20; ++k) output = step();
  CHECK(output.health == 0u);
  CHECK(output.chamber_pressure_Pa[0] == Approx(p1_port_Pa).margin(200.0));  // 10 m are 29 ms of sound away
  for (int k = 0; k < 8000; ++k) output = step();
  CHECK(output.chamber_pressure_Pa[0] == Approx(p1_port_Pa + 20e3).margin(100.0));
  CHECK(output.chamber_pressure_Pa[1] == Approx(p2_port_Pa - 20e3).margin(100.0));
  CHECK(output.valid[0]);
  CHECK(output.valid[1]);
}
