// Judges rows of the thesis, and computes them on all cores.
#include "thesis/row.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "config/input_error.hpp"

namespace pneuservo {
namespace {

/// Place of the last digit: "1.60" 0.01, "45" 1, "1.8e5" 1e4.
double last_digit(const std::string& text) {
  const std::size_t power_at = text.find_first_of("eE");
  const std::string digits = text.substr(0, power_at);
  const std::size_t point = digits.find('.');
  const double decimals = point == std::string::npos ? 0.0 : static_cast<double>(digits.size() - point - 1);
  const double power = power_at == std::string::npos ? 0.0 : std::strtod(text.c_str() + power_at + 1, nullptr);
  return std::pow(10.0, power - decimals);
}

/// "below 10", "above 7.5": whether a figure keeps the limit; nothing where the text states none.
std::optional<bool> keeps_limit(double value, const std::string& text) {
  const bool below = text.starts_with("below "), above = text.starts_with("above ");
  if (!below && !above) return std::nullopt;
  const double limit = thesis_number(text.substr(6));
  return below ? value < limit : value > limit;
}

bool is_near(const ThesisValue& ours, const std::string& text, double share) {
  const double wanted = thesis_number(text);
  if (std::isnan(wanted)) return ours.words == text || ours.words == thesis_holds;
  // Rounding must not decide on a value at the edge of half a digit.
  return std::fabs(ours.value - wanted) <= thesis_tolerance(text, share) * (1.0 + 1e-9);
}

ThesisFinding without_value(const ThesisRow& row) {
  return {&row, {}, row.plant == ThesisPlant::none ? ThesisVerdict::not_there : ThesisVerdict::corrected};
}

}  // namespace

double thesis_number(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return text.empty() || *end != '\0' ? std::nan("") : value;
}

double thesis_tolerance(const std::string& text, double share) {
  return share > 0.0 ? share * std::fabs(thesis_number(text)) : 0.5 * last_digit(text);
}

ThesisFinding judge_thesis_row(const ThesisRow& row, const ThesisValue& ours) {
  ThesisFinding out{&row, ours, ThesisVerdict::moved};
  const std::string& target = row.meant.empty() ? row.printed : row.meant;
  const std::optional<bool> limit = keeps_limit(ours.value, target);
  const bool meets_print = limit.value_or(false) || is_near(ours, target, row.within);
  if (row.held.empty() ? !meets_print : !is_near(ours, row.held, row.held_within)) return out;
  // Words in the print beside a figure of ours say nothing that could agree.
  const bool no_figure = !limit && std::isnan(thesis_number(target)) && ours.words.empty();
  if (no_figure) out.verdict = row.meant.empty() ? ThesisVerdict::no_figure : ThesisVerdict::corrected;
  else if (!meets_print) out.verdict = ThesisVerdict::differs;
  else out.verdict = row.meant.empty() ? ThesisVerdict::agrees : ThesisVerdict::corrected;
  return out;
}

std::string thesis_command(const ThesisRow& row) {
  return row.command.empty() ? fmt::format("pneuservo thesis --only '{}'", row.place) : row.command;
}

std::string thesis_value_text(const ThesisFinding& finding) {
  if (!finding.ours.words.empty()) return finding.ours.words;
  if (!std::isfinite(finding.ours.value)) return "-";
  return fmt::format("{:.4g}", finding.ours.value);
}

std::vector<ThesisResult> compute_thesis(const std::vector<ThesisGroup>& groups, ThesisBench& bench,
                                         const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<ThesisResult> out;
  std::vector<ThesisFinding*> open;
  for (const ThesisGroup& group : groups) {
    out.push_back({group.title, {}});
    for (const ThesisRow& row : group.rows) out.back().findings.push_back({&row, {}, ThesisVerdict::moved});
  }
  for (ThesisResult& group : out)
    for (ThesisFinding& finding : group.findings) open.push_back(&finding);
  std::atomic<std::size_t> next{0};
  std::size_t done = 0;
  std::mutex told;
  std::exception_ptr refused;
  const auto work = [&] {
    for (std::size_t i = next++; i < open.size(); i = next++) {
      ThesisFinding& finding = *open[i];
      try {
        finding =
            finding.row->ours ? judge_thesis_row(*finding.row, finding.row->ours(bench)) : without_value(*finding.row);
      } catch (const InputError&) {  // no row has moved where a config is not there
        const std::lock_guard lock(told);
        refused = std::current_exception();
      } catch (const std::exception& error) { finding.ours = ThesisValue(std::string(error.what())); }
      const std::lock_guard lock(told);
      progress(++done, open.size());
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < std::max(1U, std::thread::hardware_concurrency()); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (refused) std::rethrow_exception(refused);
  return out;
}

}  // namespace pneuservo
