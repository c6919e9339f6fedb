// What the pictures of the thesis' page show, computed by the same functions as the rows.
#pragma once
#include <complex>

#include "acoustics/line_acoustics.hpp"
#include "config/valve_table.hpp"
#include "report/html_page.hpp"
#include "thesis/bench.hpp"
#include "thesis/row.hpp"

namespace pneuservo {

/// Position of the spool over its command in the loop that is set to `set_Hz`, at a tenth of its stroke.
std::complex<double> spool_response(double set_Hz, double Hz);

/// Small volumes at the ends of the thesis' test rig for lines, with which its printed frequencies come out.
inline constexpr LineEnds line_rig_ends{4.7e-6, 36e-6};
/// A chamber of the table at mid-stroke.
inline constexpr LineEnds line_table_ends{0.0, 192e-6};
/// Mean pressure of the lines' rows.
inline constexpr double line_pressure_Pa = 120e3;
/// A line of the thesis; air as the configs have it.
LineAcoustics thesis_line(double length_m, double diameter_m, LineLoss loss);

/// What the experiment of Fig 3.6 gives: area over voltage.
struct MeasuredValve {
  std::vector<double> command_V, true_m2, measured_m2, straight_m2;  ///< straight: as the configs have it
  ValveTableFit fit;
  double area_per_volt_m2_per_V = 0.0;
};
MeasuredValve thesis_measured_valve(ThesisBench& bench);

/// The page of the verb.
HtmlPage thesis_page(const std::vector<ThesisResult>& results, ThesisBench& bench);

}  // namespace pneuservo
