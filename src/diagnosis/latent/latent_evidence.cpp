// Evidence for a free function of time at one element.
#include "diagnosis/latent/latent_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace pneuservo {

namespace {

/// Memories that are tried. A function that keeps its value for longer than 2 s is an offset; what changes faster than
/// a piece cannot be seen where gas is between.
constexpr std::array piece_memories_s{0.1, 0.3, 1.0}, own_memories_s{0.02, 0.1, 0.5};
/// Levels that are tried: from one that no row shows to one beside which every row is exact, in steps of 1.6.
constexpr double least_seen = 0.1, most_seen = 1e9, level_step = 1.6;

std::vector<double> levels_for(double strongest) {
  std::vector<double> out;
  if (!(strongest > 0)) return out;
  for (double level = std::sqrt(least_seen / strongest); level * level * strongest < most_seen; level *= level_step)
    out.push_back(level);
  return out;
}

/// One level that was tried at one memory.
struct Tried {
  double level, memory_s, log_evidence;
};

/// The likeliest, and the level below which 95 % of the evidence lies; levels count by the width of their steps.
LatentFit best_of(std::vector<Tried> tried, double without) {
  LatentFit best{without, 0, 0, 0};
  for (const Tried& t : tried)
    if (t.log_evidence > best.log_evidence) best = {t.log_evidence, t.level, t.memory_s, 0};
  std::sort(tried.begin(), tried.end(), [](const Tried& a, const Tried& b) { return a.level < b.level; });
  const auto weight = [&](const Tried& t) { return t.level * std::exp(t.log_evidence - best.log_evidence); };
  double all = 0, below = 0, last = 0;
  for (const Tried& t : tried) all += weight(t);
  for (const Tried& t : tried) {
    const double share = weight(t) / std::max(all, 1e-300);
    if (below + share >= 0.95) {
      best.upper_level = last + (t.level - last) * (0.95 - below) / share;
      break;
    }
    below += share;
    last = t.level;
  }
  return best;
}

/// Correlation of the process at these times.
Eigen::MatrixXd correlation(const std::vector<double>& time_s, double memory_s) {
  const auto n = static_cast<Eigen::Index>(time_s.size());
  Eigen::MatrixXd out(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k)
      out(i, k) =
          std::exp(-std::abs(time_s[static_cast<std::size_t>(i)] - time_s[static_cast<std::size_t>(k)]) / memory_s);
  return out;
}

LatentCourse course_at(int recording, const std::vector<double>& time_s, const Eigen::VectorXd& mean,
                       const Eigen::VectorXd& variance) {
  LatentCourse out{recording, time_s, {mean.data(), mean.data() + mean.size()}, {}};
  for (const double v : variance) out.deviation.push_back(std::sqrt(std::max(v, 0.0)));
  return out;
}

}  // namespace

double LatentEvidence::Normal::log_evidence() const {
  const Eigen::LDLT<Eigen::MatrixXd> factors(curvature);
  return -0.5 * (squares - gradient.dot(factors.solve(gradient)) + factors.vectorD().array().max(1e-300).log().sum() +
                 log_determinant);
}

Eigen::VectorXd LatentEvidence::Normal::moved() const { return -curvature.ldlt().solve(gradient); }

LatentEvidence::LatentEvidence(const std::vector<ResidualRow>& rows, const Fit& fit) : rows_(rows), z_(fit.z) {
  residual_.setZero(static_cast<Eigen::Index>(rows.size()));
  jacobian_.setZero(static_cast<Eigen::Index>(rows.size()), fit.z.size());
  Eigen::Index fitted = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].held_out) continue;
    const auto at = static_cast<Eigen::Index>(i);
    if (!rows[i].over_recording) {
      used_.push_back(at);
      residual_(at) = fit.residual(fitted);
      jacobian_.row(at) = fit.jacobian.row(fitted);
    }
    ++fitted;
  }
  alone_.squares = residual_.squaredNorm() + z_.squaredNorm();
  alone_.gradient = jacobian_.transpose() * residual_ + z_;
  alone_.curvature = jacobian_.transpose() * jacobian_;
  alone_.curvature.diagonal().array() += 1.0;
  without_ = alone_.log_evidence();
}

LatentFit LatentEvidence::of(const LatentInput& input) const {
  return input.own_answer.size() > 0 ? of_own(input) : of_pieces(input);
}

