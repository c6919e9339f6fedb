// The control law that a config names, behind one face for the loop.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <pneuservo/control/parameters.hpp>

namespace pneuservo {

/// function(law) with the law that the variant holds; a branch a law, no exception.
template <std::size_t Number = 0, class Variant, class F>
constexpr decltype(auto) visit_law(Variant& law, F&& function) {
  if constexpr (Number + 1 < law_count)
    if (law.index() != Number) return visit_law<Number + 1>(law, std::forward<F>(function));
  return function(*std::get_if<Number>(&law));
}

/// The law that a config names. All of it is HOT but configure and learn.
class AxisController {
 public:
  /// Cold; may allocate, and throws std::invalid_argument where the law cannot follow the reference over duration_s.
  /// `pass`: of the reference, where the law asks for one; `volume`: whose pressure the law controls.
  void configure(const ControllerParameters& parameters, const AxisParameters<double>& axis, double period_s,
                 const Reference& reference, double duration_s, std::shared_ptr<const PassTable> pass = {},
                 const ElasticVolumeParameters<double>* volume = nullptr);
  /// Forgets integral and filters; rates count from the previous commands.
  void reset(const std::array<double, 2>& previous_V) noexcept {
    visit_law(law_, [&](auto& law) { law.reset(previous_V); });
  }
  /// One period's commands; always finite.
  ControlOutput step(const ControlInput& in) noexcept {
    return visit_law(law_, [&](auto& law) { return law.step(in); });
  }
  /// Periods passed without a step (a late loop skipped its slots).
  void skip(std::int64_t periods) noexcept {
    visit_law(law_, [&](auto& law) { law.skip(periods); });
  }
  /// Writes the law's terms of the last step in the order of law_terms(); without a step, the standing ones alone.
  void write_terms(bool stepped, std::span<double> out) const noexcept {
    visit_law(law_, [&]<class L>(const L& law) {
      std::size_t i = 0;
      L::Terms::visit(
          [&](const LawTerm& term, const auto& value) {
            out[i++] = stepped || term.is_standing ? static_cast<double>(value) : no_value;
          },
          law.terms());
    });
  }

  /// How far ahead of t the second reference point of a step lies [s].
  double lead_s() const noexcept {
    return visit_law(law_, [](const auto& law) {
      if constexpr (requires { law.lead_s(); }) return law.lead_s();
      else return 0.0;
    });
  }
  /// How long the slider shall rest before the reference begins [s]; `moved`: a move has just brought it there.
  double rest_s(bool moved, const std::array<double, 2>& port_Pa) const noexcept {
    return visit_law(law_, [&](const auto& law) {
      if constexpr (requires { law.rest_s(moved, port_Pa); }) return law.rest_s(moved, port_Pa);
      else return 0.0;
    });
  }
  /// Whether a finished move teaches the next one.
  bool learns() const noexcept {
    return visit_law(law_, [](const auto& law) {
      if constexpr (requires { law.learns(); }) return law.learns();
      else return false;
    });
  }
  /// Learns from the finished move; between moves (ticks below 0); `axis` is that of configure. Cold.
  void learn(const AxisParameters<double>& axis) {
    visit_law(law_, [&](auto& law) {
      if constexpr (requires { law.learn(axis); })
        if (law.learns()) law.learn(axis);
    });
  }
  /// From the next step on follows a pass of a motion that came at run time; none: the formula alone.
  void follow_pass(std::span<const PassTick> rows, std::int64_t from) noexcept {
    visit_law(law_, [&](auto& law) {
      if constexpr (requires { law.follow_pass(rows, from); }) law.follow_pass(rows, from);
    });
  }
  /// The repeated move of a law that learns its command; null: none.
  const RepeatedMove* repeated_move() const noexcept {
    return visit_law(law_, [](const auto& law) -> const RepeatedMove* {
      if constexpr (requires { law.repeated_move(); }) return law.learns() ? &law.repeated_move() : nullptr;
      else return nullptr;
    });
  }
  /// What earlier runs of that move learned. Cold.
  void begin_with_learned(const std::vector<double>& learned_V) {
    visit_law(law_, [&](auto& law) {
      if constexpr (requires { law.begin_with_learned(learned_V); }) law.begin_with_learned(learned_V);
    });
  }
  /// Moves that taught nothing because the loop was late.
  int moves_not_learned() const noexcept {
    return visit_law(law_, [](const auto& law) {
      if constexpr (requires { law.moves_not_learned(); }) return law.moves_not_learned();
      else return 0;
    });
  }
  /// Other gains from the next step on, without a jump; of a law that takes them.
  void change_gains(const Ppd2GainSet& gains) noexcept {
    visit_law(law_, [&](auto& law) {
      if constexpr (requires { law.change_gains(gains); }) law.change_gains(gains);
    });
  }
  /// Pressures that the law takes; only a force loop has a choice.
  PressureSource pressure_source() const noexcept { return source_; }

 private:
  static constexpr double no_value = std::numeric_limits<double>::quiet_NaN();
  PressureSource source_ = PressureSource::valve;
  Laws::Variant law_;
};

}  // namespace pneuservo
