// What fits know of their residuals, of a model that is not to be asked any more.
#include "diagnosis/residuals/known_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

namespace pneuservo {

namespace {

[[noreturn]] void refuse() { throw std::logic_error("a diagnosis that was stopped simulates nothing"); }

/// Root mean square over the rows of each channel of residuals in sigmas, in the channel's unit.
std::vector<double> rms_of_rows(const ResidualModel& model, const Eigen::VectorXd& residual) {
  std::vector<double> out(model.channels().size()), count(out.size());
  for (std::size_t i = 0; i < model.rows().size(); ++i) {
    const ResidualRow& row = model.rows()[i];
    if (row.over_recording) continue;
    const auto channel = static_cast<std::size_t>(row.channel);
    out[channel] += std::pow(row.sigma * residual(static_cast<Eigen::Index>(i)), 2);
    ++count[channel];
  }
  for (std::size_t c = 0; c < out.size(); ++c) out[c] = std::sqrt(out[c] / std::max(1.0, count[c]));
  return out;
}

}  // namespace

KnownRows::KnownRows(const ResidualModel& model) : channels_(model.channels()) {
  std::copy_if(model.rows().begin(), model.rows().end(), std::back_inserter(rows_),
               [](const ResidualRow& row) { return !row.held_out; });
}

Eigen::MatrixXd KnownRows::residuals(std::span<const Hypothesis>) { refuse(); }
std::vector<ChannelMisfit> KnownRows::sample_misfit(const Hypothesis&) { refuse(); }
std::vector<ResidualCourse> KnownRows::courses(const Hypothesis&) { refuse(); }

Eigen::VectorXd residual_at(ResidualModel& model, const Fit& fit) {
  if (!model.simulates()) return fit.residual;
  const std::array<Hypothesis, 1> here{fit.hypothesis()};
  return model.residuals(here).col(0);
}

std::vector<ChannelMisfit> misfit_at(ResidualModel& model, const Fit& fit) {
  if (model.simulates()) return model.sample_misfit(fit.hypothesis());
  std::vector<ChannelMisfit> out;
  for (const double rms : rms_of_rows(model, fit.residual))
    out.push_back({rms, std::numeric_limits<double>::quiet_NaN()});
  return out;
}

std::vector<double> floors_of_misfit(const ResidualModel& model) {
  if (!model.simulates())
    return rms_of_rows(model, Eigen::VectorXd::Ones(static_cast<Eigen::Index>(model.rows().size())));
  std::vector<double> out;
  for (const ResidualChannel& channel : model.channels()) out.push_back(std::hypot(channel.noise, channel.floor));
  return out;
}

std::vector<ResidualCourse> courses_at(ResidualModel& model, const Fit& fit) {
  return model.simulates() ? model.courses(fit.hypothesis()) : std::vector<ResidualCourse>{};
}

}  // namespace pneuservo
