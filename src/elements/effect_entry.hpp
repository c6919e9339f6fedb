// The vocabulary of effects: what diagnosis, reports and tools know of an effect beside its equation, one entry each.
// The entries stand in the files of this folder that have the names of the parameter structs' headers.
#pragma once
#include <array>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/core/signal.hpp>
#include <pneuservo/elements/point_table.hpp>

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
  valve_area_per_pressure,  ///< the valve's largest area over the gauge supply pressure
  inverse_valve_area,  ///< of 1/area^2: 1 over the square of the valve's largest area
  inverse_bore_area,   ///< of 1/area^2: 1 over the square of the line's bore, the loss of one dynamic head
  moving_mass,         ///< slider and payload
  top_speed,
  half_stroke,
  line_volume,         ///< of the gas in the line
  wall_heat,           ///< W/K of free convection on the walls of a vessel
  laminar_conductance, ///< kg/(s Pa2) that passes at supply pressure what the valve's largest area does
  channel_offset,      ///< supply pressure, stroke or force, by the sensor's channel
  channel_gain,        ///< 0.6 for pressures, 1 for others
  viscosity,           ///< the slider's configured viscous friction
  adiabatic_change,    ///< K by which gas cools from a recording's first pressure to the atmosphere's without heat
  supply_resistance,   ///< Pa s/kg through which a vessel fills with a time constant of 10 s
  supply_pressure,
  stroke,
  duration,            ///< s from the first row of the recordings that is compared to the last
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

/// A list of at most N values that a table of constants can hold.
template <class T, std::size_t N> class Few {
 public:
  constexpr Few() = default;
  constexpr Few(std::initializer_list<T> values) {
    for (const T& value : values) all_.at(count_++) = value;
  }
  constexpr const T* begin() const { return all_.data(); }
  constexpr const T* end() const { return all_.data() + count_; }
  constexpr std::size_t size() const { return count_; }
  constexpr bool empty() const { return count_ == 0; }
  constexpr const T& operator[](std::size_t i) const { return all_[i]; }

 private:
  std::array<T, N> all_{};
  std::size_t count_ = 0;
};

/// How one parameter of an effect is looked for; made by amplitude() or shape().
struct ParameterTrait {
  std::string_view key{};
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
  /// A dead time: what answers to the noise of a command has a valley at every period of the loop, and no slope towards
  /// the next. Each is looked at.
  bool has_valleys = false;
  /// Physical range of the value over `range_scale`, beside that of its key: beyond it stands something else.
  double least = -infinite, most = infinite;
  EffectScale range_scale = EffectScale::one;
  /// Prior standard deviation over `small_scale`, in what is varied, of what every real machine has of it; 0: none.
  double small_spread = 0;
  EffectScale small_scale = EffectScale::one;
  /// Of that spread, for differences.
  double small_step = 0.01;
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
  constexpr ParameterTrait with_valleys() const {
    ParameterTrait out = *this;
    out.has_valleys = true;
    return out;
  }
  constexpr ParameterTrait small(double its_spread, double step = 0.01, EffectScale over = EffectScale::one) const {
    ParameterTrait out = *this;
    out.small_spread = its_spread;
    out.small_step = step;
    out.small_scale = over;
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

/// What a verdict may make of an effect.
enum class EffectRole {
  law,  ///< a name
  description,  ///< a shape for whatever is there: sought alone, its verdict is `unknown` at its element
  granted,  ///< every real machine has it: allowed for beside other physics, never a name
  disturbance,  ///< other in each recording: told with its frequency, and no config holds it
  played,  ///< for configs and simulations: no verdict looks for it
  table,  ///< a function by its points, drawn where a verdict is `unknown` at its element; never a name
};

/// The simpler law that an effect contains: it is that law where `extra` is nothing beside `beside`, or where both
/// numbers of `alike` are the same.
struct SimplerLaw {
  std::string_view name{};  ///< empty: it contains none
  std::string_view extra{}, beside{};
  std::array<std::string_view, 2> alike{};
};

/// How a size grows from rung to rung of a ladder of machines.
enum class Growth {
  held,
  twice,  ///< its distance from nothing, a rung
  narrower,  ///< an opening whose resistance goes with 1/area^2: half that square a rung
};

/// A value of a parameter, over a scale of the rig.
struct StatedSize {
  std::string_view key{};
  double value = 0;
  EffectScale scale = EffectScale::one;
  Growth growth = Growth::twice;
};
constexpr StatedSize held(std::string_view key, double value) { return {key, value, EffectScale::one, Growth::held}; }

/// How the effect looks between model and recording where the model lacks it; drawn by tools/effect-signatures.
struct EffectSignature {
  std::string_view side{};  ///< 1, 2 or a sensor's channel
  Few<StatedSize, 4> sizes{};  ///< of the machine drawn
  std::string_view words{};  ///< what gives it away
  Few<Signal, 2> channels{};
  std::string_view against{};  ///< speed, position or command
};

/// All that is known of an effect beside its equation.
struct EffectEntry {
  std::string_view name{};  ///< without side or channel
  std::string_view words{};  ///< in a machine builder's words; # stands for side or channel
  std::string_view element{};  ///< where it sits, without its side
  std::string_view family{};  ///< names that mimic each other in recordings, without their side; of a sensor: its own
  EffectRole role = EffectRole::law;
  Few<ParameterTrait, 8> parameters{};
  unsigned shown_by = 0;  ///< bits of Excitation
  bool is_never_added = false;  ///< to other names
  bool is_of_plain_axes = false;  ///< looked for where no pressures act on the slider
  std::string_view over{};  ///< of a table: position, speed, time, pressure
  /// Of a granted one: names of effects and paths of numbers that its own are where they are all alike.
  Few<std::string_view, 2> stands_for{};
  std::string_view same_as{};  ///< path of a number that is the one at fault where the owner states it
  SimplerLaw contains{};
  Few<StatedSize, 4> smallest{};  ///< first rung of the trial machines; empty: they have none of it
  Few<EffectSignature, 2> signatures{};
};

/// A function by its points: every value with the same prior.
constexpr EffectEntry table_entry(std::string_view name, std::string_view words, std::string_view element,
                                  std::string_view over, const TableKeys& keys, EffectScale scale, double spread) {
  const auto at = [&](std::size_t i) { return amplitude(keys.values[i], scale, spread); };
  return {.name = name,
          .words = words,
          .element = element,
          .family = "table",
          .role = EffectRole::table,
          .parameters = {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)},
          .over = over};
}

/// An effect's name apart: chamber_leak_1 is chamber_leak and 1, sensor_gain:x is sensor_gain and x.
struct EffectName {
  std::string_view base, side;
  bool is_of_sensor = false;
};
EffectName split_effect(std::string_view name);
/// `whole` with the side of an effect: chamber on that of chamber_leak_1 is chamber_1.
std::string on_side_of(std::string_view whole, std::string_view effect);

/// Of an effect with or without side; nullptr: there is no such effect.
const EffectEntry* find_effect(std::string_view name);
/// Every entry; what every machine has a little of comes in this order to a fit.
const std::vector<const EffectEntry*>& all_effects();

// The entries by the headers of their structs.
std::span<const EffectEntry> motion_effect_entries();
std::span<const EffectEntry> pneumatic_effect_entries();
std::span<const EffectEntry> vessel_effect_entries();
std::span<const EffectEntry> sensor_effect_entries();

}  // namespace pneuservo
