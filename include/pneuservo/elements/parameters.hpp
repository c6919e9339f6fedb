// Parameter structs of supply, valve, line, cylinder, slider and sensors: one declaration of each key of a rig.
#pragma once
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include <pneuservo/core/field.hpp>
#include <pneuservo/elements/on_off_valve.hpp>

namespace pneuservo {

template <class S> struct SupplyParameters {
  S pressure_Pa{};
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"pressure_Pa", "Pa", 1.05e5, 2e6, "supply pressure, absolute"}, p.pressure_Pa...);
  }
};

/// Proportional valve; the effective area is area_per_volt |spool|, at most area_max. With `on_off`, a section of its
/// own: two on/off valves of that area at command_max.
template <class S> struct ValveParameters {
  S command_max_V{};
  S area_per_volt_m2_per_V{};
  S area_max_m2{};
  S critical_pressure_ratio{};
  S natural_frequency_Hz = S(0);
  S damping_ratio = S(0.7);
  std::optional<PulsedValveParameters> on_off{};
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"command_max_V", "V", 1e-3, 1000, "command range is +- this"}, p.command_max_V...);
    v(Field{"area_per_volt_m2_per_V", "m2/V", 1e-12, 1e-2, "effective area per volt of spool signal"},
      p.area_per_volt_m2_per_V...);
    v(Field{"area_max_m2", "m2", 1e-10, 1e-2, "largest effective area"}, p.area_max_m2...);
    v(Field{"critical_pressure_ratio", "-", 0.05, 0.9, "b of ISO 6358"}, p.critical_pressure_ratio...);
    v(Field{"natural_frequency_Hz", "Hz", 0, 1e4, "of the spool; 0: it follows at once", Presence::optional},
      p.natural_frequency_Hz...);
    v(Field{"damping_ratio", "-", 0.01, 10, "of the spool", Presence::optional}, p.damping_ratio...);
  }
};

/// Cross-section [m2] of a round bore.
template <class S> S bore_area_m2(const S& diameter_m) noexcept {
  return S(0.25 * std::numbers::pi) * diameter_m * diameter_m;
}

/// How a line is computed: by cells along its length, or as a lag of second order on the flow into the chamber.
enum class LineModel { distributed, second_order_lag };
inline constexpr std::array<std::string_view, 2> line_model_names{"distributed", "second_order_lag"};

/// Pipeline from a valve port to a chamber.
template <class S> struct LineParameters {
  S length_m{};
  S diameter_m{};
  S laminar_reynolds = S(2300);
  S turbulent_reynolds = S(4000);
  LineModel model = LineModel::distributed;
  S natural_frequency_Hz = S(0);
  S damping_ratio = S(0.05);
  S section_m2() const noexcept { return bore_area_m2(diameter_m); }
  S volume_m3() const noexcept { return section_m2() * length_m; }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"length_m", "m", 0.01, 100, "valve port to chamber"}, p.length_m...);
    v(Field{"diameter_m", "m", 5e-4, 0.05, "inner diameter"}, p.diameter_m...);
    v(Field{"laminar_reynolds", "-", 1, 1e5, "Re_1: lambda = 64/Re up to here (the thesis: 2300)", Presence::optional},
      p.laminar_reynolds...);
    v(Field{"turbulent_reynolds", "-", 1, 1e5,
            "Re_2: lambda = 0.3164 Re^-0.25 from here, linear between (the thesis: 2300)", Presence::optional},
      p.turbulent_reynolds...);
    v(Field{"model", "", 0, 0, "how the line is computed", Presence::optional, line_model_names}, p.model...);
    v(Field{"natural_frequency_Hz", "Hz", 0, 1e4, "of a second_order_lag", Presence::optional},
      p.natural_frequency_Hz...);
    v(Field{"damping_ratio", "-", 0, 10, "of a second_order_lag", Presence::optional}, p.damping_ratio...);
  }
};