std::vector<LatentEvidence::Gram> LatentEvidence::grams_of(const LatentInput& input) const {
  std::vector<Gram> out;
  for (const LatentInput::Piece& piece : input.pieces) {
    Eigen::MatrixXd answer = piece.answer;
    const auto first = static_cast<Eigen::Index>(piece.first_row);
    for (Eigen::Index i = 0; i < answer.rows(); ++i) {
      const ResidualRow& row = rows_[static_cast<std::size_t>(first + i)];
      if (row.held_out || row.over_recording) answer.row(i).setZero();
    }
    out.push_back({answer.transpose() * answer, answer.transpose() * jacobian_.middleRows(first, answer.rows()),
                   answer.transpose() * residual_.segment(first, answer.rows())});
  }
  return out;
}

LatentEvidence::Solved LatentEvidence::solved(const Gram& gram, const std::vector<double>& time_s, double memory_s) {
  const Eigen::MatrixXd root = correlation(time_s, memory_s).llt().matrixL();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> along(root.transpose() * gram.own * root);
  const Eigen::MatrixXd back = root * along.eigenvectors();
  return {along.eigenvalues().cwiseMax(0.0), back.transpose() * gram.along, back.transpose() * gram.beside, back};
}

LatentEvidence::Normal LatentEvidence::beside(const std::vector<Solved>& pieces, double level) const {
  Normal out = alone_;
  for (const Solved& piece : pieces) {
    const Eigen::ArrayXd grown = 1.0 + level * level * piece.eigenvalue.array();
    const Eigen::VectorXd share = level * level / grown;
    const Eigen::MatrixXd weighted = share.asDiagonal() * piece.beside;
    out.curvature.noalias() -= piece.beside.transpose() * weighted;
    out.gradient.noalias() -= weighted.transpose() * piece.along;
    out.squares -= piece.along.dot(share.cwiseProduct(piece.along));
    out.log_determinant += grown.log().sum();
  }
  return out;
}

std::vector<LatentEvidence::Solved> LatentEvidence::solved_of(const LatentInput& input, const std::vector<Gram>& grams,
                                                              double memory_s) {
  std::vector<Solved> out;
  for (std::size_t p = 0; p < grams.size(); ++p) out.push_back(solved(grams[p], input.pieces[p].time_s, memory_s));
  return out;
}

LatentFit LatentEvidence::of_pieces(const LatentInput& input) const {
  std::vector<Tried> tried;
  const std::vector<Gram> grams = grams_of(input);
  for (const double memory_s : piece_memories_s) {
    const std::vector<Solved> pieces = solved_of(input, grams, memory_s);
    double strongest = 0;
    for (const Solved& piece : pieces)
      if (piece.eigenvalue.size() > 0) strongest = std::max(strongest, piece.eigenvalue.maxCoeff());
    for (const double level : levels_for(strongest))
      tried.push_back({level, memory_s, beside(pieces, level).log_evidence()});
  }
  return best_of(std::move(tried), without_);
}

LatentEvidence::Others LatentEvidence::others_of(const LatentInput& input) const {
  Others out{alone_, {}};
  for (const Eigen::Index i : used_)
    if (input.own_answer(i) != 0) out.answering.push_back(i);
  const Eigen::MatrixXd columns = jacobian_(out.answering, Eigen::all);
  const Eigen::VectorXd residual = residual_(out.answering);
  out.normal.curvature.noalias() -= columns.transpose() * columns;
  out.normal.gradient.noalias() -= columns.transpose() * residual;
  out.normal.squares -= residual.squaredNorm();
  return out;
}

LatentEvidence::Normal LatentEvidence::beside_own(const LatentInput& input, const Others& others, double level,
                                                  double memory_s) const {
  // The Kalman filter for the process, over the residual and every column alike.
  const Eigen::Index count = z_.size(), rows = static_cast<Eigen::Index>(others.answering.size());
  Eigen::MatrixXd white(count + 1, rows);  // a row of the model is a column here
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(count + 1);
  Normal out = others.normal;
  double variance = 1;
  const ResidualRow* last = nullptr;
  for (Eigen::Index k = 0; k < rows; ++k) {
    const Eigen::Index i = others.answering[static_cast<std::size_t>(k)];
    const double answer = level * input.own_answer(i);
    const ResidualRow& row = rows_[static_cast<std::size_t>(i)];
    const bool goes_on = last != nullptr && last->recording == row.recording && last->channel == row.channel;
    const double kept = goes_on ? std::exp(-(row.time_s - last->time_s) / memory_s) : 0.0;
    expected *= kept;
    variance = 1 + kept * kept * (variance - 1);
    const double total = answer * answer * variance + 1;
    auto here = white.col(k);
    here.head(count) = jacobian_.row(i).transpose();
    here(count) = residual_(i);
    here -= answer * expected;
    expected += variance * answer / total * here;
    variance /= total;
    here /= std::sqrt(total);
    out.log_determinant += std::log(total);
    last = &row;
  }
  const Eigen::VectorXd residual = white.row(count).transpose();
  out.curvature.noalias() += white.topRows(count) * white.topRows(count).transpose();
  out.gradient.noalias() += white.topRows(count) * residual;
  out.squares += residual.squaredNorm();
  return out;
}

