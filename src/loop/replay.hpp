// Runs estimator and controller on a recording and compares every output with the recorded one, bit for bit.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include <pneuservo/control/ppd2.hpp>
#include <pneuservo/control/reference.hpp>
#include <pneuservo/hal/backend.hpp>
#include <pneuservo/loop/axis_command.hpp>
#include <pneuservo/record/row.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// The first place where a replayed output differs from the recorded one.
struct ReplayDifference {
  std::size_t row = 0;
  double t_s = 0.0;
  std::string column;
  double recorded = 0.0, replayed = 0.0;
};

struct ReplayResult {
  std::vector<Row> rows;                       ///< as replayed
  std::vector<std::string> compared;           ///< columns compared
  std::size_t compared_rows = 0, differing_values = 0;
  std::vector<double> largest_difference;      ///< of each compared column where both have a value, in its unit
  std::vector<std::size_t> one_sided;          ///< of each compared column: values that only one of both has
  std::string end;                             ///< why it ended before the recording's last row; empty: it did not
  std::optional<ReplayDifference> first;
  bool identical() const noexcept { return differing_values == 0 && compared_rows > 0; }
};

/// Columns that the loop computes, in the order in which a difference would arise.
std::vector<std::string> replayed_columns(ControllerKind law);

/// `ticks[i]` is the tick of the recording's row i, `flags[i]` its RowFlag bits; `recorded(name)` its column or null.
/// `moves` as in the run. `commands[i]` is what a commanded axis obeyed in row i; none: it runs its reference.
/// `learned`: what the run began with, where the law learns a move.
/// Rows after dropped ones start from another state: the comparison ends there, `compared_rows` says where.
ReplayResult replay_loop(const Rig& rig, Backend& backend, const std::vector<std::int64_t>& ticks,
                         const std::vector<std::uint32_t>& flags, int moves, const LoadPositions& load,
                         const std::vector<std::pair<std::string, const std::vector<double>*>>& recorded,
                         const std::vector<Ppd2GainSet>& gains = {}, const std::vector<AxisCommand>& commands = {},
                         const LoadLearned& learned = {});

}  // namespace pneuservo
