// What a diagnosis infers from: residuals of any number of explanations of the same recordings, each in its noise
// floor.
#pragma once
#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <pneuservo/rig/rig.hpp>

#include "diagnosis/residuals/slow_error.hpp"
#include "diagnosis/stop.hpp"

namespace pneuservo {

/// One explanation to be tried: the rig with physics and parameters as supposed, and the gas at each recording's start.
struct Hypothesis {
  Rig rig;
  /// What no pressure tells of the gas at a recording's start, relative to what is supposed, minus 1, side 1 and 2 of
  /// each recording: a cylinder's temperature, a vessel's pressure, or that of the supply that fills it. Empty:
  /// neutral.
  std::vector<double> start_factors;
  /// Of a cylinder: how its supply's pressure swings beside its mean, at one frequency in all recordings, by the parts
  /// of sine and cosine in each, from the recording's start [Pa]. Empty: as the rig has it.
  std::vector<double> swing_Pa{};
  double swing_Hz = 0;
};

/// One compared quantity.
struct ResidualChannel {
  std::string name;  ///< p1_port, p2_port, p1_chamber, p2_chamber, p_supply, supply_flow, F
  std::string unit;  ///< Pa, kg/s, N
  double noise = 0;  ///< of one sample [unit]
  double floor = 0;  ///< the model's own coloured error [unit]
  bool is_balance = false;  ///< no sensor reads it: what has to be zero
  double stated = 0;  ///< by which it may differ from the config, as the owner's tolerance says [unit]

  /// Of a recording: name and unit, "/" as "p" (p1_port_Pa, supply_flow_kgps).
  std::string column() const {
    std::string text = name + "_" + unit;
    std::replace(text.begin(), text.end(), '/', 'p');
    return text;
  }
};

/// One row of the residual vector: a bin of samples and where it stands.
struct ResidualRow {
  int channel = 0;
  int recording = 0;
  double time_s = 0, position_m = 0, velocity_mps = 0, command_V = 0;  ///< means over the bin; command of an axis: N
  double sigma = 1;  ///< of the row [unit of the channel], noise and floor together
  bool held_out = false;  ///< no fit may see it
  bool over_recording = false;  ///< no bin: a projection of the whole fitted part of the recording
  double alike_rows = 1;  ///< in which the model's own error stays the same beyond what sigma counts
};

/// Measured and simulated course of one channel of one recording, for pictures.
struct ResidualCourse {
  int channel = 0;
  int recording = 0;
  std::vector<double> time_s, measured, simulated;
};

/// Root mean square of simulation minus recording over single samples of one channel.
struct ChannelMisfit {
  double fitted = 0, held_out = 0;  ///< [unit of the channel]
};

/// A free function of time that acts at one element, and what each of its values does to the rows.
struct LatentInput {
  std::string element;  ///< as in the vocabulary
  std::string what;  ///< in words: "force on the slider"
  std::string unit;
  /// Of one recording: the middle of each piece of time, and what one unit in it does to the rows from `first_row` on
  /// (rows by pieces).
  struct Piece {
    int recording = 0;
    std::vector<double> time_s;
    std::size_t first_row = 0;
    Eigen::MatrixXd answer;
  };
  std::vector<Piece> pieces;
  /// Instead, where nothing is simulated: what one unit at a row's own time does to that row. Empty: not so.
  Eigen::VectorXd own_answer;
};

/// Slow errors of each channel, and the log likelihood of all rows beside them and white noise of standard deviation 1.
struct LikeliestErrors {
  std::vector<SlowError> of_channel;
  double log_likelihood = 0;
};

/// The comparison of recordings with hypotheses. Residuals are simulation minus recording.
class ResidualModel {
 public:
  virtual ~ResidualModel() = default;

  virtual const std::vector<ResidualChannel>& channels() const = 0;
  virtual const std::vector<ResidualRow>& rows() const = 0;
  /// How many start factors a hypothesis has (0: the model needs none), and their standard deviation.
  virtual std::size_t start_factor_count() const { return 0; }
  virtual double start_factor_sigma() const { return 0.004; }

  /// Column i: residual of hypothesis i over rows(), each row divided by its sigma. A hypothesis that cannot be
  /// simulated gives a column of NaN. The same hypothesis gives the same column, whatever stands beside it.
  virtual Eigen::MatrixXd residuals(std::span<const Hypothesis> hypotheses) = 0;

  /// Asked in the midst of everything that simulates: true ends it with DiagnosisStopped. Empty: never.
  virtual void set_stop(StopQuestion) {}
  /// Whether anything is simulated. If not, rows() are those that fits have seen and the fits' own residuals are all
  /// that is known.
  virtual bool simulates() const { return true; }

  /// Takes the numerical error (work grid against fine grid) at this hypothesis from now on; columns change by it.
  virtual void set_working_point(const Hypothesis&) {}

  /// The slow error of small unmodelled physics that is likeliest for what this hypothesis leaves.
  virtual LikeliestErrors likeliest_slow_errors(const Hypothesis& hypothesis) {
    return {std::vector<SlowError>(channels().size()), -0.5 * residuals(std::span(&hypothesis, 1)).squaredNorm()};
  }

  /// Free functions at every element, with their answers about this hypothesis: derivatives, in sigmas of the rows.
  /// Rows over a whole recording have none. Empty: the model knows none.
  virtual std::vector<LatentInput> latent_inputs(const Hypothesis&) { return {}; }

  /// What commands that no row holds may change about this hypothesis, in sigmas of the rows, each column a draw of
  /// them. Empty: rows hold all of them.
  virtual Eigen::MatrixXd unseen_commands(const Hypothesis&) { return {}; }

  /// Over samples instead of bins, one entry a channel.
  virtual std::vector<ChannelMisfit> sample_misfit(const Hypothesis& hypothesis) = 0;
  /// Every channel of every recording at the samples compared.
  virtual std::vector<ResidualCourse> courses(const Hypothesis& hypothesis) = 0;
};

}  // namespace pneuservo
