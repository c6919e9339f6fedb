// The groups of rows, chapter by chapter, and what several of them share.
#pragma once
#include <array>
#include <span>

#include "thesis/bench.hpp"
#include "thesis/row.hpp"

namespace pneuservo {

ThesisGroup thesis_table_group();        // 2.1, 2.2.1: parameters and linear model of the servo table
ThesisGroup thesis_valve_group();        // 2.2.2
ThesisGroup thesis_line_group();         // 2.2.3
ThesisGroup thesis_identify_group();     // 2.2.3: the experiment with a line
ThesisGroup thesis_order_group();        // 2.3: loops of third, fifth, seventh order
ThesisGroup thesis_gain_group();         // tables 2.7, 2.8
ThesisGroup thesis_model_group();        // 2.4: linear models against the nonlinear table
ThesisGroup thesis_diagnosis_group();    // 2.4: what diagnose says of them
ThesisGroup thesis_feedforward_group();  // 2.6
ThesisGroup thesis_table_sets_group();   // one set of numbers for all of chapter 2
ThesisGroup thesis_element_group();      // 3.1 to 3.3
ThesisGroup thesis_flow_group();         // 3.3.1: area over voltage
ThesisGroup thesis_cylinder_group();     // 3.5
ThesisGroup thesis_cylinder_sets_group();  // one axis for all of chapter 3
ThesisGroup thesis_index_group();        // 4.1 to 4.3: the index
ThesisGroup thesis_difference_group();   // 4.3: pressure loss, position difference, verdicts
ThesisGroup thesis_wish_group();         // 5.2, nomenclature
ThesisGroup thesis_misprint_group();     // misprints and gaps of chapters 2 and 3 that no figure shows

/// Printed figures of the servo table that exclude each other on linear tables.
std::vector<ThesisRow> order_bound_rows();
/// What three runs of one curve leave of a printed figure, on any table.
std::vector<ThesisRow> three_runs_rows();
/// What a linear table would have to be to meet them, and the least sum of deviations on the others.
std::vector<ThesisRow> least_sum_rows();
/// Printed figures of the servo table that were searched for together.
std::vector<ThesisRow> table_together_rows();
/// The rig for lines that meets most printed figures.
std::vector<ThesisRow> most_met_rows();
/// How near a rig comes to both bores of one length alone.
std::vector<ThesisRow> line_length_rows();
/// Printed dampings of the lines that exclude each other.
std::vector<ThesisRow> damping_bound_rows();

/// Recordings of the table against linear models as config: how far the simulated gas is off.
std::vector<ThesisRow> model_misfit_rows();

/// All of them, in the thesis' order; `only`: rows whose place holds this text. With diagnoses: minutes.
std::vector<ThesisGroup> thesis_groups(const std::string& only = "", bool with_diagnoses = false);

/// The two lines of the printed moves, with the lag of table 2.8 unswapped and the printed gains x 1000.
struct ThesisTable {
  const char* name;
  const char* config;
  Ppd2Gains third, fifth;
};
inline constexpr ThesisTable table_4mm{"4 mm", "servo-table-0.5m-4mm", {1200, 62.1, 1.67}, {1200, 54.0, 1.30}};
inline constexpr ThesisTable table_8mm{"8 mm", "servo-table-1m-8mm", {1500, 72.3, 1.79}, {1500, 60.0, 1.80}};

/// controller.* keys of these gains.
std::vector<std::string> gain_sets(const Ppd2Gains& gains);

/// Keys that make the 4 mm table the linear model of that order (3: no lags; 5: one matched lag; 7: valve and line),
/// with the chamber pressures of (2.3) and (2.4).
std::vector<std::string> linear_model_sets(int order);

/// A figure that the thesis prints, of a run of an axis.
ThesisRow run_row(ThesisRow row, const ThesisRig& which, double (*figure)(const ThesisCourse&));

/// "holds", or by how much the sides of an equation differ.
ThesisValue equation(double printed, double ours);
ThesisValue equation(std::span<const double> printed, std::span<const double> ours);
/// The same for a correlation that the program follows within that share.
ThesisValue nearly(std::span<const double> printed, std::span<const double> ours, double within);

/// Sensors without noise and quantum.
inline const std::vector<std::string> noise_free{"sensors.position.quantum_m=0",
                                                 "sensors.port_pressure={quantum_Pa: 0, noise_Pa: 0}",
                                                 "sensors.chamber_pressure={quantum_Pa: 0, noise_Pa: 0}"};

/// Nothing ends the motion of a loop that swings: for simulation alone.
inline const std::vector<std::string> unguarded{"limits.speed_mps=20", "limits.deviation_m=0",
                                                "limits.speed_deviation_mps=0", "limits.stall_force_N=0"};

}  // namespace pneuservo
