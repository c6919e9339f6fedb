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
  /// Log evidence by which the names with the best function beside them are ahead of the best function alone.
  double ahead = 0;

  bool is_there() const { return !owner.inputs.empty(); }
  /// The names are clearly behind a function that anything may have.
  bool refutes_names() const;
};

LatentJudgement judge_by_latents(FittedRows& rows, const Decision& decision, const Search& search);

/// Probabilities of the elements by the best function at each, best first; of functions alone.
std::vector<ElementShare> element_probabilities(const LatentRanking& ranking, double temperature);
std::vector<FreeFunction> functions_of(const LatentRanking& ranking);

}  // namespace pneuservo
