// Rows of 2.2.3: natural frequency and damping of the lines.
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/format.h>

#include <pneuservo/rig/plant.hpp>

#include "thesis/groups.hpp"
#include "thesis/pictures.hpp"

namespace pneuservo {

LineAcoustics thesis_line(double length_m, double diameter_m, LineLoss loss) {
  return {length_m, diameter_m, line_pressure_Pa, AirParameters<double>{}, loss};
}

namespace {

struct PrintedLine {
  const char* place;
  double length_m, diameter_mm;
  const char *Hz, *damping;             ///< printed
  const char *rig_Hz, *rig_damping;     ///< exact theory, ends of a test rig
  const char *table_Hz, *table_damping; ///< exact theory, chamber of the table
  const char *model_Hz, *model_damping; ///< quasi-steady friction, chamber of the table
};
constexpr PrintedLine printed_lines[] = {
    {"Table 2.5", 0.5, 4, "110", "0.068", "107.0", "0.0465", "163.9", "0.045", "173.2", "0.011"},
    {"Table 2.5", 1.0, 4, "67", "0.068", "66.5", "0.056", "80.9", "0.063", "87.4", "0.022"},
    {"Table 2.5", 2.0, 4, "41", "0.07", "39.6", "0.0685", "40.0", "0.0875", "44.5", "0.042"},
    {"Table 2.6", 0.5, 8, "146", "0.06", "169.3", "0.016", "173.1", "0.021", "177.8", "0.003"},
    {"Table 2.6", 1.0, 8, "102", "0.048", "99.7", "0.018", "88.5", "0.027", "91.8", "0.005"},
    {"Table 2.6", 2.0, 8, "60", "0.050", "57.8", "0.021", "46.2", "0.034", "48.6", "0.008"},
    {"Fig 2.11", 1.0, 5, "80", "0.005", "76.9", "0.0393", "83.0", "0.0485", "", ""},
};
constexpr const char* rig_why =
    "the line between 4.7 and 36 cm3, as on a rig for lines; the print is a fit by eye to a sweep sampled at 2 ms";
constexpr const char* table_why = "the same line before 192 cm3, a chamber of the table: the print is not the table's";
constexpr const char* model_why =
    "friction of steady flow, as the simulated line has it without effects.frequency_dependent_losses";

/// Natural frequency and damping with these ends and losses.
void add(std::vector<ThesisRow>& rows, const PrintedLine& line, const char* where, const LineEnds& ends, LineLoss loss,
         const char* Hz, const char* damping, const char* why) {
  if (*Hz == '\0') return;
  const std::string name = fmt::format("L {:g} m, D {:g} mm, {}: ", line.length_m, line.diameter_mm, where);
  const auto resonance = [line, ends, loss] {
    return first_resonance(thesis_line(line.length_m, 1e-3 * line.diameter_mm, loss), ends);
  };
  const std::string command = fmt::format("pneuservo thesis --only '{}'", line.place);
  rows.push_back({.place = line.place,
                  .what = name + "w_t/2 pi",
                  .unit = "Hz",
                  .printed = line.Hz,
                  .ours = [resonance](ThesisBench&) { return resonance().natural_frequency_Hz; },
                  .held = Hz,
                  .why = why,
                  .command = command});
  const bool misprint = std::string_view(line.damping) == "0.005";
  rows.push_back(
      {.place = line.place,
       .what = name + "zeta_t",
       .printed = line.damping,
       .meant = misprint ? "0.05" : "",
       .ours = [resonance](ThesisBench&) { return resonance().damping_ratio; },
       .held = damping,
       .why = misprint ? std::string("0.005 would ring ten times as long as any air in a tube; ") + why : why,
       .command = command});
}

/// Frequency and damping of a pole.
LineResonance of_pole(std::complex<double> pole) {
  LineResonance out;
  out.natural_frequency_Hz = std::abs(pole) / (2.0 * std::numbers::pi);
  out.damping_ratio = -pole.real() / std::abs(pole);
  return out;
}

/// Decay and frequency of a ringing, from two stretches of it turned back by a frequency near its own.
LineResonance ring_down(const std::vector<double>& signal, double period_s, double near_Hz) {
  const auto length = static_cast<std::size_t>(std::lround(6.0 / (near_Hz * period_s)));
  const auto stretch = [&](std::size_t first) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < length; ++i) {
      // Hann's window: the overtones of the line stay outside.
      const double phase = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(length);
      const double turn = -2.0 * std::numbers::pi * near_Hz * period_s * static_cast<double>(first + i);
      sum += (1.0 - std::cos(phase)) * signal[first + i] * std::polar(1.0, turn);
    }
    return sum;
  };
  const std::complex<double> ratio = stretch(length) / stretch(length / 2);
  const double apart_s = period_s * static_cast<double>(length - length / 2);
  const std::complex<double> pole(std::log(std::abs(ratio)) / apart_s,
                                  std::arg(ratio) / apart_s + 2.0 * std::numbers::pi * near_Hz);
  return of_pole(pole);
}

