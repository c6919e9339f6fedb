// What is left of a mismatch: size by channel, a line in its spectrum, the element whose pattern it has.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "diagnosis/search/candidates.hpp"

namespace pneuservo {

/// Root mean square of one channel's residual rows, in sigma; held-out rows apart.
struct ChannelLevel {
  double fitted = 0, held_out = 0;
  std::size_t fitted_rows = 0, held_out_rows = 0;
  double correlation = 0;  ///< of neighbours in time
  double sigma = 0;  ///< of a row [unit of the channel], root mean square
  double stated = 1;  ///< level up to which its owner says that the quantity may differ
  /// Of fitted rows, beside what the owner states.
  double beyond_stated() const { return fitted / stated; }
};
std::vector<ChannelLevel> channel_levels(const std::vector<ResidualRow>& rows, std::size_t channels,
                                         const Eigen::VectorXd& residual);

/// Whether pressures of both sides are above the limit: no single place makes that.
bool is_everywhere(const std::vector<ResidualChannel>& channels, const std::vector<ChannelLevel>& levels, double limit);

/// The strongest periodic part between 3 and 45 Hz, below half the rate of the rows.
struct SpectralLine {
  int channel = 0;
  double frequency_Hz = 0;
  double amplitude = 0;  ///< in the channel's unit
  double ratio = 0;      ///< its power over the running median of its neighbours
};
/// nullopt: the rows are too few or too slow.
std::optional<SpectralLine> strongest_line(const std::vector<ResidualRow>& rows, const Eigen::VectorXd& residual);

/// The sine between 3 and 45 Hz, below half the rate of the rows, that takes most of one channel's residual while the
/// slider moves, over all recordings at one frequency, each with its own phase; `ratio` is the share of the sum of
/// squares. At rest friction balances a force up to its hold force: there it cannot be seen. nullopt: hardly any
/// motion.
std::optional<SpectralLine> line_in_motion(const std::vector<ResidualRow>& rows, const Eigen::VectorXd& residual,
                                           int channel);

/// The strongest part of one channel's residual that is periodic along the way, such as the lead of a screw.
struct SpatialPeriod {
  double period_m = 0;
  double amplitude = 0;  ///< in the channel's unit
  double share = 0;      ///< of the sum of squares above the floor's
};
/// Over rows that move; periods from 1 mm to a third of the way. nullopt: nothing that takes a twentieth of what is
/// left.
std::optional<SpatialPeriod> strongest_period(const std::vector<ResidualRow>& rows, const Eigen::VectorXd& residual,
                                              int channel);

/// Share of a left-over mismatch that each element can have made: every candidate has a pattern over all channels; in
/// every short stretch of time an element's patterns may have any size.
struct ElementPattern {
  std::string element;
  double explained = 0;  ///< of the sum of squares
};
/// patterns: column i belongs to candidate of[i]. Best first.
std::vector<ElementPattern> element_patterns(const std::vector<ResidualRow>& rows, const Eigen::VectorXd& residual,
                                             const Eigen::MatrixXd& patterns, const std::vector<std::string>& elements);

}  // namespace pneuservo
