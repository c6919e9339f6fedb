// What fits know of their residuals, of a model that is not to be asked any more.
#pragma once
#include <vector>

#include "diagnosis/residuals/residual_model.hpp"
#include "diagnosis/search/fit.hpp"

namespace pneuservo {

/// The fitted rows of another model, without its simulation: after a stop a verdict on what is there costs no run.
class KnownRows final : public ResidualModel {
 public:
  explicit KnownRows(const ResidualModel& model);

  const std::vector<ResidualChannel>& channels() const override { return channels_; }
  const std::vector<ResidualRow>& rows() const override { return rows_; }
  bool simulates() const override { return false; }
  /// These throw std::logic_error: there is nothing to simulate.
  Eigen::MatrixXd residuals(std::span<const Hypothesis>) override;
  std::vector<ChannelMisfit> sample_misfit(const Hypothesis&) override;
  std::vector<ResidualCourse> courses(const Hypothesis&) override;

 private:
  std::vector<ResidualChannel> channels_;
  std::vector<ResidualRow> rows_;
};

/// Residual at the fit over all rows of the model; of one that does not simulate, as the fit saw it last.
Eigen::VectorXd residual_at(ResidualModel& model, const Fit& fit);
/// Over samples; of a model that does not simulate over rows, which lack the noise within a bin, and held out: NaN.
std::vector<ChannelMisfit> misfit_at(ResidualModel& model, const Fit& fit);
/// What noise and the model's own error together make of that misfit, by channel [unit of the channel].
std::vector<double> floors_of_misfit(const ResidualModel& model);
/// None of a model that does not simulate.
std::vector<ResidualCourse> courses_at(ResidualModel& model, const Fit& fit);

}  // namespace pneuservo
