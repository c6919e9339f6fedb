// The sizes of stated effects, fitted to recordings together.
#include "diagnosis/refit.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/input_error.hpp"
#include "diagnosis/search/candidates.hpp"
#include "diagnosis/search/fit.hpp"

namespace pneuservo {

namespace {

/// A fit from sizes of zero to those of a worn machine has settled after five steps; the grid's error there moves it
/// on.
constexpr int steps_before = 6, steps_after = 4;

/// Sizes that a derivative finds: of the effect, or of the one that the config has with a tolerance.
std::vector<FreeParameter> sizes_of(const std::string& effect, const std::vector<Candidate>& candidates) {
  std::vector<FreeParameter> out;
  for (const Candidate& candidate : candidates) {
    const bool is_own = candidate.name == effect,
               is_known = candidate.name.starts_with(fmt::format("parameter:effects.{}.", effect));
    if (!is_own && !is_known) continue;
    if (std::ranges::find(candidate.amplitude, 0) != candidate.amplitude.end()) return {};
    out.insert(out.end(), candidate.parameters.begin(), candidate.parameters.end());
  }
  return out;
}

[[noreturn]] void refuse_effect(const Rig& rig, const std::string& effect, const std::vector<Candidate>& candidates) {
  std::vector<std::string> known;
  for (const Candidate& candidate : candidates)
    if (candidate.kind == CandidateKind::effect && !sizes_of(candidate.name, candidates).empty())
      known.push_back(candidate.name);
  throw InputError(
      fmt::format("{}: refit: found the effect {}, expected effects whose sizes these recordings can tell: {}",
                  rig.name, effect, fmt::join(known, ", ")));
}

Fit fit_of(const Rig& rig, FittedRows& rows, const std::vector<std::string>& effects) {
  ResidualModel& model = rows.model();
  const std::vector<Candidate> candidates = all_candidates(rig, model.channels(), motion_range(model.rows()));
  std::vector<FreeParameter> own;
  for (const std::string& effect : effects) {
    const std::vector<FreeParameter> sizes = sizes_of(effect, candidates);
    if (sizes.empty()) refuse_effect(rig, effect, candidates);
    for (const FreeParameter& size : sizes)
      if (std::ranges::none_of(own, [&](const FreeParameter& other) { return other.is_same(size); }))
        own.push_back(size);
  }
  Fit fit =
      fit_at_start(rig, rows, std::move(own), nuisances(rig, model.start_factor_count(), model.start_factor_sigma()));
  for (std::size_t i = 0; i < fit.own_count; ++i) {
    double& z = fit.z(static_cast<Eigen::Index>(i));
    z = std::clamp(z, fit.parameters[i].lower, fit.parameters[i].upper);
  }
  return fit;
}

}  // namespace

Refit refit(const Rig& configured, std::vector<Recording> recordings, const std::vector<std::string>& effects,
            const DiagnoseOptions& options) {
  if (effects.empty())
    throw InputError(
        fmt::format("{}: refit: found no effect, expected names such as coulomb_friction", configured.name));
  PreparedDiagnosis prepared = prepare_diagnosis(configured, std::move(recordings), "refit", options);
  ResidualModel& model = *prepared.model;
  FittedRows rows(model, options.stop);
  require_comparison(prepared.rig, rows);
  Fit fit = fit_of(prepared.rig, rows, effects);
  linearise(rows, {&fit});
  if (fit.failed)
    throw InputError(fmt::format("{}: refit: the rig as configured cannot be simulated on these recordings, expected "
                                 "position, pressures and command in SI units (m, Pa absolute, V)",
                                 configured.name));
  improve(rows, {&fit}, steps_before, Columns::all);
  model.set_working_point(fit.hypothesis());
  fit.known_columns.assign(fit.parameters.size(), 0);
  linearise(rows, {&fit});
  improve(rows, {&fit}, steps_after, Columns::all);
  Refit out;
  out.refitted = fit.hypothesis().rig;
  out.misfit = fit.chi2() / static_cast<double>(std::max<Eigen::Index>(1, rows.count()));
  out.warnings = std::move(prepared.warnings);
  const auto own = static_cast<Eigen::Index>(fit.own_count);
  Eigen::VectorXd slopes(own);
  out.values.resize(own);
  for (Eigen::Index i = 0; i < own; ++i) {
    const FreeParameter& size = fit.parameters[static_cast<std::size_t>(i)];
    out.paths.push_back(size.path);
    out.values(i) = size.value(fit.z(i));
    slopes(i) = size.slope(fit.z(i));
  }
  out.covariance = slopes.asDiagonal() * fit.covariance().topLeftCorner(own, own) * slopes.asDiagonal();
  return out;
}

}  // namespace pneuservo
