// What fits know of their residuals, of a model that is not to be asked any more.
#include "diagnosis/residuals/known_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>

namespace pneuservo {

namespace {

[[noreturn]] void refuse() { throw std::logic_error("a diagnosis that was stopped simulates nothing"); }

/// Root mean square over the rows of each channel.
std::vector<ChannelMisfit> misfit_of_rows(const ResidualModel& model, const Eigen::VectorXd& residual) {
  std::vector<ChannelMisfit> out(model.channels().size());
  std::vector<double> count(out.size());
  for (std::size_t i = 0; i < model.rows().size(); ++i) {
    const ResidualRow& row = model.rows()[i];
    if (row.over_recording) continue;
    const auto channel = static_cast<std::size_t>(row.channel);
    out[channel].fitted += std::pow(row.sigma * residual(static_cast<Eigen::Index>(i)), 2);
    ++count[channel];
  }
  for (std::size_t c = 0; c < out.size(); ++c) out[c].fitted = std::sqrt(out[c].fitted / std::max(1.0, count[c]));
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
  return model.simulates() ? model.sample_misfit(fit.hypothesis()) : misfit_of_rows(model, fit.residual);
}

std::vector<ResidualCourse> courses_at(ResidualModel& model, const Fit& fit) {
  return model.simulates() ? model.courses(fit.hypothesis()) : std::vector<ResidualCourse>{};
}

}  // namespace pneuservo
