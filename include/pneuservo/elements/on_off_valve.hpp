// An on/off valve: its armature follows the coil after a switching time.
#pragma once
#include <algorithm>
#include <string_view>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// Two equal valves of two ports each, one that fills and one that empties, driven by pulses.
struct PulsedValveParameters {
  static constexpr std::string_view of_the_loop = "carrier_period_s";  ///< the key that is no part of the valve
  double carrier_period_s = 0.0;
  double switching_time_on_s = 0.0, switching_time_off_s = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{of_the_loop, "s", 1e-4, 1, "from pulse to pulse, a whole number of period_s"}, p.carrier_period_s...);
    v(Field{"switching_time_on_s", "s", 0, 0.5, "from coil on to open; a shorter pulse does not open"},
      p.switching_time_on_s...);
    v(Field{"switching_time_off_s", "s", 0, 0.5, "from coil off to closed"}, p.switching_time_off_s...);
  }
};

/// Opens and closes whole, a switching time after its coil; a pulse or a gap that is shorter leaves it as it is.
class OnOffValve {
 public:
  void configure(const PulsedValveParameters& valve) noexcept { valve_ = valve; }
  /// At rest.
  void reset(bool coil) noexcept { coil_ = open_ = coil; }
  /// For how much of the coming time it is open [s]. HOT.
  double step(bool coil, double duration_s) noexcept {
    if (coil != coil_) left_s_ = coil ? valve_.switching_time_on_s : valve_.switching_time_off_s;
    coil_ = coil;
    if (open_ == coil_) return open_ ? duration_s : 0.0;
    const double before_s = std::min(left_s_, duration_s);
    left_s_ -= before_s;
    const double open_s = open_ ? before_s : duration_s - before_s;
    if (left_s_ < rounding_s) open_ = coil_;
    return open_s;
  }

 private:
  static constexpr double rounding_s = 1e-9;  // of times that are summed up
  PulsedValveParameters valve_;
  bool coil_ = false, open_ = false;
  double left_s_ = 0.0;
};

}  // namespace pneuservo
