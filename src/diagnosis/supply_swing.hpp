// A swing of the supply's pressure: what it does beside what the rig says.
#pragma once
#include <cmath>
#include <numbers>

namespace pneuservo {

/// A sine from each recording's start; neutral by default.
struct SupplySwing {
  double frequency_Hz = 0, cosine_Pa = 0, sine_Pa = 0;

  bool is_none() const { return cosine_Pa == 0 && sine_Pa == 0; }
  double at(double time_s) const {
    const double phase = 2 * std::numbers::pi * frequency_Hz * time_s;
    return cosine_Pa * std::cos(phase) + sine_Pa * std::sin(phase);
  }
};

}  // namespace pneuservo
