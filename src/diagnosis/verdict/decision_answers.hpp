// What a decision says of elements and names: answers, shares, rivals, and where an unknown sits.
#pragma once
#include "diagnosis/diagnosis.hpp"
#include "diagnosis/verdict/decision.hpp"

namespace pneuservo {

/// The chosen names with sizes, probabilities and what looks the same, the one that takes most first. Standard errors
/// hold what commands may do that no row holds.
void add_answers(ResidualModel& model, const Decision& decision, const Search& search, const DecisionRules& rules,
                 Diagnosis& out);
/// Shares of the elements by all rivals' probabilities.
void add_element_shares(const Decision& decision, const Search& search, Diagnosis& out);
/// Where something sits that has no name: the first element of `located`; where that is empty, the one whose patterns
/// over all channels take most of what is left on the owner's model.
void add_unknown(ResidualModel& model, const Decision& decision, const Search& search, const DecisionRules& rules,
                 const std::vector<ElementShare>& located, Diagnosis& out);
/// The explanations that were tried, the chosen one first.
void add_candidates(const Decision& decision, const Search& search, Diagnosis& out);

}  // namespace pneuservo
