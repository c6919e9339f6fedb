// One row of a recording: the columns of the format, declared once for ring, writer, reader and reports.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include <pneuservo/core/signal.hpp>

namespace pneuservo {

/// Bits of the column `flags`.
enum RowFlag : std::uint32_t {
  row_overrun = 1,          ///< this tick came late, slots were skipped before it
  row_dropped_before = 2,   ///< rows were dropped before this one
  row_command_limited = 4,
  row_fault = 8,
  row_input_bridged = 16,   ///< a sample of this tick was wrong and was replaced
  row_pass_begins = 32,     ///< a commanded move begins and follows a command pass
};

// All columns in file order, each declared by its line alone: type, name, value where there is none, and what the loop
// puts there, in the names of AxisLoop::fill_row, which alone expands it (PressureLoop sets its few). OF_AXIS: of
// position or side 2, which a pressure rig does not have; OF_VOLUME: of a pressure rig alone. MEASURED stands for the
// columns of signal_table from the first signal to the last.
#define PNEUSERVO_ROW_COLUMNS(COLUMN, OF_AXIS, OF_VOLUME, MEASURED)                                                    \
  COLUMN(double, t_s, 0.0, t_s)                                                                                        \
  OF_AXIS(double, x_ref_m, none, known(!begins_, now_.d[0]))                                                           \
  OF_AXIS(double, v_ref_mps, none, known(!begins_, now_.d[1]))                                                         \
  OF_VOLUME(double, p_ref_Pa, none, Row::none)                                                                         \
  /* of the simulated closed loop */                                                                                   \
  OF_AXIS(double, x_predicted_m, none, known(!twin_waits_, twin_.position_m()))                                        \
  MEASURED(x, x)                                                                                                       \
  OF_AXIS(double, v_mps, none, velocity_mps_)                                                                          \
  /* without an encoder: position and its bound, both switches (switch_bits) */                                        \
  OF_AXIS(double, x_estimated_m, none, known(encoderless_.is_on(), encoderless_x_m_))                                  \
  OF_AXIS(double, x_bound_m, none, known(encoderless_.is_on(), encoderless_bound_m_))                                  \
  OF_AXIS(std::uint32_t, switches, 0, encoderless_.is_on() ? switch_bits(measured.digital) : 0u)                       \
  COLUMN(double, u_V, none, known(!two_valves, supervisor_.command_V()[0]))                                            \
  /* of a servo table's two valves, instead of u_V */                                                                  \
  COLUMN(double, u1_V, none, known(two_valves, supervisor_.command_V()[0]))                                            \
  COLUMN(double, u2_V, none, known(two_valves, supervisor_.command_V()[1]))                                            \
  MEASURED(p1_port, p2_chamber)                                                                                        \
  COLUMN(double, p1_estimated_Pa, none, known(estimated, estimate.chamber_pressure_Pa[0]))                             \
  OF_AXIS(double, p2_estimated_Pa, none, known(estimated, estimate.chamber_pressure_Pa[1]))                            \
  /* the estimator's stated error bounds */                                                                            \
  COLUMN(double, p1_bound_Pa, none, known(estimated, estimate.error_bound_Pa[0]))                                      \
  OF_AXIS(double, p2_bound_Pa, none, known(estimated, estimate.error_bound_Pa[1]))                                     \
  /* estimated, into the chambers */                                                                                   \
  COLUMN(double, mass_flow_1_kgps, none, known(estimated, estimate.mass_flow_kgps[0]))                                 \
  OF_AXIS(double, mass_flow_2_kgps, none, known(estimated, estimate.mass_flow_kgps[1]))                                \
  MEASURED(p_supply, supply_flow)                                                                                      \
  MEASURED(dp1, dp2)                                                                                                   \
  OF_AXIS(double, x_true_m, none, truth.x_m)                                                                           \
  COLUMN(double, p1_chamber_true_Pa, none, truth.p1_chamber_Pa)                                                        \
  OF_AXIS(double, p2_chamber_true_Pa, none, truth.p2_chamber_Pa)                                                       \
  /* real time only, set after the pass by what drives it */                                                           \
  COLUMN(double, lateness_us, none, Row::none)                                                                         \
  COLUMN(double, work_us, none, Row::none)                                                                             \
  /* SupervisorState (loop/supervisor.hpp) */                                                                          \
  COLUMN(std::uint32_t, state, 0, static_cast<std::uint32_t>(supervisor_.state()))                                     \
  /* bits of RowFlag */                                                                                                \
  COLUMN(std::uint32_t, flags, 0, row_flags(skipped) | (stepped && pass_begins_ ? row_pass_begins : 0u))               \
  /* bits of Fault (loop/fault.hpp), 0 while healthy */                                                                \
  COLUMN(std::uint64_t, fault, 0, supervisor_.faults())                                                                \
  /* CommandKind (loop/axis_command.hpp) that was obeyed in this tick, its target or way, its speed */                 \
  COLUMN(std::uint32_t, command_kind, 0, static_cast<std::uint32_t>(desk_.obeyed()))                                   \
  OF_AXIS(double, command_m, none, known(commanded, asked.target))                                                     \
  OF_AXIS(double, command_mps, none, known(commanded, asked.rate))                                                     \
  OF_VOLUME(double, command_Pa, none, Row::none)                                                                       \
  OF_VOLUME(double, command_Pa_per_s, none, Row::none)                                                                 \
  /* until the next set point of a stream */                                                                           \
  COLUMN(double, command_s, none, known(commanded, asked.interval_s))

/// Plain data, copied through the ring. NaN means "no value" and is written as an empty field.
struct Row {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

#define PNEUSERVO_MEMBER(type, name, initial, value) type name = initial;
#define PNEUSERVO_NO_MEMBER(first, last)
  PNEUSERVO_ROW_COLUMNS(PNEUSERVO_MEMBER, PNEUSERVO_MEMBER, PNEUSERVO_MEMBER, PNEUSERVO_NO_MEMBER)
#undef PNEUSERVO_MEMBER
  PerSignal<double> measured = [] {
    PerSignal<double> values;
    values.all.fill(none);
    return values;
  }();
  static constexpr std::size_t most_terms = 16;
  std::array<double, most_terms> terms = no_terms();  ///< of the law, which names them (control/law.hpp)

