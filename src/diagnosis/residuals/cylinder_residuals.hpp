// Residuals of a pneumatic cylinder: pressures simulated under the recorded command and motion, and the force balance
// of the slider.
#pragma once
#include <memory>
#include <vector>

#include "diagnosis/recordings/cylinder_recording.hpp"
#include "diagnosis/residuals/command_answer.hpp"
#include "diagnosis/residuals/folded_ringing.hpp"
#include "diagnosis/residuals/force_balance.hpp"
#include "diagnosis/residuals/gas_bumps.hpp"
#include "diagnosis/residuals/gas_runs.hpp"
#include "diagnosis/residuals/residual_model.hpp"

namespace pneuservo {

/// Cells times sub-steps a step and line that show a line's ringing, though not at which length. Means over 10 ms at a
/// port are 20 to 100 Pa off, for lines of 1 to 15 m, with four times as many 17 to 34 Pa.
inline constexpr double ringing_effort = 500.0;

struct CylinderResidualsSettings {
  int jobs = 2;             ///< threads; they never change a number
  double longest_s = 1e9;   ///< of each recording, at most
  StopQuestion stop;
};

/// Rows are bins of 10 ms. Pressures have the reading that the rig's sensors would give of the simulated gas; F is the
/// force that the rig's slider needs for the recorded motion, less the force of the chambers, where measured from their
/// sensors, else simulated with the port's error carried over. docs/physics/diagnosis-method.md has the method.
class CylinderResiduals final : public ResidualModel {
 public:
  /// Throws InputError where a recording cannot be compared.
  CylinderResiduals(const Rig& owner, const std::vector<Recording>& recordings,
                    const CylinderResidualsSettings& settings = {});
  ~CylinderResiduals() override;

  const std::vector<ResidualChannel>& channels() const override { return channels_; }
  const std::vector<ResidualRow>& rows() const override { return rows_; }
  std::size_t start_factor_count() const override { return 2 * recordings_.size(); }
  Eigen::MatrixXd residuals(std::span<const Hypothesis> hypotheses) override;
  void set_stop(StopQuestion stop) override {
    stop_ = std::move(stop);
    gas_->set_stop(stop_);
  }
  void set_working_point(const Hypothesis& hypothesis) override;
  LikeliestErrors likeliest_slow_errors(const Hypothesis& hypothesis) override;
  std::vector<LatentInput> latent_inputs(const Hypothesis& hypothesis) override;
  Eigen::MatrixXd unseen_commands(const Hypothesis& hypothesis) override;
  std::vector<ChannelMisfit> sample_misfit(const Hypothesis& hypothesis) override;
  std::vector<ResidualCourse> courses(const Hypothesis& hypothesis) override;

 private:
  struct Bin {
    std::size_t first = 0, count = 0;
    double values = 0;  ///< samples of it that were measured
  };
  /// One channel of one recording: its bins and where their rows stand.
  struct Stretch {
    std::size_t recording = 0, channel = 0, first_row = 0;
    std::vector<Bin> bins;
    std::vector<char> usable;  ///< samples that are compared
    std::vector<double> times_s;  ///< of the bins
    CommandAnswer answer;  ///< of a port; its rows follow the bins'
    ReadingNoise reading_noise;  ///< of a force
  };
  struct SampledCourse {
    std::vector<double> measured, simulated;
  };

  void declare_channels();
  void declare_rows();
  std::vector<PossibleRinging> ringing_of_all() const;
  /// Of every channel at the recording's samples, what commands between its rows may do [unit of the channel]; empty
  /// where they hold all of them.
  std::vector<std::vector<double>> gap_errors(std::size_t recording) const;
  void declare_answer(Stretch& stretch, const PossibleRinging& possible);
  /// What the lines' ringing may make of the mean over `count` samples [unit of the channel].
  double largest_ringing(const PossibleRinging& ringing, std::size_t recording, std::size_t channel, std::size_t first,
                         std::size_t count) const;
  /// Of the mean of `count` neighbouring forces, by the noise of the pressures [N].
  double pressure_noise(std::size_t recording, std::size_t count) const;
  void take_reading_noise(Stretch& stretch, std::size_t count) const;
  double noise_of(const Stretch& stretch, const Bin& bin) const;  ///< of a row, by its sensors [unit of the channel]
  SampledCourse course_of(const RecordedRigs& rigs, const SidedCourse& gas, const Stretch& stretch) const;
  SampledCourse force_course(const Rig& rig, const SidedCourse& gas, std::size_t recording) const;
  std::vector<double> chamber_pressure(const Rig& rig, const SidedCourse& gas, std::size_t recording,
                                       std::size_t side) const;
  LatentInput::Piece latent_piece(const BumpTimes& bumps, std::size_t recording) const;
  /// `supply_answers`: of each recording, to a supply at the valves that is higher than measured.
  void add_sensor_latents(const Eigen::VectorXd& force_answer, std::span<const Eigen::MatrixXd> supply_answers,
                          std::vector<LatentInput>& out) const;
  /// Of the rows of a channel in a recording, to what acts on them alone: each row's answer in its bump.
  Eigen::MatrixXd at_once(std::size_t channel, const Eigen::VectorXd& answers, const BumpTimes& bumps,
                          std::size_t recording) const;
  /// What changes of the gas in every bin do to the rows of a recording; `sides`: factors on what each side has
  /// changed.
  Eigen::MatrixXd answer_of_rows(const BumpResponse& gas, std::array<double, 2> sides, std::size_t recording,
                                 const Eigen::VectorXd& force_answer) const;
  Eigen::VectorXd answer_to_force(const Hypothesis& hypothesis);
  Eigen::VectorXd answer_to_readings() const;  ///< of each row, to what its sensor reads more
  std::pair<std::size_t, std::size_t> rows_of(std::size_t recording) const;  ///< first and one past the last
  using Column = std::shared_ptr<const Eigen::VectorXd>;
  /// Residual in sigmas; remembered, for fits come back to where they were.
  std::vector<Column> plain_columns(std::span<const Hypothesis> hypotheses);
  Eigen::VectorXd plain_column(const Rig& rig, const std::vector<SidedCourse>& gas) const;

  Rig owner_;
  std::vector<CylinderRecording> recordings_;
  std::vector<ForceBalance> balances_;
  std::vector<GaussianKernel> slow_kernels_;  ///< of each recording
  std::unique_ptr<GasRuns> gas_;
  int jobs_ = 1;
  StopQuestion stop_;
  std::vector<ResidualChannel> channels_;
  std::vector<Signal> signals_;  ///< of each channel
  std::vector<ResidualRow> rows_;
  std::vector<Stretch> stretches_;
  std::map<std::vector<double>, Column> known_columns_;  ///< by every number of the hypothesis
};

}  // namespace pneuservo
