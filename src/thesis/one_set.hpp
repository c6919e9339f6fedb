// One set of a machine's numbers against everything that a chapter prints of it: what a search found, and the search.
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "thesis/bench.hpp"
#include "thesis/row.hpp"

namespace pneuservo {

/// A number that the print leaves open, with the range that the search covers, and what it found.
struct FreeNumber {
  const char *name, *unit;
  double low, high;
  bool is_logarithmic;  ///< searched by its logarithm
  double found;
};

/// A figure that the set is to meet.
struct PrintedFigure {
  const char *place, *what, *unit, *printed;
  /// Of that member; NaN: it has none.
  std::function<double(ThesisBench&, const std::vector<double>& at)> ours{};
  const char* held = "";  ///< with the set found, where that is not within 10 % of the print
};

/// What "nearest" means: the least sum of |ln(ours/printed)|, or the least of the largest |ours/printed - 1|.
enum class SetMeasure { sum, largest };

/// A family of machines and the member that comes nearest to the print.
struct OneSet {
  const char *name, *title;
  const char* why;  ///< what stands in the way
  std::vector<FreeNumber> numbers;
  std::vector<PrintedFigure> figures;
  const char *met_held, *deviation_held;  ///< of the set found
  const char* searched;                   ///< options of --search that find it
  ThesisPlant plant = ThesisPlant::nonlinear;
  SetMeasure measure = SetMeasure::sum;
  /// What a search counts at most for one figure: a machine without it is as bad as one that is that far off.
  double search_cap = 3.0;
  std::vector<double> begun{};  ///< a member set by hand, from which a search can begin
};

OneSet line_set();               // tables 2.5, 2.6, Fig 2.11
OneSet table_set();              // Figs 2.21 to 2.33
std::vector<OneSet> line_length_sets();  // both bores of one length of tables 2.5, 2.6
OneSet cylinder_set();           // Figs 3.13 to 3.21
std::vector<OneSet> all_one_sets();
/// The axis that was found for chapter 3.
ThesisRig found_cylinder(const char* source, double payload_kg);

/// Within 10 % of the print, the bound of "met".
inline constexpr double one_set_within = 0.1;
/// |ln(ours/printed)|. Infinite: no figure above 0; 0: a limit in the print is kept.
double one_set_deviation(double ours, const PrintedFigure& figure);
/// By the measure of the set, no figure counting more than `cap`.
double total_deviation(const OneSet& set, const std::vector<double>& ours,
                       double cap = std::numeric_limits<double>::infinity());
std::vector<double> figures_of(const OneSet& set, ThesisBench& bench, const std::vector<double>& at);
/// The same family against those figures alone whose place ends with one of these; throws std::invalid_argument where
/// one of them names none.
OneSet with_figures(OneSet set, const std::vector<std::string>& places);
std::vector<double> found_numbers(const OneSet& set);

struct OneSetSearch {
  std::size_t evaluations = 2000;
  std::uint64_t seed = 1;
  bool from_found = false;  ///< begin about the set on the page
  bool from_begun = false;  ///< begin about the member set by hand; throws std::invalid_argument where there is none
};
struct OneSetFound {
  std::vector<double> at, ours;
  double deviation = 0.0;
  std::size_t evaluations = 0;
};
/// Differential evolution on all cores: half of the trials over the whole range of every number, the rest about the
/// best in ever smaller ranges; with `from_found` or `from_begun` all of them about that member. `progress`: once a
/// generation.
OneSetFound search_one_set(const OneSet& set, const std::string& configs, const OneSetSearch& search,
                           const std::function<void(const OneSetFound&)>& progress);

}  // namespace pneuservo
