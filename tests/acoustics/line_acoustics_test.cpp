// Exact theory of lines: limits that are known in closed form, the resonances of the servo table's lines.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "acoustics/line_acoustics.hpp"

using namespace pneuservo;
using Complex = std::complex<double>;

namespace {
const AirParameters<double> air;
LineAcoustics table_line(double diameter_mm, double length_m, LineLoss loss) {
  return {length_m, 1e-3 * diameter_mm, 120e3, air, loss};
}
Complex at_Hz(double f) { return {0.0, 2.0 * std::numbers::pi * f}; }
}  // namespace

TEST_CASE("the quotient of the modified Bessel functions") {
  // Real arguments against the C++ library's functions.
  for (const double x : {1e-3, 0.1, 1.0, 3.0, 12.0, 80.0, 400.0})
    CHECK(bessel_i1_over_i0(x).real() == Approx(std::cyl_bessel_i(1.0, x) / std::cyl_bessel_i(0.0, x)).epsilon(1e-13));
  // On the ray of oscillating boundary layers: power series near 0, asymptotic series far out.
  for (const double size : {0.01, 0.5, 2.0}) {
    const Complex z = std::polar(size, 0.25 * std::numbers::pi);
    Complex i0 = 0.0, i1 = 0.0, term = 1.0;
    for (int k = 0; k < 40; ++k) {
      i0 += term;
      i1 += term * z / (2.0 * (k + 1.0));
      term *= 0.25 * z * z / ((k + 1.0) * (k + 1.0));
    }
    CHECK(std::abs(bessel_i1_over_i0(z) - i1 / i0) < 1e-14);
  }
  const Complex far = std::polar(300.0, 0.25 * std::numbers::pi);
  const Complex series = 1.0 - 0.5 / far - 0.125 / (far * far) - 0.125 / (far * far * far);
  CHECK(std::abs(bessel_i1_over_i0(far) - series) < 1e-9);
}

TEST_CASE("a line without losses carries sound at the isentropic speed") {
  const LineAcoustics line = table_line(4, 0.5, LineLoss::none);
  const LineWave wave = line.wave(at_Hz(100.0));
  CHECK(wave.propagation_per_m.real() == Approx(0.0).margin(1e-12));
  CHECK(wave.propagation_per_m.imag() == Approx(2.0 * std::numbers::pi * 100.0 / std::sqrt(1.4 * 287.0 * 293.0)));
  // Pressure over mass flow of a plane wave: c/A.
  CHECK(wave.impedance_Pas_per_kg.real() == Approx(line.sound_speed_mps() / (line.volume_m3() / 0.5)));
}

TEST_CASE("boundary layers: slow flow is Poiseuille's and isothermal, fast flow is free and adiabatic") {
  const double D = 4e-3, area = 0.25 * std::numbers::pi * D * D, density = 120e3 / (287.0 * 293.0);
  const LineAcoustics line = table_line(4, 0.5, LineLoss::frequency_dependent);
  const LineWave slow = line.wave(at_Hz(1e-4));
  // Series impedance per length 32 mu/(rho D^2 A), shunt admittance s A/(R T).
  const Complex series = slow.propagation_per_m * slow.impedance_Pas_per_kg;
  CHECK(series.real() == Approx(32.0 * 1.8e-5 / (density * D * D * area)).epsilon(1e-6));
  const Complex shunt = slow.propagation_per_m / slow.impedance_Pas_per_kg;
  CHECK(shunt.imag() == Approx(2.0 * std::numbers::pi * 1e-4 * area / (287.0 * 293.0)).epsilon(1e-6));
  // Kirchhoff's wide-tube attenuation (1 + (kappa-1)/sqrt(Pr)) sqrt(omega nu/2)/(c r).
  const double f = 2e5, w = 2.0 * std::numbers::pi * f;
  const LineWave fast = line.wave(at_Hz(f));
  const double kirchhoff =
      (1.0 + 0.4 / std::sqrt(0.71)) * std::sqrt(0.5 * w * 1.8e-5 / density) / (line.sound_speed_mps() * 0.5 * D);
  CHECK(fast.propagation_per_m.real() == Approx(kirchhoff).epsilon(0.01));
  CHECK(fast.impedance_Pas_per_kg.real() * area == Approx(line.sound_speed_mps()).epsilon(0.01));
}