LatentFit LatentEvidence::of_own(const LatentInput& input) const {
  std::vector<Tried> tried;
  const double strongest = input.own_answer.array().square().maxCoeff();
  const Others others = others_of(input);
  for (const double memory_s : own_memories_s)
    for (const double level : levels_for(strongest))
      tried.push_back({level, memory_s, beside_own(input, others, level, memory_s).log_evidence()});
  return best_of(std::move(tried), without_);
}

Eigen::VectorXd LatentEvidence::parameters_beside(const LatentInput& input, const LatentFit& fit) const {
  const Normal normal = input.own_answer.size() > 0
                            ? beside_own(input, others_of(input), fit.level, fit.memory_s)
                            : beside(solved_of(input, grams_of(input), fit.memory_s), fit.level);
  return z_ + normal.moved();
}

std::vector<LatentCourse> LatentEvidence::course(const LatentInput& input, const LatentFit& fit) const {
  return input.own_answer.size() > 0 ? course_of_own(input, fit) : course_of_pieces(input, fit);
}

std::vector<LatentCourse> LatentEvidence::course_of_pieces(const LatentInput& input, const LatentFit& fit) const {
  const std::vector<Solved> pieces = solved_of(input, grams_of(input), fit.memory_s);
  const Normal normal = beside(pieces, fit.level);
  const Eigen::LDLT<Eigen::MatrixXd> factors(normal.curvature);
  const Eigen::VectorXd moved = normal.moved();
  std::vector<LatentCourse> out;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Solved& piece = pieces[p];
    const Eigen::VectorXd left = (1.0 + fit.level * fit.level * piece.eigenvalue.array()).inverse();
    const Eigen::MatrixXd back = fit.level * piece.back;
    const Eigen::VectorXd mean = back * (-fit.level * left.cwiseProduct(piece.along + piece.beside * moved));
    const Eigen::MatrixXd by_moved = back * (fit.level * left.asDiagonal() * piece.beside);
    const Eigen::VectorXd variance =
        (back * left.asDiagonal()).cwiseProduct(back).rowwise().sum() +
        by_moved.transpose().cwiseProduct(factors.solve(by_moved.transpose())).colwise().sum().transpose();
    out.push_back(course_at(input.pieces[p].recording, input.pieces[p].time_s, mean, variance));
  }
  return out;
}

std::vector<LatentCourse> LatentEvidence::course_of_own(const LatentInput& input, const LatentFit& fit) const {
  const Others others = others_of(input);
  std::map<int, std::vector<Eigen::Index>> recordings;
  for (const Eigen::Index i : others.answering) recordings[rows_[static_cast<std::size_t>(i)].recording].push_back(i);
  struct Part {
    Eigen::MatrixXd joint;   ///< covariance of the function and what the rows see of it
    Eigen::LLT<Eigen::MatrixXd> seen;
    std::vector<double> time_s;
  };
  std::map<int, Part> parts;
  const Normal normal = beside_own(input, others, fit.level, fit.memory_s);
  for (const auto& [recording, at] : recordings) {
    Part& part = parts[recording];
    for (const Eigen::Index i : at) part.time_s.push_back(rows_[static_cast<std::size_t>(i)].time_s);
    const Eigen::VectorXd answer = input.own_answer(at);
    part.joint = fit.level * fit.level * correlation(part.time_s, fit.memory_s) * answer.asDiagonal();
    Eigen::MatrixXd covariance = answer.asDiagonal() * part.joint;
    covariance.diagonal().array() += 1.0;
    part.seen.compute(covariance);
  }
  const Eigen::LDLT<Eigen::MatrixXd> factors(normal.curvature);
  const Eigen::VectorXd moved = normal.moved();
  std::vector<LatentCourse> out;
  for (const auto& [recording, at] : recordings) {
    const Part& part = parts.at(recording);
    const Eigen::MatrixXd columns = jacobian_(at, Eigen::all);
    const Eigen::VectorXd mean = -part.joint * part.seen.solve(Eigen::VectorXd(residual_(at)) + columns * moved);
    const Eigen::MatrixXd by_moved = part.joint * part.seen.solve(columns);
    const Eigen::VectorXd variance =
        (fit.level * fit.level -
         part.joint.transpose().cwiseProduct(part.seen.solve(part.joint.transpose())).colwise().sum().array())
            .matrix()
            .transpose() +
        by_moved.transpose().cwiseProduct(factors.solve(by_moved.transpose())).colwise().sum().transpose();
    out.push_back(course_at(recording, part.time_s, mean, variance));
  }
  return out;
}

}  // namespace pneuservo
