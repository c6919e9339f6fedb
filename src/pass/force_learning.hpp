// Learns a command from the force that is left: a zero-phase low-pass over the measured pulse response, and Anderson's
// acceleration over the last steps.
#pragma once
#include <complex>
#include <deque>
#include <vector>

namespace pneuservo {

/// One stage of the learning: below its cut-off frequency the error is taken off, above it is left.
class ForceLearning {
 public:
  /// response_N_per_V: force after a pulse of one period; `ticks`: length of the commands. Cold.
  ForceLearning(const std::vector<double>& response_N_per_V, std::size_t ticks, double period_s);
  /// From here on learned up to this frequency; forgets the steps so far.
  void begin_stage(double cut_off_Hz);
  /// The next command from the last one and what its run left of the force [N].
  std::vector<double> next(const std::vector<double>& command_V, const std::vector<double>& left_N);
  /// What of a force lies below a cut-off frequency, without delay.
  std::vector<double> below(double cut_off_Hz, const std::vector<double>& force_N) const;

 private:
  double low_pass(std::size_t i, double cut_off_Hz) const noexcept;
  std::vector<double> filtered(const std::vector<double>& signal, const std::vector<std::complex<double>>& gain) const;

  std::size_t ticks_, length_;
  double period_s_;
  std::vector<std::complex<double>> response_;
  std::vector<std::complex<double>> gain_;  // Q/H of the stage
  std::vector<double> last_command_V_, last_step_V_;
  std::deque<std::vector<double>> command_changes_V_, step_changes_V_;
};

}  // namespace pneuservo
