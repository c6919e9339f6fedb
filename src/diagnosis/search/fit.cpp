// Fits of hypotheses by Levenberg steps in lanes: several fits go on side by side, each step tries several dampings.
#include "diagnosis/search/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace pneuservo {

namespace {

/// An undamped step is tried alone where it promises less than this, and is enough where it keeps that share of it;
/// else damped ones are tried too and the best is taken: far from its minimum a fit that takes the first step that
/// does well ends in another one.
constexpr double near_promise = 50, kept_promise = 0.7;
/// Small ones are for narrow valleys: the damping has to lie below the valley's curvature over that across it, or the
/// fit creeps. The last one is a short step along the first.
constexpr std::array<double, 8> dampings{0, 3e-5, 3e-4, 3e-3, 0.03, 0.3, 3.0, 30.0};
/// The step is bent too where it promises no more than this share of the objective: a fit that has far to go would be
/// bent into the valley of another minimum.
constexpr double bent_share = 0.4;
/// A step that would gain less than this share of the objective matters to no comparison.
constexpr double settled_share = 2e-5;

/// Minimum of the quadratic model within the bounds: what leaves them is held there and the rest solved again.
Eigen::VectorXd bounded_step(const Fit& fit, const Eigen::VectorXd& start, const Eigen::MatrixXd& h,
                             const Eigen::VectorXd& gradient, double damping) {
  const Eigen::Index n = start.size();
  Eigen::MatrixXd damped = h;
  damped.diagonal() *= 1 + damping;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
  std::vector<char> held(static_cast<std::size_t>(n), 0);
  for (Eigen::Index pass = 0; pass <= n; ++pass) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < n; ++i)
      if (!held[static_cast<std::size_t>(i)]) free.push_back(i);
    const Eigen::VectorXd right = -(gradient + damped * step)(free);
    const Eigen::VectorXd solved = damped(free, free).ldlt().solve(right);
    bool left = false;
    for (std::size_t k = 0; k < free.size(); ++k) {
      const Eigen::Index i = free[k];
      const FreeParameter& p = fit.parameters[static_cast<std::size_t>(i)];
      const double z = start(i) + step(i) + solved(static_cast<Eigen::Index>(k));
      if (z < p.lower || z > p.upper) {
        step(i) = std::clamp(z, p.lower, p.upper) - start(i);
        held[static_cast<std::size_t>(i)] = 1;
        left = true;
      }
    }
    if (!left) {
      for (std::size_t k = 0; k < free.size(); ++k) step(free[k]) += solved(static_cast<Eigen::Index>(k));
      break;
    }
  }
  return step;
}

double promised_gain(const Fit& fit, const Eigen::MatrixXd& h, const Eigen::VectorXd& gradient) {
  const Eigen::VectorXd step = bounded_step(fit, fit.z, h, gradient, 0.0);
  return -2 * gradient.dot(step) - step.dot(h * step);
}

std::vector<double> plain(const Eigen::VectorXd& z) { return {z.data(), z.data() + z.size()}; }

/// Where a difference is taken: away from the nearer bound.
double step_inside(const FreeParameter& parameter, double z) {
  return z + parameter.step > parameter.upper ? -parameter.step : parameter.step;
}

/// A hypothesis and the columns that its residual gives: one parameter, or a number that each recording has of its own,
/// of all at once (recordings do not see each other's).
struct Probe {
  Fit* fit;
  std::vector<Eigen::Index> columns;
  double step;
};

void collect_probes(Fit& fit, std::vector<Probe>& probes, std::vector<Hypothesis>& hypotheses) {
  std::array<int, 4> recordings_probe{-1, -1, -1, -1};
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    if (fit.known_columns[i]) continue;
    const FreeParameter& parameter = fit.parameters[i];
    const auto column = static_cast<Eigen::Index>(i);
    if (parameter.is_of_recording()) {
      int& known = recordings_probe.at(parameter.place_in_recording());
      if (known >= 0) {
        probes[static_cast<std::size_t>(known)].columns.push_back(column);
        parameter.of_recording(hypotheses[static_cast<std::size_t>(known)]) += parameter.spread * parameter.step;
        continue;
      }
      known = static_cast<int>(probes.size());
    }
    const double step = parameter.is_of_recording() ? parameter.step : step_inside(parameter, fit.z(column));
    std::vector<double> z = plain(fit.z);
    z[i] += step;
    hypotheses.push_back(with_parameters(fit.base, fit.parameters, z));
    probes.push_back({&fit, {column}, step});
  }
}

