// The next experiment: what an added recording tells beside those that are there, against one solution of all rows.
#include <catch2/catch.hpp>

#include <Eigen/Cholesky>

#include "diagnosis/verdict/next_experiment.hpp"

using namespace pneuservo;

namespace {

FreeParameter named(const char* path) {
  FreeParameter parameter;
  parameter.path = path;
  return parameter;
}

/// Rows linear in two shared parameters and one of a recording's own start.
Fit linear_fit(std::vector<FreeParameter> parameters, int rows, unsigned seed) {
  std::srand(seed);
  Fit fit;
  fit.parameters = std::move(parameters);
  const auto count = static_cast<Eigen::Index>(fit.parameters.size());
  fit.jacobian = 3.0 * Eigen::MatrixXd::Random(rows, count);
  fit.residual = Eigen::VectorXd::Random(rows);
  fit.z.setZero(count);
  return fit;
}

/// Moves a linear fit to its minimum.
void to_minimum(Fit& fit) {
  const Eigen::MatrixXd h =
      fit.jacobian.transpose() * fit.jacobian + Eigen::MatrixXd::Identity(fit.z.size(), fit.z.size());
  const Eigen::VectorXd step = -h.ldlt().solve(fit.jacobian.transpose() * fit.residual + fit.z);
  fit.z += step;
  fit.residual += fit.jacobian * step;
}

double objective(const Fit& fit) { return fit.residual.squaredNorm() + fit.z.squaredNorm(); }

}  // namespace

TEST_CASE("an added recording beside the others leaves what one solution of all rows leaves") {
  // Columns: before: mass, area, start of the first. Added: area, mass (another order), start of the second.
  Fit before = linear_fit({named("slider.mass_kg"), named("valve.area_max_m2"), named("")}, 7, 1);
  to_minimum(before);
  Fit added = linear_fit({named("valve.area_max_m2"), named("slider.mass_kg"), named("")}, 5, 2);
  added.z(0) = before.z(1);
  added.z(1) = before.z(0);

  Fit all = before;  // mass, area, start of the first, start of the second
  all.parameters.push_back(named(""));
  all.jacobian.setZero(12, 4);
  all.jacobian.topLeftCorner(7, 3) = before.jacobian;
  all.jacobian.block(7, 0, 5, 1) = added.jacobian.col(1);
  all.jacobian.block(7, 1, 5, 1) = added.jacobian.col(0);
  all.jacobian.block(7, 3, 5, 1) = added.jacobian.col(2);
  all.residual.resize(12);
  all.residual << before.residual, added.residual;
  all.z.setZero(4);
  all.z.head(3) = before.z;
  to_minimum(all);

  CHECK(refitted_misfit(added, before) == Approx(objective(all) - objective(before)).epsilon(1e-10));
}

TEST_CASE("what only the earlier recordings leave free gives way") {
  // The earlier recording cannot tell mass from payload; the added one, which knows no payload, moves the mass at ease.
  Fit before = linear_fit({named("slider.mass_kg"), named("slider.payload_kg")}, 1, 1);
  before.jacobian << 100.0, -100.0;
  before.residual << 0.0;
  Fit added = linear_fit({named("slider.mass_kg")}, 1, 1);
  added.jacobian << 10.0;
  added.residual << 1.0;
  // Both move together by d: priors 2 d^2 beside (1 + 10 d)^2.
  CHECK(refitted_misfit(added, before) == Approx(1.0 - 100.0 / 102.0).epsilon(1e-3));
}
