// Closed-form gain of every candidate at one place: one column a start, all that is fitted anyway projected out.
#include "diagnosis/search/screening.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "config/rig_parameters.hpp"

namespace pneuservo {

namespace {

constexpr double largest_whole = 1.5;  ///< share of a whole effect (a droop) that its column may stand for

/// z of the candidate's parameters where `here` stands.
double place_in(const Rig& here, const FreeParameter& parameter) { return parameter.z(parameter.value_in(here)); }

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

/// The Jacobian without the columns of parameters that a bound holds: free of it they would run far beyond, and with
/// them most of what a candidate has to explain.
Eigen::MatrixXd without_held_columns(const Fit& fit) {
  constexpr double at_bound = 1e-9;
  Eigen::MatrixXd out = fit.jacobian;
  const Eigen::VectorXd gradient = fit.gradient();
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const bool held = (fit.z(at) >= fit.parameters[i].upper - at_bound && gradient(at) < 0) ||
                      (fit.z(at) <= fit.parameters[i].lower + at_bound && gradient(at) > 0);
    if (held) out.col(at).setZero();
  }
  return out;
}

}  // namespace

Screening::Screening(FittedRows& rows, const Fit& base, const std::vector<Candidate>& candidates,
                     const std::vector<std::size_t>& chosen, AtBound at_bound)
    : rows_(rows), base_(base), candidates_(candidates) {
  const Hypothesis here = base.hypothesis();
  std::vector<Hypothesis> hypotheses;
  for (const std::size_t index : chosen) collect(here, candidates[index], index, hypotheses);
  fill_columns(rows(hypotheses));
  free_jacobian_ = at_bound == AtBound::held ? without_held_columns(base) : base.jacobian;
  Eigen::MatrixXd g = free_jacobian_.transpose() * free_jacobian_;
  g.diagonal().array() += 1;
  const Eigen::MatrixXd cross = product(free_jacobian_, columns_);
  const Eigen::LDLT<Eigen::MatrixXd> factors(g);
  curvature_ = product(columns_, columns_) - cross.transpose() * factors.solve(cross);
  gradient_ = columns_.transpose() * base.residual -
              cross.transpose() * factors.solve(free_jacobian_.transpose() * base.residual + base.z);
}

Eigen::MatrixXd Screening::product(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right) const {
  constexpr Eigen::Index block = 32;
  Eigen::MatrixXd out(left.cols(), right.cols());
  for (Eigen::Index first = 0; first < right.cols(); first += block) {
    rows_.look();
    const Eigen::Index count = std::min(block, right.cols() - first);
    out.middleCols(first, count).noalias() = left.transpose() * right.middleCols(first, count);
  }
  return out;
}

int Screening::column_of_path(const std::string& path) const {
  for (std::size_t i = 0; i < base_.parameters.size(); ++i)
    if (base_.parameters[i].path == path) return static_cast<int>(i);
  return -1;
}

void Screening::collect(const Hypothesis& here, const Candidate& candidate, std::size_t index,
                        std::vector<Hypothesis>& hypotheses) {
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
      if (candidate.kind == CandidateKind::parameter && column_of_path(parameter.path) >= 0) {
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
    trials_.push_back(std::move(trial));
  }
  for (const std::vector<double>& start : candidate.whole_starts) {
    trials_.push_back({index, start, {}, {1.0}, {static_cast<Eigen::Index>(hypotheses.size())}, true});
    hypotheses.push_back(with_parameters(here, candidate.parameters, start));
  }
}

void Screening::fill_columns(const Eigen::MatrixXd& batch) {
  Eigen::Index count = 0;
  for (Trial& trial : trials_) {
    trial.first_column = count;
    count += static_cast<Eigen::Index>(trial.steps.size());
  }
  columns_.resize(base_.residual.size(), count);
  for (Trial& trial : trials_)
    for (std::size_t c = 0; c < trial.steps.size(); ++c) {
      const Eigen::Index at = trial.first_column + static_cast<Eigen::Index>(c);
      if (trial.hypotheses[c] >= 0) {
        columns_.col(at) = (batch.col(trial.hypotheses[c]) - base_.residual) / trial.steps[c];
      } else {
        const FreeParameter& parameter = candidates_[trial.candidate].parameters[trial.amplitudes[c]];
        const int known = column_of_path(parameter.path);
        columns_.col(at) =
            base_.jacobian.col(known) * (parameter.spread / base_.parameters[static_cast<std::size_t>(known)].spread);
      }
      if (columns_.col(at).allFinite()) continue;
      trial.usable = false;  // cannot be simulated there
      columns_.col(at).setZero();
    }
}

void Screening::add_bounds(const Trial& trial, Eigen::Index at, Eigen::VectorXd& lower, Eigen::VectorXd& upper,
                           Eigen::MatrixXd& a, Eigen::VectorXd& b) const {
  if (trial.amplitudes.empty()) {
    lower(at) = 0;
    upper(at) = largest_whole;
  }
  for (std::size_t c = 0; c < trial.amplitudes.size(); ++c, ++at) {
    const std::size_t p = trial.amplitudes[c];
    const FreeParameter& parameter = candidates_[trial.candidate].parameters[p];
    lower(at) = parameter.lower - trial.z[p];
    upper(at) = parameter.upper - trial.z[p];
    a(at, at) += 1;
    b(at) += trial.z[p];
  }
}

