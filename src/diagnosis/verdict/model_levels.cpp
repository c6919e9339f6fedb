// Levels of one model over its rows: what is above the floors, and above what the owner states.
#include <algorithm>
#include <array>
#include <cmath>

#include "diagnosis/residuals/known_rows.hpp"
#include "diagnosis/verdict/decision.hpp"

namespace pneuservo {

double ModelLevels::chi2(bool held_out) const {
  double sum = 0;
  for (const ChannelLevel& c : channels)
    sum += held_out ? std::pow(c.held_out / c.stated, 2) * static_cast<double>(c.held_out_rows)
                    : std::pow(c.beyond_stated(), 2) * static_cast<double>(c.fitted_rows);
  return sum;
}

double ModelLevels::highest() const {
  double most = 0;
  for (const ChannelLevel& c : channels) most = std::max(most, c.beyond_stated());
  return most;
}

double ModelLevels::highest_held_out() const {
  double most = 0;
  for (const ChannelLevel& c : channels) most = std::max(most, c.held_out / c.stated);
  return most;
}

double ModelLevels::held_out_ratio() const {
  double rows = 0, held_rows = 0;
  for (const ChannelLevel& c : channels) {
    rows += static_cast<double>(c.fitted_rows);
    held_rows += static_cast<double>(c.held_out_rows);
  }
  const double fitted = chi2(false), held = chi2(true);
  return held > held_rows && fitted > 0 ? (held / held_rows) / (fitted / rows) : 1;
}

namespace {

/// What that ratio is expected to be where nothing is missing: a fit takes its leverage from the rows that it sees, and
/// on others the uncertainty of its numbers adds to what they have themselves.
double expected_ratio(ResidualModel& model, const Fit& fit, const ModelLevels& levels) {
  FittedRows rows(model, {}, FittedRows::Which::all);
  Fit whole = fit;
  whole.jacobian.resize(0, 0);
  linearise(rows, {&whole});
  if (whole.failed) return 1;
  const Eigen::VectorXd leverage = (whole.jacobian * fit.covariance()).cwiseProduct(whole.jacobian).rowwise().sum();
  std::vector<std::array<double, 2>> by_channel(levels.channels.size());
  for (std::size_t i = 0; i < model.rows().size(); ++i) {
    const ResidualRow& row = model.rows()[i];
    if (!row.over_recording)
      by_channel[static_cast<std::size_t>(row.channel)][row.held_out] += leverage(static_cast<Eigen::Index>(i));
  }
  std::array<double, 2> sum{}, count{};
  for (std::size_t c = 0; c < by_channel.size(); ++c) {
    const ChannelLevel& level = levels.channels[c];
    if (level.fitted_rows == 0) continue;
    const auto fitted_rows = static_cast<double>(level.fitted_rows),
               held_rows = static_cast<double>(level.held_out_rows);
    const double stated = level.stated * level.stated, fitted = level.fitted * level.fitted;
    const double own = fitted + by_channel[c][0] / fitted_rows;  // of a row, before the fit took its part
    sum[0] += fitted_rows * fitted / stated;
    sum[1] += (held_rows * own + by_channel[c][1]) / stated;
    count[0] += fitted_rows;
    count[1] += held_rows;
  }
  if (!(sum[0] > 0) || !(count[1] > 0)) return 1;
  return std::max(1.0, (sum[1] / count[1]) / (sum[0] / count[0]));
}

}  // namespace

ModelLevels model_levels(ResidualModel& model, const Fit& fit, const DecisionRules& rules) {
  ModelLevels levels;
  levels.residual = residual_at(model, fit);
  levels.channels = channel_levels(model.rows(), model.channels().size(), levels.residual);
  for (std::size_t c = 0; c < levels.channels.size(); ++c)
    if (const double stated = model.channels()[c].stated; stated > 0 && levels.channels[c].sigma > 0)
      levels.channels[c].stated = std::hypot(1.0, stated / levels.channels[c].sigma);
  if (levels.held_out_ratio() > rules.worse_fit && model.simulates())
    levels.expected_ratio = expected_ratio(model, fit, levels);
  levels.line = strongest_line(model.rows(), levels.residual);
  if (levels.line) {
    const ResidualChannel& channel = model.channels()[static_cast<std::size_t>(levels.line->channel)];
    const bool is_small = levels.line->amplitude <
                          std::max(rules.line_amplitude * std::hypot(channel.noise, channel.floor), channel.stated);
    if (levels.line->ratio < rules.next_gain || is_small) levels.line.reset();
  }
  return levels;
}

}  // namespace pneuservo
