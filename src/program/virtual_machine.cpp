// A rig run in closed loop on the simulated backend, as a recording in memory.
#include "program/virtual_machine.hpp"

#include <algorithm>
#include <exception>

#include "backends.hpp"
#include "loop/runner.hpp"
#include "program/rig_options.hpp"
#include "record/import.hpp"
#include "record/row_text.hpp"

namespace pneuservo {
namespace {

bool is_recorded(std::string_view column) {
  return column == "t_s" || column == "u_V" || signal_of_column(column).has_value();
}

Recording recording_of(const Rig& rig, const std::vector<Row>& rows) {
  Recording out;
  out.path = "virtual run";
  out.rig = rig.name;
  out.period_s = rig.period_s;
  for (const std::string& name : row_columns()) {
    if (!is_recorded(name)) continue;
    out.names.push_back(name);
    std::vector<double> column;
    column.reserve(rows.size());
    for (const Row& row : rows)
      Row::visit(
          [&](std::string_view key, const auto& value) {
            if (key == name) column.push_back(static_cast<double>(value));
          },
          row);
    out.values.push_back(std::move(column));
  }
  for (std::size_t i = 0; i < rows.size(); ++i) out.line_numbers.push_back(i + 1);
  return out;
}

}  // namespace

std::optional<Recording> record_virtual_run(const Rig& rig) {
  if (rig.valves() != 1) return std::nullopt;
  const auto backend = make_backend("sim", rig);
  backend->configure();
  RunSettings settings;
  settings.load = load_reference_positions;
  const RunOutcome outcome = run_loop(rig, *backend, settings);
  if (!outcome.faults.empty() || outcome.stopped_by_signal || outcome.rows.empty()) return std::nullopt;
  return recording_of(rig, outcome.rows);
}

}  // namespace pneuservo
