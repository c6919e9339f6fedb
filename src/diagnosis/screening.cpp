// Closed-form gain of every candidate at one place: one column a start, all that is fitted anyway projected out.
#include "diagnosis/screening.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "config/rig_parameters.hpp"

namespace pneuservo {

namespace {

constexpr double largest_whole = 1.5;  ///< share of a whole effect (a droop) that its column may stand for

/// A start of a candidate: its columns are changes of the residual by one amplitude each, or one by the whole effect
/// where it has no amplitude.
struct Trial {
  std::size_t candidate;
  std::vector<double> z;                 ///< of the candidate's parameters, amplitudes as they are at the base
  std::vector<std::size_t> amplitudes;   ///< parameters that have a column; empty: the whole effect is one
  std::vector<double> steps;
  std::vector<Eigen::Index> hypotheses;  ///< of each column in the batch; -1: from the base's Jacobian
};

/// z of the candidate's parameters where `here` stands.
double place_in(const Rig& here, const FreeParameter& parameter) {
  return parameter.z(get_parameter(here, parameter.path));
}

int column_of_path(const Fit& base, const std::string& path) {
  for (std::size_t i = 0; i < base.parameters.size(); ++i)
    if (base.parameters[i].start_factor < 0 && base.parameters[i].path == path) return static_cast<int>(i);
  return -1;
}

void collect_trials(const Fit& base, const Hypothesis& here, const Candidate& candidate, std::size_t index,
                    std::vector<Trial>& trials, std::vector<Hypothesis>& hypotheses) {
  for (const std::vector<double>& start : candidate.starts) {
    Trial trial{index, start, {}, {}, {}};
    for (std::size_t p = 0; p < candidate.parameters.size(); ++p) {
      const FreeParameter& parameter = candidate.parameters[p];
      if (!candidate.amplitude[p]) continue;
      trial.z[p] = std::clamp(place_in(here.rig, parameter), parameter.lower, parameter.upper);
      trial.amplitudes.push_back(p);
    }
    for (const std::size_t p : trial.amplitudes) {
      const FreeParameter& parameter = candidate.parameters[p];
      trial.steps.push_back(parameter.step);
      if (candidate.kind == CandidateKind::parameter && column_of_path(base, parameter.path) >= 0) {
        trial.hypotheses.push_back(-1);
        continue;
      }
      std::vector<double> z = trial.z;
      z[p] += parameter.step;
      trial.hypotheses.push_back(static_cast<Eigen::Index>(hypotheses.size()));
      hypotheses.push_back(with_parameters(here, candidate.parameters, z));
    }
    if (trial.amplitudes.empty()) {
      trial.steps.push_back(1.0);
      trial.hypotheses.push_back(static_cast<Eigen::Index>(hypotheses.size()));
      hypotheses.push_back(with_parameters(here, candidate.parameters, trial.z));
    }
    trials.push_back(std::move(trial));
  }
}

Eigen::MatrixXd columns_of(const Trial& trial, const Fit& base, const Candidate& candidate,
                           const Eigen::MatrixXd& batch) {
  Eigen::MatrixXd columns(base.residual.size(), static_cast<Eigen::Index>(trial.steps.size()));
  for (std::size_t c = 0; c < trial.steps.size(); ++c) {
    const auto at = static_cast<Eigen::Index>(c);
    if (trial.hypotheses[c] >= 0) {
      columns.col(at) = (batch.col(trial.hypotheses[c]) - base.residual) / trial.steps[c];
      continue;
    }
    const FreeParameter& parameter = candidate.parameters[trial.amplitudes[c]];
    const int known = column_of_path(base, parameter.path);
    columns.col(at) =
        base.jacobian.col(known) * (parameter.spread / base.parameters[static_cast<std::size_t>(known)].spread);
  }
  return columns;
}

/// What one trial's columns gain when everything in the base that the candidate does not replace goes with them.
struct Gain {
  double chi2 = 0;
  Eigen::VectorXd amplitude, standard_error;
};

/// Minimum of x'Ax/2 + b'x in a box, by holding what leaves it.
Eigen::VectorXd boxed(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& lower,
                      const Eigen::VectorXd& upper) {
  Eigen::VectorXd x = a.ldlt().solve(-b);
  for (int pass = 0; pass < 20; ++pass) {  // coordinate descent: few and well-conditioned columns
    double moved = 0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const double next = std::clamp(x(i) - (a.row(i).dot(x) + b(i)) / a(i, i), lower(i), upper(i));
      moved = std::max(moved, std::abs(next - x(i)));
      x(i) = next;
    }
    if (moved < 1e-9) break;
  }
  return x;
}

Gain gain_of(const Trial& trial, const Eigen::MatrixXd& x, const Fit& base, const Candidate& candidate) {
  std::vector<Eigen::Index> kept;
  double freed = 0;  // prior cost that goes with a nuisance that the candidate replaces
  for (std::size_t i = 0; i < base.parameters.size(); ++i) {
    const bool replaced =
        std::any_of(candidate.parameters.begin(), candidate.parameters.end(), [&](const FreeParameter& p) {
          return base.parameters[i].start_factor < 0 && p.path == base.parameters[i].path;
        });
    if (replaced) freed += base.z(static_cast<Eigen::Index>(i)) * base.z(static_cast<Eigen::Index>(i));
    else kept.push_back(static_cast<Eigen::Index>(i));
  }
  const Eigen::MatrixXd j = base.jacobian(Eigen::all, kept);
  Eigen::MatrixXd g = j.transpose() * j;
  g.diagonal().array() += 1;
  const Eigen::MatrixXd cross = j.transpose() * x;
  const Eigen::LDLT<Eigen::MatrixXd> factors(g);
  const Eigen::VectorXd gradient = j.transpose() * base.residual + base.z(kept);
  Eigen::MatrixXd a = x.transpose() * x - cross.transpose() * factors.solve(cross);
  Eigen::VectorXd b = x.transpose() * base.residual - cross.transpose() * factors.solve(gradient);
  const Eigen::Index count = x.cols();
  Eigen::VectorXd lower = Eigen::VectorXd::Zero(count), upper = Eigen::VectorXd::Constant(count, largest_whole);
  for (std::size_t c = 0; c < trial.amplitudes.size(); ++c) {
    const auto at = static_cast<Eigen::Index>(c);
    const FreeParameter& parameter = candidate.parameters[trial.amplitudes[c]];
    lower(at) = parameter.lower - trial.z[trial.amplitudes[c]];
    upper(at) = parameter.upper - trial.z[trial.amplitudes[c]];
    a(at, at) += 1;
    b(at) += trial.z[trial.amplitudes[c]];
  }
  a.diagonal().array() += 1e-9;
  Gain gain;
  gain.amplitude = boxed(a, b, lower, upper);
  gain.chi2 = freed - gain.amplitude.dot(a * gain.amplitude) - 2 * b.dot(gain.amplitude);
  gain.standard_error = a.inverse().diagonal().array().max(0.0).sqrt();
  return gain;
}

}  // namespace