/// A chamber of the table whose gas has no time for the wall at the line's frequency: adiabatic.
constexpr LineEnds quick_chamber{0.0, 192e-6 / 1.4};

/// The first pole of the exact theory, by secants from the lag of the same peak. That lag's damping is about pi/4 of
/// the pole's: near its peak a line passes 4/pi of what a lag of the same pole does.
LineResonance theory_of(const PrintedLine& line, LineLoss loss) {
  const LineAcoustics theory = thesis_line(line.length_m, 1e-3 * line.diameter_mm, loss);
  const LineResonance lag = first_resonance(theory, quick_chamber);
  const auto inverse = [&](std::complex<double> s) { return 1.0 / flow_transfer(theory, quick_chamber, s); };
  std::complex<double> before =
      2.0 * std::numbers::pi * lag.natural_frequency_Hz *
      std::complex<double>(-lag.damping_ratio, std::sqrt(1.0 - std::pow(lag.damping_ratio, 2)));
  std::complex<double> now = 1.001 * before;
  for (int i = 0; i < 30 && std::abs(now - before) > 1e-9 * std::abs(now); ++i) {
    const std::complex<double> at_now = inverse(now), next = now - at_now * (now - before) / (at_now - inverse(before));
    before = now;
    now = next;
  }
  return of_pole(now);
}

/// The line of the simulated table before its chamber: a pulse of the valve, which then shuts, and how the line rings.
LineResonance simulated_resonance(ThesisBench& bench, const PrintedLine& line, LineLoss loss) {
  Rig rig = bench.rig({table_4mm.config});
  auto& axis = rig.axis;
  axis.line_1.length_m = axis.line_2.length_m = line.length_m;
  axis.line_1.diameter_m = axis.line_2.diameter_m = 1e-3 * line.diameter_mm;
  axis.effects.frequency_dependent_losses.share = loss == LineLoss::frequency_dependent ? 1.0 : 0.0;
  axis.valve.natural_frequency_Hz = 0.0;  // the spool follows at once
  axis.slider.mass_kg = 1e6;              // and the slider stays where it is
  const double near_Hz = theory_of(line, loss).natural_frequency_Hz;
  const double period_s = 1e-4;
  AxisPlant<double> plant;
  plant.configure(axis, period_s, 64.0, valve_arrangement(rig));
  plant.reset({0.0, line_pressure_Pa, line_pressure_Pa});
  // A quarter of a period of 1 % of the range: some tens of Pa, where friction is laminar.
  const auto pulse = std::lround(0.25 / (near_Hz * period_s));
  for (long k = 0; k < pulse; ++k) plant.step(0.01 * axis.valve.command_max_V, 0.0);
  std::vector<double> difference_Pa;
  for (long k = 0; k < std::lround(14.0 / (near_Hz * period_s)); ++k) {
    const auto now = true_values(plant);
    difference_Pa.push_back(now[Signal::p1_port] - now[Signal::p1_chamber]);
    plant.step(0.0, 0.0);
  }
  return ring_down(difference_Pa, period_s, near_Hz);
}

/// What is asked of an identified line (docs/thesis.md).
constexpr double ringing_frequency_within = 0.01, ringing_damping_within = 0.05;

