// Answers to new-rig as lines of a config.
#include "program/sheet_answers.hpp"

#include <fmt/format.h>

#include "config/field_text.hpp"
#include "config/units.hpp"

namespace pneuservo {
namespace {

std::size_t place_of(std::string_view option) {
  return static_cast<std::size_t>(std::ranges::find(sheet_questions, option, &SheetQuestion::option) -
                                  sheet_questions.begin());
}

}  // namespace

const std::string& SheetAnswers::of(std::string_view option) const { return answers.at(place_of(option)); }
std::string& SheetAnswers::of(std::string_view option) { return answers.at(place_of(option)); }

std::string answer_of(const SheetAnswers& answers, std::string_view option) {
  const std::string& answer = answers.of(option);
  return answer.empty() ? std::string(sheet_questions[place_of(option)].typical) : answer;
}

double quantity_of(const SheetAnswers& answers, std::string_view option, std::string_view unit) {
  return read_quantity({option, unit, 0.0, infinite, ""}, answer_of(answers, option), {}).value.value_or(0.0);
}

std::string sheet_line(const SheetAnswers& answers, std::string_view key, std::string_view option) {
  const SheetQuestion& question = sheet_questions[place_of(option)];
  const std::string& answer = answers.of(option);
  const std::string text = fmt::format("{}: {}", key, answer.empty() ? std::string(question.typical) : answer);
  return answer.empty() ? fmt::format("{:<34}# typical: {}", text, question.why) : text;
}

std::string_view flow_key(const SheetAnswers& answers) {
  const Field conductance{"", "m3/(s Pa)", 0, infinite, ""};
  const bool is_one = read_quantity(conductance, answer_of(answers, "flow"), {}).value.has_value();
  return is_one ? "sonic_conductance" : "nominal_flow";
}

std::string draft_head(const SheetAnswers& answers) {
  std::string out =
      "# Written by pneuservo new-rig from data sheets. What is marked typical nobody measured: replace it by\n"
      "# what you know, and narrow its tolerance. Keys: pneuservo keys; judged by: pneuservo check.\n";
  return out + fmt::format("format: pneuservo-rig/1\nname: {}\nrig: {}\nperiod: 1 ms\n\n", yaml_text(answers.name),
                           info(answers.kind).name);
}

}  // namespace pneuservo
