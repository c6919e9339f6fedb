// The tables of a diagnosis.
#include <report/diagnosis_tables.hpp>

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <report/diagnosis_words.hpp>

#include "config/dump_rig.hpp"
#include "diagnosis/latent/latent_picture.hpp"
#include "diagnosis/result_text.hpp"

namespace pneuservo {
namespace {

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

/// A column whose cells come from each item.
template <class Items, class Function>
TableColumn column(std::string title, std::string unit, const Items& items, Function&& cell, bool is_text = false) {
  TableColumn out{std::move(title), std::move(unit), {}, is_text};
  for (const auto& item : items) out.cells.push_back(cell(item));
  return out;
}

template <class Items, class Function> TableColumn words(std::string title, const Items& items, Function&& cell) {
  return column(std::move(title), "", items, std::forward<Function>(cell), true);
}

std::string joined_words(const std::vector<std::string>& effects) {
  std::vector<std::string> parts;
  for (const std::string& effect : effects) parts.push_back(effect_words(effect));
  return fmt::format("{}", fmt::join(parts, "; "));
}

struct Estimate {
  std::string effect;
  EstimatedParameter parameter;
};

std::vector<Estimate> estimates(const Diagnosis& diagnosis) {
  std::vector<Estimate> out;
  for (const DiagnosisAnswer& answer : diagnosis.answers)
    for (const EstimatedParameter& parameter : answer.parameters) out.push_back({answer.effect, parameter});
  return out;
}

}  // namespace

Table answers_table(const Diagnosis& diagnosis) {
  const auto& answers = diagnosis.answers;
  Table table;
  table.columns = {
      words("what", answers, [](const DiagnosisAnswer& a) { return effect_words(a.effect); }),
      words("name", answers, [](const DiagnosisAnswer& a) { return a.effect; }),
      words("where", answers, [](const DiagnosisAnswer& a) { return element_words(a.element); }),
      column("probability", "", answers, [](const DiagnosisAnswer& a) { return fmt::format("{:.3f}", a.probability); }),
      column("takes of the mismatch", "", answers,
             [](const DiagnosisAnswer& a) { return a.share > 0 ? percent(a.share) : "–"; })};
  return table;
}

Table coverage_table(const Coverage& coverage) {
  Table table;
  table.columns = {
      words("recording", coverage.spans, [](const ComparedSpan& s) { return s.recording; }),
      column("from", "s", coverage.spans, [](const ComparedSpan& s) { return fmt::format("{:.6g}", s.from_s); }),
      column("to", "s", coverage.spans, [](const ComparedSpan& s) { return fmt::format("{:.6g}", s.to_s); })};
  return table;
}

Table estimates_table(const Diagnosis& diagnosis) {
  const std::vector<Estimate> all = estimates(diagnosis);
  Table table;
  table.columns = {
      words("effect", all, [](const Estimate& e) { return e.effect; }),
      words("parameter", all, [](const Estimate& e) { return e.parameter.name; }),
      column("value", "", all, [](const Estimate& e) { return value_text(e.parameter.value); }),
      column("standard error", "", all, [](const Estimate& e) { return error_text(e.parameter.standard_error); }),
      words("that is", all, [](const Estimate& e) {
        const bool is_path = e.parameter.name == "value" && e.effect.starts_with("parameter:");
        return size_words(is_path ? e.effect : e.parameter.name, e.parameter.value);
      })};
  return table;
}

Table fit_table(const std::vector<ChannelFit>& channels) {
  const auto figures = [&](std::string title, double ChannelFit::* member) {
    return column(std::move(title), "", channels, [member](const ChannelFit& c) { return value_text(c.*member); });
  };
  Table table;
  table.columns = {
      words("channel", channels, [](const ChannelFit& c) { return c.column; }),
      figures("noise floor", &ChannelFit::noise),
      figures("before", &ChannelFit::before),
      figures("after", &ChannelFit::after),
      figures("held out, before", &ChannelFit::held_out_before),
      figures("held out, after", &ChannelFit::held_out_after),
      column("after over floor", "", channels,
             [](const ChannelFit& c) { return c.noise > 0 ? fmt::format("{:.2f}", c.after / c.noise) : "–"; }),
      column("correlation of neighbours", "", channels, [](const ChannelFit& c) {
        return std::isfinite(c.correlation) ? fmt::format("{:.2f}", c.correlation) : "–";
      })};
  return table;
}

Table candidates_table(const Diagnosis& diagnosis) {
  const auto& all = diagnosis.candidates;
  Table table;
  table.columns = {
      words("explanation", all, [](const RankedExplanation& r) { return explanation_text(r); }),
      words("in words", all,
            [](const RankedExplanation& r) {
              return r.effects.empty() ? std::string("the model as it stands") : joined_words(r.effects);
            }),
      column("probability", "", all, [](const RankedExplanation& r) { return fmt::format("{:.3f}", r.probability); }),
      column("log evidence behind the best", "", all,
             [](const RankedExplanation& r) { return fmt::format("{:.1f}", r.log_evidence_behind); })};
  table.best_row = all.empty() || diagnosis.answers.empty() || diagnosis.answers.front().effect == "unknown" ? -1 : 0;
  return table;
}

Table moved_table(const Diagnosis& diagnosis) {
  const auto& moved = diagnosis.moved;
  Table table;
  table.columns = {
      words("parameter", moved, [](const MovedParameter& m) { return m.path; }),
      column("config", "", moved, [](const MovedParameter& m) { return fmt::format("{:.5g}", m.configured); }),
      column("best value", "", moved, [](const MovedParameter& m) { return fmt::format("{:.5g}", m.fitted); }),
      column("moved by", "tolerances", moved,
             [](const MovedParameter& m) { return fmt::format("{:+.1f}", m.tolerances); })};
  return table;
}

Table detectable_table(const Diagnosis& diagnosis) {
  const auto& all = diagnosis.detectable;
  Table table;
  table.columns = {
      words("what", all, [](const DetectableSize& d) { return effect_words(d.effect); }),
      words("name", all,
            [](const DetectableSize& d) {
              return d.parameter == "value" ? d.effect : fmt::format("{}.{}", d.effect, d.parameter);
            }),
      column("smallest value", "", all, [](const DetectableSize& d) { return fmt::format("{:.5g}", d.value); }),
      words("that is", all, [](const DetectableSize& d) {
        return size_words(d.parameter == "value" ? d.effect : d.parameter, d.value);
      })};
  return table;
}

Table functions_table(const Diagnosis& diagnosis) {
  const auto& all = diagnosis.functions;
  Table table;
  table.columns = {
      words("element", all, [](const FreeFunction& f) { return element_words(f.element); }),
      words("free function of time", all, [](const FreeFunction& f) { return f.what; }),
      column("gain in log evidence", "", all, [](const FreeFunction& f) { return fmt::format("{:.1f}", f.gain); }),
      column("likeliest size", "", all, [](const FreeFunction& f) { return size_text(f.level, f.unit); }),
      column("at most (95 %)", "", all, [](const FreeFunction& f) { return size_text(f.upper_level, f.unit); })};
  return table;
}

Table experiment_table(const ProposedExperiment& experiment) {
  Table table;
  table.columns = {
      text_column("",
                  {"tells apart", "reference", "change of the machine", "then diagnose it", "predicted separation"}),
      text_column("", {fmt::format("{}", fmt::join(experiment.between, " from ")), dump_reference(experiment.reference),
                       experiment.setup.empty() ? "none" : experiment.setup, experiment.use(),
                       fmt::format("{:.1f} noise floors", experiment.separation)})};
  return table;
}

}  // namespace pneuservo
