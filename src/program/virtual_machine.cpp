// A rig run in closed loop on the simulated backend, as a recording in memory.
#include "program/virtual_machine.hpp"

#include "backends.hpp"
#include "loop/runner.hpp"
#include "program/rig_options.hpp"
#include "record/row_recording.hpp"

namespace pneuservo {

std::optional<Recording> record_virtual_run(const Rig& rig) {
  if (rig.valves() != 1) return std::nullopt;
  const auto backend = make_backend("sim", rig);
  backend->configure();
  RunSettings settings;
  settings.load = load_reference_positions;
  const RunOutcome outcome = run_loop(rig, *backend, settings);
  if (!outcome.faults.empty() || outcome.stopped_by_signal || outcome.rows.empty()) return std::nullopt;
  return recording_of(outcome.rows, rig.name, rig.period_s, 1);
}

}  // namespace pneuservo
