// The gas of a cylinder's two sides: which numbers of a rig act on which of them, and courses put together of both.
#pragma once
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "diagnosis/residuals/imposed_run.hpp"

namespace pneuservo {

/// Gas of one recording. Each side is from a run that had its numbers; what belongs to no side is with the first.
class SidedCourse {
 public:
  using Half = std::shared_ptr<const GasCourse>;

  SidedCourse() = default;
  explicit SidedCourse(GasCourse whole);
  SidedCourse(Half first, Half second) : halves_{std::move(first), std::move(second)} {}

  const std::vector<double>& operator[](Signal signal) const { return (*halves_[side_of(signal)])[signal]; }
  const Half& half(std::size_t side) const { return halves_[side]; }
  /// Whether the gas of this side stayed within all bounds.
  bool is_finite(std::size_t side) const;
  bool is_finite() const { return is_finite(0) && is_finite(1); }

 private:
  std::array<Half, 2> halves_;
};

/// Numbers that the gas of a recording depends on.
struct GasNumbers {
  std::vector<double> of_both;
  std::array<std::vector<double>, 2> of_side;  ///< act on this side alone; empty where the sides act on each other
};

/// Of a rig along a recording. They act on each other through a leak of the piston and a supply that droops, and what
/// flows into both together is one quantity: `is_flow_wanted`.
GasNumbers gas_numbers(const ImposedRun& run, const ImposedInputs& inputs, bool is_flow_wanted);

/// Side 1 of one run beside side 2 of another, which has the same numbers of both; the rig is kept in `rig`.
ImposedRun side_by_side(const ImposedRun& first, const ImposedRun& second, const ImposedInputs& inputs, Rig& rig);

}  // namespace pneuservo
