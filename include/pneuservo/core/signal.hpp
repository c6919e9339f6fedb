// Every measured quantity of a rig, once: its name, unit, recording column, sensor and side.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace pneuservo {

enum class Signal : std::uint8_t { x, p1_port, p2_port, p1_chamber, p2_chamber, p_supply, supply_flow, F, dp1, dp2 };

/// Signals of one kind share the section of `sensors` that describes their sensor.
enum class SensorKind : std::uint8_t {
  position,
  port_pressure,
  chamber_pressure,
  supply_pressure,
  supply_flow,
  force,
  differential_pressure
};

/// `name` is the key in hal.channels, zeros and effects; `column` is name and unit, "/" as "p". Side 0: no side of the
/// cylinder.
struct SignalInfo {
  std::string_view name, unit, column;
  SensorKind sensor;
  std::uint8_t side;
  std::string_view words;
};

/// In the order of Signal. Positions are 0 at mid-stroke, pressures absolute, differences positive where the port's
/// pressure is the higher one.
inline constexpr std::array signal_table{
    SignalInfo{"x", "m", "x_m", SensorKind::position, 0, "position"},
    SignalInfo{"p1_port", "Pa", "p1_port_Pa", SensorKind::port_pressure, 1, "pressure at valve port 1, absolute"},
    SignalInfo{"p2_port", "Pa", "p2_port_Pa", SensorKind::port_pressure, 2, "pressure at valve port 2, absolute"},
    SignalInfo{"p1_chamber", "Pa", "p1_chamber_Pa", SensorKind::chamber_pressure, 1, "pressure in chamber 1, absolute"},
    SignalInfo{"p2_chamber", "Pa", "p2_chamber_Pa", SensorKind::chamber_pressure, 2, "pressure in chamber 2, absolute"},
    SignalInfo{"p_supply", "Pa", "p_supply_Pa", SensorKind::supply_pressure, 0, "supply pressure, absolute"},
    SignalInfo{"supply_flow", "kg/s", "supply_flow_kgps", SensorKind::supply_flow, 0,
               "flow from the supply into the valves"},
    SignalInfo{"F", "N", "F_N", SensorKind::force, 0, "drive force"},
    SignalInfo{"dp1", "Pa", "dp1_Pa", SensorKind::differential_pressure, 1,
               "pressure lost along line 1, port less chamber"},
    SignalInfo{"dp2", "Pa", "dp2_Pa", SensorKind::differential_pressure, 2,
               "pressure lost along line 2, port less chamber"},
};
inline constexpr std::size_t signal_count = signal_table.size();

constexpr std::size_t index_of(Signal signal) noexcept { return static_cast<std::size_t>(signal); }
constexpr const SignalInfo& info(Signal signal) noexcept { return signal_table[index_of(signal)]; }
constexpr bool is_in_pascal(Signal signal) noexcept { return info(signal).unit == "Pa"; }
constexpr bool is_difference(Signal signal) noexcept {
  return info(signal).sensor == SensorKind::differential_pressure;
}
/// An absolute one.
constexpr bool is_pressure(Signal signal) noexcept { return is_in_pascal(signal) && !is_difference(signal); }
/// What sensors show of the gas.
constexpr bool is_gas(Signal signal) noexcept { return is_in_pascal(signal) || info(signal).unit == "kg/s"; }
constexpr bool is_port(Signal signal) noexcept { return info(signal).sensor == SensorKind::port_pressure; }
constexpr bool is_chamber(Signal signal) noexcept { return info(signal).sensor == SensorKind::chamber_pressure; }
/// Whether a running axis has a channel for it: a drive force is only recorded.
constexpr bool is_channel(Signal signal) noexcept { return info(signal).sensor != SensorKind::force; }
/// Index of its side in pairs of both sides; 0 where it has none.
constexpr std::size_t side_of(Signal signal) noexcept { return info(signal).side == 2 ? 1 : 0; }

/// All signals in their order.
inline constexpr std::array<Signal, signal_count> all_signals = [] {
  std::array<Signal, signal_count> all{};
  for (std::size_t i = 0; i < signal_count; ++i) all[i] = static_cast<Signal>(i);
  return all;
}();

/// The signals that are so, in their order.
template <bool (*is)(Signal) noexcept> constexpr auto signals_that() noexcept {
  constexpr auto count = static_cast<std::size_t>(std::ranges::count_if(all_signals, is));
  std::array<Signal, count> kept{};
  std::ranges::copy_if(all_signals, kept.begin(), is);
  return kept;
}
inline constexpr auto channel_signals = signals_that<is_channel>();
inline constexpr auto pressure_signals = signals_that<is_pressure>();
inline constexpr auto pascal_signals = signals_that<is_in_pascal>();
inline constexpr auto gas_signals = signals_that<is_gas>();
inline constexpr auto port_signals = signals_that<is_port>();        ///< by side
inline constexpr auto chamber_signals = signals_that<is_chamber>();  ///< by side
inline constexpr auto difference_signals = signals_that<is_difference>();  ///< by side

/// One T for every signal, indexed by Signal alone.
template <class T> struct PerSignal {
  std::array<T, signal_count> all{};
  constexpr T& operator[](Signal signal) noexcept { return all[index_of(signal)]; }
  constexpr const T& operator[](Signal signal) const noexcept { return all[index_of(signal)]; }
};

/// The signal of a name such as "p1_port"; none where there is no such signal.
constexpr std::optional<Signal> signal_named(std::string_view name) noexcept {
  for (const Signal signal : all_signals)
    if (info(signal).name == name) return signal;
  return std::nullopt;
}

/// The signal of a recording's column such as "p1_port_Pa"; none where the column is no measurement.
constexpr std::optional<Signal> signal_of_column(std::string_view column) noexcept {
  for (const Signal signal : all_signals)
    if (info(signal).column == column) return signal;
  return std::nullopt;
}

/// Names of the signals of a list, for messages and manuals.
template <std::size_t N>
constexpr std::array<std::string_view, N> names_of(const std::array<Signal, N>& signals) noexcept {
  std::array<std::string_view, N> names;
  for (std::size_t i = 0; i < N; ++i) names[i] = info(signals[i]).name;
  return names;
}

constexpr bool columns_are_names_with_units() noexcept {
  return std::ranges::all_of(signal_table, [](const SignalInfo& s) {
    const auto is_same = [](char ours, char unit) { return ours == (unit == '/' ? 'p' : unit); };
    return s.column.starts_with(s.name) && s.column.substr(s.name.size()).starts_with('_') &&
           std::ranges::equal(s.column.substr(s.name.size() + 1), s.unit, is_same);
  });
}
static_assert(columns_are_names_with_units());

}  // namespace pneuservo
