// One set of a machine's numbers against everything that a chapter prints of it: what a search found, and the search.
#pragma once
#include <cstdint>
#include <functional>
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

/// A family of machines and the member that comes nearest to the print.
struct OneSet {
  const char *name, *title;
  const char* why;  ///< what stands in the way
  std::vector<FreeNumber> numbers;
  std::vector<PrintedFigure> figures;
  const char *met_held, *deviation_held;  ///< of the set found
  const char* searched;                   ///< options of --search that find it
  ThesisPlant plant = ThesisPlant::nonlinear;
};

OneSet line_set();               // tables 2.5, 2.6, Fig 2.11
OneSet table_set();              // Figs 2.21 to 2.33
OneSet cylinder_set();           // Figs 3.13 to 3.21
std::vector<OneSet> all_one_sets();
/// The axis that was found for chapter 3.
ThesisRig found_cylinder(const char* source, double payload_kg);

/// Within 10 % of the print, the bound of "met".
inline constexpr double one_set_within = 0.1;
/// |ln(ours/printed)|, at most 3: a figure that is twenty times off is as bad as one that is not there. 0 where a limit
/// in the print is kept.
double one_set_deviation(double ours, const PrintedFigure& figure);
double total_deviation(const std::vector<double>& ours, const std::vector<PrintedFigure>& figures);
std::vector<double> figures_of(const OneSet& set, ThesisBench& bench, const std::vector<double>& at);
/// The same family against those figures alone whose place ends with one of these; throws std::invalid_argument where
/// one of them names none.
OneSet with_figures(OneSet set, const std::vector<std::string>& places);
std::vector<double> found_numbers(const OneSet& set);

struct OneSetSearch {
  std::size_t evaluations = 2000;
  std::uint64_t seed = 1;
  bool from_found = false;  ///< begin about the set on the page
};
struct OneSetFound {
  std::vector<double> at, ours;
  double deviation = 0.0;
  std::size_t evaluations = 0;
};
/// Differential evolution on all cores: half of the trials over the whole range of every number, the rest about the
/// best in ever smaller ranges; with `from_found` all of them about the set on the page. `progress`: once a generation.
OneSetFound search_one_set(const OneSet& set, const std::string& configs, const OneSetSearch& search,
                           const std::function<void(const OneSetFound&)>& progress);

}  // namespace pneuservo
