// Rows of 2.2.3: natural frequency and damping of the lines.
#include <cmath>
#include <numbers>

#include <fmt/format.h>

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
  return {"2.2.3 The lines", rows};
}

}  // namespace pneuservo
