// Evidence for a free function of time at one element, in the currency of the names: linear about a fit.
#pragma once
#include <vector>

#include <Eigen/Core>

#include "diagnosis/search/fit.hpp"

namespace pneuservo {

/// A free function's likeliest level and memory, and what it is worth.
struct LatentFit {
  double log_evidence = -1e300;
  double level = 0;     ///< standard deviation [unit of the input]
  double memory_s = 0;  ///< of the process (Matern 1/2)
  double upper_level = 0;  ///< below it with 95 %, where every level was as likely before
};

/// Where a free function stands, with its standard deviation, at each of its times.
struct LatentCourse {
  int recording = 0;
  std::vector<double> time_s, mean, deviation;
};

/// Residuals about a fit are r + H d + J w: d moves the fit's parameters, whose priors are normal, w is the free
/// function, a Gaussian process; white noise of standard deviation 1. d and w are integrated out. Rows that are held
/// out, or over a whole recording, do not count.
class LatentEvidence {
 public:
  /// The fit has its residual and Jacobian over the fitted rows of the model.
  LatentEvidence(const std::vector<ResidualRow>& rows, const Fit& fit);

  /// Log evidence without a free function.
  double without() const { return without_; }
  /// The likeliest level and memory of this input.
  LatentFit of(const LatentInput& input) const;
  /// Where the fit's parameters stand beside the input.
  Eigen::VectorXd parameters_beside(const LatentInput& input, const LatentFit& fit) const;
  /// The posterior of the input at the level and the memory that it was fitted with.
  std::vector<LatentCourse> course(const LatentInput& input, const LatentFit& fit) const;

 private:
  struct Solved {  ///< of one piece at one memory
    Eigen::VectorXd eigenvalue, along;  ///< of J'J in units of the process; J'r
    Eigen::MatrixXd beside;             ///< J'H
    Eigen::MatrixXd back;               ///< from there to the function
  };
  struct Gram {  ///< of one piece
    Eigen::MatrixXd own, beside;
    Eigen::VectorXd along;
  };
  std::vector<Gram> grams_of(const LatentInput& input) const;
  /// Normal equations of the parameters, the function integrated out.
  struct Normal {
    Eigen::MatrixXd curvature;
    Eigen::VectorXd gradient;
    double squares = 0, log_determinant = 0;  ///< of the function alone
    double log_evidence() const;
    Eigen::VectorXd moved() const;  ///< where the parameters go
  };
  static Solved solved(const Gram& gram, const std::vector<double>& time_s, double memory_s);
  static std::vector<Solved> solved_of(const LatentInput& input, const std::vector<Gram>& grams, double memory_s);
  Normal beside(const std::vector<Solved>& pieces, double level) const;
  LatentFit of_pieces(const LatentInput& input) const;
  LatentFit of_own(const LatentInput& input) const;
  struct Others {  ///< normal equations of the rows that do not answer to an input, and those that do
    Normal normal;
    std::vector<Eigen::Index> answering;
  };
  Others others_of(const LatentInput& input) const;
  Normal beside_own(const LatentInput& input, const Others& others, double level, double memory_s) const;
  std::vector<LatentCourse> course_of_pieces(const LatentInput& input, const LatentFit& fit) const;
  std::vector<LatentCourse> course_of_own(const LatentInput& input, const LatentFit& fit) const;

  const std::vector<ResidualRow>& rows_;
  std::vector<Eigen::Index> used_;  ///< rows that count
  Eigen::VectorXd residual_;        ///< of all rows; 0 where they do not count
  Eigen::MatrixXd jacobian_;
  Eigen::VectorXd z_;
  Normal alone_;
  double without_ = 0;
};

}  // namespace pneuservo
