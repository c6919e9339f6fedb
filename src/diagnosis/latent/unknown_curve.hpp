// The function of one quantity that stands best for what no name explains: a table of the config, fitted beside the
// owner's model.
#pragma once
#include <optional>
#include <string>

#include "diagnosis/diagnosis.hpp"
#include "diagnosis/search/search.hpp"

namespace pneuservo {

/// Where a table is looked for, and beside what.
struct CurvePlace {
  std::string element;
  const Explanation* beside = nullptr;  ///< the owner's model, or names that leave something
  bool is_whole = true;  ///< recordings begin with the machine's run, so that a table over time may stand
};

/// Of the tables that sit at the element (of a line: those of its chamber) the likeliest that leaves less of what is
/// held out, ahead of what it stands beside by what a first name needs. May throw DiagnosisStopped.
std::optional<UnknownCurve> curve_of_unknown(const Rig& rig, ResidualModel& model, const Search& search,
                                             const CurvePlace& where, const DecisionRules& rules,
                                             const StopQuestion& stop);

}  // namespace pneuservo
