// PI on the pressure of a volume behind a hose: the wanted flow by the valve's inverse (docs/physics/pressure_pi.md).
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <pneuservo/control/law.hpp>
#include <pneuservo/control/limits.hpp>
#include <pneuservo/control/pulse_width.hpp>
#include <pneuservo/elements/air.hpp>
#include <pneuservo/elements/elastic_volume.hpp>
#include <pneuservo/elements/valve.hpp>

namespace pneuservo {

struct PressurePiParameters {
  static constexpr double least_gain_per_s = 1e-3;
  PressureSource pressure_source = PressureSource::estimated;
  std::optional<double> gain_per_s;
  double rate_max_Pa_per_s = infinite;

  template <class V, class... P> static void visit(V&& v, P&... p) {
    constexpr auto optional = Presence::optional;
    v(Field{"pressure_source", "", 0, 0,
            "pressure that is controlled: estimated or measured (chamber) at the far end, or at the valve's port",
            optional, std::span(pressure_source_names).first(3)},
      p.pressure_source...);
    v(Field{"gain_per_s", "1/s", least_gain_per_s, 1e4,
            "rate that a pressure error asks for, over the error; default: the highest whose sensitivity stays below 2",
            optional},
      p.gain_per_s...);
    v(Field{"rate_max_Pa_per_s", "Pa/s", 1, infinite, "largest rate that is asked for; .inf: what the valve can feed",
            optional},
      p.rate_max_Pa_per_s...);
  }
  std::string_view feedforward_name() const noexcept { return "flow"; }
};

/// `filter_rad_per_s`: corner of the two lags on the error, which keep the hose's resonances out of the loop.
struct PressureGains {
  double gain_per_s = 1.0, filter_rad_per_s = 1e3;
};

/// Every term of the law at the last step.
struct PressurePiTerms {
  double p_target_Pa = 0.0;  ///< what the reference has become within valve and rate, as late as the hose is
  double pressure_error_Pa = 0.0;  ///< p_target_Pa less the controlled pressure
  double target_rate_Pa_per_s = 0.0;
  double error_integral_Pas = 0.0;
  double flow_wanted_kgps = 0.0;
  double u_unlimited_V = 0.0;
  std::uint8_t limit = limit_none;  ///< CommandLimit that acted

  template <class V, class... S> static constexpr void visit(V&& v, S&... s) {
    v(LawTerm{"p_target_Pa", "Pa", "reference within the valve's flow and rate_max, as late as the hose"},
      s.p_target_Pa...);
    v(LawTerm{"pressure_error_Pa", "Pa", "p_target_Pa less the controlled pressure, filtered"}, s.pressure_error_Pa...);
    v(LawTerm{"target_rate_Pa_per_s", "Pa/s", "rate of the target, not yet late"}, s.target_rate_Pa_per_s...);
    v(LawTerm{"error_integral_Pas", "Pa s", "integral of the error"}, s.error_integral_Pas...);
    v(LawTerm{"flow_wanted_kgps", "kg/s", "flow that is asked of the valve, positive into the hose"},
      s.flow_wanted_kgps...);
    v(LawTerm{"u_unlimited_V", "V", "command before its range"}, s.u_unlimited_V...);
    v(LawTerm{"command_limit", "", "bits: 1 at the upper range, 2 at the lower"}, s.limit...);
  }
};

/// G = C (p_target' + k e + k^2/4 integral e), C what hose and volume take per pressure, and the command whose edges
/// let G pass at the measured port pressure. e has passed the filter. The target follows the reference with both poles
/// at -2 k; a command at its range slows the target down to what passes, so that nothing winds up.
class PressurePi {
 public:
  using Parameters = PressurePiParameters;
  using Terms = PressurePiTerms;
  static constexpr std::string_view name = "pressure_pi";
  static constexpr int valves = 1;
  static constexpr bool controls_pressure = true;
  /// Largest size of 1/(1 + L): it leaves a gain margin of 2 and a phase margin of 29 degrees.
  static constexpr double most_sensitivity = 2.0;

  /// Cold: allocates. `setup.volume` is there.
  void configure(const PressurePiParameters& parameters, const LawSetup& setup);
  /// The target starts anew at the pressure of the next step. HOT.
  void reset(const std::array<double, 2>&) noexcept { first_ = true; }
  /// HOT.
  ControlOutput step(const ControlInput& in) noexcept;
  /// Periods passed without a step: the target stands still in them, the coils too. HOT.
  void skip(std::int64_t periods) noexcept {
    if (pulses_) pulses_->skip(static_cast<long>(periods));
  }
  const PressurePiTerms& terms() const noexcept { return terms_; }
  const PressureGains& gains() const noexcept { return gains_; }
  /// By which the far pressure comes after the flow at the valve [s].
  double delay_s() const noexcept { return delay_s_; }

 private:
  void start(double p_Pa) noexcept;
  double late_target(double target_Pa) noexcept;
  double filtered(double error_Pa) noexcept;
  double capacity_kg_per_Pa(double p_Pa) const noexcept;
  /// Flow per area of both edges [kg/(s m2)].
  PortAreas<double> fluxes(double port_Pa, double supply_Pa) const noexcept;
  /// Into the port at rest of the spool under this command.
  double valve_flow_kgps(double command_V, const PortAreas<double>& flux) const noexcept;
  /// Command at which the valve lets this flow pass, or the end of its range.
  double command_for_V(double flow_kgps, const PortAreas<double>& flux) const noexcept;
  double widest_V(double from_V, double end_V) const noexcept;

  PressurePiParameters parameters_;
  ElasticVolumeParameters<double> volume_;
  Air<double> air_;
  Valve<double> valve_;
  /// Commands at which an edge begins to open and has opened as far as it does.
  struct Edge {
    double begins_V = 0.0, widest_V = 0.0;
  };
  Edge fills_, empties_;
  std::optional<PulseWidth> pulses_;  ///< of two on/off valves
  double line_volume_m3_ = 0.0, supply_Pa_ = 0.0, critical_ratio_ = 0.35, area_per_volt_ = 0.0, closed_V_ = 0.0,
         last_V_ = 0.0;
  PressureGains gains_;
  double period_s_ = 1e-3, smoothing_ = 1.0, delay_s_ = 0.0;
  std::vector<double> late_;  ///< ring of past targets
  std::size_t oldest_ = 0;
  double filter_gain_ = 1.0;
  std::array<double, 2> filtered_Pa_{};
  double target_Pa_ = 0.0, pull_Pa_per_s_ = 0.0, integral_Pas_ = 0.0;
  bool first_ = true;
  PressurePiTerms terms_;
};

/// The highest gain, over the filter's corner, with a sensitivity below most_sensitivity at atmosphere and at supply:
/// from the hose's acoustics, the volume and its growth, the valve's spool and delay and the sampling. Cold.
PressureGains pressure_gains(const LawSetup& setup, PressureSource source);
/// Largest size of 1/(1 + L) with these gains; infinite: unstable. Cold.
double pressure_sensitivity(const LawSetup& setup, PressureSource source, const PressureGains& gains);

template <> struct LawAt<2> {
  using Law = PressurePi;
};

}  // namespace pneuservo
