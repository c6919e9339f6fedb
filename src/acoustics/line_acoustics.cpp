// Exact small-signal theory of a gas-filled line with its ends: waves, two-port, first resonance.
#include "acoustics/line_acoustics.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <pneuservo/core/golden_section.hpp>

namespace pneuservo {

namespace {

using Complex = std::complex<double>;

/// Mean over the cross-section of a boundary layer's shape, 2 J_1(k r)/(k r J_0(k r)) with (k r)^2 = -z^2.
Complex layer_mean(Complex z) { return 2.0 * bessel_i1_over_i0(z) / z; }

}  // namespace

Complex bessel_i1_over_i0(Complex z) {
  // I_1/I_0 = 1/(2/z + 1/(4/z + 1/(6/z + ...))), evaluated from far down the fraction, where the tail is z/(2n).
  const int terms = 40 + static_cast<int>(2.0 * std::abs(z));
  const Complex inverse = 1.0 / z;
  Complex tail = 0.0;
  for (int n = terms; n >= 1; --n) {
    const Complex sum = 2.0 * n * inverse + tail;
    tail = std::conj(sum) / std::norm(sum);
  }
  return tail;
}

LineAcoustics::LineAcoustics(double length_m, double diameter_m, double pressure_Pa, const AirParameters<double>& air,
                             LineLoss loss)
    : length_m_(length_m), diameter_m_(diameter_m), area_m2_(bore_area_m2(diameter_m)), pressure_Pa_(pressure_Pa),
      density_kgpm3_(pressure_Pa / (air.gas_constant_J_per_kgK * air.temperature_K)), air_(air), loss_(loss) {}

double LineAcoustics::sound_speed_mps() const { return air_.sound_speed(); }

LineWave LineAcoustics::wave(Complex s) const {
  // Momentum s G = -A dp/dx (1 - B), continuity s A rho' = -dG/dx with rho' = p/c^2 (1 + (kappa - 1) B_t).
  const double c = sound_speed_mps();
  Complex inertia = s / area_m2_, compliance = s * area_m2_ / (c * c);
  if (loss_ == LineLoss::frequency_dependent) {
    const Complex z = 0.5 * diameter_m_ * std::sqrt(s * density_kgpm3_ / air_.viscosity_Pas);
    inertia /= 1.0 - layer_mean(z);
    compliance *= 1.0 + (air_.kappa - 1.0) * layer_mean(std::sqrt(air_.prandtl) * z);
  } else if (loss_ == LineLoss::quasi_steady) {
    // Friction 32 mu u/D^2; wall heat 4 h/D (T_w - T) with Nu = 3.66, which makes the gas isothermal when slow.
    const double D2 = diameter_m_ * diameter_m_;
    inertia = (s + 32.0 * air_.viscosity_Pas / (density_kgpm3_ * D2)) / area_m2_;
    const double conductivity = Air<double>::conductivity(air_.temperature_K);
    const double rate = 4.0 * 3.66 * conductivity / (D2 * density_kgpm3_ * air_.cp);
    compliance *= (s + air_.kappa * rate) / (s + rate);
  }
  return {std::sqrt(inertia * compliance), std::sqrt(inertia / compliance)};
}

LineTwoPort LineAcoustics::two_port(Complex s) const {
  const LineWave w = wave(s);
  const Complex angle = w.propagation_per_m * length_m_, sine = std::sinh(angle);
  return {std::cosh(angle), w.impedance_Pas_per_kg * sine, sine / w.impedance_Pas_per_kg};
}

Complex chamber_admittance(const LineAcoustics& line, const LineEnds& ends, Complex s) {
  const double temperature_K = line.air().temperature_K;
  const Complex isothermal = s * ends.volume_out_m3 / (line.air().R * temperature_K);
  if (std::isinf(ends.wall_out_W_per_K)) return isothermal;
  // Energy of the gas: V s p/(kappa - 1) + h p T/p_0 = G (c_p T + h R T^2/(s p_0 V)).
  const double kappa = line.air().kappa, wall_per_K = ends.wall_out_W_per_K * temperature_K / line.pressure_Pa();
  return (s * ends.volume_out_m3 / (kappa - 1.0) + wall_per_K) /
         (line.air().cp * temperature_K + wall_per_K / isothermal);
}

Complex pressure_transfer(const LineAcoustics& line, const LineEnds& ends, Complex s) {
  const LineTwoPort t = line.two_port(s);
  return 1.0 / (t.a + t.b * chamber_admittance(line, ends, s));
}

Complex flow_transfer(const LineAcoustics& line, const LineEnds& ends, Complex s) {
  const double energy = line.air().R * line.air().temperature_K;
  const LineTwoPort t = line.two_port(s);
  const Complex p_out = std::isinf(ends.volume_out_m3) ? Complex(0.0) : 1.0 / chamber_admittance(line, ends, s);
  const Complex p_in = t.a * p_out + t.b;
  return 1.0 / (t.a + t.c * p_out + s * ends.volume_in_m3 / (line.air().kappa * energy) * p_in);
}

LineResonance first_resonance(const LineAcoustics& line, const LineEnds& ends) {
  const auto gain = [&](double Hz) {
    return std::abs(flow_transfer(line, ends, Complex(0.0, 2.0 * std::numbers::pi * Hz)));
  };
  // With a closed end the first resonance is the half wave; every larger volume lowers it.
  const double highest = 0.55 * line.sound_speed_mps() / line.length_m();
  LineResonance out;
  out.static_gain =
      std::isinf(ends.volume_out_m3)
          ? 1.0
          : ends.volume_out_m3 / (ends.volume_out_m3 + line.volume_m3() + ends.volume_in_m3 / line.air().kappa);
  // The gain rises to its first peak and falls to half way of the next one, so steps of 4 % see it.
  constexpr double ratio = 1.04;
  double f = 1e-3 * highest, before = gain(f / ratio), here = gain(f);
  for (double after; f < highest; f *= ratio, before = here, here = after) {
    after = gain(f * ratio);
    if (here <= before || here < after) continue;
    out.peak_Hz = golden_section_minimum([&](double Hz) { return -gain(Hz); }, f / ratio, f * ratio, 1e-10 * f);
    const double height = gain(out.peak_Hz) / out.static_gain;
    if (height <= 1.0) break;
    // Peak of a second-order lag: 1/(2 zeta sqrt(1 - zeta^2)) at w sqrt(1 - 2 zeta^2).
    out.damping_ratio = std::sqrt(0.5 * (1.0 - std::sqrt(1.0 - 1.0 / (height * height))));
    out.natural_frequency_Hz = out.peak_Hz / std::sqrt(1.0 - 2.0 * out.damping_ratio * out.damping_ratio);
    return out;
  }
  throw std::invalid_argument("the line has no resonance: friction damps it away");
}

}  // namespace pneuservo
