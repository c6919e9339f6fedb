// What free functions of time say of a verdict.
#include "diagnosis/latent/latent_judgement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pneuservo {

namespace {

double with_best(const LatentRanking& ranking) {
  return ranking.log_evidence + (ranking.inputs.empty() ? 0.0 : std::max(ranking.inputs.front().gain, 0.0));
}

}  // namespace

bool LatentJudgement::refutes_names(std::size_t names, const DecisionRules& rules) const {
  if (!named.has_value()) return false;
  if (names > 1) return std::max(names_ahead, names_bring) < rules.next_gain;
  return names_ahead < -rules.alarm_gain && names_bring < rules.alarm_gain;
}

LatentJudgement judge_by_latents(FittedRows& rows, const Decision& decision, const Search& search,
                                 const DecisionRules& rules) {
  LatentJudgement out;
  constexpr double never = std::numeric_limits<double>::infinity();
  out.owner = rank_latents(rows, search.owner(), never, search.left_out());
  if (!out.is_there()) return out;
  if (decision.verdict != Verdict::consistent && out.owner.inputs.front().gain > 0)
    out.owner = ranked_again(rows, std::move(out.owner));
  if (decision.chosen->members.empty()) return out;
  // What stands by its evidence alone is asked no more.
  const double stands = decision.chosen->members.size() > 1 ? rules.next_gain : 0.0;
  out.named = rank_latents(rows, *decision.chosen, with_best(out.owner) + stands, search.left_out());
  if (out.named->fit.failed) {
    out.named.reset();
    return out;
  }
  out.names_ahead = out.named->log_evidence - with_best(out.owner);
  out.names_bring = with_best(*out.named) - with_best(out.owner);
  return out;
}

std::vector<ElementShare> element_probabilities(const LatentRanking& ranking, double temperature) {
  std::vector<ElementShare> out;
  double sum = 0;
  for (const RankedLatent& latent : ranking.inputs) {  // best first
    if (std::any_of(out.begin(), out.end(), [&](const ElementShare& e) { return e.element == latent.input.element; }))
      continue;
    out.push_back({latent.input.element, std::exp((latent.gain - ranking.inputs.front().gain) / temperature)});
    sum += out.back().share;
  }
  for (ElementShare& e : out) e.share /= sum;
  return out;
}

std::vector<FreeFunction> functions_of(const LatentRanking& ranking) {
  std::vector<FreeFunction> out;
  for (const RankedLatent& latent : ranking.inputs)
    out.push_back({latent.input.element, latent.input.what, latent.input.unit, latent.gain, latent.fit.level,
                   latent.fit.memory_s, latent.fit.upper_level});
  return out;
}

}  // namespace pneuservo
