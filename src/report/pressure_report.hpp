// The result of `run` with a pressure rig: words and table, JSON, page.
#pragma once
#include <string>

#include <nlohmann/json.hpp>

#include <pneuservo/rig/rig.hpp>
#include <report/html_page.hpp>
#include <report/run_result.hpp>

namespace pneuservo {

/// Whether the report's runs controlled a pressure.
bool is_of_pressure(const RunReport& report);
/// One or two sentences: how well the pressure was held, or which fault ended the run.
std::string pressure_headline(const RunReport& report);
/// One row a run.
Table pressure_table(const RunReport& report);
nlohmann::ordered_json pressure_json(const PressureMetrics& metrics);
/// Figures and plots of the pressures.
void add_pressure_sections(HtmlPage& page, const RunReport& report, double period_s);

}  // namespace pneuservo
