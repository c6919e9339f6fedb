// A residual model whose rows are written down as a function of the rig: fits and searches with known answers.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "diagnosis/residuals/residual_model.hpp"

namespace pneuservo::test {

/// One channel, no grid and no recording: the rows of a hypothesis are `residual` of its rig, which has always as many
/// entries.
class ClosedFormModel : public ResidualModel {
 public:
  using Residual = std::function<std::vector<double>(const Rig&)>;
  /// stated: by which the channel may differ from the config.
  explicit ClosedFormModel(Residual residual, double stated = 0)
      : channels_(1), rows_(residual(Rig{}).size()), residual_(std::move(residual)) {
    channels_.front().stated = stated;
  }

  /// Rows from this one on are held out of fits.
  void hold_out_from(std::size_t first) {
    for (std::size_t i = first; i < rows_.size(); ++i) rows_[i].held_out = true;
  }

  const std::vector<ResidualChannel>& channels() const override { return channels_; }
  const std::vector<ResidualRow>& rows() const override { return rows_; }
  Eigen::MatrixXd residuals(std::span<const Hypothesis> hypotheses) override {
    const auto count = static_cast<Eigen::Index>(rows_.size());
    Eigen::MatrixXd out(count, static_cast<Eigen::Index>(hypotheses.size()));
    for (Eigen::Index i = 0; i < out.cols(); ++i) {
      const std::vector<double> column = residual_(hypotheses[static_cast<std::size_t>(i)].rig);
      out.col(i) = Eigen::Map<const Eigen::VectorXd>(column.data(), count);
    }
    return out;
  }
  std::vector<ChannelMisfit> sample_misfit(const Hypothesis&) override { return {}; }
  std::vector<ResidualCourse> courses(const Hypothesis&) override { return {}; }

 protected:
  std::vector<ResidualChannel> channels_;
  std::vector<ResidualRow> rows_;

 private:
  Residual residual_;
};

}  // namespace pneuservo::test
