// Closed-form gain of every candidate at one place: one column a start, all that is fitted anyway projected out.
#pragma once
#include <vector>

#include "diagnosis/candidates.hpp"
#include "diagnosis/fit.hpp"

namespace pneuservo {

/// What a screening says of a candidate: largest gain in chi2 over its starts, and where to start from.
struct Screened {
  std::size_t candidate = 0;
  double gain = 0;
  std::vector<double> start;           ///< z of its parameters
  std::vector<double> standard_error;  ///< of its amplitudes, in z, all else projected out
};

/// Screens the candidates `chosen` at a linearised fit, in their order.
std::vector<Screened> screen_candidates(FittedRows& rows, const Fit& base, const std::vector<Candidate>& candidates,
                                        const std::vector<std::size_t>& chosen);

}  // namespace pneuservo