Screened Screening::with_amplitudes(const Trial& trial, const Eigen::VectorXd& amplitude,
                                    const Eigen::VectorXd& error) const {
  Screened out{trial.candidate, 0, trial.z, {}};
  for (std::size_t c = 0; c < trial.amplitudes.size(); ++c) {
    out.start[trial.amplitudes[c]] += amplitude(static_cast<Eigen::Index>(c));
    out.standard_error.push_back(error(static_cast<Eigen::Index>(c)));
  }
  return out;
}

Screened Screening::single(const Trial& trial) const {
  // A candidate that replaces a nuisance goes without that one's column and prior.
  std::vector<Eigen::Index> kept;
  double freed = 0;
  for (std::size_t i = 0; i < base_.parameters.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const FreeParameter& nuisance = base_.parameters[i];
    const bool replaced = !nuisance.is_of_recording() && stands_for(nuisance, candidates_[trial.candidate]);
    if (replaced) freed += base_.z(at) * base_.z(at);
    else kept.push_back(at);
  }
  const auto count = static_cast<Eigen::Index>(trial.steps.size());
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  if (kept.size() == base_.parameters.size()) {
    a = curvature_.block(trial.first_column, trial.first_column, count, count);
    b = gradient_.segment(trial.first_column, count);
  } else {
    const Eigen::MatrixXd x = columns_.middleCols(trial.first_column, count), j = free_jacobian_(Eigen::all, kept);
    Eigen::MatrixXd g = j.transpose() * j;
    g.diagonal().array() += 1;
    const Eigen::MatrixXd cross = j.transpose() * x;
    const Eigen::LDLT<Eigen::MatrixXd> factors(g);
    a = x.transpose() * x - cross.transpose() * factors.solve(cross);
    b = x.transpose() * base_.residual -
        cross.transpose() * factors.solve(j.transpose() * base_.residual + base_.z(kept));
  }
  Eigen::VectorXd lower(count), upper(count);
  a.diagonal().array() += 1e-9;
  add_bounds(trial, 0, lower, upper, a, b);
  const Eigen::VectorXd amplitude = boxed(a, b, lower, upper);
  Screened out = with_amplitudes(trial, amplitude, a.inverse().diagonal().array().max(0.0).sqrt().matrix());
  out.gain = freed - amplitude.dot(a * amplitude) - 2 * b.dot(amplitude);
  return out;
}

std::vector<Screened> Screening::singles() const {
  std::vector<Screened> out, whole;
  for (const Trial& trial : trials_) {
    rows_.look();
    if (out.empty() || out.back().candidate != trial.candidate) {
      out.push_back({trial.candidate, -1e300, trial.z, {}});
      whole.push_back(out.back());
    }
    if (!trial.usable) continue;
    Screened here = single(trial);
    Screened& best = trial.is_whole ? whole.back() : out.back();
    if (here.gain > best.gain) best = std::move(here);
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    Screened &best = out[i], &other = whole[i];
    if (other.gain > best.gain) {  // but a standard error is the derivative's alone
      std::swap(best.gain, other.gain);
      std::swap(best.start, other.start);
    }
    if (other.gain <= 0) continue;
    best.second_start = other.start;
    best.second_gain = other.gain;
  }
  return out;
}

std::vector<ScreenedPair> Screening::best_pairs(std::size_t count) const {
  std::map<std::pair<std::size_t, std::size_t>, ScreenedPair> best;
  for (std::size_t i = 0; i < trials_.size(); ++i) {
    rows_.look();
    for (std::size_t k = i + 1; k < trials_.size(); ++k) {
      const Trial &first = trials_[i], &second = trials_[k];
      if (first.candidate == second.candidate || !first.usable || !second.usable) continue;
      if (candidates_[first.candidate].is_never_added || candidates_[second.candidate].is_never_added) continue;
      const auto left = static_cast<Eigen::Index>(first.steps.size());
      const auto right = static_cast<Eigen::Index>(second.steps.size());
      std::vector<Eigen::Index> both;
      both.reserve(static_cast<std::size_t>(left + right));
      for (Eigen::Index c = 0; c < left; ++c) both.push_back(first.first_column + c);
      for (Eigen::Index c = 0; c < right; ++c) both.push_back(second.first_column + c);
      Eigen::MatrixXd a = curvature_(both, both);
      Eigen::VectorXd b = gradient_(both), lower(left + right), upper(left + right);
      a.diagonal().array() += 1e-9;
      add_bounds(first, 0, lower, upper, a, b);
      add_bounds(second, left, lower, upper, a, b);
      const Eigen::VectorXd amplitude = boxed(a, b, lower, upper);
      const double gain = -amplitude.dot(a * amplitude) - 2 * b.dot(amplitude);
      ScreenedPair& known = best[{first.candidate, second.candidate}];
      if (gain <= known.gain) continue;
      known = {with_amplitudes(first, amplitude.head(left), amplitude.head(left)),
               with_amplitudes(second, amplitude.tail(right), amplitude.tail(right)), gain};
    }
  }
  std::vector<ScreenedPair> out;
  out.reserve(best.size());
  for (const auto& [key, pair] : best) out.push_back(pair);
  std::stable_sort(out.begin(), out.end(),
                   [](const ScreenedPair& a, const ScreenedPair& b) { return a.gain > b.gain; });
  if (out.size() > count) out.resize(count);
  return out;
}

}  // namespace pneuservo
