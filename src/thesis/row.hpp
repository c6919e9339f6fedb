// A row of the thesis beside ours: where it stands, what is printed, what ours gives, and the verdict on both.
#pragma once
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace pneuservo {

class ThesisBench;

/// What ours is computed on. `config`: a key of a shipped config; `none`: this program has no such thing.
enum class ThesisPlant { formula, config, linear, nonlinear, none };
inline constexpr std::string_view thesis_plant_names[]{"formula", "config", "linear", "nonlinear", "none"};

/// What ours gives: a figure, or words.
struct ThesisValue {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string words{};
  ThesisValue() = default;
  ThesisValue(double found) : value(found) {}
  ThesisValue(std::string found) : words(std::move(found)) {}
  ThesisValue(const char* found) : words(found) {}
};

/// Relative distance of a simulated figure from what is held: the largest error of a loop that swings in a limit cycle
/// differs by 1.5 % between the plant's grids of 4 and 10 cells a metre (docs/figures.md, set P).
inline constexpr double simulated_within = 0.02;
/// Of a search for a flat minimum or a fit: its end is known to some tenths of a percent.
inline constexpr double searched_within = 5e-3;

/// What an equation's row says where both sides agree to rounding.
inline constexpr std::string_view thesis_holds = "holds";

/// One row. Figures stand as text, for their last digit says how exact they are.
struct ThesisRow {
  std::string place{};              ///< in the thesis: "Table 2.5"
  std::string what{}, unit{};
  std::string printed{};            ///< as it stands there; "below 10", "above 7.5" are limits
  std::string meant{};              ///< what it should print; empty: the print stands
  ThesisPlant plant = ThesisPlant::formula;
  std::function<ThesisValue(ThesisBench&)> ours{};  ///< in `unit`; none: a misprint in words, or nothing is there
  double within = 0.0;  ///< ours agrees with the print this near, relative; 0: half a unit of its last digit
  std::string held{};  ///< what ours gives where that is not the print; a change of it is a moved row
  double held_within = 0.0;  ///< relative; 0: half a unit of its last digit
  std::string why{};  ///< reason of the corrected print or of the difference
  std::string command{};  ///< to repeat it; empty: this verb with --only
};

struct ThesisGroup {
  std::string title;
  std::vector<ThesisRow> rows;
};

/// agrees: with the print; corrected: with the corrected print; differs: as it is known to, with a reason; no_figure:
/// the thesis says it in words or as a picture; not_there: this program lacks it; moved: ours is not what it was.
enum class ThesisVerdict { agrees, corrected, differs, no_figure, not_there, moved };
inline constexpr std::string_view thesis_verdict_names[]{"agrees",    "corrected", "differs",
                                                         "no figure", "not there", "MOVED"};

/// A row with what ours gave now.
struct ThesisFinding {
  const ThesisRow* row = nullptr;
  ThesisValue ours{};
  ThesisVerdict verdict = ThesisVerdict::not_there;
};

/// A figure that stands as text; NaN: words.
double thesis_number(const std::string& text);
/// How far a value may lie from the figure `text`: that share of it, or half a unit of its last digit.
double thesis_tolerance(const std::string& text, double share);
ThesisFinding judge_thesis_row(const ThesisRow& row, const ThesisValue& ours);
/// The command that repeats the row.
std::string thesis_command(const ThesisRow& row);
/// Ours in as many digits as the print or what is held has, and one more.
std::string thesis_value_text(const ThesisFinding& finding);

/// What became of a group; its rows must outlive it.
struct ThesisResult {
  std::string title;
  std::vector<ThesisFinding> findings;
};
/// Computes every row on all cores; `progress(done, all)` is called by one thread at a time. A row that throws has
/// moved, with the sentence as its words.
std::vector<ThesisResult> compute_thesis(const std::vector<ThesisGroup>& groups, ThesisBench& bench,
                                         const std::function<void(std::size_t, std::size_t)>& progress);
std::vector<ThesisResult> compute_thesis(std::vector<ThesisGroup>&& groups, ThesisBench& bench,
                                         const std::function<void(std::size_t, std::size_t)>& progress) = delete;

}  // namespace pneuservo
