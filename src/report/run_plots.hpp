// The plots of the verb `run`, made from rows.
#pragma once
#include <span>
#include <vector>

#include <pneuservo/control/law.hpp>
#include <report/html_page.hpp>
#include <report/run_result.hpp>

namespace pneuservo {

/// Colour of a pressure source, the same for its run and for its pressures.
Tone tone_of(const std::string& pressure_source);

/// Runs whose curves a page shows: all up to six, else the first and last move of every pressure source and
/// feedforward.
std::vector<const RunResult*> shown_runs(const RunReport& report);

/// Position against reference, all shown runs [mm].
Plot position_plot(const RunReport& report, double period_s);
/// Reference minus position, all shown runs [mm].
Plot position_error_plot(const RunReport& report, double period_s);
/// Measured minus predicted position with the permitted band [mm]; no curve without a prediction.
Plot deviation_plot(const RunReport& report, double period_s);
/// Command, all shown runs [V].
Plot command_plot(const RunReport& report, double period_s);
/// Port, chamber and estimated pressure of chamber `side` (1 or 2) of one run [kPa].
Plot pressure_plot(const RunReport& report, const RunResult& run, int side, double period_s);
/// Estimated minus true (measured where there is no truth) pressure with the estimator's stated bound [kPa].
Plot estimation_error_plot(const RunReport& report, const RunResult& run, int side, double period_s);
/// Terms of the law of one run, a plot a unit; a term that keeps one value is left out.
std::vector<Plot> term_plots(const RunReport& report, const RunResult& run, std::span<const LawTerm> terms,
                             double period_s);
/// Counts of lateness and of work per stage over the time they took, both logarithmic; the run has timing.
Plot latency_plot(const RunResult& run);
/// The figures of the table as bars, one a run.
std::vector<BarChart> figure_bars(const RunReport& report);

}  // namespace pneuservo
