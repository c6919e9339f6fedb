// What fits know of their residuals, of a model that is not to be asked any more.
#include "diagnosis/residuals/known_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "diagnosis/recordings/held_out.hpp"
#include "record/column_values.hpp"

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

/// What the mean of a usual row holds of noise and floor. A sigma weighs rows: its floor is raised by how long that
/// stays the same.
double floor_of_rows(const ResidualModel& model, std::size_t channel) {
  std::vector<double> steps_s, sigmas;
  const ResidualRow* before = nullptr;
  for (const ResidualRow& row : model.rows()) {
    if (row.over_recording || row.channel != static_cast<int>(channel)) continue;
    sigmas.push_back(row.sigma);
    if (before != nullptr && before->recording == row.recording) steps_s.push_back(row.time_s - before->time_s);
    before = &row;
  }
  const double floor = model.channels()[channel].floor;
  if (steps_s.empty()) return std::hypot(model.channels()[channel].noise, floor);
  const double raised = std::max(1.0, floor_correlation_s / median_of(steps_s)), sigma = median_of(sigmas);
  return std::sqrt(std::max(sigma * sigma - floor * floor * (raised - 1), floor * floor));
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
  std::vector<double> out;
  for (std::size_t c = 0; c < model.channels().size(); ++c)
    out.push_back(model.simulates() ? std::hypot(model.channels()[c].noise, model.channels()[c].floor)
                                    : floor_of_rows(model, c));
  return out;
}

std::vector<ResidualCourse> courses_at(ResidualModel& model, const Fit& fit) {
  return model.simulates() ? model.courses(fit.hypothesis()) : std::vector<ResidualCourse>{};
}

}  // namespace pneuservo
