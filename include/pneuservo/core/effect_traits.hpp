// What has to be known of an effect to look for it in data; stands beside the effect's parameters
// (elements/effects.hpp).
#pragma once
#include <array>
#include <limits>
#include <span>
#include <string_view>

namespace pneuservo {

/// What a size is measured in before any data are seen; the number is made from a rig and its recordings.
enum class EffectScale {
  one,                 ///< the parameter's own unit
  force,               ///< piston force at gauge supply pressure, or an axis' largest force
  force_per_pressure,  ///< that force over the gauge supply pressure
  force_per_speed,     ///< that force over the top speed
  drag,                ///< that force over the square of the top speed
  stiffness,           ///< that force over half the stroke
  valve_area,          ///< the valve's largest area
  inverse_valve_area,  ///< of 1/area^2: 1 over the square of the valve's largest area
  moving_mass,         ///< slider and payload
  top_speed,
  half_stroke,
  wall_heat,           ///< W/K of free convection on the walls of a vessel
  laminar_conductance, ///< kg/(s Pa2) that passes at supply pressure what the valve's largest area does
  channel_offset,      ///< supply pressure, stroke or force, by the sensor's channel
  channel_gain,        ///< 0.6 for pressures, 1 for others
  viscosity,           ///< the slider's configured viscous friction
  adiabatic_change,  ///< K by which gas cools from a recording's first pressure to the atmosphere's without heat
  supply_resistance,  ///< Pa s/kg through which a vessel fills with a time constant of 10 s
};

/// In what a parameter is varied: itself, its logarithm, or 1/value^2 (0 stands for "none" there).
enum class Variation { linear, logarithmic, inverse_square };

/// What recordings must hold for an effect to show; bits of `shown_by`, which an effect may have.
enum Excitation : unsigned {
  many_speeds = 1,   ///< speeds that differ by a factor of two: else a law of the speed is any other
  both_ways = 2,     ///< motion forward and backward: what friction has built up before a recording shows at a turn
  places_again = 4,  ///< each place passed more than once: else place and speed go together
  a_radian = 8,  ///< more than 1 rad of way: over less a sine is a straight line within 4 %, and a weight a spring
};

/// How one parameter of an effect is looked for; made by amplitude() or shape().
struct ParameterTrait {
  std::string_view key;
  EffectScale scale = EffectScale::one;
  /// Prior standard deviation over scale; of a logarithm in itself.
  double spread = 1;
  /// Smaller sizes than this, over scale, are never named; 0: does not decide.
  double negligible = 0;
  Variation variation = Variation::linear;
  /// Start values over scale of a shape; empty: an amplitude.
  std::span<const double> grid{};
  /// Whether that grid lies relative to the middle of the recorded motion (of centres) instead of to zero.
  bool is_over_motion = false;
  /// Sizes of an amplitude, in prior standard deviations, whose whole change is looked at beside its derivative: what
  /// tolerances mimic while it is small may be all that is left of it.
  std::span<const double> whole{};
  /// Physical range of the value over `range_scale`, beside that of its key: beyond it stands something else.
  double least = -infinite, most = infinite;
  EffectScale range_scale = EffectScale::one;
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  constexpr ParameterTrait by(Variation how) const {
    ParameterTrait out = *this;
    out.variation = how;
    return out;
  }
  constexpr ParameterTrait over_motion() const {
    ParameterTrait out = *this;
    out.is_over_motion = true;
    return out;
  }
  constexpr ParameterTrait within(double least_share, double most_share, EffectScale of) const {
    ParameterTrait out = *this;
    out.least = least_share;
    out.most = most_share;
    out.range_scale = of;
    return out;
  }
  constexpr ParameterTrait whole_at(std::span<const double> sizes) const {
    ParameterTrait out = *this;
    out.whole = sizes;
    return out;
  }
};

/// A parameter that starts at its neutral value and is found by its derivative.
constexpr ParameterTrait amplitude(std::string_view key, EffectScale scale, double spread, double negligible = 0) {
  return {key, scale, spread, negligible};
}
/// A parameter that enters nonlinearly: it starts at every value of a grid, and its prior is centred on their mean.
constexpr ParameterTrait shape(std::string_view key, EffectScale scale, double spread, std::span<const double> grid) {
  return {key, scale, spread, 0, Variation::linear, grid};
}

namespace effect_grids {
inline constexpr std::array<double, 4> stribeck_speed{0.01, 0.03, 0.1, 0.3};
inline constexpr std::array<double, 9> zone_center{-0.9, -0.675, -0.45, -0.225, 0, 0.225, 0.45, 0.675, 0.9};
inline constexpr std::array<double, 2> zone_width{0.07, 0.2};
inline constexpr std::array<double, 5> leak_zone_center{-0.9, -0.45, 0, 0.45, 0.9};
inline constexpr std::array<double, 2> leak_zone_width{0.12, 0.3};
inline constexpr std::array<double, 3> friction_way{0.003, 0.01, 0.03};
inline constexpr std::array<double, 3> spring_rest{-0.5, 0, 0.5};
inline constexpr std::array<double, 12> load_frequency{3, 3.8, 4.8, 6, 7.5, 9.5, 12, 15, 19, 24, 30, 38};
inline constexpr std::array<double, 1> load_damping{0.03};
inline constexpr std::array<double, 16> load_play{5e-5,   7e-5,   1e-4,   1.3e-4, 1.8e-4, 2.5e-4, 3.3e-4, 4.5e-4,
                                                  6.1e-4, 8.2e-4, 1.1e-3, 1.5e-3, 2e-3,   2.7e-3, 3.7e-3, 5e-3};
inline constexpr std::array<double, 2> contact_frequency{25, 80};
inline constexpr std::array<double, 1> contact_damping{0.2};
inline constexpr std::array<double, 3> leak_position{0, 0.5, 1};
inline constexpr std::array<double, 3> branch_position{0.15, 0.5, 0.85};
inline constexpr std::array<double, 2> branch_volumes{0.3, 1.5};
inline constexpr std::array<double, 1> branch_neck_length{0.3};
inline constexpr std::array<double, 2> branch_neck_diameter{0.0025, 0.007};
inline constexpr std::array<double, 3> restriction_sizes{0.1, 0.5, 2};
inline constexpr std::array<double, 3> droop_area{0.1, 0.3, 1};
inline constexpr std::array<double, 3> droop_volume{2e-4, 1e-3, 5e-3};
inline constexpr std::array<double, 4> charging_time{3, 10, 30, 100};
inline constexpr std::array<double, 2> drop_out_delays{1, 2.5};
inline constexpr std::array<double, 3> pump_resistances{0.3, 1, 3};
inline constexpr std::array<double, 3> porous_orifice{0.02, 0.06, 0.2};
}  // namespace effect_grids

}  // namespace pneuservo
