// The gas of a cylinder's two sides: which numbers of a rig act on which of them, and courses put together of both.
#pragma once
#include <array>
#include <memory>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "diagnosis/residuals/imposed_run.hpp"

namespace pneuservo {

/// Side that a key names (line_1, dead_volume_2_m3): 1 or 2; 0: none.
constexpr std::size_t side_in(std::string_view key) {
  if (key.ends_with("_1") || key.find("_1_") != std::string_view::npos) return 1;
  if (key.ends_with("_2") || key.find("_2_") != std::string_view::npos) return 2;
  return 0;
}

/// Calls what(side, number...) for every number of parameter structs of one type, in their order; side 0: of both.
template <class What> struct EachNumber {
  const What& what;
  std::size_t side = 0;
  template <class T, class... More> void operator()(const Field& field, T& value, More&... more) const {
    const std::size_t here = side != 0 ? side : side_in(field.key);
    using Value = std::remove_cvref_t<T>;
    if constexpr (std::is_arithmetic_v<Value>) what(here, value, more...);
    else if constexpr (std::is_enum_v<Value>) what(0, value, more...);  // a plant's choices are those of both sides
    else Value::visit(EachNumber{what, here}, value, more...);
  }
};

/// Whether the gas of this side stayed within all bounds.
bool is_finite(const GasCourse& gas, std::size_t side);

/// Gas of one recording. Each side is from a run that had its numbers; what belongs to no side is with the first.
class SidedCourse {
 public:
  using Half = std::shared_ptr<const GasCourse>;

  SidedCourse() = default;
  explicit SidedCourse(GasCourse whole);
  SidedCourse(Half first, Half second) : halves_{std::move(first), std::move(second)} {}

  const std::vector<double>& operator[](Signal signal) const { return (*halves_[side_of(signal)])[signal]; }
  const Half& half(std::size_t side) const { return halves_[side]; }
  bool is_finite() const { return pneuservo::is_finite(*halves_[0], 0) && pneuservo::is_finite(*halves_[1], 1); }

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