/// The simulated line's ringing over the exact theory of the same losses.
void add_simulated(std::vector<ThesisRow>& rows, const PrintedLine& line, LineLoss loss) {
  const bool is_steady = loss == LineLoss::quasi_steady;
  const std::string name = fmt::format("L {:g} m, D {:g} mm, simulated, {}: ", line.length_m, line.diameter_mm,
                                       is_steady ? "steady friction" : "frequency_dependent_losses");
  const auto both = [line, loss](ThesisBench& bench, double LineResonance::* figure) {
    const LineResonance exact = theory_of(line, loss);
    return simulated_resonance(bench, line, loss).*figure / (exact.*figure);
  };
  for (const bool frequency : {true, false})
    rows.push_back({.place = "2.2.3",
                    .what = name + (frequency ? "w_t over exact theory" : "zeta_t over exact theory"),
                    .printed = "experiment",
                    .plant = ThesisPlant::nonlinear,
                    .ours =
                        [both, frequency](ThesisBench& bench) {
                          return both(bench,
                                      frequency ? &LineResonance::natural_frequency_Hz : &LineResonance::damping_ratio);
                        },
                    .held = "1.00",
                    .held_within = frequency ? ringing_frequency_within : ringing_damping_within,
                    .why = "a pulse of the valve and the ringing after it, before 192 cm3 of adiabatic gas, over the "
                           "first pole of the theory"});
}

ThesisRow atmosphere_row() {
  return {.place = "Table 2.4",
          .what = "pressure of the atmosphere P_a",
          .unit = "kPa",
          .printed = "101.32",
          .plant = ThesisPlant::config,
          .ours = [](ThesisBench& bench) { return 1e-3 * bench.rig({table_4mm.config}).axis.air.atmosphere_Pa; }};
}

/// What stands in 2.2.3 beside its tables.
void add_single_figures(std::vector<ThesisRow>& rows) {
  rows.push_back(
      {.place = "(2.18)",
       .what = "static gain of the line, L 1 m, D 8 mm",
       .printed = "1",
       .meant = "1/(1 + V_line/V_0)",
       .ours =
           [](ThesisBench&) {
             return first_resonance(thesis_line(1.0, 8e-3, LineLoss::frequency_dependent), line_table_ends).static_gain;
           },
       .held = "0.79",
       .why = "the line itself takes its share of the air"});
  const ThesisRig moved{"servo-table-1m-8mm", noise_free};
  rows.push_back(
      {.place = "Fig 2.10",
       .what = "L 1 m, D 8 mm, printed move: largest difference of the line's ends over the pressure's swing",
       .unit = "%",
       .printed = "\"slight\" (picture)",
       .plant = ThesisPlant::nonlinear,
       .ours =
           [moved](ThesisBench& bench) {
             const ThesisCourse& course = bench.run(moved);
             const auto [least, most] = std::ranges::minmax(course.chamber_Pa[0]);
             return 100.0 * largest_loss_Pa(course, 0) / (most - least);
           },
       .held = "2.971",
       .held_within = simulated_within,
       .why = "the picture is of the line's own experiment; this is the same line in the table",
       .command = thesis_verb("run", moved) + " --report run.html"});
  rows.push_back({.place = "2.2.3",
                  .what = "Re of 2.5e-5 m3/s in D 5 mm, nu 1.64e-5 m2/s",
                  .printed = "387.75",
                  .ours = [](ThesisBench&) { return 4.0 * 2.5e-5 / (std::numbers::pi * 5e-3 * 1.64e-5); },
                  .within = searched_within,
                  .why = "a volume flow, as printed: with kg/s no diameter of the thesis gives this number"});
  rows.push_back(
      {.place = "Table 2.4",
       .what = "supply pressure of the line's experiment",
       .unit = "kPa",
       .printed = "300",
       .meant = "250",
       .ours = [](ThesisBench& bench) { return 1e-3 * bench.rig({table_4mm.config}).axis.supply.pressure_Pa; },
       .within = 0.01,
       .why = "2.2.3 says 0.25 MPa (251.3 kPa in Table 2.7); D 6.5 mm of this table is 5.0 in the figures"});
}

}  // namespace

ThesisGroup thesis_line_group() {
  std::vector<ThesisRow> rows;
  for (const PrintedLine& line : printed_lines) {
    add(rows, line, "test rig", line_rig_ends, LineLoss::frequency_dependent, line.rig_Hz, line.rig_damping, rig_why);
    add(rows, line, "table", line_table_ends, LineLoss::frequency_dependent, line.table_Hz, line.table_damping,
        table_why);
    add(rows, line, "table, steady friction", line_table_ends, LineLoss::quasi_steady, line.model_Hz,
        line.model_damping, model_why);
  }
  for (const PrintedLine& line : printed_lines) {
    add_simulated(rows, line, LineLoss::frequency_dependent);
    add_simulated(rows, line, LineLoss::quasi_steady);
  }
  add_single_figures(rows);
  rows.push_back(atmosphere_row());
  return {"2.2.3 The lines", rows};
}

}  // namespace pneuservo
