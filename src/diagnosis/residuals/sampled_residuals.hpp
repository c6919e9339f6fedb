// Residuals of rigs that are simulated freely from a recording's start, on rows of any spacing.
#pragma once
#include <vector>

#include "diagnosis/residuals/residual_model.hpp"
#include "record/reader.hpp"

namespace pneuservo {

/// One recording made ready: the times of its rows and what was measured then.
struct SampledRecording {
  std::vector<double> time_s;
  std::vector<std::vector<double>> measured;  ///< by channel; NaN: no value; empty: no such column
  std::vector<double> position_m, velocity_mps, command;  ///< of the rows, for pictures; as long as time_s
  std::vector<char> held_out;
};

/// Everything but the simulation itself. Rows of residuals are means over the samples of a stretch, a thousandth of
/// the recording and at least 10 ms long.
class SampledResiduals : public ResidualModel {
 public:
  const std::vector<ResidualChannel>& channels() const override { return channels_; }
  const std::vector<ResidualRow>& rows() const override { return rows_; }
  Eigen::MatrixXd residuals(std::span<const Hypothesis> hypotheses) override;
  void set_stop(StopQuestion stop) override { stop_ = std::move(stop); }
  std::vector<ChannelMisfit> sample_misfit(const Hypothesis& hypothesis) override;
  std::vector<ResidualCourse> courses(const Hypothesis& hypothesis) override;

 protected:
  /// Readings of every channel at the recording's times. Must not depend on other calls: recordings run in parallel.
  /// Calls look() at every row.
  virtual std::vector<std::vector<double>> simulated(const Hypothesis& hypothesis, std::size_t recording) const = 0;
  /// Makes the rows; to be called once by the constructor of the model.
  void declare(std::vector<ResidualChannel> channels, std::vector<SampledRecording> recordings, int jobs);
  void look() const { look_for_stop(stop_); }
  const std::vector<SampledRecording>& recordings() const { return recordings_; }

 private:
  struct Stretch {
    std::size_t channel, recording;
    std::vector<std::size_t> samples;
  };
  std::vector<ResidualChannel> channels_;
  std::vector<SampledRecording> recordings_;
  std::vector<ResidualRow> rows_;
  std::vector<Stretch> stretches_;  ///< of each row
  int jobs_ = 1;
  StopQuestion stop_;
};

}  // namespace pneuservo
