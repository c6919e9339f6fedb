// The recording that would tell rival explanations apart.
#include "diagnosis/verdict/next_experiment.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "config/input_error.hpp"
#include "diagnosis/recordings/recorded_rigs.hpp"
#include "diagnosis/verdict/safe_references.hpp"

namespace pneuservo {
namespace {

constexpr std::size_t checked_both_ways = 3;  ///< best choices that are tried under the rival's truth too

/// `rig`, the owner's or a supposed one, as it makes this recording.
Rig with_choice(const Rig& rig, const Rig& owner, const ExperimentChoice& choice) {
  Recording planned;
  planned.changed = choice.keys;
  Rig out = changed_rig(rig, machine_changes(owner, planned));
  out.reference = choice.reference;
  out.duration_s = choice.duration_s;
  out.evaluation.reset();
  out.initial.position_m = 0.0;
  out.initial.pressure_2_Pa.reset();
  if (out.axis.supply.pressure_Pa < rig.axis.supply.pressure_Pa)  // the gas at the start has to lie below the supply
    out.initial.pressure_1_Pa *= out.axis.supply.pressure_Pa / rig.axis.supply.pressure_Pa;
  return out;
}

/// The explanation's fit carried over to another recording: its values stand, the gas at the start is free again.
Fit carried_over(const Explanation& explanation, const Rig& owner, const ResidualModel& model) {
  const Fit& old = explanation.fit;
  Fit fit;
  fit.base.rig = old.base.rig;
  fit.base.start_factors.assign(model.start_factor_count(), 0.0);
  fit.own_count = old.own_count;
  fit.parameters.assign(old.parameters.begin(), old.parameters.begin() + static_cast<std::ptrdiff_t>(old.own_count));
  for (const FreeParameter& nuisance : nuisances(owner, model.start_factor_count(), model.start_factor_sigma())) {
    const bool is_own = std::any_of(fit.parameters.begin(), fit.parameters.end(),
                                    [&](const FreeParameter& p) { return !p.path.empty() && p.path == nuisance.path; });
    if (!is_own) fit.parameters.push_back(nuisance);
  }
  fit.z = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit.parameters.size()));
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    for (std::size_t k = 0; k < old.parameters.size(); ++k)
      if (!fit.parameters[i].path.empty() && fit.parameters[i].path == old.parameters[k].path)
        fit.z(static_cast<Eigen::Index>(i)) = old.z(static_cast<Eigen::Index>(k));
  fit.known_columns.assign(fit.parameters.size(), 0);
  return fit;
}

/// What is left of `wrong` on a recording that `truth` would make, in noise floors; nothing where it cannot be made.
std::optional<double> separation(const ExperimentChoice& choice, const Rig& owner, const Explanation& truth,
                                 const Explanation& wrong, const VirtualMachine& machine,
                                 const CompareRecording& compare, const StopQuestion& stop) {
  look_for_stop(stop);
  std::optional<Recording> recording = machine(with_choice(truth.fit.hypothesis().rig, owner, choice));
  if (!recording) return std::nullopt;
  recording->changed = choice.keys;
  look_for_stop(stop);  // a run that a stop has ended early is none
  const std::unique_ptr<ResidualModel> model = compare(*recording);
  model->set_stop(stop);
  FittedRows rows(*model, stop);
  Fit right = carried_over(truth, owner, *model), other = carried_over(wrong, owner, *model);
  linearise(rows, {&right, &other});
  if (right.failed || other.failed) return std::nullopt;
  const double left = refitted_misfit(other, wrong.fit) - refitted_misfit(right, truth.fit);
  return std::isfinite(left) ? std::optional(std::sqrt(std::max(left, 0.0))) : std::nullopt;
}

std::vector<std::string> names(const Explanation& explanation, const Search& search) {
  std::vector<std::string> out;
  out.reserve(explanation.members.size());
  for (const std::size_t member : explanation.members) out.push_back(search.candidates()[member].name);
  return out;
}

/// The names in which two explanations differ.
std::vector<std::string> differing_names(const Explanation& a, const Explanation& b, const Search& search) {
  std::vector<std::string> first = names(a, search), second = names(b, search), out;
  for (const std::string& name : first)
    if (std::find(second.begin(), second.end(), name) == second.end()) out.push_back(name);
  for (const std::string& name : second)
    if (std::find(first.begin(), first.end(), name) == first.end()) out.push_back(name);
  return out;
}

