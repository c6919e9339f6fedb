// Pulses of two on/off valves whose mean opening is a wanted one (docs/physics/pressure_pi.md).
#pragma once
#include <pneuservo/elements/parameters.hpp>

namespace pneuservo {

/// At the start of each carrier period the pulse of whole periods whose opening is nearest to the wanted one; what it
/// misses by is added to the next, so that the mean is right however short the wanted opening is.
class PulseWidth {
 public:
  /// `valve.on_off` is there.
  void configure(const ValveParameters<double>& valve, double period_s) noexcept;
  /// Both valves have been closed for long. HOT.
  void reset() noexcept;
  /// Command of this period [V], all or nothing, for a wanted mean [V]. HOT.
  double step(double mean_V) noexcept;
  /// Periods passed without a step: the coil has stayed as it was. HOT.
  void skip(long periods) noexcept;
  /// In which the shortest pulse that opens and the shortest gap that closes have room [s].
  static double shortest_carrier_s(const PulsedValveParameters& valve, double period_s) noexcept;
  /// Shortest opening that a pulse makes [s].
  double least_open_s() const noexcept { return open_s(least_ticks_, false); }

 private:
  void begin(double share) noexcept;
  double open_s(long ticks, bool goes_on) const noexcept;

  PulsedValveParameters valve_;
  double command_max_V_ = 1.0, period_s_ = 1e-3;
  long carrier_ticks_ = 1, least_ticks_ = 1, most_ticks_ = 1;  ///< pulses that open and close: from least to most
  long tick_ = 0, on_ticks_ = 0;
  double sign_ = 1.0, rest_s_ = 0.0;
};

}  // namespace pneuservo
