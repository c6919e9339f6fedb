// Guard program: a product of matrices of fixed size passes (clean), one of dynamic size is caught (dynamic).
#include "eigen_guard.hpp"

#include <string_view>

int main(int argc, char** argv) {
  const std::string_view name = argc > 1 ? argv[1] : "";
  const Eigen::Matrix4d fixed = Eigen::Matrix4d::Random();
  const Eigen::MatrixXd dynamic = Eigen::MatrixXd::Random(40, 40);
  double sum = 0;
  {
    const pneuservo::EigenNoAllocation guard;
    if (name == "clean") sum = (fixed * fixed).eval().sum();
    else if (name == "dynamic") sum = (dynamic * dynamic).eval().sum();
    else return 3;
  }
  std::fprintf(stderr, "nothing caught (%g)\n", sum);
  return 0;
}
