// The page of the verb `design`.
#pragma once
#include <string>

#include <design/axis_design.hpp>

namespace pneuservo {

/// One self-contained page: tables, pole loci, Bode diagrams, step, the line. `config_yaml`: the config as designed.
std::string design_report_html(const Rig& rig, const AxisDesign& design, const std::string& config_yaml);
/// Writes it; throws InputError naming the path if that fails.
void write_design_report(const Rig& rig, const AxisDesign& design, const std::string& config_yaml,
                         const std::string& path);

}  // namespace pneuservo
