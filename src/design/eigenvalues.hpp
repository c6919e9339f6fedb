// Eigenvalues of a real matrix; the one place that compiles the solver, which takes longer than all that uses it.
#pragma once
#include <Eigen/Core>

namespace pneuservo {

/// In no order. Scale the matrix so that rows and columns have like norms: poles near each other come out to more
/// digits.
Eigen::VectorXcd unsorted_eigenvalues(const Eigen::MatrixXd& A);

}  // namespace pneuservo
