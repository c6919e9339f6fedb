// What a control law is: what it sees and gives, its recorded terms, and the concept that laws.hpp holds it to.
#pragma once
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string_view>

#include <pneuservo/control/pass_table.hpp>
#include <pneuservo/control/reference.hpp>
#include <pneuservo/core/field.hpp>

namespace pneuservo {

template <class S> struct AxisParameters;
template <class S> struct ElasticVolumeParameters;

/// Which pressures close the force loop.
enum class PressureSource { valve, chamber, estimated, differential };
inline constexpr std::array<std::string_view, 4> pressure_source_names{"valve", "chamber", "estimated", "differential"};

/// What a law sees in a period. Pressures are absolute [Pa].
struct ControlInput {
  double x_m = 0.0;                       ///< measured position
  std::array<double, 2> pressure_Pa{};    ///< those that close a force loop
  std::array<double, 2> port_Pa{};        ///< measured at the valve ports
  double supply_Pa = std::numeric_limits<double>::quiet_NaN();  ///< measured; NaN: that of the axis
  ReferencePoint now{}, ahead{};          ///< reference at t and at t + lead_s()
  std::int64_t tick = 0;                  ///< periods since the reference's own time 0; negative: on the way to it
};

/// What a law gives in a period.
struct ControlOutput {
  std::array<double, 2> command_V{};  ///< the second for a second valve
  double speed_mps = 0.0;             ///< of the slider, as the law filtered it
  bool limited = false;
  bool finite = true;                 ///< false: no finite command came out; the last ones were kept
};

/// What a law is configured with beside its parameters; duration_s is how long it follows the reference. `pass`: that
/// of the reference, for a law that asks for one; null: none; without rows: passes come with the moves. `volume`: at
/// the end of line_1, of a law that controls its pressure.
struct LawSetup {
  const AxisParameters<double>& axis;
  double period_s;
  const Reference& reference;
  double duration_s;
  std::shared_ptr<const PassTable> pass{};
  const ElasticVolumeParameters<double>* volume = nullptr;
};

/// One recorded term of a law. The name is the recording's column and ends in the unit.
struct LawTerm {
  std::string_view name, unit, help;
  bool is_standing = false;  ///< holds in periods without a step, too, as a gain does
};

/// Number of terms that a law records; its Terms are visited without an object.
template <class L> consteval std::size_t term_count() {
  std::size_t count = 0;
  L::Terms::visit([&](const LawTerm&) { ++count; });
  return count;
}

/// Takes whatever a visit of parameters or terms offers.
struct IgnoreMembers {
  template <class... T> constexpr void operator()(const T&...) const noexcept {}
};

// The pieces of a law. laws.hpp names the one that is missing.
template <class L>
concept HasName = requires {
  { L::name } -> std::convertible_to<std::string_view>;
};
template <class L>
concept DrivesValves = requires { requires L::valves == 1 || L::valves == 2; };
template <class L>
concept HasParameters = requires(typename L::Parameters& p) { L::Parameters::visit(IgnoreMembers{}, p); };
template <class L>
concept Configures =
    requires(L law, const typename L::Parameters& p, const LawSetup& setup) { law.configure(p, setup); };
template <class L>
concept Resets = requires(L law, const std::array<double, 2>& previous_V) {
  { law.reset(previous_V) } noexcept;
};
template <class L>
concept Steps = requires(L law, const ControlInput& in) {
  { law.step(in) } noexcept -> std::same_as<ControlOutput>;
};
template <class L>
concept Skips = requires(L law, std::int64_t periods) {
  { law.skip(periods) } noexcept;
};
template <class L>
concept HasTerms = requires(const L& law) {
  { law.terms() } noexcept -> std::same_as<const typename L::Terms&>;
  L::Terms::visit(IgnoreMembers{}, law.terms());
};
/// A law of two valves says what the air rests at before the first move: no single command balances the piston.
template <class L>
concept KnowsRest = L::valves == 1 || requires(const typename L::Parameters& p) {
  { p.rest_pressure_Pa() } -> std::same_as<double>;
};

/// Controls a pressure, not a position: positions of its references are pressures [Pa].
template <class L>
concept ControlsPressure = requires { requires L::controls_pressure; };
/// Can run a drive that gives its force at once.
template <class L>
concept HasOuterLoop = requires(typename L::Parameters& p) { L::Parameters::visit_outer_loop(IgnoreMembers{}, p); };
/// A control law: all of it but configure is HOT. Optional: lead_s(), rest_s(moved, port_Pa), learns() with learn(axis)
/// and moves_not_learned(), repeated_move() with begin_with_learned(commands), follow_pass(rows, from) with
/// pass_ticks(table, reference), change_gains(gains); of its Parameters:
/// pressure_source, velocity_filter_s, command_delay_s, pressures(), feeds_back_ports(), feedforward_name(),
/// wants_pass(), visit_outer_loop(v, p...).
template <class L>
concept ControlLaw = HasName<L> && DrivesValves<L> && HasParameters<L> && Configures<L> && Resets<L> && Steps<L> &&
                     Skips<L> && HasTerms<L> && KnowsRest<L>;

/// The list of laws: each law's header defines the next number with its class as `Law`, laws.hpp includes the header.
template <std::size_t Number> struct LawAt;

}  // namespace pneuservo
