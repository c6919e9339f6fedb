// File of a learned move.
#include "pass/learned_move.hpp"

#include <charconv>
#include <sstream>

#include <fmt/format.h>

#include "config/input_error.hpp"
#include "config/input_text.hpp"

namespace pneuservo {
namespace {

constexpr std::string_view column = "u_learned_V";

std::string identity_line(const RepeatedMove& move) { return fmt::format("# move: {:016x}", move.identity()); }

}  // namespace

std::vector<double> read_learned_move(const std::string& path, const RepeatedMove& move) {
  std::istringstream in(read_input_text(path, "a file that --learned of an earlier run wrote"));
  std::string line;
  std::size_t number = 0;
  const auto fail = [&](const std::string& found, const std::string& expected) {
    throw InputError(fmt::format("{}:{}: found '{}', expected {}", path, number, found.substr(0, 60), expected));
  };
  const auto next = [&] { return ++number, static_cast<bool>(std::getline(in, line)); };
  if (!next() || line != learned_move_mark)
    fail(line, fmt::format("'{}', the first line of what --learned writes", learned_move_mark));
  bool is_same = false;
  while (next() && line.starts_with('#')) is_same = is_same || line == identity_line(move);
  if (!is_same)
    throw InputError(
        fmt::format("{}: was learned on another reference or beside another pass than this config's, expected the same "
                    "config; begin anew with another file name",
                    path));
  if (line != column) fail(line, fmt::format("the column '{}'", column));
  std::vector<double> learned_V;
  while (next()) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (error != std::errc() || end != line.data() + line.size() || !(value - value == 0.0)) fail(line, "a number [V]");
    learned_V.push_back(value);
  }
  if (learned_V.size() != move.learned_V().size())
    throw InputError(
        fmt::format("{}: has {} rows, expected {}: it is not whole", path, learned_V.size(), move.learned_V().size()));
  return learned_V;
}

std::string learned_move_text(const std::string& rig_name, const RepeatedMove& move) {
  std::string text = fmt::format("{}\n# rig: {}\n{}\n# error_rms_m:", learned_move_mark, rig_name, identity_line(move));
  for (const double error_m : move.progress().error_rms_m) text += fmt::format(" {:.4g}", error_m);
  text += fmt::format("\n{}\n", column);
  for (const double value : move.learned_V()) text += fmt::format("{}\n", value);
  return text;
}

std::string learning_words(const LearningProgress& progress) {
  const std::vector<double>& errors_m = progress.error_rms_m;
  if (errors_m.empty()) return "";
  const auto of_move = [&](std::size_t move) {
    return fmt::format("{:.3g} mm rms in move {}", 1e3 * errors_m[move], move + 1);
  };
  if (!progress.has_stopped)
    return fmt::format("learning: {}, {} in the best so far\n", of_move(0), of_move(progress.best));
  return fmt::format(
      "learning ended after move {}: {}; the command of the best one stays, {}. What is left is no error of "
      "parameters below {:g} Hz: pneuservo improve says what the model lacks\n",
      errors_m.size(), errors_m.back() > errors_m.front() ? "it was worse than the first" : "it helps no more",
      of_move(progress.best), RepeatedMove::learned_Hz);
}

}  // namespace pneuservo