/// Double-acting cylinder; x = 0 is mid-stroke, |x| <= stroke/2.
template <class S> struct CylinderParameters {
  S stroke_m{};
  S area_1_m2{};
  S area_2_m2{};
  S dead_volume_1_m3{};
  S dead_volume_2_m3{};
  S wall_heat_W_per_m2K{};
  S end_stop_restitution = S(0.3);
  S linear_about_Pa = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"stroke_m", "m", 1e-3, 10, "from end stop to end stop"}, p.stroke_m...);
    v(Field{"area_1_m2", "m2", 1e-6, 1, "piston area of chamber 1 (it pushes to positive x)"}, p.area_1_m2...);
    v(Field{"area_2_m2", "m2", 1e-6, 1, "piston area of chamber 2"}, p.area_2_m2...);
    v(Field{"dead_volume_1_m3", "m3", 1e-9, 1, "of chamber 1 at its end stop"}, p.dead_volume_1_m3...);
    v(Field{"dead_volume_2_m3", "m3", 1e-9, 1, "of chamber 2 at its end stop"}, p.dead_volume_2_m3...);
    v(Field{"wall_heat_W_per_m2K", "W/(m2 K)", 0, 1e5, "heat transfer gas to chamber wall"}, p.wall_heat_W_per_m2K...);
    v(Field{"end_stop_restitution", "-", 0, 1, "speed after an end stop over speed before", Presence::optional},
      p.end_stop_restitution...);
    v(Field{"linear_about_Pa", "Pa", 0, 2e6,
            "P_0 of linear flows and chambers (2.3 to 2.6) about mid-stroke, behind lines that are lags; 0: none",
            Presence::optional},
      p.linear_about_Pa...);
  }
};

template <class S> struct SliderParameters {
  S mass_kg{};
  S payload_kg = S(0);
  S viscous_friction_Ns_per_m{};
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"mass_kg", "kg", 1e-3, 1e4, "moving mass without payload"}, p.mass_kg...);
    v(Field{"payload_kg", "kg", 0, 1e4, "added mass", Presence::optional}, p.payload_kg...);
    v(Field{"viscous_friction_Ns_per_m", "N s/m", 0, 1e5, "B of B v"}, p.viscous_friction_Ns_per_m...);
  }
};

/// Noise and rounding of a sensor together, root mean square: rounding to a quantum q adds a variance of q^2/12.
inline double rms_with_quantum(double noise, double quantum) noexcept {
  return std::hypot(noise, quantum / std::sqrt(12.0));
}

struct PositionSensorParameters {
  double quantum_m = 0.0;
  double noise_m = 0.0;
  bool incremental = false;
  double rms_m() const noexcept { return rms_with_quantum(noise_m, quantum_m); }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"quantum_m", "m", 0, 0.01, "resolution; 0: none"}, p.quantum_m...);
    v(Field{"noise_m", "m", 0, 0.01, "white noise, rms", Presence::optional}, p.noise_m...);
    v(Field{"incremental", "", 0, 0,
            "counts from where it was switched on: devices run only with --zeros FILE of the verb home",
            Presence::optional},
      p.incremental...);
  }
};

struct ForceSensorParameters {
  double quantum_N = 0.0;
  double noise_N = 0.0;
  double rms_N() const noexcept { return rms_with_quantum(noise_N, quantum_N); }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"quantum_N", "N", 0, 1e5, "resolution; 0: none"}, p.quantum_N...);
    v(Field{"noise_N", "N", 0, 1e5, "white noise, rms", Presence::optional}, p.noise_N...);
  }
};

struct PressureSensorParameters {
  double quantum_Pa = 0.0;
  double noise_Pa = 0.0;
  double rms_Pa() const noexcept { return rms_with_quantum(noise_Pa, quantum_Pa); }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"quantum_Pa", "Pa", 0, 1e5, "resolution; 0: none"}, p.quantum_Pa...);
    v(Field{"noise_Pa", "Pa", 0, 1e5, "white noise, rms", Presence::optional}, p.noise_Pa...);
  }
};

/// Of what a line loses between port and chamber: far less noise than two absolute sensors, and a range of its own.
struct DifferentialSensorParameters {
  double quantum_Pa = 0.0;
  double noise_Pa = 0.0;
  double range_Pa = 0.0;  ///< 0: there is no sensor
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"quantum_Pa", "Pa", 0, 1e5, "resolution; 0: none"}, p.quantum_Pa...);
    v(Field{"noise_Pa", "Pa", 0, 1e5, "white noise, rms", Presence::optional}, p.noise_Pa...);
    v(Field{"range_Pa", "Pa", 0, 2e6, "it shows this much at most, to both sides; 0: there is no sensor",
            Presence::optional},
      p.range_Pa...);
  }
};

struct FlowSensorParameters {
  double quantum_kgps = 0.0;
  double noise_kgps = 0.0;
  double rms_kgps() const noexcept { return rms_with_quantum(noise_kgps, quantum_kgps); }
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"quantum_kgps", "kg/s", 0, 1, "resolution; 0: none"}, p.quantum_kgps...);
    v(Field{"noise_kgps", "kg/s", 0, 1, "white noise, rms", Presence::optional}, p.noise_kgps...);
  }
};

}  // namespace pneuservo
