// One number of a hypothesis that a fit may move, in units of its prior's standard deviation.
#pragma once
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "config/rig_parameters.hpp"
#include "diagnosis/residuals/residual_model.hpp"
#include "elements/effect_entry.hpp"

namespace pneuservo {

/// A number of the rig, of a recording's start, or of the supply's swing in a recording.
/// z = 0 is the prior's centre, +-1 its standard deviation; the prior is normal, cut at the bounds.
struct FreeParameter {
  std::string path;  ///< config path; empty for a number of one recording
  std::optional<ParameterHandle> number{};  ///< at that path
  int start_factor = -1;  ///< of Hypothesis::start_factors
  int swing_part = -1;    ///< of Hypothesis::swing_Pa
  Variation variation = Variation::linear;
  double center = 0;  ///< in what is varied (the value, its logarithm, 1/value^2)
  double spread = 1;
  double lower = -3, upper = 3;  ///< of z
  double valleys_apart = 0;  ///< a period of the loop for a dead time, whose objective has a minimum at each; else 0
  /// Of z, for differences. Short: where two numbers nearly stand for each other, a fit follows the difference of their
  /// columns, and with steps five times as long it crept on 8 in chi2 above its minimum.
  double step = 0.005;

  /// Whether both are one number, whatever their priors.
  bool is_same(const FreeParameter& other) const {
    return start_factor == other.start_factor && swing_part == other.swing_part && path == other.path;
  }
  /// Whether it is one of the four numbers that each recording has of its own.
  bool is_of_recording() const { return start_factor >= 0 || swing_part >= 0; }
  int recording() const { return std::max(start_factor, swing_part) / 2; }
  std::size_t place_in_recording() const {
    return static_cast<std::size_t>(start_factor >= 0 ? start_factor % 2 : 2 + swing_part % 2);
  }
  double& of_recording(Hypothesis& hypothesis) const {
    return start_factor >= 0 ? hypothesis.start_factors.at(static_cast<std::size_t>(start_factor))
                             : hypothesis.swing_Pa.at(static_cast<std::size_t>(swing_part));
  }

  /// Which end of the range a z stands at, to a thousandth of it: -1, 1; 0: neither.
  int end_at(double z) const {
    const double close = 1e-3 * (upper - lower);
    return z - lower < close ? -1 : upper - z < close ? 1 : 0;
  }
  /// Whether a z stands at an end away from the prior's centre: a size that cannot be negative is at one at zero, too.
  bool is_at_far_end(double z) const {
    const int end = end_at(z);
    return end != 0 && end != end_at(0);
  }
  double value_in(const Rig& rig) const { return number.value().value(rig); }
  double varied(double value) const {
    switch (variation) {
      case Variation::logarithmic: return std::log(value);
      case Variation::inverse_square: return value > 0 ? 1 / (value * value) : 0;
      case Variation::linear: break;
    }
    return value;
  }
  double value_of(double varied) const {
    switch (variation) {
      case Variation::logarithmic: return std::exp(varied);
      case Variation::inverse_square: return varied > least_varied() ? 1 / std::sqrt(varied) : 0;
      case Variation::linear: break;
    }
    return varied;
  }
  /// Of an opening: that of the widest which its key can have. What is wider is none.
  double least_varied() const { return std::pow(number.value().field().maximum, -2); }
  double value(double z) const { return value_of(center + spread * z); }
  double z(double value) const { return (varied(value) - center) / spread; }
  /// |d value / d z|, for standard errors.
  double slope(double z) const {
    const double at = center + spread * z;
    switch (variation) {
      case Variation::logarithmic: return spread * std::exp(at);
      case Variation::inverse_square: return at > least_varied() ? 0.5 * spread * std::pow(at, -1.5) : 0;
      case Variation::linear: break;
    }
    return spread;
  }
};

/// How a number of an effect is looked for, by its path (effects.NAME.KEY); null: the path is of none.
const ParameterTrait* trait_of(const std::string& path);

/// The number of this rig at a path, with no prior yet.
FreeParameter free_number(const Rig& rig, const std::string& path);

/// The hypothesis that differs from `base` in these parameters.
Hypothesis with_parameters(const Hypothesis& base, const std::vector<FreeParameter>& parameters,
                           const std::vector<double>& z);

}  // namespace pneuservo
