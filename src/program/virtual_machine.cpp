// A rig run in closed loop on the simulated backend, as a recording in memory.
#include "program/virtual_machine.hpp"

#include "backends.hpp"
#include "loop/runner.hpp"
#include "program/rig_options.hpp"
#include "record/row_recording.hpp"

namespace pneuservo {

namespace {

std::optional<Recording> recorded_run(const Rig& rig, LoadPositions load) {
  if (rig.valves() != 1) return std::nullopt;
  const auto backend = make_backend("sim", rig);
  backend->configure();
  RunSettings settings;
  settings.load = std::move(load);
  const RunOutcome outcome = run_loop(rig, *backend, settings);
  if (!outcome.faults.empty() || outcome.stopped_by_signal || outcome.rows.empty()) return std::nullopt;
  return recording_of(outcome.rows, rig.name, rig.period_s, 1);
}

}  // namespace

std::optional<Recording> record_virtual_run(const Rig& rig) { return recorded_run(rig, load_reference_positions); }

std::optional<Recording> follow_virtually(const Rig& rig, const RecordedMotion& motion) {
  return recorded_run(rig, [&](const std::string&) { return std::pair(motion.time_s, motion.position_m); });
}

}  // namespace pneuservo
