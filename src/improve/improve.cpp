// From recordings of a machine to a config that controls it better.
#include "improve/improve.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "config/rig_kinds.hpp"
#include "diagnosis/diagnose.hpp"
#include "improve/simulated_run.hpp"

namespace pneuservo {
namespace {

/// A call takes up to a minute and names one or two effects; machines with three are done after two.
constexpr std::size_t most_calls = 4;

/// Numbers of another machine are worse than none.
void require_own_recordings(const std::string& config, const Rig& rig, const std::vector<Recording>& recordings) {
  for (const Recording& recording : recordings)
    if (!recording.rig.empty() && recording.rig != rig.name)
      throw InputError(fmt::format("{}: found a recording of the rig '{}', expected one of '{}', the name in {}",
                                   recording.path, recording.rig, rig.name, config));
}

ImprovementCall call_of(const Diagnosis& diagnosis) {
  return {diagnosis.verdict, diagnosis.sentence, diagnosis.answers, diagnosis.unsaid, diagnosis.floors_left};
}

/// Keys in which a rig differs from the owner's.
std::set<std::string> changed_keys(const Rig& owner, const Rig& rig) {
  std::set<std::string> out;
  for (const ChangedNumber& change : changed_numbers(owner, rig)) out.insert(change.path);
  return out;
}

/// Diagnoses again from what was found, until nothing is missing, a call gains nothing, or none names anything new.
void diagnose_while_it_gains(const std::vector<Recording>& recordings, const ImproveOptions& options,
                             Improvement& out) {
  while (out.calls.size() < most_calls) {
    DiagnoseOptions settings;
    settings.jobs = options.jobs;
    settings.stop = options.stop;
    if (options.progress)
      settings.progress = [&](double share, const std::string& what) {
        options.progress(share, fmt::format("call {}: {}", out.calls.size() + 1, what));
      };
    const Diagnosis found = diagnose(out.improved, recordings, settings);
    if (found.stopped) throw DiagnosisStopped();
    const ImprovementCall call = call_of(found);
    const bool gains = out.calls.empty() || call.floors_left < out.calls.back().floors_left;
    const bool repeats = !out.calls.empty() && std::ranges::includes(changed_keys(out.configured, out.improved),
                                                                     changed_keys(out.configured, found.improved));
    out.calls.push_back(call);
    if (!gains) return;
    out.improved = found.improved;
    if (call.verdict == Verdict::consistent || repeats) return;
  }
}

/// A fit that ends at a bound says that something else is there.
std::string bound_words(const Improvement& improvement) {
  for (const ImprovementCall& call : improvement.calls)
    for (const auto* answers : {&call.answers, &call.unsaid})
      for (const DiagnosisAnswer& answer : *answers)
        for (const EstimatedParameter& parameter : answer.parameters)
          if (parameter.is_at_bound)
            return fmt::format(
                "{} of {} is at the bound of what is looked for ({:.4g}), so something else may be there",
                parameter.name, answer.effect, parameter.value);
  return "";
}

/// The run as it comes out on the improved model. Throws std::invalid_argument where the law asks for a pass that
/// cannot be made.
RunResult predicted(Rig law, const Rig& improved) {
  law.controller.of<PdForce>().without_pass = WithoutPass::refuse;
  Rig machine = improved;
  machine.deviations.clear();
  machine.concealed.clear();
  return simulated_run(law, machine);
}

/// What the config does today, without its pass where it has none. It does not know the machine: its cross-checks
/// would end the motion.
RunResult predicted_before(const Improvement& improvement) {
  Rig law = improvement.configured;
  law.limits.flow_mismatch_share = law.limits.chamber_mismatch_Pa = 0.0;
  for (;;) try {
      return predicted(law, improvement.improved);
    } catch (const std::invalid_argument&) {
      if (!law.controller.wants_pass()) return {};
      law.controller.of<PdForce>().flow_feedforward = FeedforwardSource::formula;
    }
}

/// The run on the improved model; where the loop swings by itself with what was found (a lag, a dead time), its force
/// gain goes down before. Lines, not the gain, set what a loop with feedforward errs by.
void predict_calm(Improvement& out, const StopQuestion& stop) {
  constexpr int most_halvings = 4;
  PdForceParameters& law = out.improved.controller.of<PdForce>();
  const double configured = law.force_gain_V_per_N;
  double swing_Hz = 0.0;
  out.after = predicted(out.improved, out.improved);
  for (int i = 0; i < most_halvings && out.after.verdict.oscillates; ++i) {
    look_for_stop(stop);
    swing_Hz = out.after.verdict.oscillation_Hz;
    law.force_gain_V_per_N *= 0.5;
    out.after = predicted(out.improved, out.improved);
  }
  if (law.force_gain_V_per_N < configured)
    out.warnings.push_back(fmt::format("with what was found the loop swings at {:.3g} Hz: "
                                       "controller.force_gain_V_per_N was {:g} and is {:g} now{}",
                                       swing_Hz, configured, law.force_gain_V_per_N,
                                       out.after.verdict.oscillates ? ", where it still swings" : ""));
}

/// Takes a feedforward with the configured gains, and keeps it where the config's own run does not err less on the
/// model. Why not, where it does; else empty.
std::string tried(Improvement& out, FeedforwardSource source, const PdForceParameters& configured,
                  const StopQuestion& stop) {
  PdForceParameters& law = out.improved.controller.of<PdForce>();
  const auto told = static_cast<std::ptrdiff_t>(out.warnings.size());
  law = configured;
  law.flow_feedforward = source;
  std::string why;
  try {
    predict_calm(out, stop);
    const double ratio = out.error_ratio();
    if (!out.after.faults.empty()) why = "the simulated run with it ended by " + out.after.faults.front();
    else if (ratio > 1.0) why = fmt::format("on the model it errs {:.3g} times as much", ratio);
  } catch (const std::invalid_argument& error) { why = error.what(); } catch (const DiagnosisStopped&) {
    law = configured;  // a config that was tried in part is none that is told of
    throw;
  }
  if (why.empty()) return why;
  out.warnings.erase(out.warnings.begin() + told, out.warnings.end());
  law = configured;
  return why;
}

/// What the law does where there is no pass: the formula where the config says so or it errs less on the model.
void predict_without_pass(Improvement& out, const PdForceParameters& configured, bool is_model_in_doubt,
                          const StopQuestion& stop) {
  PdForceParameters& law = out.improved.controller.of<PdForce>();
  const bool asks_for_pass = configured.wants_pass();
  const bool may_take = configured.flow_feedforward == FeedforwardSource::off && !is_model_in_doubt;
  if (may_take && tried(out, FeedforwardSource::formula, configured, stop).empty()) {
    out.warnings.emplace_back("controller.flow_feedforward was off and is formula now, which errs less on the model");
    return;
  }
  law = configured;
  const bool takes_formula = !may_take && law.without_pass == WithoutPass::formula;
  if (asks_for_pass || takes_formula) law.flow_feedforward = FeedforwardSource::formula;
  if (asks_for_pass)
    out.warnings.emplace_back("controller.flow_feedforward was pass and is formula now, for there is no pass");
  look_for_stop(stop);
  try {
    predict_calm(out, stop);
  } catch (const std::invalid_argument&) { out.after = {}; }
}

/// With the pass, or why there is none.
void predict_after(Improvement& out, const StopQuestion& stop) {
  const PdForceParameters configured = out.improved.controller.of<PdForce>();
  out.without_pass = bound_words(out);
  const bool is_model_in_doubt = !out.without_pass.empty();
  if (!is_model_in_doubt) out.without_pass = tried(out, FeedforwardSource::pass, configured, stop);
  if (!out.without_pass.empty()) predict_without_pass(out, configured, is_model_in_doubt, stop);
}

void predict(Improvement& out, const StopQuestion& stop) {
  if (out.calls.back().verdict == Verdict::unknown)
    out.warnings.emplace_back(
        "the last call leaves something that no name explains; the prediction knows nothing of it");
  out.before = predicted_before(out);
  look_for_stop(stop);
  predict_after(out, stop);
}

/// What is commanded at run time is predicted by two moves, whose passes are those that the loop makes.
void predict_commanded(Improvement& out, const StopQuestion& stop) {
  const Rig as_it_was = out.configured;
  for (Rig* rig : {&out.configured, &out.improved}) {
    rig->reference = live_moves(as_it_was.reference);
    rig->duration_s = Reference(rig->reference).end_s() + live_rest_s;
  }
  const auto restore = [&] {
    out.configured = as_it_was;
    out.improved.reference = as_it_was.reference;
    out.improved.duration_s = as_it_was.duration_s;
    PdForceParameters& law = out.improved.controller.of<PdForce>();
    if (law.wants_pass()) law.without_pass = WithoutPass::formula;
  };
  try {
    predict(out, stop);
  } catch (const DiagnosisStopped&) {
    restore();
    throw;
  }
  restore();
}

}  // namespace

void require_improvable(const std::string& config, const Rig& rig) {
  require_valves("improve", config, rig, 1);
  if (!rig.controller.is<PdForce>())
    throw InputError(fmt::format("{}: controller.kind: found {}, expected {}, the law that follows a command pass",
                                 config, rig.controller.name(), PdForce::name));
}

Improvement improve(const std::string& config, const Rig& rig, const std::vector<Recording>& recordings,
                    const ImproveOptions& options) {
  require_improvable(config, rig);
  require_own_recordings(config, rig, recordings);
  Improvement out;
  out.configured = out.improved = rig;
  try {
    diagnose_while_it_gains(recordings, options, out);
    look_for_stop(options.stop);
    if (options.progress) options.progress(1.0, "command pass and prediction");
    if (rig.reference.kind == ReferenceKind::live) predict_commanded(out, options.stop);
    else predict(out, options.stop);
  } catch (const DiagnosisStopped&) {
    if (out.calls.empty()) throw;
    out.stopped = true;
    out.before = out.after = {};
  }
  out.changes = changed_numbers(rig, out.improved);
  return out;
}

std::string improved_config_text(const Improvement& improvement) {
  std::string text;
  for (const ImprovementCall& call : improvement.calls) text += "# " + call.sentence + "\n";
  return text + dump_rig(improvement.improved);
}

void judge_improved_config(Improvement& improvement, const std::string& text, const std::string& source) {
  try {
    parse_rig(text, source);
  } catch (const InputError& error) {
    improvement.is_refused = true;
    improvement.warnings.emplace_back(error.what());
  }
}

}  // namespace pneuservo
