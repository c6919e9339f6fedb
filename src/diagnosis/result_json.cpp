// A diagnosis as JSON, format pneuservo-diagnosis/1.
#include "diagnosis/result_json.hpp"

#include <cmath>
#include <filesystem>

#include <yaml-cpp/yaml.h>

#include "config/dump_rig.hpp"

namespace pneuservo {

namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json answer_json(const DiagnosisAnswer& answer) {
  Json parameters = Json::object();
  for (const EstimatedParameter& p : answer.parameters)
    parameters[p.name] = {{"value", p.value}, {"standard_error", p.standard_error}};
  Json out{{"effect", answer.effect},
           {"element", answer.element},
           {"probability", answer.probability},
           {"parameters", parameters},
           {"ambiguous_with", answer.ambiguous_with}};
  if (answer.share > 0) out["share"] = answer.share;
  if (!answer.note.empty()) out["note"] = answer.note;
  return out;
}

Json fit_json(const Diagnosis& diagnosis) {
  Json channels = Json::object();
  for (const ChannelFit& c : diagnosis.channels)
    channels[c.column] = {{"noise", c.noise},
                          {"before", c.before},
                          {"after", c.after},
                          {"held_out_before", c.held_out_before},
                          {"held_out_after", c.held_out_after},
                          {"neighbour_correlation", c.correlation}};
  return {{"channels", channels},
          {"held_out_ratio", diagnosis.held_out_ratio},
          {"over_noise", diagnosis.over_noise},
          {"explained_share", diagnosis.explained_share}};
}

/// The reference as a config has it, so that it can be put into one.
Json plain_json(const YAML::Node& node) {
  if (node.IsMap()) {
    Json out = Json::object();
    for (const auto& entry : node) out[entry.first.as<std::string>()] = plain_json(entry.second);
    return out;
  }
  if (node.IsSequence()) {
    Json out = Json::array();
    for (const auto& entry : node) out.push_back(plain_json(entry));
    return out;
  }
  double number = 0;
  if (YAML::convert<double>::decode(node, number)) return number;
  return node.as<std::string>("");
}

Json experiment_json(const std::optional<ProposedExperiment>& experiment) {
  if (!experiment) return nullptr;
  Json out{{"reference", plain_json(YAML::Load(dump_reference(experiment->reference)))}};
  out["duration_s"] = experiment->duration_s;
  if (!experiment->setup.empty()) {
    Json keys = Json::object();
    for (const auto& [path, value] : experiment->keys) keys[path] = value;
    out["setup"] = {{"words", experiment->setup}, {"keys", keys}};
  }
  out["use"] = experiment->use();
  out["between"] = experiment->between;
  out["separation"] = experiment->separation;
  return out;
}

Json coverage_json(const Coverage& coverage) {
  Json spans = Json::array();
  for (const ComparedSpan& span : coverage.spans)
    spans.push_back({{"recording", std::filesystem::path(span.recording).filename().string()},
                     {"from_s", span.from_s},
                     {"to_s", span.to_s}});
  return {{"recorded_s", coverage.recorded_s}, {"choice", coverage.choice}, {"spans", spans}};
}

Json picture_json(const std::optional<UnknownPicture>& picture) {
  if (!picture) return nullptr;
  return {{"element", picture->element},   {"what", picture->what},   {"unit", picture->unit},
          {"log_evidence", picture->gain}, {"level", picture->level}, {"words", picture->words}};
}

Json curve_json(const std::optional<UnknownCurve>& curve) {
  if (!curve) return nullptr;
  Json points = Json::array(), channels = Json::object();
  for (const UnknownCurve::Point& p : curve->points)
    points.push_back({{"place", p.place}, {"value", p.value}, {"standard_error", p.standard_error}});
  for (const ChannelFit& c : curve->channels)
    channels[c.column] = {{"noise", c.noise},
                          {"before", c.before},
                          {"after", c.after},
                          {"held_out_before", c.held_out_before},
                          {"held_out_after", c.held_out_after}};
  return {{"effects", curve->effects}, {"beside", curve->beside},
          {"over", curve->over},       {"over_unit", curve->over_unit},
          {"unit", curve->unit},       {"log_evidence", curve->gain},
          {"points", points},          {"channels", channels}};
}

Json self_test_json(const std::optional<SelfTest>& test) {
  if (!test) return nullptr;
  return {{"machines", test->machines}, {"same", test->same}, {"others", test->others}};
}

}  // namespace

Json diagnosis_json(const Diagnosis& diagnosis) {
  Json recordings = Json::array(), elements = Json::array(), answers = Json::array(), candidates = Json::array();
  for (const std::string& path : diagnosis.recordings)
    recordings.push_back(std::filesystem::path(path).filename().string());
  for (const ElementShare& e : diagnosis.elements) elements.push_back({{"element", e.element}, {"share", e.share}});
  for (const DiagnosisAnswer& a : diagnosis.answers) answers.push_back(answer_json(a));
  for (const RankedExplanation& r : diagnosis.candidates)
    candidates.push_back(
        {{"effects", r.effects}, {"probability", r.probability}, {"log_evidence_behind", r.log_evidence_behind}});
  Json detectable = Json::array(), moved = Json::array(), functions = Json::array();
  for (const FreeFunction& f : diagnosis.functions)
    functions.push_back({{"element", f.element},
                         {"what", f.what},
                         {"unit", f.unit},
                         {"log_evidence", f.gain},
                         {"level", f.level},
                         {"memory_s", f.memory_s},
                         {"upper_level", f.upper_level}});
  for (const DetectableSize& d : diagnosis.detectable)
    detectable.push_back({{"effect", d.effect}, {"parameter", d.parameter}, {"value", d.value}});
  for (const MovedParameter& m : diagnosis.moved)
    moved.push_back(
        {{"path", m.path}, {"configured", m.configured}, {"fitted", m.fitted}, {"tolerances", m.tolerances}});
  return {{"format", "pneuservo-diagnosis/1"},
          {"rig", diagnosis.rig},
          {"recordings", recordings},
          {"verdict", verdict_names[static_cast<std::size_t>(diagnosis.verdict)]},
          {"sentence", diagnosis.sentence},
          {"elements", elements},
          {"answers", answers},
          {"candidates", candidates},
          {"fit", fit_json(diagnosis)},
          {"data",
           {{"warnings", diagnosis.warnings},
            {"admitted_s", diagnosis.admitted_s},
            {"held_out_s", diagnosis.held_out_s},
            {"stopped", diagnosis.stopped},
            {"coverage", coverage_json(diagnosis.coverage)}}},
          {"parameters_moved", moved},
          {"detectable", detectable},
          {"unknown_picture", picture_json(diagnosis.picture)},
          {"curve", curve_json(diagnosis.curve)},
          {"free_functions", functions},
          {"names_ahead_of_functions", number_or_null(diagnosis.names_ahead)},
          {"names_bring_to_functions", number_or_null(diagnosis.names_bring)},
          {"self_test", self_test_json(diagnosis.self_test)},
          {"next_experiment", experiment_json(diagnosis.next_experiment)}};
}

}  // namespace pneuservo
