// The result of `run` in words and tables: what the screen and the page both show.
#pragma once
#include <optional>
#include <string>

#include <report/run_result.hpp>
#include <report/table.hpp>

namespace pneuservo {

/// What position errors are told in: mm, or µm where all of them are below 0.1 mm.
struct LengthUnit {
  const char* name;
  double per_m;
};
LengthUnit error_unit(const RunReport& report);

/// "estimated", with feedforward and move where the report has several: "estimated, formula feedforward, move 2".
std::string run_label(const RunReport& report, const RunResult& run);

/// Index of the run without a fault that has the smallest root mean square position error; -1 if there is none.
int best_run(const RunReport& report);

/// The result in one or two sentences: which pressures held the position best and how well, or which run faulted.
std::string headline(const RunReport& report);

/// "simulated time, 10 s, 2600 times as fast as real time"
std::string circumstances(const RunReport& report);

/// One row a run: errors in mm and kPa, ripple in kPa, command step in mV, faults.
Table comparison_table(const RunReport& report);

/// One row a run and stage: p50, p99, p99.99, maximum [us]. Nothing in simulated time.
std::optional<Table> latency_table(const RunReport& report);

/// One row a run: ticks, overruns, page faults, involuntary context switches. Nothing in simulated time.
std::optional<Table> interruption_table(const RunReport& report);

/// The worst cycles of a real-time run by lateness + work, worst first; nothing where there are none.
std::optional<Table> worst_cycles_table(const RunResult& run, std::size_t count);

/// All of it for the screen.
std::string run_text(const RunReport& report);

}  // namespace pneuservo
