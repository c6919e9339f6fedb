// Natural frequency and damping of a line from recorded pressures at both of its ends.
#pragma once
#include <complex>
#include <vector>

#include "acoustics/line_acoustics.hpp"

namespace pneuservo {

/// Pressures at the two ends of a line [Pa], sampled at the same times period_s apart. Both begin and end at rest.
struct LinePressures {
  std::vector<double> in_Pa, out_Pa;
  double period_s = 0.0;
  double in_age_s = 0.0;  ///< by which the value of in_Pa is older than that of out_Pa in the same row
};

/// What is believed of the line and of what stands at its end.
struct LineBelief {
  double length_m = 0.0, diameter_m = 0.0;
  AirParameters<double> air;
  LineEnds ends;                  ///< volume_out finite
  double relative_volume = 0.1;   ///< standard deviation of volume_out's logarithm
  double relative_gain = 0.005;   ///< of one sensor's gain against the other's
};

struct EstimatedNumber {
  double value = 0.0;
  double standard_error = 0.0;
};

/// Measured and fitted pressure transfer about one frequency.
struct ResponsePoint {
  double Hz = 0.0;
  std::complex<double> measured, fitted;
  double standard_error = 0.0;  ///< of the measured one's magnitude
};

struct LineIdentification {
  EstimatedNumber natural_frequency_Hz, damping_ratio;  ///< of first_resonance between valve flow and chamber flow
  EstimatedNumber length_m;                             ///< at the config's speed of sound
  EstimatedNumber loss_ratio;                           ///< of viscosity and heat conduction over those of the air
  EstimatedNumber volume_out_m3, gain;
  double mean_pressure_Pa = 0.0;
  double noise_Pa = 0.0;         ///< a sensor's noise that would leave what the fit leaves, up to highest_Hz
  double lowest_Hz = 0.0, highest_Hz = 0.0;
  double ends_share = 0.0;  ///< share of the input's energy in the first and last hundredth; at rest: none but noise
  bool resonates = true;  ///< else friction leaves no peak, and the first two numbers are NaN
  std::vector<ResponsePoint> response;
};

/// Fits length, losses, volume and relative gain of exact theory to the transfer between the two pressures, with noise
/// of the same size in both. Throws std::invalid_argument for fewer than 64 rows, columns of two lengths, values that
/// are not finite, or pressures that do not move.
LineIdentification identify_line(const LinePressures& pressures, const LineBelief& belief);

}  // namespace pneuservo
