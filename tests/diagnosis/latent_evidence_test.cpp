// Evidence for a free function of time: the same number as the dense Gaussian has, and a course that follows the truth.
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

#include <Eigen/Dense>

#include "diagnosis/latent/latent_evidence.hpp"

using namespace pneuservo;

namespace {

constexpr Eigen::Index row_count = 60, parameter_count = 3, piece_count = 20;

struct Problem {
  std::vector<ResidualRow> rows;
  Fit fit;
  LatentInput by_pieces, own;
  Eigen::MatrixXd covariance_of(const LatentInput& input, const LatentFit& at) const;
};

Eigen::MatrixXd ou(const std::vector<double>& time_s, double memory_s) {
  const auto n = static_cast<Eigen::Index>(time_s.size());
  return Eigen::MatrixXd::NullaryExpr(n, n, [&](Eigen::Index i, Eigen::Index k) {
    return std::exp(-std::abs(time_s[static_cast<std::size_t>(i)] - time_s[static_cast<std::size_t>(k)]) / memory_s);
  });
}

/// Covariance of the rows that the input makes.
Eigen::MatrixXd Problem::covariance_of(const LatentInput& input, const LatentFit& at) const {
  if (input.own_answer.size() > 0) {
    std::vector<double> time_s;
    for (const ResidualRow& row : rows) time_s.push_back(row.time_s);
    return at.level * at.level * input.own_answer.asDiagonal() * ou(time_s, at.memory_s) *
           input.own_answer.asDiagonal();
  }
  const LatentInput::Piece& piece = input.pieces.front();
  return at.level * at.level * piece.answer * ou(piece.time_s, at.memory_s) * piece.answer.transpose();
}

/// Rows of one channel; a slow wave of `size` is what the free function should find.
Problem problem(double size) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Problem out;
  out.rows.resize(row_count);
  for (std::size_t i = 0; i < out.rows.size(); ++i) out.rows[i].time_s = 0.05 * static_cast<double>(i);
  out.fit.z = Eigen::VectorXd::Zero(parameter_count);
  out.fit.jacobian = Eigen::MatrixXd::NullaryExpr(row_count, parameter_count, [&] { return normal(random); });
  LatentInput::Piece piece;
  for (Eigen::Index p = 0; p < piece_count; ++p) piece.time_s.push_back(0.05 + 0.15 * static_cast<double>(p));
  piece.answer = Eigen::MatrixXd::NullaryExpr(row_count, piece_count, [](Eigen::Index i, Eigen::Index p) {
    const double since_s = 0.05 * static_cast<double>(i) - 0.15 * static_cast<double>(p);  // fades in a second
    return since_s < 0 ? 0.0 : std::exp(-since_s);
  });
  out.own.own_answer = Eigen::VectorXd::Constant(row_count, -0.5);
  const Eigen::VectorXd wave = Eigen::VectorXd::NullaryExpr(
      piece_count, [](Eigen::Index p) { return std::sin(2.0 * 0.15 * static_cast<double>(p)); });
  out.fit.residual = Eigen::VectorXd::NullaryExpr(row_count, [&] { return normal(random); });
  out.fit.residual -= size * piece.answer * wave;
  out.by_pieces.pieces.push_back(std::move(piece));
  return out;
}

double dense_evidence(const Eigen::VectorXd& residual, const Eigen::MatrixXd& covariance) {
  const Eigen::LDLT<Eigen::MatrixXd> factors(covariance);
  return -0.5 * (residual.dot(factors.solve(residual)) + factors.vectorD().array().log().sum());
}

}  // namespace

TEST_CASE("latent evidence: is that of the dense Gaussian, parameters integrated out") {
  const Problem p = problem(4.0);
  const LatentEvidence evidence(p.rows, p.fit);
  const Eigen::MatrixXd plain =
      Eigen::MatrixXd::Identity(row_count, row_count) + p.fit.jacobian * p.fit.jacobian.transpose();
  CHECK(evidence.without() == Approx(dense_evidence(p.fit.residual, plain)).epsilon(1e-9));
  for (const LatentInput* input : {&p.by_pieces, &p.own}) {
    const LatentFit found = evidence.of(*input);
    REQUIRE(found.level > 0);
    CHECK(found.log_evidence ==
          Approx(dense_evidence(p.fit.residual, plain + p.covariance_of(*input, found))).epsilon(1e-9));
    CHECK(found.log_evidence > evidence.without() + 50);
  }
}

TEST_CASE("latent evidence: rows of noise alone give a free function nothing") {
  const Problem p = problem(0.0);
  const LatentEvidence evidence(p.rows, p.fit);
  CHECK(evidence.of(p.by_pieces).log_evidence < evidence.without() + 3);
  CHECK(evidence.of(p.own).log_evidence < evidence.without() + 3);
}

TEST_CASE("latent evidence: rows that are held out or over a recording do not count") {
  Problem p = problem(4.0);
  const double all = LatentEvidence(p.rows, p.fit).of(p.by_pieces).log_evidence;
  p.rows.push_back({});
  p.rows.back().over_recording = true;
  p.fit.residual.conservativeResize(row_count + 1);
  p.fit.jacobian.conservativeResize(row_count + 1, Eigen::NoChange);
  p.fit.residual(row_count) = 1e3;
  p.fit.jacobian.row(row_count).setConstant(1e3);
  CHECK(LatentEvidence(p.rows, p.fit).of(p.by_pieces).log_evidence == Approx(all).epsilon(1e-9));
}

TEST_CASE("latent evidence: the course is the function that acts, within its band") {
  const Problem p = problem(4.0);
  const LatentEvidence evidence(p.rows, p.fit);
  const LatentCourse course = evidence.course(p.by_pieces, evidence.of(p.by_pieces)).front();
  REQUIRE(course.mean.size() == piece_count);
  int within = 0;
  for (std::size_t i = 0; i < course.mean.size(); ++i)
    within += std::abs(course.mean[i] - 4.0 * std::sin(2.0 * 0.15 * static_cast<double>(i))) < 2 * course.deviation[i];
  CHECK(within >= 17);
  // The same function where rows answer at once: from the dense posterior.
  const LatentFit at = evidence.of(p.own);
  const LatentCourse own = evidence.course(p.own, at).front();
  const Eigen::MatrixXd made = p.covariance_of(p.own, at);
  const Eigen::MatrixXd all =
      made + Eigen::MatrixXd::Identity(row_count, row_count) + p.fit.jacobian * p.fit.jacobian.transpose();
  const Eigen::VectorXd mean = -(made * all.ldlt().solve(p.fit.residual)).cwiseQuotient(p.own.own_answer);
  for (Eigen::Index i = 0; i < row_count; ++i)
    CHECK(own.mean[static_cast<std::size_t>(i)] == Approx(mean(i)).epsilon(1e-6).margin(1e-9));
}
