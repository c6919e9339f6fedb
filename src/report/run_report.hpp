// The page of the verb `run`: figures, comparison, plots, timing, config and machine in one HTML file.
#pragma once
#include <string>

#include <pneuservo/rig/rig.hpp>
#include <report/run_result.hpp>

namespace pneuservo {

/// The page as text; the runs' metrics have been evaluated.
std::string run_report_html(const RunReport& report, const Rig& rig);

/// Writes the page to `path`; throws InputError naming the path if that fails.
void write_run_report(const RunReport& report, const Rig& rig, const std::string& path);

}  // namespace pneuservo
