// Exact small-signal theory of a gas-filled line with its ends: waves, two-port, first resonance.
#pragma once
#include <complex>
#include <limits>

#include <pneuservo/elements/air.hpp>
#include <pneuservo/elements/parameters.hpp>

namespace pneuservo {

/// What damps the waves of a line.
enum class LineLoss {
  none,                 ///< adiabatic, no friction
  quasi_steady,         ///< laminar friction and wall heat of steady flow, as in elements/line.hpp
  frequency_dependent,  ///< Kirchhoff's viscous and thermal boundary layers (in the time domain: Zielke)
};

/// A wave exp(-+ propagation x) and the pressure per mass flow that it carries.
struct LineWave {
  std::complex<double> propagation_per_m;
  std::complex<double> impedance_Pas_per_kg;
};

/// p_in = a p_out + b G_out,  G_in = c p_out + a G_out;  a^2 - b c = 1.
struct LineTwoPort {
  std::complex<double> a;  ///< -
  std::complex<double> b;  ///< Pa s/kg
  std::complex<double> c;  ///< kg/(Pa s)
};

/// A round line full of gas at rest; small changes of pressure and mass flow in the plane s [1/s] (docs/physics/
/// line_acoustics.md). All quantities SI, pressure absolute.
class LineAcoustics {
 public:
  /// A line of no length.
  LineAcoustics() = default;
  /// length, diameter, pressure > 0.
  LineAcoustics(double length_m, double diameter_m, double pressure_Pa, const AirParameters<double>& air,
                LineLoss loss);

  /// The travelling wave at s != 0.
  LineWave wave(std::complex<double> s) const;
  LineTwoPort two_port(std::complex<double> s) const;

  double length_m() const { return length_m_; }
  double pressure_Pa() const { return pressure_Pa_; }
  double volume_m3() const { return length_m_ * area_m2_; }
  /// Isentropic speed of sound [m/s].
  double sound_speed_mps() const;
  const Air<double>& air() const { return air_; }

 private:
  double length_m_ = 0.0, diameter_m_ = 0.0, area_m2_ = 0.0, pressure_Pa_ = 0.0, density_kgpm3_ = 0.0;
  Air<double> air_;
  LineLoss loss_ = LineLoss::none;
};

/// What stands at a line's ends.
struct LineEnds {
  double volume_in_m3 = 0.0;                                        ///< between valve and line, adiabatic
  double volume_out_m3 = std::numeric_limits<double>::infinity();  ///< chamber; infinite: constant pressure
  double wall_out_W_per_K = std::numeric_limits<double>::infinity();  ///< of the chamber; infinite: isothermal
};

/// Mass flow into the chamber per pressure in it [kg/(Pa s)], at s != 0: V s/(R T) with a wall that keeps the gas at
/// its temperature, 1/kappa of it with none. volume_out finite.
std::complex<double> chamber_admittance(const LineAcoustics& line, const LineEnds& ends, std::complex<double> s);

/// Pressure in the chamber over pressure at the line's other end, at s != 0.
std::complex<double> pressure_transfer(const LineAcoustics& line, const LineEnds& ends, std::complex<double> s);

/// Flow out of the line into the chamber over flow through the valve, at s != 0.
std::complex<double> flow_transfer(const LineAcoustics& line, const LineEnds& ends, std::complex<double> s);

/// First resonance of flow_transfer as a second-order lag with the same peak frequency and the same peak over static
/// gain.
struct LineResonance {
  double peak_Hz = 0.0;
  double natural_frequency_Hz = 0.0;  ///< of the lag; peak_Hz / sqrt(1 - 2 damping^2)
  double damping_ratio = 0.0;
  double static_gain = 0.0;  ///< 1/(1 + V_line/V_out) without a volume at the valve
};
/// Throws std::invalid_argument if friction leaves no peak below the second resonance.
LineResonance first_resonance(const LineAcoustics& line, const LineEnds& ends);

/// I_1(z)/I_0(z) of the modified Bessel functions for Re z >= 0, to rounding, from Gauss' continued fraction.
std::complex<double> bessel_i1_over_i0(std::complex<double> z);

}  // namespace pneuservo