  static constexpr std::array<double, most_terms> no_terms() noexcept {
    std::array<double, most_terms> out;
    out.fill(none);
    return out;
  }
  /// v(name, member...) for every column in file order, the law's terms last, by their names.
  template <class V, class... R> static void visit_all(std::span<const std::string_view> term_names, V&& v, R&... r) {
    visit(v, r...);
    for (std::size_t i = 0; i < term_names.size(); ++i) v(term_names[i], r.terms[i]...);
  }
  /// v(name, member...) for the columns that no law names.
  template <class V, class... R> static constexpr void visit(V&& v, R&... r) {
    const auto visit_measured = [&](Signal first, Signal last) {
      for (std::size_t i = index_of(first); i <= index_of(last); ++i)
        v(signal_table[i].column, r.measured[all_signals[i]]...);
    };
#define PNEUSERVO_VISIT(type, name, initial, value) v(std::string_view(#name), r.name...);
#define PNEUSERVO_VISIT_MEASURED(first, last) visit_measured(Signal::first, Signal::last);
    PNEUSERVO_ROW_COLUMNS(PNEUSERVO_VISIT, PNEUSERVO_VISIT, PNEUSERVO_VISIT, PNEUSERVO_VISIT_MEASURED)
#undef PNEUSERVO_VISIT
#undef PNEUSERVO_VISIT_MEASURED
  }
};

inline constexpr std::size_t row_column_count = [] {
  std::size_t count = 0;
  Row::visit([&](std::string_view) { ++count; });
  return count;
}();

/// Whether a rig that controls a pressure, or one that does not, records this column.
constexpr bool is_column_of(std::string_view column, bool controls_pressure) {
#define PNEUSERVO_OF_BOTH(type, name, initial, value)
#define PNEUSERVO_OF_AXIS(type, name, initial, value)                                                                  \
  if (column == #name) return !controls_pressure;
#define PNEUSERVO_OF_VOLUME(type, name, initial, value)                                                                \
  if (column == #name) return controls_pressure;
  PNEUSERVO_ROW_COLUMNS(PNEUSERVO_OF_BOTH, PNEUSERVO_OF_AXIS, PNEUSERVO_OF_VOLUME, PNEUSERVO_NO_MEMBER)
#undef PNEUSERVO_OF_BOTH
#undef PNEUSERVO_OF_AXIS
#undef PNEUSERVO_OF_VOLUME
#undef PNEUSERVO_NO_MEMBER
  return true;
}

/// One column of numbers of a row: a member or a measured signal.
class RowColumn {
 public:
  constexpr RowColumn(double Row::* member) noexcept : member_(member) {}
  constexpr RowColumn(Signal signal) noexcept : signal_(signal) {}
  constexpr double of(const Row& row) const noexcept {
    return member_ != nullptr ? row.*member_ : row.measured[signal_];
  }

 private:
  double Row::* member_ = nullptr;
  Signal signal_ = Signal::x;
};

}  // namespace pneuservo
