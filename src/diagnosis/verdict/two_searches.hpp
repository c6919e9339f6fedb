// The verdict on two searches: without small physics, and with it where the first one's is doubtful.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/search/search.hpp"
#include "diagnosis/verdict/decision.hpp"

namespace pneuservo {

/// The verdict on a search, with the chosen explanation fitted to its end where the model still simulates.
Decision decided(const Rig& rig, ResidualModel& model, Search& search, const DecisionRules& rules);

/// The verdict on the first search; where it is doubtful, on a second one with small physics free, which is then in
/// `beside`, and whose remainder is told in `warnings`. May throw DiagnosisStopped.
Decision decided_twice(const Rig& rig, FittedRows& rows, Search& search, const DecisionRules& rules,
                       const Search::Progress& progress, std::optional<Search>& beside,
                       std::vector<std::string>& warnings);

/// What each name would gain beside the chosen ones where small physics stands beside them all, as it does where a name
/// is asked whether it is needed. May throw DiagnosisStopped.
std::vector<Screened> screened_beside(const Rig& rig, FittedRows& rows, const Search& search, const Decision& decision,
                                      const DecisionRules& rules);

}  // namespace pneuservo