std::vector<Screened> screen_candidates(FittedRows& rows, const Fit& base, const std::vector<Candidate>& candidates,
                                        const std::vector<std::size_t>& chosen) {
  const Hypothesis here = base.hypothesis();
  std::vector<Trial> trials;
  std::vector<Hypothesis> hypotheses;
  for (const std::size_t index : chosen) collect_trials(base, here, candidates[index], index, trials, hypotheses);
  const Eigen::MatrixXd batch = rows(hypotheses);
  std::vector<Screened> out;
  for (const Trial& trial : trials) {
    const Candidate& candidate = candidates[trial.candidate];
    const Eigen::MatrixXd x = columns_of(trial, base, candidate, batch);
    if (out.empty() || out.back().candidate != trial.candidate) {
      out.push_back({trial.candidate, -1e300, trial.z, std::vector<double>(trial.amplitudes.size(), 0.0)});
    }
    if (!x.allFinite()) continue;
    const Gain gain = gain_of(trial, x, base, candidate);
    Screened& screened = out.back();
    if (gain.chi2 <= screened.gain) continue;
    screened.gain = gain.chi2;
    screened.start = trial.z;
    for (std::size_t c = 0; c < trial.amplitudes.size(); ++c)
      screened.start[trial.amplitudes[c]] += gain.amplitude(static_cast<Eigen::Index>(c));
    screened.standard_error.assign(gain.standard_error.data(),
                                   gain.standard_error.data() +
                                       (trial.amplitudes.empty() ? 0 : gain.standard_error.size()));
  }
  return out;
}

}  // namespace pneuservo
