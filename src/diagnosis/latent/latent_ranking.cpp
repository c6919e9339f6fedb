// Free functions at all elements, ranked by evidence.
#include "diagnosis/latent/latent_ranking.hpp"

#include <algorithm>

#include "diagnosis/search/candidates.hpp"

namespace pneuservo {

namespace {

/// The explanation where it stands, with small physics free beside its parameters, linear there.
Fit with_small_physics(FittedRows& rows, const Fit& fit, const std::vector<std::string>& left_out) {
  Fit out;
  out.base = fit.base;
  out.parameters = fit.parameters;
  out.own_count = fit.own_count;
  std::vector<double> z(fit.z.data(), fit.z.data() + fit.z.size());
  out.base.rig = fit.hypothesis().rig;
  for (FreeParameter& parameter : small_physics(out.base.rig, rows.model().channels(), left_out)) {
    if (std::any_of(fit.parameters.begin(), fit.parameters.end(),
                    [&](const FreeParameter& known) { return known.is_same(parameter); }))
      continue;
    out.parameters.push_back(std::move(parameter));
    z.push_back(0.0);
  }
  out.z = Eigen::Map<const Eigen::VectorXd>(z.data(), static_cast<Eigen::Index>(z.size()));
  linearise(rows, {&out});
  return out;
}

void judge_inputs(FittedRows& rows, std::vector<LatentInput> inputs, LatentRanking& ranking) {
  const LatentEvidence evidence(rows.model().rows(), ranking.fit);
  for (LatentInput& input : inputs) {
    const LatentFit found = evidence.of(input);
    ranking.inputs.push_back({std::move(input), found, found.log_evidence - ranking.log_evidence});
  }
  std::stable_sort(ranking.inputs.begin(), ranking.inputs.end(),
                   [](const RankedLatent& a, const RankedLatent& b) { return a.gain > b.gain; });
}

}  // namespace

LatentRanking rank_latents(FittedRows& rows, const Explanation& explanation, double enough,
                           const std::vector<std::string>& left_out) {
  LatentRanking out;
  out.fit = with_small_physics(rows, explanation.fit, left_out);
  if (out.fit.failed) return out;
  out.log_evidence = LatentEvidence(rows.model().rows(), out.fit).without();
  if (out.log_evidence < enough) judge_inputs(rows, rows.model().latent_inputs(out.fit.hypothesis()), out);
  return out;
}

LatentRanking ranked_again(FittedRows& rows, LatentRanking ranking) {
  const RankedLatent& best = ranking.inputs.front();
  LatentRanking out;
  out.fit = ranking.fit;
  out.fit.z = LatentEvidence(rows.model().rows(), ranking.fit).parameters_beside(best.input, best.fit);
  for (std::size_t i = 0; i < out.fit.parameters.size(); ++i) {
    double& z = out.fit.z(static_cast<Eigen::Index>(i));
    z = std::clamp(z, out.fit.parameters[i].lower, out.fit.parameters[i].upper);
  }
  out.fit.known_columns.clear();
  linearise(rows, {&out.fit});
  if (out.fit.failed) return ranking;
  // Alone the fit stands best where it was, or here where small physics has moved too.
  out.log_evidence = std::max(ranking.log_evidence, LatentEvidence(rows.model().rows(), out.fit).without());
  std::vector<LatentInput> inputs;
  for (RankedLatent& latent : ranking.inputs) inputs.push_back(std::move(latent.input));
  judge_inputs(rows, std::move(inputs), out);
  return out;
}

}  // namespace pneuservo
