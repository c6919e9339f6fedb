// The quick answer of a port's pressure to the steps of the command: what means over a bin cannot show.
#pragma once
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace pneuservo {

/// Under feedback the command carries the sensors' noise, a step every sample, and the pressure at the valve answers
/// within the sample: for the first moments the line is nothing but its wave impedance, dp = (c / A) dG. When that
/// answer comes, at once, later or little by little, tells dead time, lag and spool apart to a part of a sample; in
/// means over 10 ms they are all alike.
///
/// The command's values 1 to `latest` samples ago, freed from the parabola through the `window` samples before each,
/// and made orthonormal, span what the pressure can have answered. The pressure is freed from the parabola through the
/// samples after each: motion and drift go out, and the noise of a sample, which the loop brings into all later
/// commands, meets none of them. Parabolas through windows of both would make that noise an answer of its own, nine
/// standard deviations in 7 s. A signal's projections are as many rows, white where the signal is white, and nearly
/// independent of the means over bins.
class CommandAnswer {
 public:
  /// latest: at 1 kHz twice the prior's standard deviation of a dead time. window: a parabola through 20 values errs by
  /// 0.74 of their noise at the next one, one through fewer by more.
  static constexpr std::size_t window = 20, latest = 12;

  CommandAnswer() = default;
  /// used: samples that may be looked at, as many as `command` has.
  CommandAnswer(const std::vector<double>& command, const std::vector<char>& used);

  /// None where the command has no quick part.
  Eigen::Index rows() const { return basis_.cols(); }
  /// Projections of a signal of as many samples as the command.
  Eigen::VectorXd of(const std::vector<double>& signal) const;
  /// Turns the rows so that what is uncertain lies in as few as can be: `possible` are projections that an error of the
  /// model may have. Returns their root mean square in each row as it is then, 0 where there are none.
  Eigen::VectorXd turn_along(const std::vector<Eigen::VectorXd>& possible);
  /// Root mean square of a signal freed from its parabolas; of white noise its own.
  double quick_part(const std::vector<double>& signal) const;

 private:
  std::vector<std::size_t> places_;  ///< samples that are compared: `window` more that may be looked at come after each
  std::vector<std::size_t> looked_at_;  ///< samples that any row looks at; others may be no number
  Eigen::MatrixXd basis_;  ///< a row for each of those, orthonormal columns
};

}  // namespace pneuservo
