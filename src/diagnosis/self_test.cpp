// Machines as an answer has them, diagnosed.
#include "diagnosis/self_test.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "config/rig_parameters.hpp"
#include "diagnosis/recordings/recorded_rigs.hpp"
#include "diagnosis/residuals/gaussian_kernel.hpp"
#include "diagnosis/result_text.hpp"
#include "diagnosis/stop.hpp"

namespace pneuservo {

namespace {

/// Gaussian of a position whose reference is not recorded: half the power at 6.6 Hz, beyond which a cylinder hardly
/// moves and an encoder's noise would drive the loop.
constexpr double smoothed_s = 0.02;

/// The owner's config on a machine that has what the answer says.
Rig machine_of(const Rig& configured, const Diagnosis& found, const RecordedMotion& motion, std::uint64_t seed) {
  Recording planned;
  planned.changed = motion.changed;
  Rig out = changed_rig(configured, machine_changes(configured, planned));
  out.deviations.clear();  // what the config conceals from its own loop is no part of the answer
  out.concealed.clear();
  const Rig true_rig = changed_rig(found.improved, machine_changes(configured, planned));
  for (const ParameterPath& parameter : parameter_paths(true_rig))
    if (get_parameter(out, parameter.path) != parameter.value) out.concealed[parameter.path] = parameter.value;
  out.seed = seed;
  out.reference = {};
  out.reference.kind = ReferenceKind::file;
  out.reference.path = motion.path;
  out.duration_s = motion.time_s.back();
  out.evaluation.reset();
  out.initial.position_m = motion.position_m.front();
  return out;
}

/// As many rows as the real recording has: a logger that is slower than the loop sees less.
void thin_to(const RecordedMotion& motion, double period_s, Recording& recording) {
  const double step_s = motion.time_s.back() / static_cast<double>(motion.time_s.size() - 1);
  const auto every = static_cast<std::size_t>(std::max(1L, std::lround(step_s / period_s)));
  if (every == 1) return;
  const auto thin = [&](auto& values) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < values.size(); i += every) values[kept++] = values[i];
    values.resize(kept);
  };
  for (std::vector<double>& column : recording.values) thin(column);
  thin(recording.line_numbers);
  recording.period_s *= static_cast<double>(every);
}

std::vector<std::string> names_of(const Diagnosis& diagnosis) {
  std::vector<std::string> out;
  for (const DiagnosisAnswer& answer : diagnosis.answers)
    out.push_back(answer.effect == "unknown" ? "unknown at " + answer.element : answer.effect);
  return out;
}

}  // namespace

std::vector<RecordedMotion> motions_of(const std::vector<Recording>& recordings) {
  std::vector<RecordedMotion> out;
  for (const Recording& recording : recordings) {
    const bool has_reference = recording.has("x_ref_m");
    if (!has_reference && !recording.has("x_m")) continue;
    const std::vector<double>& time_s = recording.t_s();
    const double step_s = row_interval_s(recording);
    if (time_s.size() < 10 || !(step_s > 0)) continue;
    RecordedMotion motion{recording.path, {}, {}, recording.names, recording.changed, recording.is_held_out};
    motion.position_m = held_over_gaps(recording.column(has_reference ? "x_ref_m" : "x_m"));
    if (!has_reference)
      motion.position_m = GaussianKernel(std::max(smoothed_s, step_s), step_s).apply(motion.position_m, 0);
    for (const double t : time_s) motion.time_s.push_back(t - time_s.front());
    out.push_back(std::move(motion));
  }
  return out;
}

void add_self_test(const Rig& configured, const std::vector<RecordedMotion>& motions, int machines,
                   const FollowingMachine& play, const DiagnoseAgain& again, Diagnosis& out) {
  if (out.stopped) return;
  if (motions.empty() || (out.verdict == Verdict::unknown && !out.curve)) {
    out.warnings.emplace_back("no self-test: an unknown without a table, or recordings without a motion, tell nothing "
                              "that a machine could be played by");
    return;
  }
  const std::vector<std::string> names = names_of(out);
  std::vector<int> hits(names.size(), 0);
  SelfTest test;
  for (int i = 1; i <= machines; ++i) {
    std::vector<Recording> played;
    for (std::size_t r = 0; r < motions.size(); ++r) {
      const RecordedMotion& motion = motions[r];
      const auto seed = static_cast<std::uint64_t>(i) * 1000 + r;
      std::optional<Recording> recording = play(machine_of(configured, out, motion, seed), motion);
      if (!recording) break;
      recording->path = fmt::format("self-test {}, {}", i, motion.path);
      recording->changed = motion.changed;
      recording->is_held_out = motion.is_held_out;
      thin_to(motion, configured.period_s, *recording);
      recording->keep_columns([&](const std::string& column) {
        return std::find(motion.columns.begin(), motion.columns.end(), column) != motion.columns.end();
      });
      played.push_back(std::move(*recording));
    }
    if (played.size() < motions.size()) continue;
    const Diagnosis answer = again(std::move(played));
    if (answer.stopped) throw DiagnosisStopped();
    const std::vector<std::string> said = names_of(answer);
    for (std::size_t n = 0; n < names.size(); ++n)
      hits[n] += std::find(said.begin(), said.end(), names[n]) != said.end();
    ++test.machines;
    if (answer.verdict == out.verdict && said == names) ++test.same;
    else test.others.push_back(answer.sentence);
  }
  if (test.machines == 0) {
    out.warnings.emplace_back(
        "no self-test: the config's own loop does not follow the recorded motion without a fault, or this kind of "
        "rig is not simulated");
    return;
  }
  for (std::size_t n = 0; n < names.size(); ++n)
    out.answers[n].probability = std::min(out.answers[n].probability, static_cast<double>(hits[n]) / test.machines);
  out.self_test = std::move(test);
  out.sentence = verdict_sentence(out);
}

}  // namespace pneuservo
