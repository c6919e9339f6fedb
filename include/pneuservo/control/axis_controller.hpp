// The control law that a config names, behind one face for the loop.
#pragma once
#include <array>
#include <cstdint>

#include <pneuservo/control/parameters.hpp>
#include <pneuservo/control/pd_force.hpp>
#include <pneuservo/control/ppd2.hpp>
#include <pneuservo/control/reference.hpp>

namespace pneuservo {

/// What a law sees in a period. Pressures are absolute [Pa].
struct ControlInput {
  double x_m = 0.0;                       ///< measured position
  std::array<double, 2> pressure_Pa{};    ///< those that close a force loop
  std::array<double, 2> port_Pa{};        ///< measured at the valve ports
  ReferencePoint now, ahead;              ///< reference at t and at t + lead_s()
  std::int64_t tick = 0;                  ///< periods since the reference's own time 0; negative: on the way to it
};

/// What a law gives in a period.
struct ControlOutput {
  std::array<double, 2> command_V{};  ///< the second for a second valve
  double speed_mps = 0.0;             ///< of the slider, as the law filtered it
  bool limited = false;
  bool finite = true;                 ///< false: no finite command came out; the last ones were kept
};

/// One law out of those that ControllerKind names. All of it is HOT but configure and learn.
class AxisController {
 public:
  /// Cold; may allocate, and throws std::invalid_argument where the law cannot follow the reference over duration_s.
  void configure(const ControllerParameters& parameters, const AxisParameters<double>& axis, double period_s,
                 const Reference& reference, double duration_s);
  /// Forgets integral and filters; rates count from the previous commands.
  void reset(const std::array<double, 2>& previous_V) noexcept;
  /// One period's commands; always finite.
  ControlOutput step(const ControlInput& in) noexcept;
  /// Periods passed without a step (a late loop skipped its slots).
  void skip(std::int64_t periods) noexcept;

  /// How far ahead of t the second reference point of a step lies [s].
  double lead_s() const noexcept;
  /// How long the slider shall rest before the reference begins [s]; `moved`: a move has just brought it there.
  double rest_s(bool moved, const std::array<double, 2>& port_Pa) const noexcept;
  /// Whether a finished move teaches the next one.
  bool learns() const noexcept { return kind_ == ControllerKind::ppd2 && ppd2_.learns(); }
  /// Learns from the finished move; between moves (ticks below 0); `axis` is that of configure. Cold.
  void learn(const AxisParameters<double>& axis) {
    if (learns()) ppd2_.learn(axis);
  }
  /// Other gains from the next step on, without a jump; of the PPD2 law alone. HOT.
  void change_gains(const Ppd2GainSet& gains) noexcept {
    if (kind_ == ControllerKind::ppd2) ppd2_.change_gains(gains);
  }
  /// Pressures that the law takes; only a force loop has a choice.
  PressureSource pressure_source() const noexcept { return source_; }

  const PdForce& pd_force() const noexcept { return pd_force_; }
  const Ppd2& ppd2() const noexcept { return ppd2_; }
  Ppd2& ppd2() noexcept { return ppd2_; }
  ControllerKind kind() const noexcept { return kind_; }

 private:
  ControllerKind kind_ = ControllerKind::pd_force;
  PressureSource source_ = PressureSource::valve;
  PdForce pd_force_;
  Ppd2 ppd2_;
};

}  // namespace pneuservo