bool store_residual(Fit& fit, const Eigen::VectorXd& residual) {
  if (!residual.allFinite()) return false;
  fit.residual = residual;
  fit.objective = residual.squaredNorm() + fit.z.squaredNorm();
  return true;
}

}  // namespace

Eigen::Index Fit::own_place(const FreeParameter& parameter) const {
  for (std::size_t i = 0; i < own_count; ++i)
    if (parameters[i].is_same(parameter)) return static_cast<Eigen::Index>(i);
  throw std::logic_error("a fit has no parameter " + parameter.path + " of its own");
}

std::size_t tolerances_at_end(const Rig& rig, const Fit& fit) {
  std::size_t count = 0;
  for (std::size_t i = fit.own_count; i < fit.parameters.size(); ++i) {
    const FreeParameter& p = fit.parameters[i];
    if (rig.tolerances.count(p.path) > 0 && p.end_at(fit.z(static_cast<Eigen::Index>(i))) != 0) ++count;
  }
  return count;
}

Fit fit_at_start(const Rig& rig, FittedRows& rows, std::vector<FreeParameter> own,
                 const std::vector<FreeParameter>& nuisances) {
  Fit fit;
  fit.base.rig = rig;
  fit.base.start_factors.assign(rows.model().start_factor_count(), 0.0);
  fit.own_count = own.size();
  fit.parameters = std::move(own);
  for (const FreeParameter& nuisance : nuisances)
    if (std::none_of(fit.parameters.begin(), fit.parameters.end(),
                     [&](const FreeParameter& p) { return p.is_same(nuisance); }))
      fit.parameters.push_back(nuisance);
  fit.z.setZero(static_cast<Eigen::Index>(fit.parameters.size()));
  fit.freed_from = rows.slow_error();
  fit.residual.setZero(rows.count());
  fit.jacobian.setZero(rows.count(), fit.z.size());
  fit.known_columns.assign(fit.parameters.size(), 0);
  return fit;
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> shared_parameters(const Fit& a, const Fit& b) {
  const auto same_prior = [](const FreeParameter& one, const FreeParameter& other) {
    return one.spread == other.spread && one.lower == other.lower && one.upper == other.upper;
  };
  std::vector<std::pair<Eigen::Index, Eigen::Index>> out;
  for (std::size_t i = 0; i < a.parameters.size(); ++i)
    for (std::size_t k = 0; k < b.parameters.size(); ++k)
      if (a.parameters[i].is_same(b.parameters[k]) && same_prior(a.parameters[i], b.parameters[k]))
        out.emplace_back(i, k);
  return out;
}

Hypothesis Fit::hypothesis() const { return with_parameters(base, parameters, plain(z)); }

Eigen::MatrixXd Fit::curvature() const {
  Eigen::MatrixXd h = jacobian.transpose() * jacobian;
  h.diagonal().array() += 1.0;
  return h;
}

double Fit::log_evidence() const {
  const Eigen::LDLT<Eigen::MatrixXd> factors(curvature());
  return -0.5 * objective - 0.5 * factors.vectorD().array().max(1e-300).log().sum();
}

Eigen::MatrixXd Fit::covariance() const {
  return curvature().ldlt().solve(Eigen::MatrixXd::Identity(z.size(), z.size()));
}

void bring_to_slow_error(const FittedRows& rows, Fit& fit) {
  if (fit.freed_from == rows.slow_error()) return;
  const auto bring = [&](Eigen::Ref<Eigen::MatrixXd> columns) {
    if (fit.freed_from) fit.freed_from->put_back(columns);
    if (rows.slow_error()) rows.slow_error()->take_out(columns);
  };
  bring(fit.jacobian);
  bring(fit.residual);
  fit.freed_from = rows.slow_error();
  fit.objective = fit.residual.squaredNorm() + fit.z.squaredNorm();
}

void linearise(FittedRows& rows, const std::vector<Fit*>& fits) {
  std::vector<Hypothesis> hypotheses;
  std::vector<Probe> probes;
  for (Fit* fit : fits) {
    hypotheses.push_back(fit->hypothesis());
    probes.push_back({fit, {}, 0});
    if (fit->known_columns.size() != fit->parameters.size()) fit->known_columns.assign(fit->parameters.size(), 0);
    if (fit->jacobian.cols() != static_cast<Eigen::Index>(fit->parameters.size())) {
      fit->jacobian.setZero(rows.count(), static_cast<Eigen::Index>(fit->parameters.size()));
      fit->known_columns.assign(fit->parameters.size(), 0);
      fit->residual.setZero(rows.count());
      fit->freed_from = rows.slow_error();
    }
    bring_to_slow_error(rows, *fit);
    collect_probes(*fit, probes, hypotheses);
  }
  const Eigen::MatrixXd columns = rows(hypotheses);
  for (std::size_t p = 0; p < probes.size(); ++p) {
    const Probe& probe = probes[p];
    Fit& fit = *probe.fit;
    const auto column = columns.col(static_cast<Eigen::Index>(p));
    if (probe.columns.empty()) {
      if (!store_residual(fit, column)) fit.failed = true;
      continue;
    }
    if (fit.failed) continue;  // where it begins nothing can be computed, so there is no residual to compare with
    const Eigen::VectorXd derivative = (column - fit.residual) / probe.step;
    if (!derivative.allFinite()) fit.failed = true;
    for (const Eigen::Index c : probe.columns) {
      const FreeParameter& parameter = fit.parameters[static_cast<std::size_t>(c)];
      if (!parameter.is_of_recording()) fit.jacobian.col(c) = derivative;
      else
        for (Eigen::Index i = 0; i < rows.count(); ++i)
          fit.jacobian(i, c) = rows.row(i).recording == parameter.recording() ? derivative(i) : 0.0;
    }
  }
  for (Fit* fit : fits) fit->known_columns.assign(fit->parameters.size(), 1);
}

namespace {

/// A fit on its way: what its step starts from and how much it promises.
struct Stepping {
  Fit* fit;
  Eigen::MatrixXd curvature;
  Eigen::VectorXd start, gradient;
  double before, promised;
  Eigen::VectorXd undamped, residual_there;  ///< the step without damping, and the residual at its end
  std::array<double, dampings.size()> after{};  ///< objective at the end of each damped step; 1e300: not tried
  Eigen::VectorXd reached;  ///< the residual at the end of the step that was taken
};

/// The undamped step bent to where the residual really goes: r(z + d) - r - J d is what the linear model misses of it,
/// half its second derivative along d. In a narrow bent valley the undamped step alone climbs out and damped ones
/// creep.
Eigen::VectorXd bent_step(const Stepping& s) {
  const Fit& fit = *s.fit;
  const Eigen::VectorXd missed = s.residual_there - fit.residual - fit.jacobian * s.undamped;
  std::vector<Eigen::Index> free;  // what the step has led to a bound stays there
  for (Eigen::Index i = 0; i < s.start.size(); ++i) {
    const FreeParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    const double z = s.start(i) + s.undamped(i);
    if (z > p.lower && z < p.upper) free.push_back(i);
  }
  Eigen::VectorXd step = s.undamped;
  const Eigen::VectorXd right = fit.jacobian.transpose() * missed;
  step(free) -= s.curvature(free, free).ldlt().solve(right(free));
  for (Eigen::Index i = 0; i < step.size(); ++i) {
    const FreeParameter& p = fit.parameters[static_cast<std::size_t>(i)];
    step(i) = std::clamp(s.start(i) + step(i), p.lower, p.upper) - s.start(i);
  }
  return step;
}

/// A step to try, and where the objective at its end goes; null: nowhere.
struct Trial {
  Stepping* stepping;
  Eigen::VectorXd step;
  double* after = nullptr;
};

/// Tries every step for its fit, takes the best if it is better than where the fit stands; residuals of all.
Eigen::MatrixXd try_steps(FittedRows& rows, const std::vector<Trial>& trials) {
  std::vector<Hypothesis> hypotheses;
  hypotheses.reserve(trials.size());
  for (const auto& [s, step, after] : trials)
    hypotheses.push_back(with_parameters(s->fit->base, s->fit->parameters, plain(s->start + step)));
  Eigen::MatrixXd columns = rows(hypotheses);
  for (std::size_t at = 0; at < trials.size(); ++at) {
    const auto& [s, step, after] = trials[at];
    const auto column = columns.col(static_cast<Eigen::Index>(at));
    const Eigen::VectorXd place = s->start + step;
    const double objective = column.squaredNorm() + place.squaredNorm();
    if (!column.allFinite()) continue;
    if (after != nullptr) *after = objective;
    if (objective >= s->fit->objective) continue;
    s->fit->objective = objective;
    s->fit->z = place;
    s->reached = column;
  }
  return columns;
}

void add_damped(Stepping& s, std::size_t damping, std::vector<Trial>& trials) {
  trials.push_back({&s, bounded_step(*s.fit, s.start, s.curvature, s.gradient, dampings[damping]), &s.after[damping]});
}

/// The undamped step of every fit; where that does not keep what it promises, the bent one and every second damping
/// beside it, then those on both sides of the best: along the dampings the objective falls and rises again.
void step_on(FittedRows& rows, std::vector<Stepping>& steppings) {
  std::vector<Trial> trials;
  for (Stepping& s : steppings) {
    s.after.fill(1e300);
    s.undamped = bounded_step(*s.fit, s.start, s.curvature, s.gradient, dampings[0]);
    trials.push_back({&s, s.undamped, &s.after[0]});
  }
  const Eigen::MatrixXd there = try_steps(rows, trials);
  trials.clear();
  std::vector<Stepping*> damped;
  for (std::size_t i = 0; i < steppings.size(); ++i) {
    Stepping& s = steppings[i];
    if (s.promised < near_promise && s.before - s.fit->objective >= kept_promise * s.promised) continue;
    damped.push_back(&s);
    for (std::size_t d = 2; d < dampings.size(); d += 2) add_damped(s, d, trials);
    s.residual_there = there.col(static_cast<Eigen::Index>(i));
    if (s.promised < bent_share * s.before && s.residual_there.allFinite()) trials.push_back({&s, bent_step(s)});
  }
  try_steps(rows, trials);
  trials.clear();
  for (Stepping* s : damped) {
    const auto best = static_cast<std::size_t>(std::ranges::min_element(s->after) - s->after.begin());
    if (best > 0) add_damped(*s, best - 1, trials);
    if (best + 1 < dampings.size()) add_damped(*s, best + 1, trials);
  }
  try_steps(rows, trials);
}

/// Derivatives that are kept follow what the step found along itself: Broyden's update, the least change of them that
/// foretells the residual there.
void correct_columns(const Stepping& s) {
  Fit& fit = *s.fit;
  const Eigen::VectorXd step = fit.z - s.start;
  if (s.reached.size() == 0 || step.isZero(0)) return;
  const Eigen::VectorXd missed = s.reached - fit.residual - fit.jacobian * step;
  fit.jacobian.noalias() += missed * (step / step.squaredNorm()).transpose();
}

}  // namespace

void improve(FittedRows& rows, std::vector<Fit*> fits, int iterations, Columns columns_at_steps, double settled_gain) {
  std::erase_if(fits, [](const Fit* fit) { return fit->failed; });
  for (Fit* fit : fits) fit->settled = false;
  for (int iteration = 0; !fits.empty(); ++iteration) {
    linearise(rows, fits);
    std::erase_if(fits, [](const Fit* fit) { return fit->failed || fit->settled; });
    if (iteration == iterations) break;
    std::vector<Stepping> steppings;
    for (Fit* fit : fits) {
      Stepping s{fit, fit->curvature(), fit->z, fit->gradient(), fit->objective, 0, {}, {}, {}, {}};
      s.promised = promised_gain(*fit, s.curvature, s.gradient);
      fit->settled = s.promised < std::max(settled_gain, settled_share * fit->objective);
      if (!fit->settled) steppings.push_back(std::move(s));
    }
    std::erase_if(fits, [](const Fit* fit) { return fit->settled; });
    step_on(rows, steppings);
    for (const Stepping& s : steppings) {
      Fit& fit = *s.fit;
      fit.settled = s.before - fit.objective < std::max(settled_gain, settled_share * s.before);
      if (columns_at_steps == Columns::corrected) correct_columns(s);
      for (std::size_t i = 0; i < fit.parameters.size(); ++i)
        fit.known_columns[i] = columns_at_steps != Columns::all && i >= fit.own_count;
    }
  }
}

}  // namespace pneuservo
