// Columns of a recording on an even grid of its own interval: by the stamps, not by the row's number.
#pragma once
#include <cstddef>
#include <vector>

#include "record/reader.hpp"

namespace pneuservo {

/// Steps longer than this are gaps: nothing is drawn through them, and the gas behind one is not known.
/// Two missing rows are, and 20 ms: a command that changes evenly over that moves no side by a sensor's noise.
double longest_drawn_s(double interval_s);

/// Grid sample k is at time_s.front() + k interval_s. Rows whose stamps are rounded no further than they stand off such
/// a grid stand at its samples.
class EvenSamples {
 public:
  /// Rows after time_s.front() + longest_s are left out.
  EvenSamples(const std::vector<double>& time_s, double interval_s, double longest_s = 1e300);

  std::size_t count() const { return count_; }
  /// Every row stands at its sample: a loop wrote it in its tick. Others were read beside the loop.
  bool is_even() const { return is_even_; }
  /// Values at their nearest samples; NaN where there is none. For columns that are compared where they were measured.
  std::vector<double> placed(const std::vector<double>& values) const;
  /// Cubics through neighbouring rows; straight where a neighbour is missing; NaN in gaps.
  std::vector<double> drawn(const std::vector<double>& values) const { return drawn(values, true, 0); }
  /// Straight lines between neighbouring rows, each read `later_s` behind its sample; NaN in gaps.
  std::vector<double> straight(const std::vector<double>& values, double later_s = 0) const {
    return drawn(values, false, later_s / interval_s_);
  }

 private:
  std::vector<double> drawn(const std::vector<double>& values, bool is_cubic, double later) const;
  void take_rounded_places(double rounding);

  std::vector<double> place_;  ///< of each row, in intervals
  double interval_s_;
  bool is_even_ = true;  ///< every row stands at its sample
  std::size_t count_ = 0;
};

/// Root mean square error of a cubic drawn through one missing row, measured by leaving rows out and drawing them
/// again, noise of the row itself included [unit of the column]. 0 where there are no five rows in line.
double drawing_error(const std::vector<double>& time_s, const std::vector<double>& values, double interval_s);

}  // namespace pneuservo
