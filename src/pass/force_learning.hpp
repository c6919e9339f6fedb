// Learns a command from the force that is left: a zero-phase low-pass over the measured pulse response, and Anderson's
// acceleration over the last steps.
#pragma once
#include <cstddef>
#include <deque>
#include <vector>

#include "control/inverse_response.hpp"

namespace pneuservo {

/// One stage of the learning: below its cut-off frequency the error is taken off, above it is left.
class ForceLearning {
 public:
  /// response_N_per_V: force after a pulse of one period; `ticks`: length of the commands. Cold.
  ForceLearning(const std::vector<double>& response_N_per_V, std::size_t ticks, double period_s)
      : inverse_(response_N_per_V, ticks, period_s) {}
  /// From here on learned up to this frequency; forgets the steps so far.
  void begin_stage(double cut_off_Hz);
  /// The next command from the last one and what its run left of the force [N].
  std::vector<double> next(const std::vector<double>& command_V, const std::vector<double>& left_N);
  /// What of a force lies below a cut-off frequency, without delay.
  std::vector<double> below(double cut_off_Hz, const std::vector<double>& force_N) const {
    return inverse_.below(cut_off_Hz, force_N);
  }

 private:
  InverseResponse inverse_;
  double cut_off_Hz_ = 0.0;
  std::vector<double> last_command_V_, last_step_V_;
  std::deque<std::vector<double>> command_changes_V_, step_changes_V_;
};

}  // namespace pneuservo
