// References: what the axis shall do, as a position with analytic derivatives up to the seventh.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pneuservo {

/// Position and its derivatives: d[0] = x [m], d[i] = d^i x / dt^i [m/s^i].
struct ReferencePoint {
  std::array<double, 8> d{};
};

enum class ReferenceKind { sine, multisine, waypoints, sum, cruise, minimum_jerk, file, live };

/// A reference as a config states it (docs/config-keys.md); keys that a kind does not have stay unused.
struct ReferenceSpec {
  ReferenceKind kind = ReferenceKind::sine;
  double amplitude_m = 0.0, frequency_Hz = 0.0;                      // sine
  std::vector<std::array<double, 3>> components;                     // multisine: amplitude, frequency, phase
  double center_m = 0.0, start_s = 0.0;
  double ramp_s = -1.0;                                              // < 0: one period (of the slowest component)
  int smoothness = 5;                                                // polynomial degree of ramp or move
  std::vector<double> times_s, positions_m;                          // waypoints
  std::vector<ReferenceSpec> parts;                                  // sum
  double start_m = 0.0, end_m = 0.0, speed_mps = 0.0, duration_s = 0.0;  // cruise, minimum_jerk
  std::string path;                                                  // file
  double lowest_m = 0.0, highest_m = 0.0, acceleration_mps2 = 0.0, pass_within_s = 0.25;  // live, with speed_mps
};

/// Reads the columns t_s and x_ref_m of a recording: the loader of references of kind `file`.
using LoadPositions = std::function<std::pair<std::vector<double>, std::vector<double>>(const std::string& path)>;

/// Whether any part of it comes from a file, so that building it needs a loader.
inline bool needs_file(const ReferenceSpec& spec) {
  if (spec.kind == ReferenceKind::file) return true;
  for (const ReferenceSpec& part : spec.parts)
    if (needs_file(part)) return true;
  return false;
}

/// The trial motion of a reference of kind `live`: the hardest that commands may ask for, with which everything that a
/// config's motion is checked by is checked (docs/serve.md). Forth and at once back over the range, then the shortest
/// moves that reach the largest speed, forth and back.
ReferenceSpec live_trial(const ReferenceSpec& live);
/// Two of its moves: over the whole range and back, with a rest before and between.
ReferenceSpec live_moves(const ReferenceSpec& live);
inline constexpr double live_rest_s = 0.5;  ///< of both: that from which a command pass begins (PassTable::rest_s)

/// Smallest and largest value of one derivative of a reference over a time span.
struct ReferenceExtremes {
  double minimum = 0.0, maximum = 0.0;
};

class LivePlanner;

/// A reference that can be asked for any time. Built once (cold); after that nothing is allocated and `at` is HOT.
/// Before its start it rests at its first value, after its end at its last (docs/physics/references.md).
class Reference {
 public:
  /// Rests at 0 for ever.
  Reference() = default;
  /// `load` is needed for references of kind `file` only. Throws std::invalid_argument with one sentence that names
  /// the key, what was found and what is expected.
  explicit Reference(const ReferenceSpec& spec, const LoadPositions& load = {});
  /// What a planner has planned from its tick 0 on, and from rest.
  explicit Reference(std::shared_ptr<const LivePlanner> planned);

  /// Position and derivatives 1 to 7 at time t_s [s]. At a joint the later piece counts.
  ReferencePoint at(double t_s) const noexcept;
  /// Start of the first motion [s]; 0 if nothing ever moves.
  double start_s() const noexcept { return start_s_; }
  /// End of the last motion [s]; infinity for sines; 0 if nothing ever moves.
  double end_s() const noexcept { return end_s_; }
  /// True if the motion comes to an end (every part does): the run is judged over the move, not over its second half.
  bool is_move() const noexcept { return end_s_ < std::numeric_limits<double>::infinity(); }
  /// From `from_s` on it does the same every `period_s`; 0: it rests, infinity: it has no period that is known.
  struct Repetition {
    double from_s = 0.0, period_s = 0.0;
  };
  Repetition repetition() const;
  /// Extremes of derivative `order` (0: position [m] ... 6) over [0, duration_s]; cold: it samples the span and
  /// refines every turning point. duration_s > 0.
  ReferenceExtremes extremes(int order, double duration_s) const;

 private:
  struct Builder;
  /// Polynomial sum c_i w^i in w = (t - origin_s) rate_per_s, valid until end_s; a negative rate runs from the far end.
  struct Piece {
    double end_s, origin_s, rate_per_s;
    std::uint32_t first_coefficient, coefficients;
  };
  /// A range of pieces, in time; before its begin and after its end it rests.
  struct Track {
    double begin_s, end_s, first_value, last_value;
    std::uint32_t first_piece, pieces;
  };
  struct Component {
    double amplitude_m, rate_rad_per_s, phase_rad;
  };
  /// center + ramp(t) sum of components; ramp is a track from 0 to 1.
  struct Oscillation {
    double center_m, start_s;
    Track ramp;
    std::uint32_t first_component, components;
  };
  using Derivatives = std::array<double, 8>;

  void evaluate(const Track& track, double t_s, Derivatives& d) const noexcept;
  void add(const Oscillation& oscillation, double t_s, Derivatives& d) const noexcept;

  std::vector<Track> tracks_;
  std::vector<Oscillation> oscillations_;
  std::vector<Piece> pieces_;
  std::vector<double> coefficients_;
  std::vector<Component> components_;
  std::shared_ptr<const LivePlanner> planned_;
  double start_s_ = 0.0, end_s_ = 0.0;
};

/// Extremes of the position that a reference asks for during a run [m], for checks against the stroke. Throws as
/// Reference's constructor does.
ReferenceExtremes reference_range_m(const ReferenceSpec& spec, double duration_s, const LoadPositions& load = {});
/// Largest |velocity| that a reference asks for during a run [m/s].
double reference_peak_speed_mps(const ReferenceSpec& spec, double duration_s, const LoadPositions& load = {});

}  // namespace pneuservo
