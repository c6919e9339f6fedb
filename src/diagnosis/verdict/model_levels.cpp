// Levels of one model over its rows: what is above the floors, and above what the owner states.
#include <algorithm>
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

double ModelLevels::held_out_excess() const {
  double rows = 0, held_rows = 0;
  for (const ChannelLevel& c : channels) {
    rows += static_cast<double>(c.fitted_rows);
    held_rows += static_cast<double>(c.held_out_rows);
  }
  const double fitted = chi2(false), held = chi2(true);
  return held > held_rows && fitted > 0 ? (held / held_rows) / (fitted / rows) : 1;
}

ModelLevels model_levels(ResidualModel& model, const Fit& fit, const DecisionRules& rules) {
  ModelLevels levels;
  levels.residual = residual_at(model, fit);
  levels.channels = channel_levels(model.rows(), model.channels().size(), levels.residual);
  for (std::size_t c = 0; c < levels.channels.size(); ++c)
    if (const double stated = model.channels()[c].stated; stated > 0 && levels.channels[c].sigma > 0)
      levels.channels[c].stated = std::hypot(1.0, stated / levels.channels[c].sigma);
  levels.line = strongest_line(model.rows(), levels.residual, levels.channels, rules.line_level);
  if (levels.line) {
    const ResidualChannel& channel = model.channels()[static_cast<std::size_t>(levels.line->channel)];
    const bool is_small = levels.line->amplitude <
                          std::max(rules.line_amplitude * std::hypot(channel.noise, channel.floor), channel.stated);
    if (levels.line->ratio < rules.line_ratio || is_small) levels.line.reset();
  }
  return levels;
}

}  // namespace pneuservo
