// What free functions of time say of a verdict: where an unknown sits, whether its names may stand, what may hide.
#pragma once
#include <optional>
#include <vector>

#include "diagnosis/latent/latent_ranking.hpp"
#include "diagnosis/verdict/decision.hpp"

namespace pneuservo {

struct LatentJudgement {
  LatentRanking owner;                 ///< functions beside the owner's model
  std::optional<LatentRanking> named;  ///< and beside the verdict's names
  double names_ahead = 0;  ///< log evidence of the names alone over that of the best function beside the owner's model
  double names_bring = 0;  ///< of names and a function over that of the best function: what the names add to it

  bool is_there() const { return !owner.inputs.empty(); }
  /// A name alone is behind a function that anything may have by what a first name needs, and adds less to one. A right
  /// name beside a background may be behind, but adds much; one that only bends what is missing adds nothing. Several
  /// names are more causes than the one that a function stands for: they have to be ahead of it, or add, what one more
  /// name has to.
  bool refutes_names(std::size_t names, const DecisionRules& rules) const;
};

LatentJudgement judge_by_latents(FittedRows& rows, const Decision& decision, const Search& search,
                                 const DecisionRules& rules);

/// Probabilities of the elements by the best function at each, best first; of functions alone.
std::vector<ElementShare> element_probabilities(const LatentRanking& ranking, double temperature);
std::vector<FreeFunction> functions_of(const LatentRanking& ranking);

}  // namespace pneuservo
