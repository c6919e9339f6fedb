// Whether what is left of a mismatch is that of a supply whose pressure swings.
#pragma once
#include <optional>

#include "diagnosis/residuals/fitted_rows.hpp"

namespace pneuservo {

/// The sine of the supply's pressure that takes most of what a hypothesis leaves.
struct PeriodicSupply {
  double frequency_Hz = 0;
  double amplitude_Pa = 0;  ///< root mean square over the recordings' amplitudes
  double share = 0;         ///< of the sum of squares over all fitted rows
  double next_share = 0;  ///< the same of the best sine of another frequency: what moves slowly is like many of them
};

/// Standard deviation of each part of a swing that every supply has, of its pressure. Three of these, half a per cent,
/// are more than any background has that this was tried on; no real supply was measured.
inline constexpr double small_swing_share = 0.0015;

/// From two periods in the longest recording to 15 Hz, in all recordings at one frequency, in each with its own phase
/// and amplitude: compressor and regulator do not wait for a recording to begin. The gas answers small swings in
/// proportion, so two runs of the model at each frequency say what any sine of it would do. nullopt: the supply is in
/// no row.
std::optional<PeriodicSupply> strongest_supply_swing(FittedRows& rows, const Hypothesis& hypothesis);

}  // namespace pneuservo
