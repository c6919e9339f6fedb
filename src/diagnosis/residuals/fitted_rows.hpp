// What fits see of a model: rows that no proof is held out of, freed from the slow error that was taken last.
#pragma once
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "diagnosis/residuals/residual_model.hpp"
#include "diagnosis/residuals/slow_error.hpp"

namespace pneuservo {

/// The rows of a model that fits see, as residuals of hypotheses, in sigmas.
class FittedRows {
 public:
  enum class Which { fitted, all };  ///< all: held-out ones too
  /// stop: asked before every batch; true ends the work with DiagnosisStopped.
  FittedRows(ResidualModel& model, StopQuestion stop, Which which = Which::fitted);

  /// Residuals of the fitted rows, a column a hypothesis.
  Eigen::MatrixXd operator()(const std::vector<Hypothesis>& hypotheses);
  /// Of values for each row, those that are fitted.
  Eigen::MatrixXd of(const Eigen::MatrixXd& all) const { return all(fitted_, Eigen::all); }
  /// For what takes long between two batches; throws DiagnosisStopped.
  void look() const { look_for_stop(stop_); }
  Eigen::Index count() const { return static_cast<Eigen::Index>(fitted_.size()); }
  const ResidualRow& row(Eigen::Index i) const {
    return model_.rows()[static_cast<std::size_t>(fitted_[static_cast<std::size_t>(i)])];
  }
  ResidualModel& model() { return model_; }
  std::size_t hypotheses_tried() const { return tried_; }

  /// Takes what this hypothesis leaves for the slow error of small unmodelled physics: residuals are freed from it from
  /// now on, so that what looks like it is no evidence.
  void take_slow_error(const Hypothesis& hypothesis);
  /// Residuals are again as if there were none.
  void drop_slow_error() { slow_.reset(); }
  /// What residuals are freed from; null: nothing.
  const std::shared_ptr<const SlowErrors>& slow_error() const { return slow_; }

 private:
  ResidualModel& model_;
  StopQuestion stop_;
  std::vector<int> fitted_;
  std::shared_ptr<const SlowErrors> slow_;
  std::size_t tried_ = 0;
};

}  // namespace pneuservo
