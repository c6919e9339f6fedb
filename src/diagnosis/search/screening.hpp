// Closed-form gain of every candidate at one place: one column a start, all that is fitted anyway projected out.
#pragma once
#include <vector>

#include "diagnosis/search/candidates.hpp"
#include "diagnosis/search/fit.hpp"

namespace pneuservo {

/// What a screening says of a candidate: largest gain in chi2 over its starts, and where to start from.
struct Screened {
  std::size_t candidate = 0;
  double gain = 0;
  std::vector<double> start;           ///< z of its parameters
  std::vector<double> standard_error;  ///< of its amplitudes, in z, all else projected out
  /// The best of its other kind, by derivative or by whole change, where both promise something: their fits may end in
  /// different valleys. A branch of 241 cm3 whose derivative promised more ended at 226 cm3, 42 in log evidence behind.
  std::vector<double> second_start{};
  double second_gain = 0;
};

/// Two candidates together.
struct ScreenedPair {
  Screened first, second;
  double gain = 0;
};

/// Parameters of a screening's base that stand at a bound and push against it.
enum class AtBound {
  held,  ///< they stay there: what the rows say now
  follows  ///< they follow a candidate as all others do: what rows with that candidate in them may say
};

/// All candidates at one linearised fit: a batch of hypotheses once, then closed forms. What is fitted anyway follows
/// each candidate.
class Screening {
 public:
  /// `rows`, `base` and `candidates` must outlive this. Throws DiagnosisStopped, as do singles and best_pairs.
  Screening(FittedRows& rows, const Fit& base, const std::vector<Candidate>& candidates,
            const std::vector<std::size_t>& chosen, AtBound at_bound = AtBound::held);

  /// Every chosen candidate alone, in their order.
  std::vector<Screened> singles() const;
  /// The pairs that gain most, each two candidates once. Greedy search misses a pair when its better half looks like
  /// something else as long as the other half is missing.
  std::vector<ScreenedPair> best_pairs(std::size_t count) const;

 private:
  /// A start of a candidate: its columns are changes of the residual by one amplitude each, or one by the whole effect
  /// where it has no amplitude or is looked at whole.
  struct Trial {
    std::size_t candidate;
    std::vector<double> z;  ///< of the candidate's parameters; amplitudes that have a column as they are at the base
    std::vector<std::size_t> amplitudes;  ///< parameters that have a column; empty: the whole effect is one
    std::vector<double> steps;
    std::vector<Eigen::Index> hypotheses;  ///< of each column in the batch; -1: from the base's Jacobian
    bool is_whole = false;  ///< one of the candidate's whole changes
    Eigen::Index first_column = 0;
    bool usable = true;
  };
  void collect(const Hypothesis& here, const Candidate& candidate, std::size_t index,
               std::vector<Hypothesis>& hypotheses);
  void fill_columns(const Eigen::MatrixXd& batch);
  void add_bounds(const Trial& trial, Eigen::Index at, Eigen::VectorXd& lower, Eigen::VectorXd& upper,
                  Eigen::MatrixXd& a, Eigen::VectorXd& b) const;
  Screened single(const Trial& trial) const;
  Screened with_amplitudes(const Trial& trial, const Eigen::VectorXd& amplitude, const Eigen::VectorXd& error) const;
  int column_of_path(const std::string& path) const;

  /// left'right, with a look for a stop between blocks of columns.
  Eigen::MatrixXd product(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right) const;

  const FittedRows& rows_;
  const Fit& base_;
  const std::vector<Candidate>& candidates_;
  std::vector<Trial> trials_;
  Eigen::MatrixXd free_jacobian_;  ///< of the base; columns of parameters held at a bound are 0
  Eigen::MatrixXd columns_;  ///< of all trials
  Eigen::MatrixXd curvature_;  ///< columns'columns, the base's own parameters projected out
  Eigen::VectorXd gradient_;  ///< the same of columns'residual
};

}  // namespace pneuservo
