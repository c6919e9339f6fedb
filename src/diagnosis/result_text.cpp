// A diagnosis in words: one sentence, and the page of text that the program prints.
#include "diagnosis/result_text.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/dump_rig.hpp"
#include "diagnosis/latent/latent_picture.hpp"

namespace pneuservo {

namespace {

/// With its article, for the middle of a sentence.
std::string in_words(const std::string& element) {
  const bool is_numbered = element.starts_with("line_") || element.starts_with("chamber_");
  return (is_numbered ? "" : "the ") + element_words(element);
}

/// Of what was compared how long, and what of it was held out.
std::string compared_text(const Diagnosis& diagnosis) {
  const std::size_t count = diagnosis.recordings.size();
  const std::string out =
      fmt::format("compared: {:.1f} s in {} recording{}", diagnosis.admitted_s, count, count == 1 ? "" : "s");
  if (diagnosis.stopped)
    return out + "; stopped before held-out stretches were simulated: figures are of means over rows, as fits see them";
  return out + fmt::format(", {:.1f} s held out of every fit", diagnosis.held_out_s);
}

std::string misfits_text(const std::vector<ChannelFit>& channels) {
  std::string out = fmt::format("{:<18}{:>12}{:>12}{:>12}{:>16}{:>16}\n", "channel", "floor", "before", "after",
                                "held out before", "held out after");
  for (const ChannelFit& c : channels)
    out += fmt::format("{:<18}{:>12}{:>12}{:>12}{:>16}{:>16}\n", c.column, value_text(c.noise), value_text(c.before),
                       value_text(c.after), value_text(c.held_out_before), value_text(c.held_out_after));
  return out;
}

std::string parameters_text(const DiagnosisAnswer& answer) {
  std::vector<std::string> parts;
  parts.reserve(answer.parameters.size());
  for (const EstimatedParameter& p : answer.parameters)
    parts.push_back(fmt::format("{} = {:.4g} +- {:.1g}", p.name, p.value, p.standard_error));
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// A name with its place, its sizes and its own probability; where that is below a half, what may be meant as well.
std::string answer_text(const DiagnosisAnswer& answer) {
  const bool is_doubted = answer.probability < 0.5 && !answer.ambiguous_with.empty();
  const std::string rivals =
      is_doubted ? fmt::format(" (not told from {})", fmt::join(answer.ambiguous_with, ", ")) : "";
  return fmt::format("{} at {} ({}), probability {:.2f}{}", answer.effect, in_words(answer.element),
                     parameters_text(answer), answer.probability, rivals);
}

std::string lead(Verdict verdict) {
  switch (verdict) {
    case Verdict::missing_physics: return "The model lacks ";
    case Verdict::parameter_error: return "A parameter is off: ";
    case Verdict::sensor_error: return "A sensor is at fault: ";
    default: return "";
  }
}

std::string smallest_sizes(const Diagnosis& diagnosis) {
  std::string out;
  for (const DetectableSize& d : diagnosis.detectable)
    if (!d.effect.starts_with("parameter:") && !d.effect.starts_with("sensor_"))
      out += fmt::format("  {:<32} {:<28} {:>10.5g}\n", d.effect, d.parameter, d.value);
  return out;
}

/// Numbers of the config with which alone the recordings agree: they are at the end of their tolerances, and may be off
/// by more.
std::string at_the_end(const Diagnosis& diagnosis) {
  std::vector<std::string> parts;
  for (const MovedParameter& m : diagnosis.moved)
    if (m.is_at_end) parts.push_back(fmt::format("{} = {:.4g} instead of {:.4g}", m.path, m.fitted, m.configured));
  return parts.empty() ? "" : fmt::format(", but only at the end of a tolerance: {}", fmt::join(parts, ", "));
}

/// As if it had not been stopped.
std::string finished_sentence(const Diagnosis& diagnosis) {
  if (diagnosis.verdict == Verdict::consistent)
    return fmt::format("Model and recordings agree: in {:.3g} s nothing is missing that these data could show{}.",
                       diagnosis.admitted_s, at_the_end(diagnosis));
  if (diagnosis.answers.empty()) return "No verdict.";
  const DiagnosisAnswer& first = diagnosis.answers.front();
  if (diagnosis.verdict == Verdict::unknown)
    return fmt::format("Something is missing at {} that no name explains: {} (probability {:.2f}).",
                       in_words(first.element), first.note, first.probability);
  std::string out = lead(diagnosis.verdict) + answer_text(first);
  for (std::size_t i = 1; i < diagnosis.answers.size(); ++i) out += ", and " + answer_text(diagnosis.answers[i]);
  return out + ".";
}

std::string coverage_text(const Coverage& coverage) {
  if (coverage.choice.empty()) return "";
  std::string out = fmt::format("of {:.4g} s recorded are compared {}\n", coverage.recorded_s, coverage.choice);
  for (const ComparedSpan& span : coverage.spans)
    out += fmt::format("  {}: {:.6g} to {:.6g} s\n", span.recording, span.from_s, span.to_s);
  return out + "\n";
}

std::string functions_text(const Diagnosis& diagnosis) {
  std::string out =
      "\nfree functions of time beside the owner's model: gain in log evidence, likeliest size, at most (95 %)\n";
  for (const FreeFunction& f : diagnosis.functions)
    out += fmt::format("  {:<20}{:<42}{:>10.1f}   {:<26}{}\n", f.element, f.what, f.gain, size_text(f.level, f.unit),
                       size_text(f.upper_level, f.unit));
  return out;
}

std::string curve_text(const UnknownCurve& curve) {
  std::string out =
      fmt::format("\nwhat no name explains, as a table over {} beside {}: {:.0f} in log evidence ahead\n{}", curve.over,
                  beside_words(curve), curve.gain, misfits_text(curve.channels));
  out += fmt::format("{:>14} [{}]  {} [{}]  standard error\n", curve.over, curve.over_unit,
                     fmt::join(curve.effects, ", "), curve.unit);
  for (const UnknownCurve::Point& p : curve.points)
    out += fmt::format("  {:>12.4g}{:>20.4g}{:>14.2g}\n", p.place, p.value, p.standard_error);
  return out;
}

}  // namespace

std::string beside_words(const UnknownCurve& curve) {
  return curve.beside.empty() ? "the config" : fmt::format("{}", fmt::join(curve.beside, " and "));
}

std::string element_words(std::string_view element) {
  if (element.starts_with("sensor:")) return fmt::format("sensor of {}", element.substr(7));
  if (element.starts_with("line_") || element.starts_with("chamber_"))
    return fmt::format("{} {}", element.substr(0, element.size() - 2), element.substr(element.size() - 1));
  if (element == "timing") return "timing of the command";
  if (element == "motion") return "slider, guide and load";
  return std::string(element);
}

std::string value_text(double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : "–"; }

std::string explanation_text(const RankedExplanation& explanation) {
  return explanation.effects.empty() ? "nothing" : fmt::format("{}", fmt::join(explanation.effects, " + "));
}

std::string self_test_text(const SelfTest& test) {
  std::string out = fmt::format("self-test: of {} machines as this answer has them {} got the same answer\n",
                                test.machines, test.same);
  for (const std::string& other : test.others) out += fmt::format("  another: {}\n", other);
  return out;
}

std::string verdict_sentence(const Diagnosis& diagnosis) {
  if (!diagnosis.stopped) return finished_sentence(diagnosis);
  if (diagnosis.verdict == Verdict::consistent) return "Stopped early, no finished verdict: by then nothing was named.";
  if (diagnosis.verdict == Verdict::unknown && !diagnosis.answers.empty())
    return fmt::format("Stopped early, no finished verdict: no name tried by then explains what is left: {}.",
                       diagnosis.answers.front().note);
  return "Stopped early, no finished verdict; by then: " + finished_sentence(diagnosis);
}

std::string diagnosis_text(const Diagnosis& diagnosis) {
  std::string out = diagnosis.sentence + "\n\n";
  out += compared_text(diagnosis) + "\n\n";
  out += coverage_text(diagnosis.coverage);
  out += misfits_text(diagnosis.channels);
  if (!diagnosis.candidates.empty()) {
    out += "\nexplanations tried in full, probability, log evidence behind the best\n";
    for (const RankedExplanation& r : diagnosis.candidates)
      out += fmt::format("  {:<56}{:>8.3f}{:>12.1f}\n", explanation_text(r), r.probability, r.log_evidence_behind);
  }
  for (const DiagnosisAnswer& answer : diagnosis.answers)
    if (!answer.ambiguous_with.empty())
      out += fmt::format("\nThese recordings cannot tell {} from {}.\n", answer.effect,
                         fmt::join(answer.ambiguous_with, ", "));
  if (diagnosis.verdict != Verdict::unknown)
    for (const DiagnosisAnswer& answer : diagnosis.answers)
      if (!answer.note.empty()) out += fmt::format("\n{}: {}\n", answer.effect, answer.note);
  if (diagnosis.next_experiment) {
    const ProposedExperiment& next = *diagnosis.next_experiment;
    out +=
        fmt::format("\nnext recording, {:g} s, tells {} apart by {:.1f} noise floors\n  reference: {}\n",
                    next.duration_s, fmt::join(next.between, " and "), next.separation, dump_reference(next.reference));
    if (!next.setup.empty()) out += fmt::format("  before it: {}\n", next.setup);
    out += fmt::format("  then diagnose it {}\n", next.use());
  }
  bool any_moved = false;
  for (const MovedParameter& m : diagnosis.moved) {
    if (std::abs(m.tolerances) < 1) continue;
    if (!any_moved) out += "\nparameters that moved by more than one tolerance\n";
    any_moved = true;
    out += fmt::format("  {:<40}{:>12.5g} -> {:<12.5g} ({:+.1f} tolerances)\n", m.path, m.configured, m.fitted,
                       m.tolerances);
  }
  if (diagnosis.curve) out += curve_text(*diagnosis.curve);
  if (diagnosis.self_test) out += "\n" + self_test_text(*diagnosis.self_test);
  if (!diagnosis.functions.empty()) out += functions_text(diagnosis);
  if (diagnosis.verdict == Verdict::consistent)
    out += "\nsmallest sizes that would have been seen\n" + smallest_sizes(diagnosis);
  for (const std::string& warning : diagnosis.warnings) out += "\nwarning: " + warning;
  if (!diagnosis.warnings.empty()) out += "\n";
  return out;
}

std::string ProposedExperiment::use() const {
  std::string out = "together with the recordings so far";
  for (const auto& [path, value] : keys) out += fmt::format(", --changed RECORDING:{}={:g}", path, value);
  return out;
}

}  // namespace pneuservo