TEST_CASE("a two-port conserves: its determinant is one, halves in series make the whole") {
  for (const LineLoss loss : {LineLoss::none, LineLoss::quasi_steady, LineLoss::frequency_dependent}) {
    const LineTwoPort whole = table_line(8, 1.0, loss).two_port(at_Hz(70.0)),
                      half = table_line(8, 0.5, loss).two_port(at_Hz(70.0));
    CHECK(std::abs(whole.a * whole.a - whole.b * whole.c - 1.0) < 1e-12);
    CHECK(std::abs(half.a * half.a + half.b * half.c - whole.a) < 1e-12);
    CHECK(std::abs(2.0 * half.a * half.b - whole.b) < 1e-9 * std::abs(whole.b));
  }
}

TEST_CASE("a lossless line resonates at its quarter wave, or at its half wave with a closed end") {
  const double c = std::sqrt(1.4 * 287.0 * 293.0);
  // No peak is infinite in the scan of the quasi-steady line; its small friction hardly moves it.
  const LineAcoustics wide(1.0, 0.05, 120e3, air, LineLoss::quasi_steady);
  CHECK(first_resonance(wide, {}).peak_Hz == Approx(c / 4.0).epsilon(1e-3));
  CHECK(first_resonance(wide, {0.0, 1e-7}).peak_Hz == Approx(c / 2.0).epsilon(1e-3));
}

TEST_CASE("the resonances of the servo table's lines") {
  struct Row {
    double D_mm, L_m;
    double open[2], table[2], rig[2], quasi_steady[2];  // Hz, damping ratio
  };
  // Golden: constant pressure at the end; into 192 cm3; 4.7 cm3 at the valve and 36 cm3 at the end; quasi-steady
  // friction into 192 cm3. The 4.7 cm3 are rounded: 0.5 % there.
  const Row rows[]{{4, 0.5, {162.2, 0.046}, {163.9, 0.045}, {106.9, 0.047}, {173.2, 0.011}},
                   {4, 1.0, {79.3, 0.066}, {80.9, 0.063}, {66.4, 0.057}, {87.4, 0.022}},
                   {4, 2.0, {38.4, 0.096}, {40.0, 0.088}, {39.5, 0.069}, {44.5, 0.042}},
                   {8, 0.5, {166.8, 0.023}, {173.1, 0.021}, {169.0, 0.016}, {177.8, 0.003}},
                   {8, 1.0, {82.4, 0.032}, {88.5, 0.028}, {99.5, 0.019}, {91.8, 0.005}},
                   {8, 2.0, {40.6, 0.046}, {46.2, 0.035}, {57.6, 0.023}, {48.6, 0.009}}};
  for (const Row& row : rows) {
    INFO("D " << row.D_mm << " mm, L " << row.L_m << " m");
    const LineAcoustics exact = table_line(row.D_mm, row.L_m, LineLoss::frequency_dependent);
    const LineAcoustics simple = table_line(row.D_mm, row.L_m, LineLoss::quasi_steady);
    const auto check = [](const LineResonance& found, const double(&golden)[2], double Hz, double ratio) {
      CHECK(found.natural_frequency_Hz == Approx(golden[0]).margin(Hz));
      CHECK(found.damping_ratio == Approx(golden[1]).margin(ratio));
    };
    check(first_resonance(exact, {}), row.open, 0.06, 0.0007);
    check(first_resonance(exact, {0.0, 192e-6}), row.table, 0.06, 0.0010);
    check(first_resonance(exact, {4.7e-6, 36e-6}), row.rig, 0.005 * row.rig[0], 0.0020);
    check(first_resonance(simple, {0.0, 192e-6}), row.quasi_steady, 0.06, 0.0008);
  }
  // The misprint "1 m, 5 mm: 80 Hz, 0.005" of the thesis' text.
  const LineResonance five = first_resonance(table_line(5, 1.0, LineLoss::frequency_dependent), {4.7e-6, 36e-6});
  CHECK(five.natural_frequency_Hz == Approx(76.7).epsilon(0.01));
  CHECK(five.damping_ratio == Approx(0.040).margin(0.0015));
}

TEST_CASE("a volume at the end takes its share of the flow at rest") {
  const LineAcoustics line = table_line(4, 0.5, LineLoss::frequency_dependent);
  const LineResonance found = first_resonance(line, {0.0, 192e-6});
  CHECK(found.static_gain == Approx(0.97).margin(0.003));
  CHECK(std::abs(flow_transfer(line, {0.0, 192e-6}, at_Hz(1e-3))) == Approx(found.static_gain).epsilon(1e-5));
}

TEST_CASE("a line that is damped away has no resonance") {
  const LineAcoustics thin(10.0, 5e-4, 120e3, air, LineLoss::frequency_dependent);
  CHECK_THROWS_AS(first_resonance(thin, {0.0, 2e-4}), std::invalid_argument);
}
