// What fits see of a model.
#include "diagnosis/residuals/fitted_rows.hpp"

#include <utility>

namespace pneuservo {

FittedRows::FittedRows(ResidualModel& model, StopQuestion stop, Which which) : model_(model), stop_(std::move(stop)) {
  const std::vector<ResidualRow>& rows = model.rows();
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (which == Which::all || !rows[i].held_out) fitted_.push_back(static_cast<int>(i));
}

Eigen::MatrixXd FittedRows::operator()(const std::vector<Hypothesis>& hypotheses) {
  look();
  tried_ += hypotheses.size();
  if (hypotheses.empty()) return Eigen::MatrixXd(count(), 0);
  Eigen::MatrixXd out = of(model_.residuals(hypotheses));
  if (slow_) slow_->take_out(out);
  return out;
}

void FittedRows::take_slow_error(const Hypothesis& hypothesis) {
  std::vector<ResidualRow> rows;
  rows.reserve(fitted_.size());
  for (Eigen::Index i = 0; i < count(); ++i) rows.push_back(row(i));
  slow_ = std::make_shared<SlowErrors>(rows, model_.likeliest_slow_errors(hypothesis).of_channel);
}

}  // namespace pneuservo