const Explanation* nearest_rival(const Decision& decision, const DecisionRules& rules) {
  for (const Explanation* rival : decision.rivals)
    if (rival != decision.chosen && !rival->fit.failed &&
        rival->log_evidence > decision.chosen->log_evidence - rules.ambiguous_distance())
      return rival;
  return nullptr;
}

/// What a fit at its minimum has against moving the parameters `kept`, all others following them.
Eigen::MatrixXd reduced_curvature(const Fit& fit, const std::vector<int>& kept) {
  std::vector<int> others;
  for (int i = 0; i < static_cast<int>(fit.parameters.size()); ++i)
    if (std::find(kept.begin(), kept.end(), i) == kept.end()) others.push_back(i);
  const Eigen::MatrixXd h = fit.curvature(), across = h(kept, others);
  if (others.empty()) return h(kept, kept);
  return h(kept, kept) - across * h(others, others).ldlt().solve(across.transpose());
}

}  // namespace

double refitted_misfit(const Fit& added, const Fit& before) {
  Eigen::VectorXd gradient = added.gradient();
  Eigen::MatrixXd h = added.curvature();
  double misfit = added.residual.squaredNorm() + added.z.squaredNorm();
  std::vector<int> here, there;  // the same parameters' places in both fits; the gas at the start has no path
  for (std::size_t i = 0; i < added.parameters.size(); ++i)
    for (std::size_t k = 0; !added.parameters[i].path.empty() && k < before.parameters.size(); ++k)
      if (before.parameters[k].path == added.parameters[i].path) {
        here.push_back(static_cast<int>(i));
        there.push_back(static_cast<int>(k));
      }
  if (!here.empty()) {
    // Where the earlier fit stands its gradient is zero; its curvature has the priors, which must not count twice.
    h(here, here) +=
        reduced_curvature(before, there) - Eigen::MatrixXd::Identity(h(here, here).rows(), h(here, here).cols());
    gradient(here) -= added.z(here);
    misfit -= added.z(here).squaredNorm();
  }
  return misfit - gradient.dot(h.ldlt().solve(gradient));
}

std::optional<ProposedExperiment> propose_experiment(const Rig& owner, const Decision& decision, const Search& search,
                                                     const DecisionRules& rules, double shown_speed_mps,
                                                     const VirtualMachine& machine, const CompareRecording& compare,
                                                     const StopQuestion& stop) {
  if (decision.chosen == nullptr || decision.chosen->members.empty() || !machine) return std::nullopt;
  const Explanation* rival = nearest_rival(decision, rules);
  if (rival == nullptr) return std::nullopt;
  const auto separated = [&](const ExperimentChoice& choice, const Explanation& truth,
                             const Explanation& other) -> std::optional<double> {
    try {
      return separation(choice, owner, truth, other, machine, compare, stop);
    } catch (const InputError&) {  // a value out of its range, a recording too short: this choice cannot be made
      return std::nullopt;
    }
  };
  std::vector<std::pair<double, ExperimentChoice>> ranked;
  for (const ExperimentChoice& choice : safe_references(owner, shown_speed_mps))
    if (const auto floors = separated(choice, *decision.chosen, *rival)) ranked.emplace_back(*floors, choice);
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::optional<ProposedExperiment> best;
  for (std::size_t i = 0; i < std::min(ranked.size(), checked_both_ways); ++i) {
    const auto& [floors, choice] = ranked[i];
    const auto back = separated(choice, *rival, *decision.chosen);
    if (!back) continue;
    const double sure = std::min(floors, *back);
    if (sure < least_separation || (best && sure <= best->separation)) continue;
    best = ProposedExperiment{choice.reference,  choice.setup, differing_names(*decision.chosen, *rival, search), sure,
                              choice.duration_s, choice.keys};
  }
  return best;
}

Rig experiment_rig(const Rig& owner, const ProposedExperiment& experiment) {
  return with_choice(owner, owner, {experiment.reference, experiment.duration_s, experiment.setup, experiment.keys});
}

}  // namespace pneuservo
