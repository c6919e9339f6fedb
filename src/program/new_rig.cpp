// Verb new-rig: writes the config of a new axis from the numbers of its data sheets, with gains and a motion it can do.
#include <iostream>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "config/input_error.hpp"
#include "program/output_files.hpp"
#include "program/rig_draft.hpp"
#include "program/verbs.hpp"
#include "record/result_file.hpp"

namespace pneuservo {

namespace {

struct NewRigOptions {
  std::string file;
  SheetAnswers answers;
  std::string kind = "cylinder";
};

/// Numbers of another kind of rig, or half of those of two on/off valves, are a mistake.
void require_fitting(const SheetAnswers& answers) {
  const bool is_pressure = answers.kind == RigKind::pressure;
  for (const SheetQuestion& question : sheet_questions)
    if (!answers.are_asked(question) && !answers.of(question.option).empty())
      throw InputError(
          fmt::format("--{}: found with --rig {}, expected no such number", question.option, info(answers.kind).name));
  if (is_pressure ? !(answers.speed + answers.acceleration).empty()
                  : !(answers.rate + answers.switching_on + answers.switching_off).empty())
    throw InputError(
        fmt::format("new-rig: found {} with --rig {}, expected {}",
                    is_pressure ? "--speed or --acceleration" : "--rate, --switching-on or --switching-off",
                    info(answers.kind).name, is_pressure ? "--rate" : "--speed and --acceleration"));
  if (answers.switching_on.empty() != answers.switching_off.empty())
    throw InputError("new-rig: found one time of on/off valves, expected both --switching-on and --switching-off");
}

bool is_known(const SheetAnswers& answers, const SheetQuestion& question) {
  return !answers.are_asked(question) || !answers.of(question.option).empty() || !question.typical.empty();
}

/// Asks for what no option says; an empty line takes the typical value.
void ask(SheetAnswers& answers) {
  std::cout << "Numbers with their units, as the data sheets have them. Enter alone takes what stands in brackets.\n";
  for (const SheetQuestion& question : sheet_questions) {
    if (!answers.are_asked(question)) continue;
    std::string& answer = answers.of(question.option);
    while (answer.empty()) {
      std::cout << question.question
                << (question.typical.empty() ? fmt::format(" (such as {})", question.example)
                                             : fmt::format(" [{}]", question.typical))
                << ": " << std::flush;
      if (!std::getline(std::cin, answer)) throw InputError("new-rig: found the end of the answers, expected more");
      if (answer.empty() && !question.typical.empty()) break;
    }
  }
}

void require_answers(const SheetAnswers& answers) {
  std::string missing;
  for (const SheetQuestion& question : sheet_questions)
    if (!is_known(answers, question)) missing += fmt::format(" --{} '{}'", question.option, question.example);
  if (!missing.empty())
    throw InputError(fmt::format("new-rig: found no value for some numbers, expected options such as{}", missing));
}

int run_new_rig(NewRigOptions& options) {
  options.answers.kind = options.kind == "pressure" ? RigKind::pressure : RigKind::cylinder;
  OutputFiles().writes("FILE", options.file, ResultKind::config);
  require_fitting(options.answers);
  bool asks = false;
  for (const SheetQuestion& question : sheet_questions) asks = asks || !is_known(options.answers, question);
  if (asks && isatty(STDIN_FILENO) != 0) ask(options.answers);
  require_answers(options.answers);
  const FinishedDraft draft = options.answers.kind == RigKind::pressure ? finish_pressure_draft(options.answers)
                                                                        : finish_draft(options.answers);
  write_result(options.file, draft.text);
  for (const std::string& sentence : draft.told) std::cout << sentence << "\n";
  std::cout << fmt::format("written to {}; next:\n  pneuservo check {}\n  pneuservo serve {} --socket {}.sock\n",
                           options.file, options.file, options.file, options.kind == "pressure" ? "rig" : "axis");
  return draft.is_fed ? 0 : 1;
}

}  // namespace

void add_new_rig(CommandLine& app, int& status) {
  auto options = std::make_shared<NewRigOptions>();
  Verb verb = app.add_verb("new-rig",
                           "config of a new axis or pressure rig from data sheets, with gains and a motion it can do");
  verb.add_option("FILE", options->file, "config to write").required();
  verb.add_option("--rig", options->kind, "kind of rig: an axis, or a pressure behind a hose")
      .among({"cylinder", "pressure"})
      .shows_default();
  verb.add_option("--name", options->answers.name, "of the rig, in recordings and reports").shows_default();
  for (const SheetQuestion& question : sheet_questions)
    verb.add_option(fmt::format("--{}", question.option), options->answers.of(question.option),
                    fmt::format("{} ({}{})", question.question, question.typical.empty() ? "such as " : "typical: ",
                                question.typical.empty() ? question.example : question.typical));
  verb.add_option("--speed", options->answers.speed, "of moves (0.2 m/s); default: what the valve can feed");
  verb.add_option("--acceleration", options->answers.acceleration, "of moves (2 m/s2); default: the same");
  verb.add_option("--rate", options->answers.rate, "of a pressure (0.5 bar/s); default: the same");
  verb.add_option("--switching-on", options->answers.switching_on,
                  "of two on/off valves in place of a proportional one: from coil on to open (3 ms)");
  verb.add_option("--switching-off", options->answers.switching_off, "the same: from coil off to closed (2 ms)");
  verb.footer(
      "On a terminal it asks for what the options do not say. Status 1: the rig does not follow its moves within\n"
      "2 % of their way, and a sentence says what stands in the way.");
  verb.callback([options, &status] { status = run_new_rig(*options); });
}

}  // namespace pneuservo
