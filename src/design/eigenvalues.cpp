// Eigenvalues of a real matrix.
#include "design/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace pneuservo {

Eigen::VectorXcd unsorted_eigenvalues(const Eigen::MatrixXd& A) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues();
}

}  // namespace pneuservo
