// One run of a law on a simulated machine, with its figures.
#include "improve/simulated_run.hpp"

#include <utility>

#include "loop/runner.hpp"
#include "record/import.hpp"
#include "report/evaluation.hpp"
#include "report/motion_verdict.hpp"
#include "sim/sim_backend.hpp"

namespace pneuservo {
namespace {

/// The motion is judged afterwards, so what would end it beforehand is off.
Rig unsupervised(Rig rig) {
  rig.limits.deviation_m = rig.limits.speed_deviation_mps = rig.limits.stall_force_N = 0.0;
  rig.limits.speed_mps = 100.0;
  rig.limits.end_stop_contact = EndStopContact::allowed;
  return rig;
}

}  // namespace

RunResult simulated_run(const Rig& config, double payload_kg) {
  Rig machine = config;
  machine.axis.slider.payload_kg = payload_kg;
  return simulated_run(config, machine);
}

RunResult simulated_run(const Rig& config, const Rig& machine) {
  const Rig rig = unsupervised(config);
  SimBackend backend(machine, SimBackend::Has::sensors_of_the_config);
  backend.configure();
  RunSettings settings;
  settings.load = load_reference_positions;
  RunOutcome outcome = run_loop(rig, backend, settings);
  RunResult run;
  run.feedforward = rig.controller.feedforward_name();
  if (outcome.moves.empty()) return run;
  run.start_s = outcome.moves[0].start_s;
  run.rows = std::move(outcome.rows);
  run.faults = std::move(outcome.faults);
  run.metrics = evaluate(rig, run.rows, run.start_s);
  run.verdict = judge_motion(rig, run);
  return run;
}

}  // namespace pneuservo
