// The page of the verb `diagnose`.
#include <report/diagnosis_report.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <report/diagnosis_plots.hpp>
#include <report/diagnosis_tables.hpp>
#include <report/diagnosis_words.hpp>
#include <report/html_page.hpp>
#include <report/rig_picture.hpp>

#include "config/dump_rig.hpp"

namespace pneuservo {
namespace {

std::string eyebrow(const Diagnosis& diagnosis) {
  return fmt::format("{} · diagnosis of {} recording{}: {:.1f} s compared, {}", diagnosis.rig,
                     diagnosis.recordings.size(), diagnosis.recordings.size() == 1 ? "" : "s", diagnosis.admitted_s,
                     diagnosis.stopped ? "stopped early"
                                       : fmt::format("{:.1f} s held out of every fit", diagnosis.held_out_s));
}

bool is_named(const Diagnosis& diagnosis) {
  return diagnosis.verdict != Verdict::consistent && diagnosis.verdict != Verdict::unknown;
}

std::string shares_sentence(const Diagnosis& diagnosis) {
  if (diagnosis.elements.empty())
    return "No element is marked: simulation and recordings agree to within their floors.";
  std::vector<std::string> parts;
  for (const ElementShare& e : diagnosis.elements)
    if (e.share >= 0.05) parts.push_back(fmt::format("{} {:.0f} %", element_words(e.element), 100 * e.share));
  return fmt::format("Share of the mismatch by element: {}.", fmt::join(parts, ", "));
}

void add_picture(HtmlPage& page, const Diagnosis& diagnosis) {
  std::vector<std::string> sensors{"x"};
  for (const ResidualChannel& channel : diagnosis.residual_channels)
    if (channel.name != "F" || !diagnosis.configured.is_pneumatic()) sensors.push_back(channel.name);
  std::vector<PictureMark> marks;
  for (const ElementShare& e : diagnosis.elements) marks.push_back({e.element, e.share});
  page.section("Where it sits");
  page.drawing(rig_picture(diagnosis.configured, sensors, marks), shares_sentence(diagnosis));
}

std::string ambiguity_sentence(const DiagnosisAnswer& answer) {
  std::vector<std::string> others;
  for (const std::string& other : answer.ambiguous_with)
    others.push_back(fmt::format("{} ({})", effect_words(other), other));
  return fmt::format("These recordings cannot tell it apart: {} would look the same as {}.", fmt::join(others, ", or "),
                     answer.effect);
}

void add_answers(HtmlPage& page, const Diagnosis& diagnosis) {
  if (diagnosis.answers.empty()) return;
  page.section("What it is");
  page.table(answers_table(diagnosis));
  for (const DiagnosisAnswer& answer : diagnosis.answers) {
    if (!answer.ambiguous_with.empty()) page.alert(ambiguity_sentence(answer));
    if (!answer.note.empty()) page.paragraph(answer.note);
  }
  if (diagnosis.self_test) page.paragraph(self_test_text(*diagnosis.self_test));
  if (is_named(diagnosis)) page.table(estimates_table(diagnosis));
  if (diagnosis.explained_share > 0 && is_named(diagnosis))
    page.paragraph(fmt::format("Together this takes {:.1f} % of the squared mismatch above the noise floors.",
                               100 * diagnosis.explained_share));
}

void add_unknown(HtmlPage& page, const Diagnosis& diagnosis) {
  if (!diagnosis.picture) return;
  const UnknownPicture& picture = *diagnosis.picture;
  page.section("What is missing looks like this",
               "A free function of time at this element, as the recordings have it: what the model would need there to "
               "agree. A law shows as a line in one of these pictures.");
  page.paragraph(picture.words + ".");
  std::vector<Plot> courses;
  for (std::size_t r = 0; r < recording_count(diagnosis); ++r)
    courses.push_back(unknown_course_plot(picture, static_cast<int>(r)));
  page.plots(courses);
  const std::vector<Plot> plots = unknown_plots(picture);
  for (std::size_t first = 0; first < plots.size(); first += 3)
    page.plots({plots.begin() + static_cast<std::ptrdiff_t>(first),
                plots.begin() + static_cast<std::ptrdiff_t>(std::min(first + 3, plots.size()))});
}

void add_curve(HtmlPage& page, const Diagnosis& diagnosis) {
  if (!diagnosis.curve) return;
  const UnknownCurve& curve = *diagnosis.curve;
  page.section("What no name explains, as a table",
               fmt::format("{}, fitted beside {} with the tolerances free: {:.0f} in log evidence ahead. It is no law; "
                           "the improved config has it.",
                           fmt::join(curve.effects, " and "), beside_words(curve), curve.gain));
  page.plots({curve_plot(curve)});
  page.table(fit_table(curve.channels));
}

/// Only where not everything is compared.
void add_coverage(HtmlPage& page, const Diagnosis& diagnosis) {
  const Coverage& coverage = diagnosis.coverage;
  if (coverage.choice.empty()) return;
  page.section("What is compared", fmt::format("Of {:.4g} s recorded: {}.", coverage.recorded_s, coverage.choice));
  page.table(coverage_table(coverage));
}

void add_proof(HtmlPage& page, const Diagnosis& diagnosis) {
  page.section("Proof",
               "Root mean square of simulation minus recording. Before: the config as it stands. After: with what was "
               "found. Held out: the last second of every four, which no fit has seen. The floor is the noise of the "
               "sensor and the model's own error together. The correlation of neighbouring rows is 0 where nothing but "
               "noise is left.");
  page.table(fit_table(diagnosis.channels));
  const std::string left =
      std::isfinite(diagnosis.error_left)
          ? fmt::format("On the held-out stretches {:.1f} % of the error is left", 100 * diagnosis.error_left)
          : "Nothing held out was simulated";
  page.paragraph(fmt::format("{}; after the change the fitted stretches are at {:.2f} times the floors (root mean "
                             "squares over all channels, each in its floor).",
                             left, diagnosis.floors_left));
}

void add_courses(HtmlPage& page, const Diagnosis& diagnosis) {
  const std::size_t recordings = recording_count(diagnosis);
  if (recordings == 0) return;
  page.section(
      "Measured and simulated",
      "Left: the courses; right: simulation minus recording as means over 10 ms, with their noise floor as a band. "
      "Held-out stretches are shaded. Drag across a plot to zoom, shift and drag to pan, double-click to return; a "
      "click on a name "
      "hides its curve. Curves are thinned to what a screen can show; every peak is kept. F: the force of "
      "the pressures or of the drive (measured) against what the recorded motion needs by the model (simulated).");
  std::vector<std::string> names;
  for (std::size_t r = 0; r < recordings; ++r)
    names.push_back(r < diagnosis.recordings.size() ? std::filesystem::path(diagnosis.recordings[r]).filename().string()
                                                    : fmt::format("recording {}", r + 1));
  page.panels_begin(names, 0);
  for (std::size_t r = 0; r < recordings; ++r) {
    page.panel(r);
    for (const std::size_t channel : channels_by_mismatch(diagnosis)) {
      const Plot course = course_plot(diagnosis, channel, r);
      if (!course.curves.empty()) page.plots({course, difference_plot(diagnosis, channel, r)});
    }
  }
  page.panels_end();
}

void add_residuals(HtmlPage& page, const Diagnosis& diagnosis) {
  if (diagnosis.rows.empty()) return;
  page.section(
      "Where the mismatch lives",
      "Simulation minus recording in noise floors, as means over 40 equal bins of position, speed and command, "
      "with the standard deviation in each bin as a band. A leak shows at every speed, dry friction as a step at "
      "speed zero, a tight spot at one position, a fault of the valve's edges near command zero.");
  const std::vector<std::size_t> channels = channels_by_mismatch(diagnosis);
  std::vector<std::string> names;
  for (const std::size_t channel : channels) names.push_back(diagnosis.residual_channels[channel].name);
  page.panels_begin(names, 0);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    page.panel(i);
    std::vector<Plot> row;
    for (const ResidualAxis axis : {ResidualAxis::position, ResidualAxis::velocity, ResidualAxis::command}) {
      Plot plot = residual_plot(diagnosis, channels[i], axis);
      if (!plot.curves.empty()) row.push_back(std::move(plot));
    }
    if (!row.empty()) page.plots(row);
  }
  page.panels_end();
}

void add_candidates(HtmlPage& page, const Diagnosis& diagnosis) {
  if (diagnosis.candidates.empty()) return;
  page.section("Explanations that were tried in full",
               fmt::format("Out of {} simulated hypotheses. Ten in log evidence are a factor of 20 000.",
                           diagnosis.hypotheses_tried));
  page.table(candidates_table(diagnosis));
}

void add_experiment(HtmlPage& page, const Diagnosis& diagnosis) {
  if (!diagnosis.next_experiment) return;
  page.section(
      "The recording to make next",
      "Of a menu of safe references, simulated in closed loop under each rival, this one tells them apart best. "
      "The separation is what would be left of the wrong rival's misfit after its own refit.");
  page.table(experiment_table(*diagnosis.next_experiment));
}

HtmlPage make_page(const Diagnosis& diagnosis) {
  HtmlPage page(diagnosis.rig + " · diagnosis", eyebrow(diagnosis), verdict_words(diagnosis));
  if (verdict_words(diagnosis) != diagnosis.sentence) page.paragraph(diagnosis.sentence);
  for (const std::string& warning : diagnosis.warnings) page.alert(warning);
  add_picture(page, diagnosis);
  add_answers(page, diagnosis);
  add_unknown(page, diagnosis);
  add_curve(page, diagnosis);
  add_experiment(page, diagnosis);
  add_coverage(page, diagnosis);
  add_proof(page, diagnosis);
  add_courses(page, diagnosis);
  add_residuals(page, diagnosis);
  add_candidates(page, diagnosis);
  if (!diagnosis.moved.empty()) {
    page.section("Parameters inside their tolerances",
                 "Every parameter under `tolerances` of the config was free to move by as much as its tolerance makes "
                 "likely.");
    page.table(moved_table(diagnosis));
  }
  if (!diagnosis.detectable.empty()) {
    page.section(
        "What would have been seen",
        "The smallest size of each effect that these recordings would have shown in nine of ten cases. What is "
        "smaller may be there.");
    page.table(detectable_table(diagnosis));
  }
  if (!diagnosis.functions.empty()) {
    page.section("How large could it hide",
                 "A free function of time at each element beside the owner's model, its size as the standard deviation "
                 "over time. What is larger than the last column is excluded with 95 %. Small physics is granted.");
    page.table(functions_table(diagnosis));
  }
  page.section("Circumstances");
  page.details("Config with what was found", dump_rig(diagnosis.improved));
  page.details("Config as it was", dump_rig(diagnosis.configured));
  return page;
}

}  // namespace

std::string diagnosis_report_html(const Diagnosis& diagnosis) { return make_page(diagnosis).html(); }

void write_diagnosis_report(const Diagnosis& diagnosis, const std::string& path) { make_page(diagnosis).write(path); }

}  // namespace pneuservo
