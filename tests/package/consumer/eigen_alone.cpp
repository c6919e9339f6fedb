// One translation unit with nothing but Eigen beside the compiler; install_test.sh looks at what it includes.
#include <pneuservo/estimator/pipeline_estimator.hpp>

static_assert(noexcept(pneuservo::PipelineEstimator{}.step({0.0, 0.0, 0.0, 0.0})), "step is called in the loop");

pneuservo::EstimatorOutput one_step(pneuservo::PipelineEstimator& estimator) {
  return estimator.step({470000.0, 540200.0, 0.0, 0.0});
}
